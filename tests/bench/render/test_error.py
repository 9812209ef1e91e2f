"""The renderer against a path tracer: same scene, same light, a committed picture."""

import json
from collections.abc import Iterator

import pytest

from ashe_live.bench.render.error import Reference, picture_error, read_references
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.gl.offscreen import Context, offscreen_context
from tests.checkout import CHECKOUT

FOLDER = CHECKOUT / "assets" / "reference"
VIEWS = json.loads((FOLDER / "reference.json").read_text(encoding="utf-8"))["views"]
NAMES = [f"{view['name']}, {model}" for view in VIEWS for model in view["models"]]


@pytest.fixture(scope="module")
def ctx() -> Iterator[Context]:
    ctx = offscreen_context()
    yield ctx
    ctx.release()


@pytest.fixture(scope="module")
def references() -> dict[str, Reference]:
    return {reference.name: reference for reference in read_references(FOLDER)}


@pytest.mark.parametrize("preset", [FAST.render, BALANCED.render], ids=["fast", "balanced"])
@pytest.mark.parametrize("name", NAMES)
def test_shadows_and_colours_are_near_the_path_tracers(
    ctx: Context, references: dict[str, Reference], name: str, preset
) -> None:
    reference = references[name]
    error = picture_error(ctx, reference, preset)
    # Where the real object hides the sky at its foot, that is taken for its shadow, and leaves a seam.
    assert error.shadow_iou >= (0.95 if reference.kind == "directional" else 0.94)
    assert error.shadow_de < 6
    # The tree's leaves are as small as pixels, and each is lit or in shadow.
    assert error.model_de < (9.5 if "tree" in name else 7)


def test_as_many_scenes_have_lamps_as_suns(references: dict[str, Reference]) -> None:
    kinds = [reference.kind for reference in references.values()]
    assert kinds.count("lamp") == len(kinds) // 2 == 6

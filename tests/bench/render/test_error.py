"""The renderer against a path tracer: same scene, same light, a committed picture."""

import pytest

from ashe_live.bench.render.error import picture_error, read_references
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.gl.offscreen import offscreen_context
from tests.checkout import CHECKOUT

REFERENCES = read_references(CHECKOUT / "assets" / "reference")


@pytest.mark.parametrize("preset", [FAST.render, BALANCED.render], ids=["fast", "balanced"])
@pytest.mark.parametrize("reference", REFERENCES, ids=lambda reference: reference.name)
def test_shadows_and_colours_are_near_the_path_tracers(reference, preset) -> None:
    error = picture_error(offscreen_context(), reference, preset)
    # Where the real object hides the sky at its foot, that is taken for its shadow, and leaves a seam.
    assert error.shadow_iou >= (0.95 if reference.kind == "directional" else 0.94)
    assert error.shadow_de < 6
    # The tree's leaves are as small as pixels, and each is lit or in shadow.
    assert error.model_de < (9.5 if "tree" in reference.name else 7)


def test_as_many_scenes_have_lamps_as_suns() -> None:
    assert [reference.kind for reference in REFERENCES].count("lamp") == len(REFERENCES) // 2 == 6

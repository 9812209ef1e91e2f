"""The renderer against a path tracer: same scene, same light, a committed picture."""

from pathlib import Path

import pytest

from ashe_live.bench.render.error import picture_error, read_references
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.offscreen import offscreen_context

REFERENCES = read_references(Path(__file__).resolve().parents[3] / "assets" / "reference")


@pytest.mark.parametrize("preset", [FAST.render, BALANCED.render], ids=["fast", "balanced"])
@pytest.mark.parametrize("reference", REFERENCES, ids=lambda reference: reference.name)
def test_shadows_and_colours_are_near_the_path_tracers(reference, preset) -> None:
    error = picture_error(offscreen_context(), reference, preset)
    assert error.shadow_iou >= 0.95
    assert error.shadow_de < 6
    assert error.model_de < 7

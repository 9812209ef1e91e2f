"""How much a picture shows of the object and the shadow that a light was found by."""

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.views.in_view import share_shown
from tests.light.synthetic_masks import camera_towards

CAMERA = Camera.from_hfov((640, 480), 60)

BODY = Proxy("cylinder", np.array([[0.1, 0.0, 0.0, 0.03, 0.0], [0.1, 0.0, 0.1, 0.03, 0.0]]))


def shown(towards: tuple[float, float], distance_m: float, light: Light | None, body: Proxy | None = BODY) -> float:
    width, height = CAMERA.size
    T = camera_towards(towards, distance_m, 60.0)
    pose = MarkerPose(T, np.zeros((4, 2)), 0.08, 0.1, None)
    tracked = TrackedFrame(Frame(np.zeros((height, width, 3), np.uint8), 0, 0.0), CAMERA, pose)
    lights = () if light is None else (light,)
    reason = None if lights else "none"
    return share_shown(LightEstimate("test", 0, Illumination(lights, real_object=body), reason), tracked)


@pytest.mark.parametrize("light", [Light((1.0, 0.0, 1.0)), Light((1.0, 0.0, 1.0), inverse_distance=1.5)])
def test_object_and_shadow_must_be_in_the_picture(light: Light) -> None:
    """The object stands at x = 0.1, and its shadow falls towards -x."""
    assert shown((0.05, 0.0), 0.5, light) == 1
    assert shown((0.0, 0.3), 0.12, light) == 0
    assert shown((0.2, 0.0), 0.12, light) < 0.5, "only the object is in view"
    assert shown((-0.1, 0.0), 0.12, light) < 0.5, "only the end of the shadow is"


def test_where_nothing_is_known_nothing_is_missing() -> None:
    assert shown((0.0, 0.3), 0.12, Light((1.0, 0.0, 1.0)), None) == 1
    assert shown((0.0, 0.3), 0.12, None) == 1


def test_a_lamp_below_the_top_casts_no_shadow_to_be_seen() -> None:
    assert shown((0.05, 0.0), 0.5, Light((1.0, 0.0, 1.0), inverse_distance=12.0)) == 0

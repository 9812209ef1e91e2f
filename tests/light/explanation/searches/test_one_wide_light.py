"""What darkens a shadow in part, as a second light would: on painted scenes with one light it stays one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.transforms import angle_between, raycast_to_plane
from ashe_live.light.estimators.proxy import ProxyEstimator
from tests.light.painted_scenes import BOX, CYLINDER, Caster, Painted, paint


def with_hidden_sky(painted: Painted, caster: Caster, share: float, reach_m: float) -> Painted:
    """The picture with ground that gets darker by up to `share` towards the caster's foot, where it sees less sky."""
    frame = painted.tracked.frame
    height, width = frame.image_bgr.shape[:2]
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=2).reshape(-1, 2).astype(np.float64)
    places = raycast_to_plane(painted.tracked.camera, painted.tracked.pose.T_cam_marker, pixels)[:, :2]
    away = np.maximum(np.linalg.norm(places - caster.at, axis=1) - caster.width_m / 2, 0.0)
    left = np.where(painted.body.ravel(), 1.0, 1 - share * np.exp(-away / reach_m)).reshape(height, width, 1)
    image = np.round(255 * srgb_from_linear(linear_from_srgb(frame.image_bgr / 255.0) * left)).astype(np.uint8)
    return replace(painted, tracked=replace(painted.tracked, frame=replace(frame, image_bgr=image)))


def errors_deg(painted: Painted, *truths: Float) -> list[float]:
    """Of each light that is answered, the angle to the nearest of the true ones."""
    answers = [light.to_light_marker for light in ProxyEstimator().estimate(painted.tracked).lights]
    return [min(math.degrees(angle_between(answer, truth)) for truth in truths) for answer in answers]


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=["box", "cylinder"])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_sky_that_the_object_hides_at_its_foot_is_no_second_light(caster: Caster, share: float) -> None:
    painted = with_hidden_sky(paint(caster), caster, share, reach_m=0.02)
    errors = errors_deg(painted, painted.to_light)
    assert len(errors) == 1
    assert errors[0] < 3


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=["box", "cylinder"])
@pytest.mark.parametrize("penumbra_px", [2.0, 5.0, 9.0])
def test_a_wide_penumbra_is_no_second_light(caster: Caster, penumbra_px: float) -> None:
    painted = paint(caster, penumbra_px=penumbra_px)
    assert len(errors_deg(painted, painted.to_light)) == 1

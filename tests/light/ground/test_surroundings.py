"""An object that a wall behind the table, or the floor beyond its edge, is seen beside is told from that."""

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.view_search import Trace
from ashe_live.light.ground.surroundings import BORDER_PX, LEAST_BORDER, stands_inside, surroundings_in
from tests.light.painted_regions import in_region, painted_region
from tests.light.painted_scenes import BOX, Caster, Painted, overlap, paint, tracked_frame
from tests.light.synthetic_masks import camera_towards

TALL = Caster("cylinder", at=(0.1, 0.08), width_m=0.06, height_m=0.16, rgb=(0.1, 0.25, 0.5))
WALLS = {"dark": (60, 70, 90), "pale": (190, 215, 225)}  # sRGB, BGR
LOW = camera_towards((0.05, 0.02), 0.6, 30.0)


def _before_a_wall(wall: tuple[int, int, int], azimuth_deg: float = 130.0) -> tuple[Painted, Mask]:
    """A tall cylinder whose upper half is seen before a wall, and where the wall is seen, (h, w)."""
    scene = paint(TALL, azimuth_deg=azimuth_deg, elevation_deg=45.0, T_cam_marker=LOW)
    rows = np.flatnonzero(scene.body.any(axis=1))
    behind = np.zeros_like(scene.body)
    behind[: (rows[0] + rows[-1]) // 2] = True
    assert not (behind & scene.shadow).any()
    behind &= ~scene.body
    image = np.array(scene.tracked.frame.image_bgr)
    noise = np.random.default_rng(1).normal(0, 1.5, image.shape)
    # One side of a room is brighter than the other.
    shading = np.linspace(0.9, 1.1, image.shape[1])[:, None]
    image[behind] = (np.array(wall) * shading + noise)[behind].clip(0, 255).astype(np.uint8)
    tracked = tracked_frame(image, scene.tracked.camera, LOW)
    return Painted(tracked, scene.to_light, scene.body, scene.shadow, scene.sheet), behind


@pytest.fixture(scope="module", params=WALLS)
def traced(request: pytest.FixtureRequest) -> tuple[Painted, Mask, Trace, float | None]:
    scene, behind = _before_a_wall(WALLS[request.param])
    estimate, trace = ProxyEstimator().traced(scene.tracked)
    light = estimate.light
    return scene, behind, trace, None if light is None else angle_between(light.to_light_marker, scene.to_light)


def test_the_object_before_a_wall_is_a_region_of_its_own(traced) -> None:
    scene, behind, trace, _ = traced
    region = trace.regions[0]
    assert overlap(region.unlit, in_region(region, scene.body | scene.shadow)) > 0.85
    assert region.surroundings is not None
    assert (in_region(region, behind) & region.surroundings).sum() > 0.8 * region.surroundings.sum()
    assert not (region.surroundings & in_region(region, scene.shadow)).any()


def test_the_wall_is_neither_object_nor_shadow(traced) -> None:
    _, behind, trace, error = traced
    assert error is not None
    assert np.degrees(error) < 3
    likeliest = trace.judged[int(np.argmax(trace.probabilities))]
    taken = likeliest.split.whole & in_region(likeliest.region, behind)
    assert taken.sum() < 0.05 * likeliest.split.object_mask.sum()


def test_what_lies_within_the_picture_has_no_surroundings() -> None:
    here = painted_region(BOX)
    assert surroundings_in(here.unlit, here.ground) is None
    # Nor has what lies on less of the border than any wall does.
    rows, columns = here.unlit.shape
    touching = here.unlit.copy()
    touching[: rows // 2, : round(0.5 * LEAST_BORDER * (rows + columns))] = True
    touching[BORDER_PX : rows // 2, :BORDER_PX] = False
    assert surroundings_in(touching, here.ground) is None


def test_what_is_cut_by_the_border_does_not_stand_inside() -> None:
    whole = np.zeros((90, 120), np.bool_)
    whole[30:50, 40:60] = True
    assert stands_inside(whole)
    assert not stands_inside(np.roll(whole, -40, axis=1))
    assert not stands_inside(np.zeros_like(whole))

"""Ground that is flatter in the real object's shadow than in the light is so in the virtual shadow as well."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.models.primitives import box
from ashe_live.quality import QUALITIES
from ashe_live.render.camera.relief import relief_of
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.lights.photometry import Photometry
from ashe_live.render.scene import Scene

POST = Proxy("post", np.array([(-0.14, 0.03, z, 0.025, 0.0) for z in (0.0, 0.08)]))
TOWER_AT = 0.06
RATIO = 0.2
LIT = 0.2  # contrast of the ground's relief in the light


@pytest.fixture
def light(stage):
    return stage.light(100, 40, (RATIO, RATIO, RATIO))


def _table(stage, light, shaded: float, marks: float = 0.0, camera: Camera | None = None) -> TrackedFrame:
    """Relief of contrast LIT, and `shaded` in the post's shadow; black marks over a share `marks` of all."""
    camera, T = camera or stage.camera(), stage.pose(-90, 55, 0.5)
    cast = cast_by_point(POST.points_marker(), np.append(light.to_light_marker, 0.0))
    outline = cv2.convexHull(project(camera, T, np.column_stack([cast, np.zeros(len(cast))])).astype(np.float32))
    width, height = camera.size
    shadow = np.zeros((height, width), np.uint8)
    cv2.fillConvexPoly(shadow, np.round(outline).astype(int), 1)
    rng = np.random.default_rng(3)
    grain = cv2.GaussianBlur(rng.normal(size=shadow.shape), (0, 0), 1.0)
    grain *= np.where(shadow, shaded, LIT) / grain.std()
    albedo = np.where(cv2.dilate((rng.random(shadow.shape) < marks / 25).astype(np.uint8), np.ones((5, 5))), 0.02, 0.4)
    linear = albedo * np.exp(grain) * np.where(shadow, RATIO, 1.0)
    return stage.tracked(
        np.repeat(np.round(255 * srgb_from_linear(linear)).astype(np.uint8)[..., None], 3, axis=2), T, camera
    )


@pytest.mark.parametrize("shaded", [0.06, 0.12])
@pytest.mark.parametrize("marks", [0.0, 0.03])
def test_how_much_flatter_it_is_in_the_shadow_is_measured(stage, light, shaded: float, marks: float) -> None:
    relief = relief_of(_table(stage, light, shaded, marks), POST, lighting_of((light,)))
    assert relief is not None
    assert relief.contrast == pytest.approx(shaded / LIT, rel=0.15)
    assert relief.most == pytest.approx(3 * LIT, rel=0.25)
    assert relief.sky_share == pytest.approx(RATIO)


def test_ground_with_as_much_in_the_shadow_stays_as_it_is(stage, light) -> None:
    assert relief_of(_table(stage, light, 1.2 * LIT), POST, lighting_of((light,))) is None


def test_a_shadow_that_is_not_seen_says_nothing(stage, light) -> None:
    far = Proxy("post", POST.spheroids_marker + np.array((5.0, 0, 0, 0, 0)))
    behind = Proxy("post", POST.spheroids_marker + np.array((0, -2.0, 0, 0, 0)))
    tracked = _table(stage, light, 0.06)
    assert relief_of(tracked, far, lighting_of((light,))) is None
    assert relief_of(tracked, behind, lighting_of((light,))) is None


def test_a_black_shadow_is_flat(stage, light) -> None:
    """Nothing can be told of it, and no logarithm of 0 may get into the picture."""
    tracked = _table(stage, light, LIT)
    dark = _table(stage, light, 3.0 * LIT).frame.image_bgr != tracked.frame.image_bgr
    image = np.where(
        cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((9, 9))), 0, tracked.frame.image_bgr
    )
    relief = relief_of(replace(tracked, frame=replace(tracked.frame, image_bgr=image)), POST, lighting_of((light,)))
    assert relief is not None
    assert relief.contrast == pytest.approx(0, abs=1e-9)


def test_it_stays_while_the_light_is_turned_by_hand(stage, light) -> None:
    tracked = _table(stage, light, 0.06)
    estimated = Illumination((light,), real_object=POST, seen_in=tracked)
    photometry = Photometry(QUALITIES["fast"].render)
    measured = photometry.relief(estimated)
    assert measured is not None
    turned = estimated.relit((stage.light(-20, 40, (RATIO, RATIO, RATIO)),), None)
    assert [photometry.relief(turned) for _ in range(3)] == [measured] * 3
    bare = _table(stage, light, LIT)  # another frame, where nothing is flatter
    assert photometry.relief(replace(estimated, seen_in=bare)) != measured


def test_a_light_on_its_way_is_not_measured_by(stage, light) -> None:
    """The first picture of an eased light has the old direction, where the new frame has no shadow."""
    tracked = _table(stage, light, 0.06)
    photometry = Photometry(QUALITIES["fast"].render)
    for azimuth in (-20, 20, 60):
        on_its_way = stage.light(azimuth, 40, (RATIO, RATIO, RATIO))
        assert photometry.relief(Illumination((on_its_way,), real_object=POST, seen_in=tracked)) is None
    there = Illumination((light,), real_object=POST, seen_in=tracked)
    assert photometry.relief(there) is None  # not before the light stands still
    found = photometry.relief(there)
    assert found is not None
    assert found.contrast == pytest.approx(0.3, rel=0.15)


def _drawn(make_renderer, stage, light, tracked: TrackedFrame, quality: str, ground: TrackedFrame) -> np.ndarray:
    """(h, w) linear brightness of a black tower's picture on `ground`, the light estimated in `tracked`."""
    tower = stage.placed(box((0.04, 0.04, 0.08), (0.0, 0.0, 0.0, 1.0)).moved(1.0, np.array((TOWER_AT, 0.0, 0.0))))
    renderer = make_renderer(QUALITIES[quality].render, tracked.frame.size)
    renderer.render(Scene(ground, tower, Illumination((light,), real_object=POST, seen_in=tracked)))
    return LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()] @ REC709_LUMINANCE[::-1]


def _in_shadow(tracked: TrackedFrame, light) -> np.ndarray:
    """(h, w) well within the tower's shadow, away from the tower."""
    to_light, (width, height) = light.to_light_marker, tracked.frame.size
    corners = np.array([(TOWER_AT + x, y) for x in (-0.012, 0.012) for y in (-0.012, 0.012)])
    away = -to_light[:2] / to_light[2]
    points = np.concatenate([corners + 0.035 * away, corners + 0.07 * away])
    outline = project(tracked.camera, tracked.marker.T_cam_marker, np.column_stack([points, np.zeros(len(points))]))
    mask = np.zeros((height, width), np.uint8)
    cv2.fillConvexPoly(mask, np.round(cv2.convexHull(outline.astype(np.float32))).astype(int), 1)
    return mask > 0


LENS = (-0.25, 0.05, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("lens", [None, LENS], ids=["pinhole", "lens"])
@pytest.mark.parametrize("quality", list(QUALITIES))
def test_the_virtual_shadow_is_as_flat_as_the_real_one(make_renderer, stage, light, quality: str, lens) -> None:
    camera = None if lens is None else replace(stage.camera(), dist=np.array(lens))
    flat, deep = (_table(stage, light, shaded, camera=camera) for shaded in (0.4 * LIT, LIT))
    where = _in_shadow(flat, light)
    assert where.sum() > 500
    pictures = [np.log(_drawn(make_renderer, stage, light, seen, quality, deep) + 1e-6) for seen in (flat, deep)]
    # From pixel to pixel, as the ground is darker towards the tower's foot.
    steps = [np.diff(each, axis=1)[where[:, 1:] & where[:, :-1]].std() for each in pictures]
    assert steps[0] / steps[1] == pytest.approx(0.4, abs=0.08)
    assert pictures[0][where].mean() == pytest.approx(pictures[1][where].mean(), abs=0.03)


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_light_that_is_all_the_suns_or_all_the_skys_draws_no_nonsense(
    make_renderer, stage, light, ratio: float
) -> None:
    """Both are ends of the formula for the contrast that is left, where a division by zero would be."""
    at_end = replace(light, shadow_rgb_ratio=np.full(3, ratio))
    flat, deep = _table(stage, light, 0.4 * LIT), _table(stage, light, LIT)
    relief = relief_of(flat, POST, lighting_of((at_end,)))
    assert relief is not None
    assert 0 < relief.sky_share < 1
    where = _in_shadow(flat, light)
    picture = _drawn(make_renderer, stage, at_end, flat, "fast", deep)[where]
    bare = (LINEAR_FROM_SRGB_8BIT[deep.frame.image_bgr] @ REC709_LUMINANCE[::-1])[where]
    assert picture.mean() < 0.01 if ratio == 0 else picture.mean() == pytest.approx(bare.mean(), rel=0.25)


def test_lit_ground_and_paint_in_the_shadow_stay(make_renderer, stage, light) -> None:
    flat, marked = _table(stage, light, 0.4 * LIT), _table(stage, light, LIT, marks=0.04)
    where = _in_shadow(flat, light)
    picture = _drawn(make_renderer, stage, light, flat, "balanced", marked)
    bare = LINEAR_FROM_SRGB_8BIT[marked.frame.image_bgr] @ REC709_LUMINANCE[::-1]
    black = where & (bare < 0.03)
    assert black.sum() > 30
    # Twenty times as dark before, and still at least ten times.
    assert np.median(picture[where & (bare > 0.2)]) > 10 * np.median(picture[black])
    beside = np.zeros_like(where)
    beside[-60:, :100] = True
    assert np.abs(picture - bare)[beside].max() < 0.01

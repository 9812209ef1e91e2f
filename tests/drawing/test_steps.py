"""An estimate's steps as pictures: that they show what they say they show."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.drawing.colours import OBJECT_BGR, PAPER_BGR, SHADOW_BGR, UNEXPLAINED_BGR
from ashe_live.drawing.light_rose import light_rose
from ashe_live.drawing.overlays import with_body
from ashe_live.drawing.steps import debug_pictures
from ashe_live.drawing.steps_sheet import steps_sheet
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.view_search import Trace
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import outline, shadow_outline
from tests.light.synthetic_masks import camera_towards

SIZE = (320, 240)
CAMERA = Camera.from_hfov(SIZE, 60)
VIEW = camera_towards((0.05, 0.0), 0.5, 40.0)
SUN = Light(direction_from_angles(math.radians(30), math.radians(45)), np.diag([1e-3, 4e-3]), 0.07, 0.9)
# An upright cylinder, 6 cm high.
BODY = Proxy("frustum", np.array([[0.1, 0.0, 0.0, 0.02, 0.0], [0.1, 0.0, 0.06, 0.02, 0.0]]))


def filled(points):
    mask = np.zeros(SIZE[::-1], np.uint8)
    cv2.fillConvexPoly(mask, np.round(points).astype(np.int32), 1)
    return mask.astype(bool)


@pytest.fixture
def tracked():
    """Plain ground with noise, the body darker on it and its shadow half as bright."""
    picture = np.full((*SIZE[::-1], 3), 160.0)
    picture[filled(shadow_outline(CAMERA, VIEW, BODY.points_marker(), at_infinity(SUN.to_light_marker)))] = 110
    picture[filled(outline(CAMERA, VIEW, BODY.points_marker()))] = (40, 60, 150)
    picture += np.random.default_rng(0).normal(0, 2, picture.shape)
    corners = project(CAMERA, VIEW, np.array([(-0.03, 0.03, 0), (0.03, 0.03, 0), (0.03, -0.03, 0), (-0.03, -0.03, 0)]))
    pose = MarkerPose(VIEW, corners, 0.06, 0.1, None)
    return TrackedFrame(Frame(np.clip(picture, 0, 255).astype(np.uint8), 0, 0.0), CAMERA, pose)


@pytest.fixture
def estimate():
    body = filled(outline(CAMERA, VIEW, BODY.points_marker()))
    shadow = filled(shadow_outline(CAMERA, VIEW, BODY.points_marker(), at_infinity(SUN.to_light_marker))) & ~body
    return LightEstimate("proxy", 0, Illumination((SUN,), real_object=BODY), None, body, shadow)


def has(picture, colour):
    return bool((np.abs(picture.astype(int) - colour).max(axis=2) < 12).any())


def test_all_steps_have_one_size_and_the_light_is_said_last(tracked, estimate):
    traced, trace = ProxyEstimator().traced(tracked)
    assert traced.light is not None
    pictures = debug_pictures(tracked, estimate, trace)
    assert len(pictures) == 10
    assert {picture.image_bgr.shape for picture in pictures} == {(240, 320, 3)}
    assert pictures[-1].title == "azimuth 30°, elevation 45° ± 4.0°, 90 % sure"


def test_without_an_answer_the_reason_stands_in_its_place(tracked):
    pictures = debug_pictures(tracked, LightEstimate("proxy", 0, Illumination(), "no shadow found"))
    assert pictures[-1].title == "none: no shadow found"
    assert len(pictures) == 2


def test_without_a_marker_there_is_nothing_to_show(tracked, estimate):
    with pytest.raises(ValueError, match="marker"):
        debug_pictures(TrackedFrame(tracked.frame, tracked.camera, None), estimate)


def test_the_ratio_is_one_on_lit_ground_and_the_shadows_in_the_shadow(tracked, estimate):
    _, trace = ProxyEstimator().traced(tracked)
    pictures = debug_pictures(tracked, estimate, trace)
    ratio = next(picture for picture in pictures if picture.title == "ratio to lit ground")
    lit = ratio.image_bgr[200:, :60].astype(float)
    inner = cv2.erode(estimate.shadow_mask.astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
    assert lit.mean() > 247
    encoded = np.median(ratio.image_bgr[inner]) / 255
    linear = (110 / 255 + 0.055) ** 2.4 / (160 / 255 + 0.055) ** 2.4
    assert ((encoded + 0.055) / 1.055) ** 2.4 == pytest.approx(linear, rel=0.08)


def unexplained(tracked, estimate):
    """How many pixels the residual marks as not explained."""
    assert UNEXPLAINED_BGR[2] > UNEXPLAINED_BGR[0]
    rest = debug_pictures(tracked, estimate)[-2].image_bgr.astype(int)
    towards = rest - tracked.frame.image_bgr
    return np.count_nonzero((towards[:, :, 2] - towards[:, :, 0] > 60) & (np.abs(towards).max(axis=2) > 30))


def test_a_perfect_fit_leaves_nothing_and_a_wrong_one_does(tracked, estimate):
    low = Proxy("frustum", BODY.spheroids_marker * [1, 1, 0.3, 1, 1])
    wrong = replace(estimate, illumination=Illumination((SUN,), real_object=low))
    assert unexplained(tracked, wrong) > 10 * unexplained(tracked, estimate) + 100


def test_a_lamps_shadow_is_explained_by_the_lamp_where_it_stands(tracked, estimate):
    lamp = replace(SUN, inverse_distance=1 / 0.25)
    shadow = filled(shadow_outline(CAMERA, VIEW, BODY.points_marker(), lamp.homogeneous)) & ~estimate.object_mask
    by_lamp = replace(estimate, illumination=Illumination((lamp,), real_object=BODY), shadow_mask=shadow)
    by_sun = replace(by_lamp, illumination=Illumination((SUN,), real_object=BODY))
    assert unexplained(tracked, by_sun) > 10 * unexplained(tracked, by_lamp) + 100


def test_the_shadow_leans_away_from_the_light():
    body, shadow = (
        outline(CAMERA, VIEW, BODY.points_marker()),
        shadow_outline(CAMERA, VIEW, BODY.points_marker(), at_infinity(SUN.to_light_marker)),
    )
    tip = project(CAMERA, VIEW, np.array([[0.1, 0.0, 0.06]]) - 0.06 * SUN.to_light_marker / SUN.to_light_marker[2])[0]
    assert cv2.pointPolygonTest(shadow.astype(np.float32), tip.tolist(), False) > 0
    assert cv2.pointPolygonTest(body.astype(np.float32), tip.tolist(), False) < 0


def test_no_shadow_falls_from_below_and_no_outline_is_behind_the_camera():
    from_below = Light((0.0, 1.0, -0.1))
    assert shadow_outline(CAMERA, VIEW, BODY.points_marker(), at_infinity(from_below.to_light_marker)) is None
    behind = VIEW.copy()
    behind[2, 3] = -5.0
    assert outline(CAMERA, behind, BODY.points_marker()) is None
    picture = np.zeros((*SIZE[::-1], 3), np.uint8)
    assert not with_body(picture, CAMERA, behind, BODY, (from_below,)).any()
    drawn = with_body(picture, CAMERA, VIEW, BODY, (SUN,))
    assert has(drawn, OBJECT_BGR)
    assert has(drawn, SHADOW_BGR)


@pytest.mark.parametrize("size", [(640, 480), (480, 640), (360, 640), (640, 40)])
def test_the_sheet_of_any_shape_of_picture_has_the_answer_and_the_rose(tracked, estimate, size):
    """Phones are held upright."""
    camera = Camera.from_hfov(size, 60)
    frame = Frame(np.full((size[1], size[0], 3), 160, np.uint8), 0, 0.0)
    upright = TrackedFrame(frame, camera, tracked.marker)
    answer_alone = replace(estimate, illumination=Illumination(), reason="no shadow found")
    with_rose, without = (steps_sheet(upright, each, Trace(View.of(upright, 320))) for each in (estimate, answer_alone))
    assert with_rose.shape[1] > without.shape[1]
    assert with_rose.shape[0] >= without.shape[0] > 320 * size[1] / size[0]


@pytest.mark.parametrize("size_px", [1, 6, 99])
def test_the_rose_of_a_low_picture_is_as_low(size_px):
    """As of a panorama, scaled to the width of the sheet."""
    assert light_rose((SUN,), size_px).shape == (size_px, size_px, 3)


@pytest.mark.parametrize("azimuth_deg", [0, 100, 230])
def test_the_rose_has_x_right_y_up_and_the_horizon_at_its_rim(azimuth_deg):
    low, high = (Light(direction_from_angles(math.radians(azimuth_deg), math.radians(e))) for e in (20, 70))
    empty = light_rose((), 400).astype(int)
    reach = []
    for light in (low, high):
        changed = np.abs(light_rose((light,), 400).astype(int) - empty).max(axis=2) > 60
        y, x = np.nonzero(changed)
        length = np.hypot(x - 200, y - 200)
        far = length > 0.9 * length.max()
        off = math.degrees(math.atan2(200 - y[far].mean(), x[far].mean() - 200)) - azimuth_deg
        assert (off + 180) % 360 - 180 == pytest.approx(0, abs=4)
        reach.append(length.max())
    assert reach[0] / reach[1] == pytest.approx(70 / 20, rel=0.15)


def test_the_rose_s_rings_are_where_lights_of_their_elevations_are():
    """Elevations of 0, 30 and 60 degrees, as the guide reads the rose."""
    empty = light_rose((), 400).astype(int)
    (x,) = np.nonzero(np.abs(empty[180] - PAPER_BGR).max(axis=1) > 20)
    rings = np.unique(np.hypot(x[x > 210] - 200, 20).round())
    for elevation_deg in (0, 30, 60):
        light = Light(direction_from_angles(math.radians(45), math.radians(elevation_deg)))
        y, x = np.nonzero(np.abs(light_rose((light,), 400) - empty).max(axis=2) > 60)
        reach = np.hypot(x - 200, y - 200).max()
        assert np.abs(rings - reach).min() < 3, "but for the width of what is drawn"
        rings = rings[np.abs(rings - reach) > 5]
    assert not len(rings)


def test_the_rose_counts_azimuths_from_its_right_to_its_top():
    """Told by the widths of 0°, 90°, and of what has three figures."""
    inked = np.abs(light_rose((), 400).astype(int) - PAPER_BGR).max(axis=2) > 20
    beside_rim = inked[150:250, 366:], inked[:34, 150:250], inked[150:250, :34], inked[366:, 150:250]
    right, top, left, bottom = (np.ptp(np.nonzero(part)[1]) for part in beside_rim)
    assert right < top < min(left, bottom)


def test_the_rose_shows_the_camera_where_a_light_from_there_would_be():
    camera = direction_from_angles(math.radians(160), math.radians(40))
    empty = light_rose((), 98).astype(int)
    triangle, light = (
        np.argwhere(np.abs(each.astype(int) - empty).max(axis=2) > 30)
        for each in (light_rose((), 98, 0.7 * camera), light_rose((Light(camera),), 98))
    )
    tip = light[np.hypot(*(light - 49).T).argmax()]
    np.testing.assert_allclose(triangle.mean(axis=0), tip, atol=3)


def test_the_ellipse_is_long_where_the_covariance_is():
    def extent(covariance):
        changed = np.abs(light_rose((Light(direction_from_angles(0, 0.8), covariance),), 400).astype(int))
        orange = (np.abs(changed - SHADOW_BGR).max(axis=2)) < 40
        y, x = np.nonzero(orange)
        return np.ptp(x), np.ptp(y)

    # At azimuth 0 elevation runs along x, azimuth along y.
    along_x, across = extent(np.diag([1e-4, 1e-2]))
    assert along_x > 4 * across
    across, along_y = extent(np.diag([1e-2, 1e-4]))
    assert along_y > 4 * across


def test_a_trace_holds_what_the_answer_came_from_and_changes_no_bit_of_it(tracked):
    answer, trace = ProxyEstimator().traced(tracked)
    again = ProxyEstimator().estimate(tracked)
    assert answer.light.to_light_marker.tobytes() == again.light.to_light_marker.tobytes()
    assert len(trace.rough) <= len(trace.proposals)
    best = max(zip(trace.probabilities, trace.judged, strict=True), key=lambda pair: pair[0])[1]
    # The answer's direction is found anew from its slope, as of what may be a lamp: the same but for the last digit.
    np.testing.assert_allclose(best.lights[0].to_light_marker, answer.light.to_light_marker, rtol=0, atol=1e-15)
    assert best.proxy.family == answer.illumination.real_object.family

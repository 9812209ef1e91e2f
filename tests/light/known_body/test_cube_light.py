"""The light from a painted cube whose truth is known: directions, sizes, counts, and when there is none."""

import dataclasses
import math

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.pictures import is_seen
from ashe_live.bench.cube.scenes import SETS, CubeSet
from ashe_live.bench.metrics import squared_sigmas
from ashe_live.core.arrays import Float
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import ELLIPSE_95, angle_between
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.known_body.found_light import FoundLight
from ashe_live.light.known_body.lights import are_apart
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, frame_of, looking, sun


def estimate(scene: CubeScene) -> LightEstimate:
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    assert tracked.marker is not None
    return make_estimator("proxy").estimate(tracked)


def off_deg(found: Float, true: Float) -> float:
    return math.degrees(angle_between(found, true[:3]))


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "tilt_deg"), [(200, 40, 45), (100, 20, 55), (320, 60, 40), (250, 14, 30)]
)
def test_a_sun_is_found_to_half_a_degree(azimuth_deg: float, elevation_deg: float, tilt_deg: float) -> None:
    light = sun(azimuth_deg, elevation_deg)
    answer = estimate(CubeScene(CAMERA, looking(0.5, tilt_deg, 30), [light]))
    assert len(answer.lights) == 1
    found = answer.lights[0]
    assert off_deg(found.to_light_marker, light.point) < 0.5
    assert found.confidence is not None
    assert found.confidence > 0.9
    assert answer.illumination.real_object is not None
    assert answer.illumination.real_object.points_marker()[:, 2].max() == pytest.approx(EDGE_M, abs=1e-3)


def test_the_shadows_colour_is_what_the_sky_alone_gives() -> None:
    light = sun(200, 35, on_table=0.6)
    sky = np.array((0.25, 0.3, 0.4))
    answer = estimate(CubeScene(CAMERA, looking(0.45, 45, 80), [light], sky_rgb=sky))
    given = light.irradiance_rgb * light.point[2]
    assert answer.light is not None
    assert answer.light.shadow_rgb_ratio == pytest.approx(sky / (sky + given), abs=0.06)
    assert answer.illumination.ambient_rgb_ratio == pytest.approx(sky / (sky + given), abs=0.06)


def test_the_masks_are_those_of_cube_and_shadow() -> None:
    scene = CubeScene(CAMERA, looking(0.45, 45, 80), [sun(200, 35)])
    answer = estimate(scene)
    bright = cv2.cvtColor(frame_of(scene).image_bgr, cv2.COLOR_BGR2GRAY)
    assert answer.object_mask is not None
    assert answer.shadow_mask is not None
    assert not (answer.object_mask & answer.shadow_mask).any()
    inside = cv2.erode(answer.shadow_mask.astype(np.uint8), np.ones((5, 5))) > 0
    beside = ~cv2.dilate((answer.shadow_mask | answer.object_mask).astype(np.uint8), np.ones((9, 9))).astype(bool)
    assert np.percentile(bright[inside], 95) < np.percentile(bright[beside], 5)


def test_under_a_cloudy_sky_there_is_no_light() -> None:
    for tilt_deg, sky in ((35, 0.4), (60, 0.8)):
        scene = CubeScene(CAMERA, looking(0.45, tilt_deg, 130), [], sky_rgb=np.full(3, sky), mottled=0.1)
        answer = estimate(scene)
        assert answer.lights == ()
        assert answer.reason is not None
        assert "diffuse" in answer.reason


@pytest.mark.parametrize("radius_px", [170, 215])  # the second covers most of the map around the cube
def test_a_shadow_over_all_of_it_is_said(radius_px: int) -> None:
    scene = CubeScene(CAMERA, looking(0.5, 45, 30), [])
    frame = frame_of(scene)
    shaded = frame.image_bgr.copy()
    x, y = CAMERA.K[:2, 2]
    around_cube = np.zeros(shaded.shape[:2], np.uint8)
    cv2.circle(around_cube, (round(x), round(y)), radius_px, 1, -1)
    shaded[around_cube > 0] = shaded[around_cube > 0] * 0.62
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(
        dataclasses.replace(frame, image_bgr=shaded)
    )
    answer = make_estimator("proxy").estimate(tracked)
    assert answer.lights == ()
    assert answer.reason is not None
    assert "another thing's shadow" in answer.reason


def test_a_shadow_that_falls_on_another_thing_is_said() -> None:
    frame = frame_of(CubeScene(CAMERA, looking(0.45, 50, 35), [sun(190, 25)]))
    with_thing = frame.image_bgr.copy()
    outline = np.array([(159, 271), (229, 219), (363, 283), (361, 332), (303, 401), (171, 320)], np.int32)
    cv2.fillConvexPoly(with_thing, outline, (70, 120, 60))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(
        dataclasses.replace(frame, image_bgr=with_thing)
    )
    answer = make_estimator("proxy").estimate(tracked)
    assert answer.lights == ()
    assert answer.reason is not None
    assert "falls on other things" in answer.reason


def test_the_same_frame_gives_the_same_answer() -> None:
    scene = CubeScene(CAMERA, looking(0.5, 45, 30), [sun(200, 40)])
    first, second = estimate(scene), estimate(scene)
    assert first.light is not None
    assert second.light is not None
    assert np.array_equal(first.light.to_light_marker, second.light.to_light_marker)


def confidences(answer: LightEstimate) -> dict[int, float]:
    """By the light's elevation, rounded to ten degrees."""
    return {round(light.elevation_deg, -1): light.confidence for light in answer.lights if light.confidence is not None}


def test_each_light_is_as_sure_as_its_own_shadow_shows_it() -> None:
    low, high = sun(200, 30, on_table=0.4), sun(75, 60, on_table=0.3)
    both = confidences(estimate(CubeScene(CAMERA, looking(0.4, 45, 30), [low, high])))
    assert set(both) == {30, 60}
    assert min(both.values()) > 0.9
    # The cube hides nearly all of a shadow that falls away from the camera.
    hidden = sun(40, 70, on_table=0.3)
    one_hidden = confidences(estimate(CubeScene(CAMERA, looking(0.4, 60, 220), [low, hidden])))
    assert one_hidden[30] > 0.99
    assert one_hidden.get(70, 0.0) < one_hidden[30]


@pytest.mark.parametrize(("seed", "mottled"), [(2, 0.06), (6, 0.1)])
def test_a_high_suns_narrow_shadow_beside_anothers_is_a_second_light(seed: int, mottled: float) -> None:
    suns = [sun(95, 48, on_table=0.45), sun(186, 74, on_table=0.32)]
    answer = estimate(CubeScene(CAMERA, looking(0.5, 45, 340), suns, mottled=mottled, seed=seed))
    assert len(answer.lights) == 2
    for true in suns:
        assert min(off_deg(light.to_light_marker, true.point) for light in answer.lights) < 1.5


def test_a_pale_second_shadow_on_a_mottled_table_is_a_second_light() -> None:
    """Its edges are steps all along, though stains move them by a pixel."""
    *_, scene = next(one for one in SETS if one.name == "two suns").scenes(21, 51717)
    assert len(estimate(scene).lights) == 2


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "tilt_deg", "from_deg", "seed"),
    [(96.3, 42, 47.7, 305, 10), (182.8, 41.8, 44, 215.3, 12), (314.7, 36.6, 38.3, 304.2, 18)],
)
def test_a_pale_shadow_lies_where_its_edges_do_and_not_on_the_tables_stains(
    azimuth_deg: float, elevation_deg: float, tilt_deg: float, from_deg: float, seed: int
) -> None:
    light = sun(azimuth_deg, elevation_deg, on_table=0.12)
    view = looking(0.5, tilt_deg, from_deg)
    answer = estimate(CubeScene(CAMERA, view, [light], sky_rgb=np.full(3, 0.5), mottled=0.16, seed=seed))
    assert len(answer.lights) == 1
    stated_deg = np.degrees(answer.lights[0].sigma_rad)  # stains leave open whether the sun is a lamp
    assert stated_deg < 5
    assert off_deg(answer.lights[0].to_light_marker, light.point) < max(1.5, 0.6 * stated_deg)


def test_the_rest_of_a_shadow_is_no_second_light() -> None:
    """Lights that are moved onto the same edges are one."""
    for azimuth_deg in (20, 140, 260):
        answer = estimate(
            CubeScene(CAMERA, looking(0.45, 50, 80), [sun(azimuth_deg, 44)], mottled=0.1, seed=azimuth_deg)
        )
        assert len(answer.lights) <= 1


def test_what_darkens_the_foot_within_a_shadow_is_no_second_light() -> None:
    """There the cube hides most of the sky, which is all that is left: its gradient is as steep as a step."""
    scenes = [*CubeSet("sun", key=1).scenes(33, 31337)]
    assert len(estimate(scenes[32]).lights) == 1


def test_lights_that_come_within_the_maps_resolution_are_one() -> None:
    apart = [FoundLight(sun(azimuth, 50).point, np.eye(2), None, 0.3) for azimuth in (0, 30, 200)]
    assert are_apart(apart, EDGE_M)
    assert not are_apart([*apart, FoundLight(sun(35, 50).point, np.eye(2), None, 0.3)], EDGE_M)


def test_a_crooked_cubes_light_is_estimated_better_by_how_its_folds_move_the_shadow() -> None:
    """Than by the shadow of the body as it was tracked, root mean square over suns; and its covariance holds."""
    crooked = next(each for each in SETS if each.name == "sun, crooked")
    squared, sigmas = [], []
    for scene in crooked.scenes(12, 3):
        true = scene.lights[0].point
        tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
        assert tracked.marker is not None
        perfect = dataclasses.replace(tracked, marker=dataclasses.replace(tracked.marker, pose_shape_errors=None))
        answers = [make_estimator("proxy").estimate(each).lights for each in (tracked, perfect)]
        if not is_seen(scene, true) or not all(answers):
            continue
        squared.append([off_deg(lights[0].to_light_marker, true) ** 2 for lights in answers])
        light = answers[0][0]
        assert light.covariance_rad2 is not None
        sigmas.append(squared_sigmas(light.to_light_marker, light.covariance_rad2, true[:3]))
    assert len(squared) >= 8
    beside_folds, as_tracked = np.sqrt(np.mean(squared, axis=0))
    assert beside_folds < 0.9 * as_tracked
    assert np.median(sigmas) < 2.5
    assert max(sigmas) < 2 * ELLIPSE_95


def test_no_answer_is_surer_than_the_pose_of_the_cube() -> None:
    scene = CubeScene(CAMERA, looking(0.5, 45, 30), [sun(200, 40)])
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    assert tracked.marker is not None

    def turned_by(sigma_deg: float) -> LightEstimate:
        covariance = np.diag([math.radians(sigma_deg) ** 2] * 3 + [1e-8] * 3)
        marker = dataclasses.replace(tracked.marker, covariance=covariance, pose_shape_errors=None)
        return make_estimator("proxy").estimate(dataclasses.replace(tracked, marker=marker))

    (sure,), (less,), open_pose = turned_by(0.1).lights, turned_by(6.0).lights, turned_by(57.0)
    assert sure.confidence is not None
    assert less.confidence is not None
    # A direction moves by turns about two axes: within 10 degrees with probability 1 - exp(-(10 / 6)^2 / 2).
    assert less.confidence == pytest.approx(sure.confidence * (1 - math.exp(-((10 / 6) ** 2) / 2)), abs=0.05)
    assert open_pose.light is None
    assert open_pose.reason is not None
    assert open_pose.reason.startswith("how the marker lies stays open")

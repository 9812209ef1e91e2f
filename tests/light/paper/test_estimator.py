"""The whole of estimator `paper`, with small steps where only the joints matter."""

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.paper.estimator import PaperEstimator
from tests.light.painted_scenes import overlap

SMALL = PaperEstimator(size=(160, 120), grabcut_iterations=2)


def test_as_published_it_finds_object_shadow_and_roughly_the_light(scene):
    estimate = PaperEstimator().estimate(scene.tracked)
    assert overlap(estimate.object_mask, scene.box) > 0.9
    assert overlap(estimate.shadow_mask, scene.shadow) > 0.9
    # The centre of a half-hidden shadow is not the centre's shadow: the method itself is this rough.
    assert np.degrees(angle_between(estimate.light.to_light_marker, scene.to_light)) < 30
    np.testing.assert_allclose(estimate.light.shadow_rgb_ratio, (50 / 150) ** 2.2, atol=0.04)
    assert estimate.light.covariance_rad2 is None
    assert estimate.light.confidence is None
    assert estimate.frame_index == 7
    stages = dict(estimate.timing_ms)
    total = stages.pop("total")
    assert set(stages) == {"segment", "associate", "fit", "judge"}
    assert sum(stages.values()) <= total


@pytest.mark.parametrize("azimuth_deg", [100, 150])
def test_the_light_lies_on_its_side(paint_scene, azimuth_deg):
    scene = paint_scene(azimuth_deg=azimuth_deg)
    estimate = SMALL.estimate(scene.tracked)
    assert estimate.object_mask.shape == (120, 160)
    assert estimate.light.to_light_marker[:2] @ scene.to_light[:2] > 0
    assert np.degrees(angle_between(estimate.light.to_light_marker, scene.to_light)) < 40


def test_the_same_frame_gives_the_same_bits(scene):
    first = SMALL.estimate(scene.tracked)
    cv2.setRNGSeed(12345)
    again = SMALL.estimate(scene.tracked)
    np.testing.assert_array_equal(first.light.to_light_marker, again.light.to_light_marker)
    np.testing.assert_array_equal(first.shadow_mask, again.shadow_mask)
    np.testing.assert_array_equal(first.object_mask, again.object_mask)


def test_turning_the_marker_turns_the_light(scene):
    tracked, pose = scene.tracked, scene.tracked.marker
    quarter = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    turned = MarkerPose(pose.T_cam_marker @ quarter, np.roll(pose.corners_px, 1, axis=0), pose.side_m, 0.0, None)
    before = SMALL.estimate(tracked).light.to_light_marker
    after = SMALL.estimate(TrackedFrame(tracked.frame, tracked.camera, turned)).light.to_light_marker
    # The cube is the same cube: only the frame of the answer turns.
    np.testing.assert_allclose(quarter[:3, :3] @ after, before, atol=1e-6)


def test_without_a_marker_it_is_not_asked(scene):
    with pytest.raises(ValueError, match="marker"):
        SMALL.estimate(TrackedFrame(scene.tracked.frame, scene.tracked.camera, None))


def estimate_of(image, pose):
    camera = Camera.from_hfov((image.shape[1], image.shape[0]), 55)
    return SMALL.estimate(TrackedFrame(Frame(image, 0, 0.0), camera, pose))


@pytest.mark.parametrize("level", [0, 128, 255])
@pytest.mark.parametrize("shape", [(120, 160), (1, 1), (3000, 4000), (2, 3000), (3000, 2), (2400, 1080)])
def test_a_picture_of_one_colour_gives_a_reason(scene, level, shape):
    estimate = estimate_of(np.full((*shape, 3), level, np.uint8), scene.tracked.marker)
    assert estimate.light is None
    assert estimate.reason
    assert estimate.timing_ms["total"] > 0


@pytest.mark.parametrize("seed", range(3))
def test_noise_gives_no_nonsense(scene, seed):
    image = np.random.default_rng(seed).integers(0, 256, (120, 160, 3), dtype=np.uint8)
    estimate = estimate_of(image, scene.tracked.marker)
    assert estimate.reason if estimate.light is None else estimate.light.to_light_marker[2] > 0


def test_a_marker_that_reaches_behind_the_camera_gives_a_reason(scene, pose_above):
    pose = MarkerPose(pose_above((0.0, -0.03, 0.05)), scene.tracked.marker.corners_px, 0.08, 0.0, None)
    estimate = SMALL.estimate(TrackedFrame(scene.tracked.frame, scene.tracked.camera, pose))
    assert "behind the camera" in estimate.reason


def test_an_object_without_a_shadow_gives_a_reason(scene):
    image = scene.tracked.frame.image_bgr.copy()
    image[scene.shadow] = 150
    estimate = SMALL.estimate(TrackedFrame(Frame(image, 0, 0.0), scene.tracked.camera, scene.tracked.marker))
    assert estimate.light is None
    assert estimate.reason

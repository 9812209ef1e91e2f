"""How the drawn exposure follows measurements of it, against a known exposure with noise."""

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.transforms import image_from_plane, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.render.camera.exposure import NOISE, followed, gain_and_slope

CAMERA = Camera.from_hfov((320, 240), 60)
T_CAM_MARKER = rigid(cv2.Rodrigues(np.array([2.4, 0.3, 0.1]))[0], (0.02, -0.01, 0.5))


def _shown(measured: np.ndarray) -> np.ndarray:
    """(n, 3) what is shown after each of the measurements (n, 3), the first of which is shown as it is."""
    shown = [measured[0]]
    for each in measured[1:]:
        shown.append(followed(shown[-1], each))
    return np.array(shown)


def test_noise_is_smoothed_away() -> None:
    noise = np.random.default_rng(5).normal(0, NOISE, (2000, 3))
    steps, shown = np.diff(noise, axis=0), np.diff(_shown(noise), axis=0)
    assert shown.std() < 0.6 * steps.std()
    assert _shown(noise).std() < NOISE


@pytest.mark.parametrize("step", [0.05, -0.3, 1.0])
def test_a_change_is_followed_at_once(step: float) -> None:
    measured = np.array([np.zeros(3), np.full(3, step)])
    assert _shown(measured)[-1] == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("slope", [1e-4, 1e-3, 0.01])
def test_a_slow_drift_is_not_left_behind_by_more_than_the_noise(slope: float) -> None:
    measured = np.outer(np.arange(400) * slope, np.ones(3))
    behind = measured - _shown(measured)
    assert (behind >= 0).all()
    assert behind.max() < max(2 * NOISE, slope)


def test_one_channel_that_changes_takes_the_others_along() -> None:
    """White balance and exposure are one measurement: no colours in between are shown."""
    shown, measured = np.zeros(3), np.array([0.2, 0.001, -0.001])
    assert followed(shown, measured) == pytest.approx(measured, rel=0.01)


GROUND = np.array((0.2, 0.15, 0.1))


def _pattern(places: np.ndarray) -> np.ndarray:
    """(..., 1) how much brighter than `GROUND` it is at places (..., 2): broad waves."""
    return 1 + 0.3 * np.sin(30 * places).sum(axis=-1, keepdims=True)


@pytest.mark.parametrize("thing", [None, "dark", "as bright as the middle"])
def test_gain_and_sheen_of_the_ground_are_found_also_where_things_lie_on_it(thing: str | None) -> None:
    """Painted by both: a thing covers a fifth of the ground, and places are looked up that are out of view.

    One that is as bright where the sheen is as other ground is elsewhere shows only once the sheen is known.
    """
    gain, slope = np.array((1.3, 1.2, 1.1)), np.array((0.9, -0.6))
    columns, rows = np.meshgrid(*map(np.arange, CAMERA.size))
    pixels = np.stack([columns, rows, np.ones_like(rows)], axis=-1)
    plane = pixels @ np.linalg.inv(image_from_plane(CAMERA, T_CAM_MARKER)).T
    plane = plane[..., :2] / plane[..., 2:]
    linear = GROUND * _pattern(plane) * gain * np.exp(plane @ slope)[..., None]
    if thing == "dark":
        linear[:, : CAMERA.size[0] // 5] = 0.01
    elif thing is not None:
        linear[plane @ slope > 0.22] *= np.exp(-0.48)
    image = np.round(255 * srgb_from_linear(np.clip(linear, 0, 1))).astype(np.uint8)[..., ::-1].copy()
    marker = MarkerPose(T_CAM_MARKER, np.zeros((4, 2)), 0.08, 0.1, None)
    places = np.stack(np.meshgrid(*[np.linspace(-0.3, 0.3, 40)] * 2), axis=-1).reshape(-1, 2)
    before = GROUND * _pattern(places)
    found = gain_and_slope(TrackedFrame(Frame(image, 0, 0.0), CAMERA, marker), places, before)
    assert found is not None
    np.testing.assert_allclose(found[0], gain, rtol=0.02)
    np.testing.assert_allclose(found[1], slope, atol=0.1)
    nowhere = places + np.array((0.0, 50.0))
    assert gain_and_slope(TrackedFrame(Frame(image, 0, 0.0), CAMERA, marker), nowhere, before) is None


@pytest.mark.parametrize(("before", "gain"), [(0.02, 2.5), (0.9, 0.4), (0.1, 2.16)])
def test_a_gain_that_no_camera_makes_from_frame_to_frame_is_limited(before: float, gain: float) -> None:
    """On even ground of 0.216, as linear RGB, something else is seen then."""
    marker = MarkerPose(T_CAM_MARKER, np.zeros((4, 2)), 0.08, 0.1, None)
    grey = TrackedFrame(Frame(np.full((*CAMERA.size[::-1], 3), 128, np.uint8), 0, 0.0), CAMERA, marker)
    places = np.stack(np.meshgrid(*[np.linspace(-0.1, 0.1, 10)] * 2), axis=-1).reshape(-1, 2)
    found = gain_and_slope(grey, places, np.full((len(places), 3), before))
    assert found is not None
    np.testing.assert_allclose(found[0], gain, rtol=2e-3)
    np.testing.assert_allclose(found[1], 0, atol=1e-9)

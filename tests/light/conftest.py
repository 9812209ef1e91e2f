"""A painted scene with a known light: a box beside a marker on a lit ground, its shadow where projection puts it."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from tests.camera_poses import looking_at

SIDE_M = 0.08
GROUND, SHADOW, SHEET, INK = 150, 50, 230, 15
BOX_BGR = (40, 140, 235)


@dataclass(frozen=True)
class PaintedScene:
    tracked: TrackedFrame
    to_light: np.ndarray
    box: np.ndarray
    shadow: np.ndarray  # on the ground, as far as the box does not hide it


def camera_above(eye: tuple[float, float, float]) -> np.ndarray:
    """`T_cam_marker` of a camera at `eye` that looks at the marker."""
    return looking_at((0.0, 0.0, 0.0), eye)


def prism(centre: tuple[float, float], side: float, height: float) -> np.ndarray:
    half = side / 2
    return np.array(
        [[centre[0] + x, centre[1] + y, z] for z in (0, height) for x in (-half, half) for y in (-half, half)]
    )


def paint(azimuth_deg: float = 200.0, elevation_deg: float = 40.0, size: tuple[int, int] = (640, 480)) -> PaintedScene:
    camera = Camera.from_hfov(size, 55)
    T_cam_marker = camera_above((-0.05, -0.45, 0.4))
    to_light = direction_from_angles(np.radians(azimuth_deg), np.radians(elevation_deg))

    def mask(points: np.ndarray) -> np.ndarray:
        hull = cv2.convexHull(project(camera, T_cam_marker, points).astype(np.float32))
        picture = np.zeros(size[::-1], np.uint8)
        cv2.fillConvexPoly(picture, np.round(hull).astype(np.int32), 1)
        return picture > 0

    corners = prism((0.13, 0.02), 0.06, 0.09)
    cast = corners - corners[:, 2:] * (to_light / to_light[2])
    box, shadow = mask(corners), mask(cast)
    image = np.full((*size[::-1], 3), GROUND, np.uint8)
    image[mask(prism((0, 0), 1.3 * SIDE_M, 0))] = SHEET
    image[mask(prism((0, 0), SIDE_M, 0))] = INK
    image[shadow] = SHADOW
    image[box] = BOX_BGR
    noise = np.random.default_rng(0).integers(-3, 4, image.shape)
    image = (image + noise).astype(np.uint8)

    half = SIDE_M / 2
    square = np.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])
    pose = MarkerPose(T_cam_marker, project(camera, T_cam_marker, square), SIDE_M, 0.0, None)
    return PaintedScene(TrackedFrame(Frame(image, 7, 0.0), camera, pose), to_light, box, shadow & ~box)


@pytest.fixture(scope="session")
def paint_scene() -> Callable[..., PaintedScene]:
    return paint


@pytest.fixture(scope="session")
def scene() -> PaintedScene:
    return paint()


@pytest.fixture(scope="session")
def pose_above() -> Callable[[tuple[float, float, float]], np.ndarray]:
    return camera_above

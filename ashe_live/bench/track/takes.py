"""The synthetic takes of the tracking bench: a marker on known paths; deterministic."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from ashe_live.bench.track.frames import CLEAN_CAMERA, Flaws, PrintedMarker, ground
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame
from ashe_live.tracking.families.markers import parse_marker

SPEC, CELLS, SIDE_M = "aruco:4x4_50:3", 6, 0.08
FPS = 30.0
SMALL, HD = Camera.from_focal((640, 480), 900.0), Camera.from_focal((1280, 720), 1000.0)
LENS = Camera(SMALL.size, SMALL.K, np.array((-0.35, 0.15, 0.001, -0.002, 0.0)), "file")
CLUTTER = 12
EXPOSURES = 11  # sub-frames of a motion-blurred frame
SLIDING_PX = 100.0  # side of a marker that slides across the picture


@dataclass(frozen=True, slots=True)
class Take:
    """A film with known poses."""

    name: str
    camera: Camera
    frames: int
    poses: Callable[[int], Sequence[Float]]  # T_cam_marker (4, 4) over the exposure of a frame, by its index
    flaws: Flaws = CLEAN_CAMERA

    def film(self) -> Iterator[tuple[Frame, Float]]:
        """Each frame with its true T_cam_marker (4, 4)."""
        marker = PrintedMarker(parse_marker(SPEC).bitmap(CELLS), SIDE_M, self.camera, self.flaws)
        canvas = ground(self.camera, CLUTTER)
        rng = np.random.default_rng(1)
        for index in range(self.frames):
            poses = self.poses(index)
            yield Frame(marker.painted(poses, rng, canvas), index, index / FPS), poses[len(poses) // 2]


def pose_at(distance_m: float, tilt_deg: float, turn_deg: float, aside_m: tuple[float, float] = (0.0, 0.0)) -> Float:
    """T_cam_marker (4, 4): turned in its plane, then tilted with its upper edge away from the camera."""
    turn = cv2.Rodrigues(np.array((0, 0, np.radians(turn_deg))))[0]
    tilt = cv2.Rodrigues(np.array((np.radians(180 - tilt_deg), 0, 0)))[0]
    return rigid(tilt @ turn, (*aside_m, distance_m))


def roaming(name: str, side_px: float, tilt_deg: float, frames: int, camera: Camera = SMALL) -> Take:
    """The marker circles, nearer and farther, turning and tilting by a few degrees, once in four seconds."""
    return Take(name, camera, frames, partial(_roaming_poses, camera, side_px, tilt_deg))


def at_rest(name: str, side_px: float, tilt_deg: float, frames: int) -> Take:
    """A marker at rest; only the noise differs between frames."""
    pose = pose_at(SMALL.K[0, 0] * SIDE_M / side_px, tilt_deg, 20)
    return Take(name, SMALL, frames, lambda _: (pose,))


def sliding(name: str, speed_m_s: float, frames: int) -> Take:
    """Back and forth across the picture at constant speed, reversing within a fifth of a second."""
    return Take(name, SMALL, frames, partial(_sliding_poses, SMALL.K[0, 0] * SIDE_M / SLIDING_PX, speed_m_s))


def scattered(name: str, side_px: float, frames: int, flaws: Flaws = CLEAN_CAMERA, blur_px: float = 0.0) -> Take:
    """In every frame a random position, turn, and tilt up to 50 degrees, with motion blur of `blur_px`."""
    return Take(name, SMALL, frames, partial(_scattered_poses, side_px, blur_px), flaws)


def _roaming_poses(camera: Camera, side_px: float, tilt_deg: float, index: int) -> Sequence[Float]:
    angle = 2 * np.pi * index / (4 * FPS)
    distance_m = camera.K[0, 0] * SIDE_M / side_px * (1 + 0.1 * np.sin(3 * angle))
    aside_m = 0.12 * distance_m * np.sin(angle), 0.1 * distance_m * np.cos(angle)
    return (pose_at(distance_m, tilt_deg + 2 * np.sin(2 * angle), 20 + 15 * np.sin(angle), aside_m),)


def _sliding_poses(distance_m: float, speed_m_s: float, index: int) -> Sequence[Float]:
    reach_m, time_s = 0.15, index / FPS
    # A triangle with rounded tips: the arcsine of a sine that stays just below one.
    phase = speed_m_s * time_s * np.pi / (2 * reach_m)
    aside = reach_m * np.arcsin(0.995 * np.sin(phase)) * 2 / np.pi
    return (pose_at(distance_m, 35, 20, (float(aside), 0.0)),)


def _scattered_poses(side_px: float, blur_px: float, index: int) -> Sequence[Float]:
    rng = np.random.default_rng(index)
    distance_m = SMALL.K[0, 0] * SIDE_M / side_px
    centre_m, way = rng.uniform(-0.15, 0.15, 2) * distance_m, rng.uniform(0, 2 * np.pi)
    tilt_deg, turn_deg = rng.uniform(0, 50), rng.uniform(0, 360)
    blur_m = blur_px * distance_m / SMALL.K[0, 0] * np.array((np.cos(way), np.sin(way)))
    moments = np.linspace(-0.5, 0.5, EXPOSURES) if blur_px else (0.0,)
    places = [centre_m + moment * blur_m for moment in moments]
    return [pose_at(distance_m, tilt_deg, turn_deg, (float(x), float(y))) for x, y in places]

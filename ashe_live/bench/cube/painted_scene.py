"""What a painted picture of a paper cube shows: its camera, its lights, its folds and its table."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.tracking.cube.faces import FACES


@dataclass(frozen=True, slots=True)
class Folds:
    """How each of the five faces lies off where a perfect cube has it."""

    turns: Float = field(default_factory=lambda: np.zeros((5, 3)))  # (5, 3) rotation vectors about their centres
    shifts: Float = field(default_factory=lambda: np.zeros((5, 3)))  # (5, 3) edges

    @classmethod
    def drawn(cls, rng: np.random.Generator, edge_m: float, most_m: float = 1e-3, most_deg: float = 1.5) -> "Folds":
        """Evenly up to so much along and about each axis."""
        shifts = rng.uniform(-most_m, most_m, (5, 3)) / edge_m
        return cls(np.radians(rng.uniform(-most_deg, most_deg, (5, 3))), shifts)

    def placed(self, number: int, points: Float) -> Float:
        """(n, 3) points of a face, as they lie."""
        centre = FACES[number].centre
        R = cv2.Rodrigues(self.turns[number])[0]
        return np.asarray((points - centre) @ R.T + centre + self.shifts[number])


@dataclass(frozen=True, slots=True)
class PaintedLight:
    """A sun, or a lamp near by."""

    point: Float  # (4,) homogeneous, the cube's frame, metres: w = 0 for a sun
    irradiance_rgb: Float  # (3,) over pi, of what faces it at the origin
    size_rad: float = math.radians(0.53)  # angular diameter, seen from the origin


@dataclass(frozen=True, slots=True)
class CubeScene:
    """All that is in a picture."""

    camera: Camera  # without distortion
    T_cam_cube: Float  # (4, 4)
    lights: Sequence[PaintedLight]
    sky_rgb: Float = field(default_factory=lambda: np.full(3, 0.3))  # (3,) irradiance over pi of level ground
    sky_slope: Float = field(default_factory=lambda: np.zeros(3))  # (3,) how much brighter the sky is along an axis
    edge_m: float = 0.06
    folds: Folds = field(default_factory=Folds)
    table_rgb: Float = field(default_factory=lambda: np.array([0.42, 0.36, 0.3]))  # (3,) reflectance
    mottled: float = 0.06  # relative deviation of the table's reflectance
    grain_from: Float | None = None  # (4, 4) T_cam_cube of the view that the table's grain is drawn in; None: of this
    exposure: float = 0.9  # linear value of a white surface in the light of level ground
    noise: float = 2.0  # standard deviation, grey levels
    blur_px: float = 0.7
    seed: int = 0


def hull_of(scene: CubeScene) -> Float:
    """(20, 3) metres, the cube's frame: the corners of all faces as they lie, whose hull casts the shadow.

    The bottom's are those of the sides' lower edges, on the table.
    """
    corners = np.concatenate([scene.folds.placed(number, face.corners()) for number, face in enumerate(FACES)])
    corners[:, 2] = np.maximum(corners[:, 2], 0.0)
    return np.asarray(scene.edge_m * corners)


def level_of(scene: CubeScene) -> Float:
    """(3,) irradiance over pi of the open table."""
    return np.asarray(scene.sky_rgb + sum(map(on_table, scene.lights), np.zeros(3)))


def on_table(one: PaintedLight) -> Float:
    """(3,) irradiance over pi of the open table at the origin."""
    return np.asarray(one.irradiance_rgb * one.point[2] / np.linalg.norm(one.point[:3]))

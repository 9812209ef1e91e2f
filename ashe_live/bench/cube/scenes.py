"""The scenes that the cube's bench draws: cubes seen and lit from everywhere, in sets that each ask one question."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.bench.cube.painted_scene import CubeScene, Folds, PaintedLight
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import angle_between, direction_from_angles

CAMERA = Camera.from_hfov((640, 480), 60)
EDGE_M = 0.06
APART_RAD = math.radians(25)  # of two lights
SUN_DEG = 0.53
LAMPS_M = (0.4, 0.6)
# By how much a camera moves around a cube that it follows, and in how many frames, eight of which it learns from.
AROUND_DEG, BEFORE = 160.0, 32


@dataclass(frozen=True, slots=True)
class CubeSet:
    """Scenes of one kind."""

    name: str
    lights: int = 1
    size_deg: tuple[float, float] = (SUN_DEG, SUN_DEG)
    distance_m: tuple[float, float] | None = None  # of lamps; None: suns
    folded: bool = False
    followed: bool = False  # the camera has moved around the cube before
    together: bool = False  # what it has seen then is given as further views
    key: int = 1  # of the set's own random stream

    def scenes(self, count: int, seed: int = 0) -> Iterator[CubeScene]:
        """From 25 to 75 degrees of tilt, 35 to 60 cm away; lights from 12 to 80 degrees high; others for each seed."""
        # A sequence of both is a stream of its own for each pair; their sum would be one of another set's.
        rng = np.random.default_rng((seed, self.key))
        for _ in range(count):
            pose = looking(rng.uniform(0.35, 0.6), rng.uniform(25, 75), rng.uniform(0, 360))
            lights: list[PaintedLight] = []
            while len(lights) < self.lights:
                azimuth, elevation = rng.uniform(0, 360), rng.uniform(12, 80)
                on_table, size = rng.uniform(0.3, 0.8) / self.lights, rng.uniform(*self.size_deg)
                light = sun(azimuth, elevation, on_table, size)
                if self.distance_m is not None:
                    light = lamp(light, rng.uniform(*self.distance_m))
                if all(angle_between(light.point[:3], other.point[:3]) > APART_RAD for other in lights):
                    lights.append(light)
            colour = np.array((1.0, rng.uniform(0.75, 1), rng.uniform(0.6, 1)))
            yield CubeScene(
                CAMERA,
                pose,
                lights,
                sky_rgb=rng.uniform(0.2, 0.4) * np.array((0.9, 1.0, 1.1)),
                sky_slope=rng.normal(0, 0.2, 3),
                edge_m=EDGE_M,
                folds=Folds.drawn(rng, EDGE_M) if self.folded else Folds(),
                table_rgb=rng.uniform(0.12, 0.6) * colour,
                mottled=rng.uniform(0.02, 0.12),
                seed=int(rng.integers(1_000_000)),
            )


# Suns are 0.53 degrees wide, soft ones 3 to 10; folds are up to 1 mm and 1.5 degrees off; lamps are 40 to 60 cm away.
# Sets of the same key show the same scenes.
SETS = (
    CubeSet("sun", key=1),
    CubeSet("sun, crooked", folded=True, key=5),
    CubeSet("sun, crooked, followed", folded=True, followed=True, key=5),
    CubeSet("sun, crooked, views", folded=True, followed=True, together=True, key=5),
    CubeSet("soft sun", size_deg=(3.0, 10.0), key=4),
    CubeSet("two suns", lights=2, key=3),
    CubeSet("two suns, views", lights=2, followed=True, together=True, key=3),
    CubeSet("lamp", size_deg=(2.0, 6.0), distance_m=LAMPS_M, key=6),
    CubeSet("lamp, crooked", size_deg=(2.0, 6.0), distance_m=LAMPS_M, folded=True, key=7),
    CubeSet(
        "lamp, crooked, views",
        size_deg=(2.0, 6.0),
        distance_m=LAMPS_M,
        folded=True,
        followed=True,
        together=True,
        key=7,
    ),
    CubeSet("cloudy sky", lights=0, key=2),
)


def before(scene: CubeScene) -> Iterator[CubeScene]:
    """The same as a camera sees it that moves around the cube and comes to its place, at the same tilt."""
    for number in range(BEFORE):
        angle = math.radians(AROUND_DEG * (number / BEFORE - 1))
        turned = np.eye(4)
        turned[:2, :2] = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
        yield replace(scene, T_cam_cube=scene.T_cam_cube @ turned, grain_from=scene.T_cam_cube)


def looking(distance_m: float, tilt_deg: float, azimuth_deg: float) -> Float:
    """(4, 4) T_cam_cube of a camera held upright, `tilt_deg` away from straight above; not straight above itself."""
    aim = np.array((0.0, 0.0, 0.02))
    from_aim = direction_from_angles(math.radians(azimuth_deg), math.radians(90 - tilt_deg))
    right = np.cross(-from_aim, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = right, np.cross(-from_aim, right), -from_aim
    T[:3, 3] = -T[:3, :3] @ (aim + distance_m * from_aim)
    return T


def sun(azimuth_deg: float, elevation_deg: float, on_table: float = 0.7, size_deg: float = SUN_DEG) -> PaintedLight:
    """Slightly yellow; `on_table` is what it gives the open table, over pi."""
    to_light = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
    across = np.array((1.0, 0.95, 0.88)) * on_table / to_light[2]
    return PaintedLight(np.append(to_light, 0.0), across, math.radians(size_deg))


def lamp(far: PaintedLight, distance_m: float) -> PaintedLight:
    """A light at infinity moved near, as bright at the origin as before."""
    return PaintedLight(np.append(distance_m * far.point[:3], 1.0), far.irradiance_rgb, far.size_rad)

"""The scenes: what stands where, on which ground, in which light, seen from where."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from painted.bodies import Convex, Floats, ball, box, frustum, upright
from painted.lights import direction

SUN_DEG = 0.53


@dataclass(frozen=True)
class Scene:
    id: str
    category: str
    caster: str
    bodies: tuple[Convex, ...]  # of the caster, and nothing else casts a shadow but `clutter`
    suns: tuple[tuple[float, float, float], ...]  # azimuth, elevation (degrees), strength over the sky's on the ground
    ground: str = "plain"
    eye: tuple[float, float, float] = (0.42, 38.0, 95.0)  # distance, pitch and heading of the camera
    sun_deg: float = SUN_DEG
    clutter: tuple[Convex, ...] = field(default=())
    inverse_distance: float = 0.0  # 1/m of the suns from the marker's centre; below 0 their rays meet under the table

    @property
    def everything(self) -> tuple[Convex, ...]:
        return (*self.bodies, *self.clutter)

    @property
    def lights(self) -> list[Floats]:
        """The suns as homogeneous points (4,)."""
        return [np.append(direction(azimuth, elevation), self.inverse_distance) for azimuth, elevation, _ in self.suns]


RED, BLUE, GREEN, WHITE, DARK = (0.5, 0.09, 0.07), (0.08, 0.15, 0.45), (0.1, 0.32, 0.12), (0.75, 0.73, 0.7), (0.03,) * 3
SCENES = (
    Scene("clean_box", "clean", "box", (box(0.11, 0.02, (0.06, 0.04, 0.08), 25, albedo=RED),), ((205, 40, 1.9),)),
    Scene("clean_cylinder", "clean", "cylinder", (upright(0.1, 0.03, 0.03, 0.09, albedo=BLUE),), ((310, 48, 2.2),)),
    Scene(
        "clean_cone", "clean", "cone", (frustum(0.11, 0.0, 0.04, 0.002, 0.09, albedo=GREEN),),
        ((160, 35, 1.8),), "concrete", (0.4, 45.0, 80.0),
    ),
    Scene(
        "clean_cup", "clean", "cup", (frustum(-0.1, 0.03, 0.025, 0.038, 0.08, albedo=WHITE),),
        ((20, 42, 2.4),), "wood",
    ),
    Scene(
        "texture_bricks", "texture", "box", (box(0.1, 0.04, (0.05, 0.05, 0.07), 50, albedo=BLUE),),
        ((230, 50, 2.0),), "tiles",
    ),
    Scene(
        "texture_wood", "texture", "cylinder", (upright(0.12, 0.0, 0.025, 0.1, albedo=RED),),
        ((340, 38, 2.0),), "wood", (0.45, 33.0, 110.0),
    ),
    Scene(
        "soft_box", "soft", "box", (box(0.11, 0.03, (0.05, 0.05, 0.09), 10, albedo=GREEN),),
        ((200, 45, 2.2),), sun_deg=5.0,
    ),
    Scene(
        "low_cylinder", "low", "cylinder", (upright(0.09, 0.05, 0.022, 0.045, albedo=RED),),
        ((215, 18, 1.4),), "concrete",
    ),
    Scene(
        "high_box", "high", "box", (box(0.1, 0.02, (0.05, 0.05, 0.1), 40, albedo=BLUE),),
        ((100, 76, 2.6),), eye=(0.42, 50.0, 95.0),
    ),
    Scene(
        "two_cylinder", "two", "cylinder", (upright(0.1, 0.03, 0.026, 0.08, albedo=GREEN),),
        ((205, 42, 1.6), (320, 50, 1.0)), eye=(0.45, 45.0, 95.0),
    ),
    Scene("dark_ball", "dark", "sphere", (ball(0.1, 0.03, 0.035, albedo=DARK),), ((210, 44, 2.2),), "wood"),
    Scene(
        "clutter_boxes", "clutter", "box", (box(0.1, 0.05, (0.05, 0.04, 0.08), 70, albedo=RED),),
        ((225, 46, 2.1),), eye=(0.5, 42.0, 95.0), clutter=(upright(-0.13, 0.04, 0.02, 0.05, albedo=BLUE),),
    ),
    Scene("diffuse_cylinder", "diffuse", "cylinder", (upright(0.1, 0.03, 0.03, 0.09, albedo=BLUE),), (), "concrete"),
)  # fmt: skip

# Lamps from beyond infinity to 8 cm in one direction, and where a picture tells little or nothing of them: metres.
INVERSE_DISTANCES = (-0.01, 0.0, 0.01, 0.05, 0.5, 1.0, 2.0, 4.0, 8.0, 12.0)
EXTREME_PLACES = {
    "45 cm above the marker": (0.0, 0.0, 0.45),
    "30 cm above the object": (0.11, 0.02, 0.3),
    "8 cm above the marker": (0.0, 0.0, 0.08),
    "grazing, 60 cm away": (-0.59, -0.1, 0.07),
    "below the object's top": (0.3, 0.0, 0.05),
    "behind the camera": (0.08, -0.7, 0.5),
    "behind the object": (0.25, 0.45, 0.35),
}


def extremes() -> Iterator[Scene]:
    """A box and a cylinder under each of these lamps, on plain ground and on wood."""
    places = {f"q = {q}": (205.0, 45.0, q) for q in INVERSE_DISTANCES}
    for name, (x, y, z) in EXTREME_PLACES.items():
        across = math.hypot(x, y)
        angles = math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, across))
        places[name] = (*angles, 1 / math.hypot(across, z))
    for number, (category, (azimuth, elevation, q)) in enumerate(places.items()):
        for caster, body, ground in (
            ("box", box(0.11, 0.02, (0.06, 0.04, 0.08), 25, albedo=RED), "plain"),
            ("cylinder", upright(0.1, 0.03, 0.03, 0.09, albedo=BLUE), "wood"),
        ):
            sun = (azimuth, elevation, 2.0)
            yield Scene(f"{number:02}_{caster}", category, caster, (body,), (sun,), ground, inverse_distance=q)

"""Paints the scenes with a known light in ../scenes: objects beside a marker, ray by ray, in NumPy alone.

Convex bodies under a sun or lamp with a disc (penumbrae), a second sun or none, and an open sky that objects hide
(contact shadows), on grounds with patterns; then exposure, blur, noise and JPEG. Not path traced: no light is thrown
from one surface onto another, and lamps are not seen themselves. Fields and frames are those that
`ashe_live/bench/cases.py` reads. Two minutes on one core; the second, lamps at the extremes of their places, six:

    python assets/sources/paint_scenes.py
    python assets/sources/paint_scenes.py --extremes DIR
"""

import argparse
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

OUT = Path(__file__).resolve().parents[1] / "scenes"
SIZE = (480, 360)
FOCAL_PX = 430.0
SIDE_M = 0.06
SHEET_SIDES = 1.4
DICTIONARY, MARKER_ID = "DICT_4X4_50", 7
SEED = 5150
SUN_SAMPLES, SKY_SAMPLES = 16, 24
SUN_DEG = 0.53
INK, PAPER = 0.04, 0.8
NEAR_M = 0.3  # beyond, an object hides none of the sky that counts

Floats = NDArray[np.float64]
Masks = NDArray[np.bool_]
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Convex:
    """n·x <= d for every face."""

    normals: Floats  # (f, 3) outward
    offsets: Floats  # (f,)
    middle: Floats  # (3,) of a ball that holds it
    reach: float  # that ball's radius
    albedo: Colour = (0.5, 0.5, 0.5)

    def hit(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.intp]]:
        """(n,) the distance to where unit rays enter, inf where they miss or it is behind, and the face there."""
        distance, face = np.full(len(origins), np.inf), np.zeros(len(origins), np.intp)
        away = self.middle - origins
        along = (away * directions).sum(axis=1)
        near = ((away**2).sum(axis=1) - along**2 <= self.reach**2) & (along > -self.reach)
        distance[near], face[near] = self._hit(origins[near], directions[near])
        return distance, face

    def _hit(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.intp]]:
        if not len(origins):
            return np.empty(0), np.empty(0, np.intp)
        speed = directions @ self.normals.T
        gap = self.offsets - origins @ self.normals.T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = gap / speed
        enter = np.where(speed < -1e-12, at, -np.inf)
        leave = np.where(speed > 1e-12, at, np.where((np.abs(speed) <= 1e-12) & (gap < 0), -np.inf, np.inf))
        face = enter.argmax(axis=1)
        first, last = enter.max(axis=1), leave.min(axis=1)
        return np.where((first < last) & (first > 1e-6), first, np.inf), face

    def blocks(self, origins: Floats, directions: Floats) -> Masks:
        return np.isfinite(self.hit(origins, directions)[0])

    def shades(self, points: Floats, sun: Floats) -> Masks:
        """(n,) whether the body is between points (n, 3) and a light (4,)."""
        away = seen_from(points, sun)
        length = np.linalg.norm(away, axis=1)
        at = self.hit(points, away / length[:, None])[0]
        return np.isfinite(at) & (np.where(np.isfinite(at), at, 0) * sun[3] < length)


def box(x: float, y: float, size: tuple[float, float, float], yaw_deg: float, **kwargs: Colour) -> Convex:
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    axes = np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    centre = np.array([x, y, size[2] / 2])
    normals = np.concatenate([axes, -axes])
    half = np.array(size) / 2
    return Convex(normals, normals @ centre + np.tile(half, 2), centre, float(np.linalg.norm(half)), **kwargs)


def frustum(x: float, y: float, below: float, above: float, height: float, sides: int = 64, **kwargs: Colour) -> Convex:
    angles = np.arange(sides) * (2 * math.pi / sides)
    slope = (below - above) / height
    around = np.column_stack([np.cos(angles), np.sin(angles), np.full(sides, slope)]) / math.hypot(1, slope)
    foot = np.array([x, y, 0.0]) + below * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
    normals = np.concatenate([around, [(0, 0, 1.0)], [(0, 0, -1.0)]])
    reach = math.hypot(max(below, above), height / 2)
    offsets = np.append((around * foot).sum(axis=1), [height, 0.0])
    return Convex(normals, offsets, np.array([x, y, height / 2]), reach, **kwargs)


def upright(x: float, y: float, radius: float, height: float, **kwargs: Colour) -> Convex:
    return frustum(x, y, radius, radius, height, **kwargs)


def ball(x: float, y: float, radius: float, **kwargs: Colour) -> Convex:
    count = 300
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    turn = np.arange(count) * math.pi * (3 - math.sqrt(5))
    flat = np.sqrt(1 - z**2)
    normals = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])
    centre = np.array([x, y, radius])
    return Convex(normals, normals @ centre + radius, centre, 1.1 * radius, **kwargs)


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


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--extremes", type=Path, metavar="DIR", help="only lamps at the extremes of their places, there")
    asked = ask.parse_args()
    out, scenes = (OUT, SCENES) if asked.extremes is None else (asked.extremes, tuple(extremes()))
    out.mkdir(exist_ok=True)
    described = []
    for number, scene in enumerate(scenes):
        described.append(painted(scene, np.random.default_rng(SEED + number), out))
        print(scene.id, flush=True)
    (out / "ground_truth.json").write_text(json.dumps({"seed": SEED, "scenes": described}, indent=1) + "\n")


def painted(scene: Scene, rng: np.random.Generator, out: Path) -> dict:
    """Writes the scene's picture and masks to a folder; its entry in ground_truth.json."""
    K = np.array([(FOCAL_PX, 0, (SIZE[0] - 1) / 2), (0, FOCAL_PX, (SIZE[1] - 1) / 2), (0, 0, 1)])
    R, t = pose(*scene.eye)
    bodies = (*scene.bodies, *scene.clutter)
    suns = [np.append(direction(azimuth, elevation), scene.inverse_distance) for azimuth, elevation, _ in scene.suns]
    tint = np.array([1.0, 0.97, 0.92])
    sky = np.array([0.92, 0.97, 1.05])

    fine = (2 * SIZE[1], 2 * SIZE[0])
    v, u = np.meshgrid(*((np.arange(n) + 0.5) / 2 - 0.5 for n in fine), indexing="ij")
    rays = np.column_stack([u.ravel(), v.ravel(), np.ones(u.size)]) @ np.linalg.inv(K).T @ R
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    eye = np.broadcast_to(-R.T @ t, rays.shape)
    light = np.zeros((len(rays), 3))

    nearest, owner = np.full(len(rays), np.inf), np.full(len(rays), -1)
    face = np.zeros(len(rays), np.intp)
    for number, body in enumerate(bodies):
        at, its_face = body.hit(eye, rays)
        closer = at < nearest
        nearest[closer], owner[closer], face[closer] = at[closer], number, its_face[closer]
    for number, body in enumerate(bodies):
        here = owner == number
        normals = body.normals[face[here]]
        shade = sky * (0.5 + 0.5 * normals[:, 2:]) + 0.12 * (0.5 - 0.5 * normals[:, 2:])
        points = (eye[here] + nearest[here, None] * rays[here]) + 1e-5 * normals
        for sun, (_, _, strength) in zip(suns, scene.suns, strict=True):
            facing = np.maximum((normals * seen_from(points, sun)).sum(axis=1), 0) * fall(points, sun)
            clear = facing > 0
            for other in bodies:
                if other is not body:
                    clear &= ~other.shades(points, sun)
            shade += (strength / sun[2] * facing * clear)[:, None] * tint
        light[here] = np.array(body.albedo) * shade

    down = (owner < 0) & (rays[:, 2] < -1e-3)
    points = eye[down] - eye[down, 2:] / rays[down, 2:] * rays[down]
    falls = sky * open_sky(points, bodies)[:, None]
    seen_suns = []
    for sun, (_, _, strength) in zip(suns, scene.suns, strict=True):
        share = open_disc(points, bodies, sun, math.radians(scene.sun_deg))
        falls = falls + (strength * share * fall(points, sun))[:, None] * tint
        seen_suns.append(share)
    light[down] = ground_albedo(scene.ground, points, rng) * falls

    def mask(which: Masks) -> Masks:
        return which.reshape(SIZE[1], 2, SIZE[0], 2).mean(axis=(1, 3)) > 0.5

    masks = {"object": mask((owner >= 0) & (owner < len(scene.bodies)))}
    if scene.clutter:
        masks["clutter"] = mask(owner >= len(scene.bodies))
    for number, sun in enumerate(suns):
        for name, those in (("shadow", bodies), ("shadow_caster", scene.bodies)):
            if name == "shadow_caster" and (number or not scene.clutter):
                continue
            whole = np.zeros(len(rays), np.bool_)
            whole[down] = np.any([b.shades(points, sun) for b in those], axis=0)
            masks[name if number == 0 else f"{name}{number + 1}"] = mask(whole)

    picture = developed(light.reshape(*fine, 3), rng)
    cv2.imwrite(str(out / f"{scene.id}.jpg"), picture, [cv2.IMWRITE_JPEG_QUALITY, 90])
    for name, values in masks.items():
        cv2.imwrite(str(out / f"{scene.id}_{name}.png"), values.astype(np.uint8) * 255, [cv2.IMWRITE_PNG_BILEVEL, 1])
    half = SIDE_M / 2
    corners = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)]) @ R.T + t
    corners = corners @ K.T
    return {
        "id": scene.id,
        "category": scene.category,
        "image": f"{scene.id}.jpg",
        "size": list(SIZE),
        "K": K.tolist(),
        "dist": [0.0] * 5,
        "R": R.tolist(),
        "t": t.tolist(),
        "marker": {
            "dictionary": DICTIONARY,
            "id": MARKER_ID,
            "side_m": SIDE_M,
            "corners_px": (corners[:, :2] / corners[:, 2:]).tolist(),
        },
        "directional": bool(suns),
        "lights": [
            {
                "dir_to_light": sun[:3].tolist(),
                "relative_strength": strength,
                "angular_diameter_deg": scene.sun_deg,
                **lamp(sun, scene.sun_deg),
            }
            for sun, (_, _, strength) in zip(suns, scene.suns, strict=True)
        ],
        "caster": {"type": scene.caster, "base_xy_m": scene.bodies[0].middle[:2].tolist()},
        "masks": {name: f"{scene.id}_{name}.png" for name in masks},
    }


def direction(azimuth_deg: float, elevation_deg: float) -> Floats:
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])


def seen_from(points: Floats, sun: Floats) -> Floats:
    """(n, 3) the vector from points (n, 3) to a light (4,), over the light's distance from the marker's centre."""
    return sun[:3] - sun[3] * points


def fall(points: Floats, sun: Floats) -> Floats:
    """(n,) one over the cube of that vector's length: with its part along a normal, the irradiance of a small light."""
    return np.asarray((seen_from(points, sun) ** 2).sum(axis=1) ** -1.5)


def lamp(sun: Floats, diameter_deg: float) -> dict:
    """What ground_truth.json says of a light's place, if it has one."""
    if sun[3] <= 0:
        return {}
    radius_m = math.tan(math.radians(diameter_deg) / 2) / sun[3]
    return {"lamp": {"position_m": (sun[:3] / sun[3]).tolist(), "radius_m": radius_m}}


def pose(distance: float, pitch_deg: float, heading_deg: float) -> tuple[Floats, Floats]:
    """R and t of a camera that looks down at a place between the marker and the object, along the heading."""
    forward = direction(heading_deg, -pitch_deg)
    right = direction(heading_deg - 90, 0)
    R = np.array([right, np.cross(forward, right), forward])
    return R, -R @ (np.array([0.03, 0.02, 0.02]) - distance * forward)


def open_sky(points: Floats, bodies: tuple[Convex, ...]) -> Floats:
    """(n,) share of a cosine-weighted sky that ground points see past the bodies."""
    share = np.ones(len(points))
    count = np.arange(SKY_SAMPLES)
    radius, turn = np.sqrt((count + 0.5) / SKY_SAMPLES), count * math.pi * (3 - math.sqrt(5))
    ways = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)])
    for body in bodies:
        near = np.linalg.norm(points[:, :2] - body.middle[:2], axis=1) < NEAR_M
        for way in ways:
            share[near] -= body.blocks(points[near], np.broadcast_to(way, points[near].shape)) / SKY_SAMPLES
    return np.clip(share, 0, 1)


def open_disc(points: Floats, bodies: tuple[Convex, ...], sun: Floats, diameter_rad: float) -> Floats:
    """(n,) share of the disc of a light (4,) that ground points see past the bodies; as wide as it is at the marker."""
    towards = sun[:3]
    east = np.cross((0, 0, 1.0) if towards[2] < 0.999 else (0, 1.0, 0), towards)
    east /= np.linalg.norm(east)
    up = np.cross(towards, east)
    share = np.zeros(len(points))
    for i in range(SUN_SAMPLES):
        radius, turn = math.tan(diameter_rad / 2) * math.sqrt((i + 0.5) / SUN_SAMPLES), i * math.pi * (3 - math.sqrt(5))
        place = np.append(towards + radius * (math.cos(turn) * east + math.sin(turn) * up), sun[3])
        share += ~np.any([b.shades(points, place) for b in bodies], axis=0)
    return share / SUN_SAMPLES


def ground_albedo(kind: str, points: Floats, rng: np.random.Generator) -> Floats:
    """(n, 3), with the marker's sheet on it."""
    x, y = points[:, 0], points[:, 1]
    grain = waves(x, y, rng, 40, 0.004, 0.02) + waves(x, y, rng, 20, 0.05, 0.3)
    if kind == "wood":
        rings = np.sin(2 * math.pi * (y + 0.006 * np.sin(11 * x)) / 0.013 + 2 * waves(x, y, rng, 12, 0.05, 0.2))
        albedo = np.array([0.36, 0.24, 0.14]) * (1 + 0.12 * rings + 0.06 * grain)[:, None]
    elif kind == "tiles":
        joint = (np.abs((x % 0.07) - 0.035) > 0.033) | (np.abs((y % 0.07) - 0.035) > 0.033)
        tone = 1 + 0.1 * np.sin(37 * np.floor(x / 0.07) + 91 * np.floor(y / 0.07))
        albedo = np.where(joint[:, None], 0.2, np.array([0.45, 0.38, 0.32]) * (tone + 0.05 * grain)[:, None])
    elif kind == "concrete":
        albedo = np.array([0.36, 0.35, 0.33]) * (1 + 0.12 * grain)[:, None]
    else:
        albedo = np.array([0.42, 0.4, 0.37]) * (1 + 0.03 * grain)[:, None]
    sheet = (np.abs(x) < SHEET_SIDES * SIDE_M / 2) & (np.abs(y) < SHEET_SIDES * SIDE_M / 2)
    albedo[sheet] = PAPER
    inside = (np.abs(x) < SIDE_M / 2) & (np.abs(y) < SIDE_M / 2)
    cells = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARY)), MARKER_ID, 6, borderBits=1
    )
    column = np.clip(((x[inside] / SIDE_M + 0.5) * 6).astype(int), 0, 5)
    row = np.clip(((0.5 - y[inside] / SIDE_M) * 6).astype(int), 0, 5)
    albedo[inside] = np.where(cells[row, column] > 127, PAPER, INK)[:, None]
    return albedo


def waves(x: Floats, y: Floats, rng: np.random.Generator, count: int, shortest_m: float, longest_m: float) -> Floats:
    """(n,) a random field of unit deviation with wavelengths in a range."""
    total = np.zeros(len(x))
    for _ in range(count):
        length = math.exp(rng.uniform(math.log(shortest_m), math.log(longest_m)))
        turn, phase = rng.uniform(0, 2 * math.pi, 2)
        total += np.sin(2 * math.pi * (x * math.cos(turn) + y * math.sin(turn)) / length + phase)
    return total / math.sqrt(count / 2)


def developed(light: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """The picture (h, w, 3) BGR of linear light at twice its size: exposed, a little blurred and noisy, as sRGB."""
    height, width = light.shape[0] // 2, light.shape[1] // 2
    light = cv2.GaussianBlur(light.astype(np.float32), (0, 0), 1.1)
    light = light.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
    light = 0.85 * light / np.percentile(light, 99)
    light = np.clip(light + rng.normal(size=light.shape) * np.sqrt(2e-5 + 1.5e-4 * np.maximum(light, 0)), 0, 1)
    encoded = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.ascontiguousarray((255 * encoded + 0.5).astype(np.uint8)[:, :, ::-1])


if __name__ == "__main__":
    main()

"""Photos painted by plain projective geometry: bodies, their shadows and a marker's sheet on a ground, known light.

Everything is painted in linear light at three times the size, averaged, and encoded once, last.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera, Size
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from tests.light.synthetic_masks import camera_towards, direction

Float32 = NDArray[np.float32]
Albedo = Callable[[Float32, Float32], Float32]  # (h, w) metres along x and y to (h, w, 3) linear RGB

SIDE_M = 0.08
HFOV_DEG = 55.0
SUPERSAMPLING = 3
SHADOW_RATIO = np.array([0.22, 0.27, 0.36])  # linear RGB: lit by the blue sky alone
AMBIENT, SUN, SKY = 0.3, 0.9, 0.5
NEAR_M = 0.05
VIEW = camera_towards((0.08, 0.0), 0.55, 45.0)


@dataclass(frozen=True)
class Caster:
    """An upright body on the ground."""

    shape: str = "box"  # or cylinder
    at: tuple[float, float] = (0.12, 0.0)  # metres
    width_m: float = 0.05
    height_m: float = 0.08
    rgb: tuple[float, float, float] = (0.65, 0.2, 0.05)  # linear albedo

    def base(self) -> Float:
        """(n, 3) corners of the base, anticlockwise."""
        sides, turn = (4, math.radians(70)) if self.shape == "box" else (64, 0.0)
        angles = turn + np.arange(sides) * (2 * math.pi / sides)
        radius = self.width_m / (math.sqrt(2) if self.shape == "box" else 2)
        x, y = self.at
        return np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles), np.zeros(sides)])

    def top(self) -> Float:
        """(n, 3) the same corners at the top."""
        return self.base() + np.array([0, 0, self.height_m])

    def faces(self) -> list[tuple[Float, Float]]:
        """Corners (n, 3) and outward normal (3,) of the sides and the top."""
        base, top = self.base(), self.top()
        sides = []
        for i in range(len(base)):
            along = base[i] - base[i - 1]
            normal = np.array([along[1], -along[0], 0]) / np.linalg.norm(along)
            sides.append((np.array([base[i - 1], base[i], top[i], top[i - 1]]), normal))
        return [*sides, (top, np.array([0.0, 0, 1]))]


BOX, CYLINDER = Caster(), Caster("cylinder", rgb=(0.1, 0.25, 0.5))


@dataclass(frozen=True)
class OtherLight:
    """A second sun, that adds to what the first one and the sky send to the ground."""

    azimuth_deg: float
    elevation_deg: float
    blocked_rgb: tuple[float, float, float]  # share of the lit ground's light that is missing in its shadow

    @property
    def to_light(self) -> Float:
        return direction(self.azimuth_deg, self.elevation_deg)


@dataclass(frozen=True)
class Painted:
    tracked: TrackedFrame
    to_light: Float
    body: Mask  # (h, w) of all casters
    shadow: Mask  # (h, w) of all casters, as far as no body hides it
    sheet: Mask  # (h, w)

    @property
    def beside_sheet(self) -> Mask:
        """(h, w) all but the sheet and what its edge mixes with."""
        return cv2.dilate(self.sheet.astype(np.uint8), np.ones((5, 5), np.uint8)) == 0


def paint(
    *casters: Caster,
    ground: str = "plain",
    azimuth_deg: float = 200.0,
    elevation_deg: float = 40.0,
    size: Size = (640, 480),
    T_cam_marker: Float = VIEW,
    focal_px: float | None = None,
    exposure: float = 1.0,
    penumbra_px: float = 0.0,
    noise_levels: float = 1.5,
    seed: int = 0,
    other: OtherLight | None = None,
    lamp_m: Float | None = None,
    gloss: float = 0.0,
    page_m: Sequence[float] | None = None,
) -> Painted:
    """The casters in one directional light, or two; no casters: the empty ground.

    Focal length: by HFOV_DEG if not given. The shadow of what is returned is the first light's. lamp_m: (3,) place of a
    lamp, in place of the first light; the shadow ratio is then that at the marker's centre. gloss: fraction of the
    light of what the ground mirrors that it adds to its own; of the sky it does everywhere. page_m: how far the paper
    reaches right, above, left and below of the marker's centre, in place of a small sheet.
    """
    camera = Camera.from_hfov(size, HFOV_DEG) if focal_px is None else Camera.from_focal(size, focal_px)
    fine = camera.resized((size[0] * SUPERSAMPLING, size[1] * SUPERSAMPLING))
    to_light = direction(azimuth_deg, elevation_deg) if lamp_m is None else lamp_m / np.linalg.norm(lamp_m)
    light = np.append(to_light, 0.0 if lamp_m is None else 1 / np.linalg.norm(lamp_m))
    linear = _lit_ground(fine, T_cam_marker, ground)
    sheet, shadow, body = (np.zeros(linear.shape[:2], np.uint8) for _ in range(3))
    paper = _square(1.3 * SIDE_M) if page_m is None else _rectangle(*page_m)
    _fill(sheet, fine, T_cam_marker, paper, 1)
    for printed, level in ((paper, 0.8), (_square(SIDE_M), 0.03), (_square(0.4 * SIDE_M), 0.8)):
        _fill(linear, fine, T_cam_marker, printed, (level,) * 3)
    _cast(shadow, casters, light, fine, T_cam_marker)
    ratio = SHADOW_RATIO.astype(np.float32)
    if penumbra_px == 0 and other is None and lamp_m is None:
        linear[shadow > 0] *= ratio
    else:
        shade = shadow.astype(np.float32)
        if penumbra_px > 0:
            shade = np.asarray(cv2.GaussianBlur(shade, (0, 0), penumbra_px * SUPERSAMPLING), np.float32)
        falling = np.ones_like(shade) if lamp_m is None else _fall_of_light(fine, T_cam_marker, lamp_m)
        left = ratio + (falling * (1 - shade))[..., None] * (1 - ratio)
        if other is not None:
            second = np.zeros_like(shadow)
            _cast(second, casters, np.append(other.to_light, 0.0), fine, T_cam_marker)
            left -= second[..., None] * np.array(other.blocked_rgb, np.float32)
        linear *= left
    eye = -T_cam_marker[:3, :3].T @ T_cam_marker[:3, 3]
    farthest_first = sorted(casters, key=lambda caster: -float(np.linalg.norm(eye[:2] - caster.at)))
    if gloss:
        mirrored = np.zeros_like(linear)
        for caster in farthest_first:
            for corners, lit in _lit_faces(caster, light, eye * (1, 1, -1)):
                _fill(mirrored, fine, T_cam_marker, corners * (1, 1, -1), tuple(value - SKY for value in lit))
        linear += gloss * mirrored
    for caster in farthest_first:
        for corners, lit in _lit_faces(caster, light, eye):
            _fill(linear, fine, T_cam_marker, corners, lit)
            _fill(body, fine, T_cam_marker, corners, 1)

    encoded = 255 * srgb_from_linear(np.minimum(exposure * _averaged(linear), 1))
    encoded += np.random.default_rng(seed).normal(0, noise_levels, encoded.shape)
    image = np.round(encoded[..., ::-1]).clip(0, 255).astype(np.uint8)
    body_mask = _averaged(body.astype(np.float32)) > 0.5
    shadow_mask = (_averaged(shadow.astype(np.float32)) > 0.5) & ~body_mask
    return Painted(
        tracked_frame(image, camera, T_cam_marker),
        to_light,
        body_mask,
        shadow_mask,
        _averaged(sheet.astype(np.float32)) > 0,
    )


def _lit_faces(caster: Caster, light: Float, eye: Float) -> Iterator[tuple[Float, tuple[float, ...]]]:
    """The corners (n, 3) of the faces that the eye sees, and their linear RGB in a light (4,)."""
    for corners, normal in caster.faces():
        if normal @ (eye - corners[0]) > 0:
            aside = light[:3] - light[3] * corners.mean(axis=0)
            facing = max(float(normal @ aside), 0) / float(np.linalg.norm(aside)) ** 3
            yield corners, tuple(map(float, np.multiply(caster.rgb, AMBIENT + SUN * facing)))


def tracked_frame(image: Image, camera: Camera, T_cam_marker: Float = VIEW, side_m: float = SIDE_M) -> TrackedFrame:
    """A frame with the marker's true pose."""
    corners = np.nan_to_num(project(camera, T_cam_marker, _square(side_m)))
    return TrackedFrame(Frame(image, 7, 0.0), camera, MarkerPose(T_cam_marker, corners, side_m, 0.1, None))


def overlap(a: Mask, b: Mask) -> float:
    """Intersection over union."""
    return np.count_nonzero(a & b) / max(np.count_nonzero(a | b), 1)


def _plain(x: Float32, _y: Float32) -> Float32:
    return np.broadcast_to(np.array([0.42, 0.38, 0.33], np.float32), (*x.shape, 3))


def _checkered(x: Float32, y: Float32) -> Float32:
    light, dark = np.array([[0.5, 0.46, 0.4], [0.2, 0.24, 0.2]], np.float32)
    odd = (np.floor(x / 0.03) + np.floor(y / 0.03)) % 2 > 0
    return np.asarray(np.where(odd[..., None], light, dark))


def _striped(x: Float32, y: Float32) -> Float32:
    colours = np.array([[0.5, 0.45, 0.4], [0.25, 0.3, 0.38], [0.4, 0.2, 0.16]], np.float32)
    return np.asarray(colours[(np.floor((x + 0.4 * y) / 0.02) % 3).astype(int)])


def _bricks(x: Float32, y: Float32) -> Float32:
    row = np.floor(y / 0.025)
    along = x / 0.06 + 0.5 * (row % 2)
    column = np.floor(along)
    tint = 0.85 + 0.3 * np.modf(np.abs(np.sin(12.9 * column + 78.2 * row)) * 43.7)[0]
    brick = np.array([0.38, 0.2, 0.14], np.float32) * tint[..., None]
    mortar = (along - column < 0.05) | (y / 0.025 - row < 0.12)
    return np.asarray(np.where(mortar[..., None], np.float32(0.45), brick), np.float32)


def _planks(x: Float32, y: Float32) -> Float32:
    """Pale boards, with joints that are as dark as boards in the shadow."""
    row = np.floor(y / 0.05)
    along = x / 0.3 + 0.37 * row
    joint = (y / 0.05 - row < 0.1) | (along - np.floor(along) < 0.017)
    board = np.array([0.55, 0.48, 0.4], np.float32)
    return np.asarray(np.where(joint[..., None], board * SHADOW_RATIO, board), np.float32)


GROUNDS: Mapping[str, Albedo] = {"plain": _plain, "checkered": _checkered, "striped": _striped, "bricks": _bricks}
PAINTED = {**GROUNDS, "planks": _planks}


def _lit_ground(camera: Camera, T_cam_marker: Float, ground: str) -> Float32:
    """(h, w, 3) linear RGB: the ground, which slowly darkens towards one side, or the sky where there is none."""
    return _lit_ground_of(camera.size, camera.K.tobytes(), T_cam_marker.tobytes(), ground).copy()


@lru_cache(maxsize=8)  # most tests see the same ground many times; 33 MB each
def _lit_ground_of(size: Size, K: bytes, T: bytes, ground: str) -> Float32:
    """By the bytes of the camera's K (3, 3) and of T_cam_marker (4, 4)."""
    width, height = size
    corner, right, below = _plane_by_pixel(np.frombuffer(K).reshape(3, 3), np.frombuffer(T).reshape(4, 4))
    u, v = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    x, y, nearness = (np.float32(corner[i]) + u * np.float32(right[i]) + v * np.float32(below[i]) for i in range(3))
    meets = nearness > 1e-4
    depth = np.where(meets, nearness, 1)
    lit = PAINTED[ground](np.asarray(x / depth, np.float32), np.asarray(y / depth, np.float32))
    slow = np.exp(0.25 * (u / width - 0.5) + 0.15 * (v / height - 0.5))
    return np.where(meets[..., None], lit * slow[..., None], np.float32(0.7)).astype(np.float32)


def _fall_of_light(camera: Camera, T_cam_marker: Float, lamp_m: Float) -> Float32:
    """(h, w) a lamp's irradiance of the plane, over that at the marker's centre."""
    width, height = camera.size
    corner, right, below = _plane_by_pixel(camera.K, T_cam_marker)
    u, v = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    x, y, nearness = (np.float32(corner[i]) + u * np.float32(right[i]) + v * np.float32(below[i]) for i in range(3))
    depth = np.where(nearness > 1e-4, nearness, 1)
    lamp_x, lamp_y, lamp_z = map(float, lamp_m)  # Python's, by which single precision stays single
    squared = (x / depth - lamp_x) ** 2 + (y / depth - lamp_y) ** 2 + lamp_z**2
    return np.asarray((squared / float(lamp_m @ lamp_m)) ** -1.5, np.float32)


def _plane_by_pixel(K: Float, T_cam_marker: Float) -> Float:
    """(3, 3): homogeneous plane coordinates (x, y, w) of pixel (0, 0), and their change by a column and by a row."""
    plane_to_pixel = K @ T_cam_marker[:3, (0, 1, 3)]
    pixel_to_plane = np.linalg.inv(plane_to_pixel)
    # The eye is above the plane, so that w, one over the depth, is positive before the camera.
    return np.array([pixel_to_plane[:, 2], pixel_to_plane[:, 0], pixel_to_plane[:, 1]])


def _square(side_m: float) -> Float:
    return _rectangle(*[side_m / 2] * 4)


def _rectangle(right: float, above: float, left: float, below: float) -> Float:
    return np.array([(-left, above, 0), (right, above, 0), (right, -below, 0), (-left, -below, 0)])


def _fill(
    picture: NDArray[np.uint8] | Float32,
    camera: Camera,
    T_cam_marker: Float,
    polygon: Float,
    value: float | tuple[float, ...],
) -> None:
    """Paints a convex polygon (n, 3) of the marker frame, cut in the camera's near plane."""
    kept: list[Float] = []
    depth = polygon @ T_cam_marker[2, :3] + T_cam_marker[2, 3] - NEAR_M
    for i in range(len(polygon)):
        if (depth[i - 1] > 0) != (depth[i] > 0):
            share = depth[i - 1] / (depth[i - 1] - depth[i])
            kept.append(polygon[i - 1] + share * (polygon[i] - polygon[i - 1]))
        if depth[i] > 0:
            kept.append(polygon[i])
    if len(kept) >= 3:
        pixels = np.clip(project(camera, T_cam_marker, np.array(kept)), -1e6, 1e6)
        cv2.fillConvexPoly(picture, np.round(pixels * 16).astype(np.int32), value, shift=4)


def _cast(
    picture: NDArray[np.uint8], casters: Sequence[Caster], light: Float, camera: Camera, T_cam_marker: Float
) -> None:
    """Paints the casters' shadows in a light (4,); a lamp that is not above a caster casts a very long one."""
    for caster in casters:
        corners = np.concatenate([caster.base(), caster.top()])
        height_left = np.maximum(1 - corners[:, 2:] * (light[3] / light[2]), 0.02)
        cast = (corners - corners[:, 2:] * (light[:3] / light[2])) / height_left
        hull = cv2.convexHull(cast[:, :2].astype(np.float32))[:, 0]
        _fill(picture, camera, T_cam_marker, np.column_stack([hull, np.zeros(len(hull))]), 1)


def _averaged(fine: Float32) -> Float32:
    size = fine.shape[1] // SUPERSAMPLING, fine.shape[0] // SUPERSAMPLING
    return np.asarray(cv2.resize(fine, size, interpolation=cv2.INTER_AREA), np.float32)


def noise_frames(count: int) -> Iterator[TrackedFrame]:
    """Frames of noise, in squares or smooth, with a marker's pose of its own for each."""
    for seed in range(count):
        image = np.random.default_rng(seed).integers(0, 256, (30, 40, 3)).astype(np.uint8)
        noise = cv2.resize(image, (640, 480), interpolation=(cv2.INTER_NEAREST, cv2.INTER_CUBIC)[seed % 2])
        pose = camera_towards((0.0, 0.0), 0.5, 10.0 + 4 * seed)
        yield tracked_frame(np.asarray(noise, np.uint8), Camera.from_hfov((640, 480), HFOV_DEG), pose)

"""Pictures of a paper cube on a table, painted with exactly known pose, folds and lights.

Independent of the renderer, the tracker and the estimator: every face is a print seen by its homography, lit by
Lambert's law; the shadow on the table is that of the hull of all faces, averaged over each light's disc. All light is
linear, averaged over a finer grid of pixels, then blurred, encoded, made noisy and rounded.
"""

import math
from functools import cache, lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.bench.cube.bounce import light_from_table, part_from_facet
from ashe_live.bench.cube.painted_scene import CubeScene, PaintedLight, hull_of, level_of, on_table
from ashe_live.core.arrays import GOLDEN_ANGLE_RAD, Float, Float32, Image, fixed_point
from ashe_live.core.camera import Camera, Size
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.transforms import image_from_plane
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE
from ashe_live.tracking.families.layout import cube_layout

PAPER, INK = 0.78, 0.035  # linear reflectances
TEXTURE_PX = 300  # of a face: 6 cells of 35 pixels, and 45 pixels of margin on either side
FINER = 3  # pixels of the finer grid to one of the picture's, in each direction
DISC = 48  # points of a light's disc
# The table near the cube's foot sees less of the sky: so much at its side, fading over this part of the edge.
HIDDEN_SKY, FADING = 0.45, 0.55
AROUND, MAPPED = 4.0, 129  # edges around the cube to which its sides send light, and places of a map along these
Part = tuple[slice, slice]  # rows and columns of a picture
BITS = 6  # of a finer pixel's fractions in OpenCV's polygons


def painted(scene: CubeScene) -> Image:
    """(h, w, 3) uint8 BGR picture."""
    width, height = scene.camera.size
    fine = scene.camera.resized((width * FINER, height * FINER))
    light = _table(scene, fine)
    body = hull_of(scene)
    whole = projected(fine, scene.T_cam_cube, body)
    grey = _irradiance(scene, np.array((0.0, 0.0, 1.0)), np.zeros(3))
    cv2.fillConvexPoly(
        light, fixed_point(cv2.convexHull(whole.astype(np.float32))[:, 0], BITS), (PAPER * grey).tolist(), shift=BITS
    )
    for number, reflectance in enumerate(_prints()):
        corners, normal = _facet(scene, number)
        R, t = scene.T_cam_cube[:3, :3], scene.T_cam_cube[:3, 3]
        if (R @ corners.mean(axis=0) + t) @ (R @ normal) >= 0:
            continue
        pixels = projected(fine, scene.T_cam_cube, corners).astype(np.float32)
        size = len(reflectance)
        ends = np.array([(0, 0), (size, 0), (size, size), (0, size)], np.float32) - np.float32(0.5)
        part = _around(pixels, fine.size)
        pixels -= np.array((part[1].start, part[0].start), np.float32)
        of_part = light[part]
        H = cv2.getPerspectiveTransform(ends, pixels)
        seen = cv2.warpPerspective(
            reflectance, H, of_part.shape[1::-1], flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        inside = np.zeros(seen.shape, np.uint8)
        cv2.fillConvexPoly(inside, fixed_point(pixels, BITS), 1, shift=BITS)
        here = inside > 0
        of_part[here] = seen[here, None] * _irradiance(scene, normal, corners.mean(axis=0)).astype(np.float32)
    averaged = cv2.resize(light, (width, height), interpolation=cv2.INTER_AREA)
    return _developed(scene, np.asarray(averaged, dtype=np.float32))


def _facet(scene: CubeScene, number: int) -> tuple[Float, Float]:
    """(4, 3) corners of a face, metres, and (3,) its unit normal, outwards."""
    corners = scene.edge_m * scene.folds.placed(number, FACES[number].corners())
    normal = np.cross(corners[1] - corners[0], corners[0] - corners[3])
    return corners, normal / np.linalg.norm(normal)


def _irradiance(scene: CubeScene, normal: Float, place: Float) -> Float:
    """(3,) over pi, linear RGB, of a facet: the lights that it faces, the sky, and what the table sends back."""
    sky = scene.sky_rgb * ((1 + normal[2]) / 2 + 0.5 * float(scene.sky_slope @ (normal - (0, 0, normal[2]))))
    total = np.maximum(sky, 0)
    for one in scene.lights:
        way = one.point[:3] - one.point[3] * place
        nearer = 1.0 if one.point[3] == 0 else float(np.linalg.norm(one.point[:3]) / np.linalg.norm(way)) ** 2
        total = total + nearer * one.irradiance_rgb * max(float(normal @ way) / float(np.linalg.norm(way)), 0.0)
    body = hull_of(scene)
    lit = [(on_table(one), cast_on_table(body, one.point)[:, :2]) for one in scene.lights]
    table = light_from_table(normal, place, lambda x, y: (1 - _hidden_sky(scene, x, y))[:, None] * scene.sky_rgb, lit)
    return np.asarray(total + scene.table_rgb * table)


def _hidden_sky(scene: CubeScene, x: Float, y: Float) -> Float:
    """The part of the sky that the cube hides from places on the table."""
    beyond = np.hypot(*(np.maximum(np.abs(each) - scene.edge_m / 2, 0) for each in (x, y)))
    return np.asarray(HIDDEN_SKY * np.exp(-beyond / (FADING * scene.edge_m)))


@cache
def _prints() -> tuple[Float32, ...]:
    """Each face's reflectances, as `_print` has them."""
    return tuple(_print(member.marker.bitmap(round(TAG_SHARE * TEXTURE_PX))) for member in cube_layout().members)


def _table(scene: CubeScene, fine: Camera) -> Float32:
    """(h, w, 3) linear light of the table with the cube's shadows."""
    size = scene.camera.size
    width, height = size
    rng = np.random.default_rng(scene.seed)
    grain = np.zeros((height, width), np.float32)
    for step in (3, 13):
        coarse = rng.normal(0, 1, (max(2, height // step), max(2, width // step))).astype(np.float32)
        grain += cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC)
    if scene.grain_from is not None:
        there, here = (image_from_plane(scene.camera, pose) for pose in (scene.grain_from, scene.T_cam_cube))
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        moved = cv2.warpPerspective(grain, there @ np.linalg.inv(here), size, None, flags, cv2.BORDER_REFLECT_101)
        grain = np.asarray(moved, dtype=np.float32)
    reflectance = (1 + scene.mottled * 0.7 * grain)[..., None] * scene.table_rgb.astype(np.float32)
    body = hull_of(scene)
    from_pixel = np.linalg.inv(image_from_plane(scene.camera, scene.T_cam_cube))
    x, y, w = (a * np.arange(width)[None] + b * np.arange(height)[:, None] + c for a, b, c in from_pixel)
    with np.errstate(divide="ignore", invalid="ignore"):
        hidden = np.nan_to_num(_hidden_sky(scene, x / w, y / w), nan=0.0)

    def finer(picture: Float) -> Float32:
        whole = cv2.resize(picture.astype(np.float32), fine.size, interpolation=cv2.INTER_LINEAR)
        return np.asarray(whole, dtype=np.float32)

    with np.errstate(divide="ignore", invalid="ignore"):
        from_sides = _from_sides(scene, x / w, y / w)
    sent = [reflectance * on_table(one) * _falloff(one, x, y, w) for one in scene.lights]
    light = finer(sum(sent, reflectance * ((1 - hidden)[..., None] * scene.sky_rgb + from_sides)))
    for one, of_light in zip(scene.lights, sent, strict=True):
        part, shaded = _shaded(scene, fine, body, one)
        light[part] -= finer(of_light)[part] * shaded[..., None]
    return light


def _from_sides(scene: CubeScene, x: Float, y: Float) -> Float:
    """(h, w, 3) irradiance over pi that the cube's printed sides send to places of the table, by a map around it."""
    mapped = np.zeros((MAPPED, MAPPED, 3))
    for number, (face, reflectance) in enumerate(zip(FACES, _prints(), strict=True)):
        if face.outwards[2] > 0:
            continue
        corners, normal = _facet(scene, number)
        light = _irradiance(scene, normal, corners.mean(axis=0))
        mapped += _part_around(corners.tobytes(), scene.edge_m)[..., None] * (float(reflectance.mean()) * light)
    column, row = (
        np.nan_to_num((each / scene.edge_m / AROUND + 1) * (MAPPED - 1) / 2, nan=-1e3)
        .clip(-1e3, 1e3)
        .astype(np.float32)
        for each in (x, y)
    )
    return np.asarray(
        cv2.remap(mapped, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT), dtype=np.float64
    )


@lru_cache(maxsize=64)  # of the pictures of one cube, as folds move with it
def _part_around(corners: bytes, edge_m: float) -> Float:
    """(MAPPED, MAPPED) what places around the cube get from a facet, by the bytes of its corners (4, 3)."""
    along = np.linspace(-AROUND, AROUND, MAPPED) * edge_m
    return part_from_facet(np.frombuffer(corners).reshape(4, 3), along[None], along[:, None])


def _shaded(scene: CubeScene, fine: Camera, body: Float, one: PaintedLight) -> tuple[Part, Float32]:
    """A part of the finer picture, and (h, w) of it how much of a light's disc each place lacks, from 0 to 1."""
    shadows = [projected(fine, scene.T_cam_cube, cast_on_table(body, point)) for point in _disc(one)]
    part = _around(np.concatenate(shadows), fine.size)
    rows, columns = part
    hidden = np.zeros((rows.stop - rows.start, columns.stop - columns.start), np.uint8)
    for pixels in shadows:
        shadow = np.zeros_like(hidden)
        hull = cv2.convexHull((pixels - (columns.start, rows.start)).astype(np.float32))[:, 0]
        cv2.fillConvexPoly(shadow, fixed_point(hull, BITS), 1, shift=BITS)
        cv2.add(hidden, shadow, hidden)
    return part, np.asarray(hidden / np.float32(DISC), dtype=np.float32)


def _around(pixels: NDArray[Any], size: Size) -> Part:
    """Rows and columns of the part of a picture of `size` that has those of the pixels (n, 2) within it that it has.

    Never empty, as OpenCV refuses to draw into nothing.
    """
    low = np.floor(pixels.min(axis=0)).astype(int).clip(0, np.array(size) - 1)
    high = (np.ceil(pixels.max(axis=0)).astype(int) + 2).clip(low + 1, size)
    return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))


def _falloff(one: PaintedLight, x: Float, y: Float, w: Float) -> Float:
    """(h, w, 1) or (1, 1, 1): irradiance of the table by a lamp over that at the origin; 1 for a sun."""
    if one.point[3] == 0:
        return np.ones((1, 1, 1))
    lamp = one.point[:3] / one.point[3]
    with np.errstate(divide="ignore", invalid="ignore"):
        squared = (x / w - lamp[0]) ** 2 + (y / w - lamp[1]) ** 2 + lamp[2] ** 2
    return np.asarray(np.nan_to_num((float(lamp @ lamp) / squared) ** 1.5, nan=0.0)[..., None])


def _disc(one: PaintedLight) -> Float:
    """(n, 4) points spread evenly over the light's disc."""
    to_light = one.point[:3] / np.linalg.norm(one.point[:3])
    aside = np.linalg.svd(to_light[None])[2][1:]
    number = np.arange(DISC)
    radius, angle = np.sqrt((number + 0.5) / DISC) * math.tan(one.size_rad / 2), number * GOLDEN_ANGLE_RAD
    spread = radius[:, None] * (np.cos(angle)[:, None] * aside[0] + np.sin(angle)[:, None] * aside[1])
    points = np.empty((DISC, 4))
    points[:, :3] = np.linalg.norm(one.point[:3]) * (to_light + spread)
    points[:, 3] = one.point[3]
    return points


def cast_on_table(points: Float, light: Float) -> Float:
    """(n, 3) where the table has the points' shadows."""
    left = light[2] - light[3] * points[:, 2:]
    return np.asarray((light[2] * points - points[:, 2:] * light[:3]) / left)


def projected(camera: Camera, T_cam_cube: Float, points: Float) -> Float:
    """(n, 2) pixels of points (n, 3), cube frame, metres; far outside of the picture for what is beside the camera."""
    in_camera = points @ T_cam_cube[:3, :3].T + T_cam_cube[:3, 3]
    depth = np.maximum(in_camera[:, 2:], 0.01)
    return np.asarray((in_camera / depth) @ camera.K[:2].T).clip(-3e4, 3e4)


def _print(bitmap: Image) -> Float32:
    margin = (TEXTURE_PX - len(bitmap)) // 2
    whole = np.pad(bitmap, margin, constant_values=255)
    return np.where(whole > 127, PAPER, INK).astype(np.float32)


def _developed(scene: CubeScene, light: Float32) -> Image:
    """sRGB of a camera that is exposed for white in the light of the open table, which it takes for white."""
    rng = np.random.default_rng(scene.seed + 1)
    exposed = scene.exposure * light / level_of(scene)
    blurred = cv2.GaussianBlur(exposed.astype(np.float32), (0, 0), scene.blur_px)
    encoded = 255 * srgb_from_linear(blurred.clip(0, 1)) + rng.normal(0, scene.noise, light.shape)
    return np.ascontiguousarray((encoded + 0.5).clip(0, 255).astype(np.uint8)[..., ::-1])

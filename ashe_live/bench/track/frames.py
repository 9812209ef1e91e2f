"""Synthetic pictures of a printed marker at an exactly known pose, taken by a camera with known flaws.

Independent of the renderer and the tracker: every pixel is the mean of many rays in linear light, each traced backwards
through lens and pose onto the paper's plane; blur, vignetting, encoding, noise and rounding follow.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.transforms import undistorted

# Linear reflectances, times the exposure that makes white paper nearly white.
INK, PAPER, GROUND = 0.03, 0.72, 0.22
# Width of the white margin around the black square, relative to its side.
QUIET_ZONE = 0.25
# The penumbra's width, and how far from the marker's centre a shadow's edge crosses it at most, relative to the side.
PENUMBRA, OFF_CENTRE = 0.05, 0.4
# Rays per pixel, in each direction.
RAYS, RAYS_IN_MOTION = 6, 3
MARGIN_PX = 16
# Grey level for each of 65536 steps of linear light.
ENCODED = (255 * srgb_from_linear(np.linspace(0, 1, 65536))).astype(np.float32)


@dataclass(frozen=True, slots=True)
class Cover:
    """A strip that lies over a side of the black square, in units of its side."""

    side: int  # 0 the upper one, then clockwise as printed
    inwards: float  # how far it reaches into the square
    outwards: float  # and out of it
    along: tuple[float, float]  # from where to where it lies, 0 and 1 are the side's ends
    skew: float  # tangent of its angle with the side
    light: float  # linear reflectance


@dataclass(frozen=True, slots=True)
class Flaws:
    """The degradations between the scene and the picture."""

    blur_px: float = 0.7  # standard deviation of the lens's Gaussian blur
    noise: float = 2.0  # standard deviation, grey levels of the encoded picture
    vignetting: float = 0.3  # light lost in the picture's corners
    shadow_ratio: float = 1.0  # of a shadow whose edge runs across the marker anywhere; 1: there is none
    gain: float = 1.0  # exposure relative to the correct one
    gamma: float = 1.0  # exponent put on the encoded picture, as by a camera's contrast curve
    quiet_zone: float = QUIET_ZONE  # white around the black square, over its side
    ground_gain: float = 1.0  # light of the ground, over what it is beside white paper as a rule
    cover: Cover | None = None  # what lies over the print


CLEAN_CAMERA = Flaws()


@dataclass(frozen=True, slots=True, eq=False)
class PrintedMarker:
    """A print on white paper before a camera."""

    bitmap: Image  # (n, n) its black square
    side_m: float  # of that
    camera: Camera
    flaws: Flaws = CLEAN_CAMERA
    rays: int | None = None  # per pixel in each direction; None: as many as measuring hundredths of a pixel needs

    def painted(self, poses: Sequence[Float], rng: np.random.Generator, canvas: Float | None = None) -> Image:
        """(h, w, 3) uint8 BGR.

        poses: T_cam_marker (4, 4) at times spread evenly over the exposure, one for a marker at rest; the middle one is
        the ground truth. canvas: (h, w) linear light behind the paper; without it, `ground` without clutter.
        """
        light = self.flaws.ground_gain * (ground(self.camera) if canvas is None else canvas)
        x0, y0, x1, y1 = self._region(poses)
        if x1 > x0 and y1 > y0:
            rays = self.rays or (RAYS if len(poses) == 1 else RAYS_IN_MOTION)
            region = light[y0:y1, x0:x1]
            light[y0:y1, x0:x1] = np.mean([self._over(region, (x0, y0), pose, rays) for pose in poses], axis=0)
        if self.flaws.shadow_ratio < 1:
            light = self._shaded(light, poses[len(poses) // 2], rng)
        return developed(light, self.flaws, rng)

    def _region(self, poses: Sequence[Float]) -> tuple[int, int, int, int]:
        """Left, top, right, bottom of the pixels that the paper may cover."""
        camera, half = self.camera, self.side_m * (0.5 + QUIET_ZONE)
        outline = np.array([(x, y, 0.0) for x in np.linspace(-half, half, 9) for y in np.linspace(-half, half, 9)])
        pixels = np.concatenate(
            [
                cv2.projectPoints(outline, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)[0][:, 0]
                for T in poses
            ]
        )
        lower = np.floor(pixels.min(axis=0) - MARGIN_PX).clip(0, camera.size)
        upper = np.ceil(pixels.max(axis=0) + MARGIN_PX).clip(0, camera.size)
        return int(lower[0]), int(lower[1]), int(upper[0]), int(upper[1])

    def _over(self, behind: Float, corner_px: tuple[int, int], T_cam_marker: Float, rays: int) -> Float:
        """`behind` (h, w), from pixel `corner_px` on, with the paper in front of it; `rays` squared rays per pixel."""
        height, width = behind.shape
        x, y = _on_paper(self.camera, T_cam_marker, corner_px, (width * rays, height * rays), rays)
        half = self.side_m / 2
        reach = half * (1 + 2 * self.flaws.quiet_zone)
        is_paper = (np.abs(x) < reach) & (np.abs(y) < reach)
        is_square = (np.abs(x) < half) & (np.abs(y) < half)
        cells = len(self.bitmap)
        column = ((x / self.side_m + 0.5) * cells).astype(np.int32).clip(0, cells - 1)
        row = ((0.5 - y / self.side_m) * cells).astype(np.int32).clip(0, cells - 1)
        printed = np.where(self.bitmap > 127, PAPER, INK)[row, column]
        colour = np.where(is_square, printed, PAPER)
        light = np.where(is_paper, colour, np.repeat(np.repeat(behind, rays, axis=0), rays, axis=1))
        cover = self.flaws.cover
        if cover is not None:
            light = np.where(_is_covered(cover, x / self.side_m, y / self.side_m), cover.light, light)
        return np.asarray(light.reshape(height, rays, width, rays).mean(axis=(1, 3)))

    def _shaded(self, light: Float, T_cam_marker: Float, rng: np.random.Generator) -> Float:
        """`light` (h, w), with a soft-edged shadow that begins somewhere on the marker, its edge straight."""
        x, y = _on_paper(self.camera, T_cam_marker, (0, 0), self.camera.size, 1)
        angle = rng.uniform(0, 2 * np.pi)
        off_centre = rng.uniform(-OFF_CENTRE, OFF_CENTRE)
        beyond_edge = (np.cos(angle) * x + np.sin(angle) * y) / self.side_m - off_centre
        lost = (1 - self.flaws.shadow_ratio) * (0.5 + beyond_edge / PENUMBRA).clip(0, 1)
        return np.asarray(light * (1 - lost))


def developed(light: Float, flaws: Flaws, rng: np.random.Generator) -> Image:
    """The picture (h, w, 3) uint8 BGR that a camera with `flaws` makes of linear `light` (h, w)."""
    height, width = light.shape
    light = light.astype(np.float32)
    blurred = cv2.GaussianBlur(light, (0, 0), flaws.blur_px) if flaws.blur_px > 0 else light
    x = (np.arange(width) - (width - 1) / 2) / (width / 2)
    y = (np.arange(height) - (height - 1) / 2) / (height / 2)
    falloff = 1 - flaws.vignetting * (x[None] ** 2 + y[:, None] ** 2) / 2
    exposed = flaws.gain * falloff.astype(np.float32) * blurred
    grey = ENCODED[(exposed * (len(ENCODED) - 1) + 0.5).clip(0, len(ENCODED) - 1).astype(np.int32)]
    if flaws.gamma != 1:
        grey = 255 * (grey / 255) ** np.float32(flaws.gamma)
    noisy = grey + flaws.noise * rng.standard_normal(grey.shape, np.float32)
    encoded = (noisy + 0.5).clip(0, 255).astype(np.uint8)
    return np.repeat(encoded[:, :, None], 3, axis=2)


def ground(camera: Camera, clutter: int = 0, seed: int = 4) -> Float:
    """(h, w) linear light of a mottled ground with `clutter` random quadrilaterals; deterministic."""
    width, height = camera.size
    rng = np.random.default_rng(seed)
    coarse = rng.normal(0, 1, (max(2, height // 12), max(2, width // 12))).astype(np.float32)
    light = GROUND * (1 + 0.12 * cv2.resize(coarse, camera.size, interpolation=cv2.INTER_CUBIC)).astype(np.float64)
    for _ in range(clutter):
        centre, radius = rng.uniform((0, 0), (width, height)), rng.uniform(0.01, 0.06) * width
        angles = np.sort(rng.uniform(0, 2 * np.pi, 4))
        corners = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        cv2.fillConvexPoly(light, np.round(corners).astype(np.int32), float(rng.uniform(0.02, 0.6)))
    return light.clip(0.01, 1)


def _is_covered(cover: Cover, x: Float, y: Float) -> Mask:
    """Whether the strip lies over places in units of the side."""
    for _ in range(cover.side):
        x, y = -y, x
    along = x + 0.5
    beyond = y - 0.5 - cover.skew * (along - 0.5)
    start, end = cover.along
    return (along > start) & (along < end) & (beyond > -cover.inwards) & (beyond < cover.outwards)


def _on_paper(
    camera: Camera, T_cam_marker: Float, corner_px: tuple[int, int], size: tuple[int, int], rays: int
) -> tuple[Float, Float]:
    """x and y, each (h, w), metres: where the rays of a supersampled pixel grid meet the marker's plane."""
    u = corner_px[0] + (np.arange(size[0]) + 0.5) / rays - 0.5
    v = corner_px[1] + (np.arange(size[1]) + 0.5) / rays - 0.5
    if camera.is_distorted:
        ideal = undistorted(camera, np.stack(np.meshgrid(u, v), axis=2).reshape(-1, 2))
        u_ideal, v_ideal = np.moveaxis(ideal.reshape(size[1], size[0], 2), 2, 0)
    else:
        u_ideal, v_ideal = u[None], v[:, None]
    marker_from_pixel = np.linalg.inv(camera.K @ T_cam_marker[:3, (0, 1, 3)])
    x, y, w = (a * u_ideal + b * v_ideal + c for a, b, c in marker_from_pixel)
    is_before = w > 1e-12  # behind the camera the plane is not seen
    w = np.where(is_before, w, 1.0)
    far = 1e6
    return np.where(is_before, x / w, far), np.where(is_before, y / w, far)

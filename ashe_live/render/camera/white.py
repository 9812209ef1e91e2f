"""Exposure and white balance: how the picture shows perfectly white ground, by the marker's paper and ink."""

import math
from dataclasses import dataclass
from itertools import compress

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import mean_side_px, square_corners
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.camera.paper_gloss import mirrored_by_paper
from ashe_live.render.lights.cast_shadows import lit_past
from ashe_live.render.lights.lighting import RGB, Lighting, ShadingLight

PAPER_ALBEDO = 0.8  # of office paper, which reflects all colours alike
# Brightness of printed black over that of paper: a laser printer's toner (0.045 over 0.8), and 1 % that a lens
# scatters.
INK_RATIO = 0.07
# Standard deviations of the logarithms of black print and of exposure about their usual values; and the probability
# density of pale grey print over that of black print, at the most probable brightness of black.
INK_SPREAD, EXPOSURE_SPREAD, PALE = 0.3, 0.3, 0.15
# Standard deviations of the logarithm of the ratio of two channels: of paper after white balancing, and of black print
# relative to paper. Black is warm: its red over green is 1.1 to 1.2 times that of paper in six of six photos in
# sunlight, and more beside terracotta, some of whose light a lens scatters.
WHITE_TINT, INK_TINT = 0.09, 0.15
# Linear brightness from which paper counts as overexposed in part, and fully: tone curves bend near white.
OVEREXPOSED = (0.88, 0.94)
MOST_OVER = 1.4  # largest assumed overexposure of paper
# Assumed where nothing can be measured: paper a little below the display's white, as in a well exposed photo.
ASSUMED_WHITE = 0.8
ASSUMED_RGB: RGB = (ASSUMED_WHITE, ASSUMED_WHITE, ASSUMED_WHITE)
MIN_CONTRAST = 1.6  # least brightness of paper over that of black ink
RING_SIDES = (0.57, 0.62)  # distances from the marker's centre, in sides, at which there is paper
OVERSHOOT_PX = 3.0  # width of the rim beside the square in which sharpening makes paper brighter than it is
INK_SIDES = 0.45  # distance from the marker's centre, in sides, at which there is its square's black border
LEAST_LEVEL = 0.05  # least light on paper, over full light, for it to be used
BLACKEST = 1e-3  # least linear brightness assumed of ink and of paper's channels, which a picture may show as 0
MIN_PAPER = 0.02  # least linear brightness of paper in the picture
LIT_SHARE, BLACK_SHARE = 0.4, 0.6  # shares of the places on paper and ink used, the brightest: others may be shaded
AROUND = 12  # places along each of the square's edges
ALONG = np.linspace(-0.5, 0.5, AROUND)
INK_PLACES = np.concatenate([[(INK_SIDES * s, 0.9 * x), (0.9 * x, INK_SIDES * s)] for s in (-1, 1) for x in ALONG])
BODY_PRINT_SHARE = 0.7  # side of the black squares on a body's faces over its edge: TAG_SHARE of tracking/cube/faces.py


@dataclass(frozen=True, slots=True)
class LightOnPrint:
    """The light on the paper and ink of the marker's print, by which its brightness becomes that of white."""

    lighting: Lighting  # of lamps the paper is brighter towards them
    reaching: tuple[ShadingLight, ...]  # those of its lights that reach any of the print past the real object
    height_m: float = 0.0  # of the print above the plane: that of a body is nearer to lamps

    def level_at(self, places: Float) -> Float:
        """(n, 3) of full light at the marker's centre, at places (n, 2) of the print."""
        level = self.lighting.level_at(places, self.height_m)
        for light in self.lighting.lights:
            if light not in self.reaching:
                level = level - np.outer(light.ground_falloff(places, self.height_m), light.ground_share)
        return np.maximum(level, LEAST_LEVEL)


def light_on_print(tracked: TrackedFrame, lighting: Lighting, real_object: Proxy | None) -> LightOnPrint:
    """By where the marker lies alone: the same for all frames of a marker.

    Only a light whose shadow covers the whole print is none of those that reach it: where light and shadow meet, the
    picture tells them apart better than an estimated light does. A body that bears the marker is the real object
    itself, and does not shade the print on its own top.
    """
    if real_object is None or tracked.pose.body is not None:
        return LightOnPrint(lighting, lighting.lights, print_height_m(tracked))
    ring = print_side_m(tracked) * _ring(RING_SIDES)
    reaches = [np.nan_to_num(lit_past(real_object, light, ring), nan=1.0).any() for light in lighting.lights]
    return LightOnPrint(lighting, tuple(compress(lighting.lights, reaches)))


def white_of(tracked: TrackedFrame, light: LightOnPrint | None = None) -> RGB:
    """As `measured_white`; grey without any paper."""
    return measured_white(tracked, light) or ASSUMED_RGB


def measured_white(tracked: TrackedFrame, light: LightOnPrint | None = None) -> RGB | None:
    """Linear RGB that white, fully lit at the marker's centre, has in a frame with a marker; None without any paper.

    `light`: None while it is unknown, and even over the print.
    """
    side = print_side_m(tracked)
    nearest, farthest = RING_SIDES
    side_px = mean_side_px(print_corners_px(tracked))
    nearest = float(np.clip(0.5 + OVERSHOOT_PX / max(side_px, 1.0), nearest, farthest))
    paper, ink = (_linear_at(tracked, side * places, light) for places in (_ring((nearest, farthest)), INK_PLACES))
    if len(paper) < AROUND or len(ink) < AROUND:
        return None
    brightness, darkness = paper @ REC709_LUMINANCE, ink @ REC709_LUMINANCE
    # Some of the paper may lie in a shadow.
    lit = paper[brightness >= np.quantile(brightness, 1 - LIT_SHARE)]
    if np.median(brightness) < max(MIN_CONTRAST * np.median(darkness), MIN_PAPER):
        return None
    black = ink[darkness >= np.quantile(darkness, 1 - BLACK_SHARE)]
    mirrored = _mirrored(tracked, () if light is None else light.reaching)
    exposed = _as_exposed(lit.mean(axis=0), black.mean(axis=0), float(mirrored @ REC709_LUMINANCE))
    red, green, blue = (float(value) for value in np.maximum(exposed, BLACKEST) / (PAPER_ALBEDO + mirrored))
    return red, green, blue


def print_pixels(tracked: TrackedFrame, places: Float) -> Float:
    """(n, 2) pixels of places (n, 2) of the marker's upright print; NaN for what lies behind the camera.

    For a body, of the print on its top.
    """
    points = np.column_stack([places, np.full(len(places), print_height_m(tracked))])
    return project_distorted(tracked.camera, tracked.pose.T_cam_marker, points)


def print_corners_px(tracked: TrackedFrame) -> Float:
    """(4, 2) of the print's black square, in the order of the marker's; NaN for those behind the camera."""
    if tracked.pose.body is None:
        return tracked.pose.corners_px
    return print_pixels(tracked, square_corners(print_side_m(tracked))[:, :2])


def print_side_m(tracked: TrackedFrame) -> float:
    """The side of the print's black square, metres."""
    return tracked.pose.side_m * (1.0 if tracked.pose.body is None else BODY_PRINT_SHARE)


def print_height_m(tracked: TrackedFrame) -> float:
    """Metres from the plane up to the print: a body's is on its top."""
    return 0.0 if tracked.pose.body is None else tracked.pose.side_m


def _mirrored(tracked: TrackedFrame, lights: tuple[ShadingLight, ...]) -> Float:
    """(3,) what the print's middle mirrors of the lights into the camera, as `mirrored_by_paper`."""
    middle = np.array([0.0, 0.0, print_height_m(tracked)])
    to_eye = camera_centre(tracked.pose.T_cam_marker) - middle
    return mirrored_by_paper(lights, to_eye / np.linalg.norm(to_eye), middle)


def _as_exposed(paper: Float, ink: Float, mirrored: float) -> Float:
    """(3,) paper as it would be if no channel were brighter than the picture can show, by ink beside it; linear RGB.

    Where paper has lost the light's colours, ink tells them, as far as it is colourless itself. How bright the paper is
    follows from a channel that is not overexposed, or else from the ink's brightness. Of the logarithm by which ink is
    brighter than usual, half counts, as exposure and ink vary alike; more of a small one, as overexposed paper is at
    least fully exposed; and less, the likelier it is that the print is a pale one. `mirrored`: what paper and ink both
    mirror, which brings them closer; white has 1.
    """
    low, high = OVEREXPOSED
    ink = np.maximum(ink, BLACKEST)
    shares = np.clip((paper - low) / (high - low), 0.0, 1.0)
    brightness, darkness = float(paper @ REC709_LUMINANCE), float(ink @ REC709_LUMINANCE)
    usual = (INK_RATIO * PAPER_ALBEDO + mirrored) / (PAPER_ALBEDO + mirrored)
    excess = math.log(darkness / usual / brightness)
    variance = INK_SPREAD**2 + EXPOSURE_SPREAD**2
    black = math.exp(-(excess**2) / (2 * variance))
    over = math.exp(_mean_over(excess) * black / (black + PALE))
    ink = darkness * (ink / darkness) ** (WHITE_TINT**2 / (WHITE_TINT**2 + INK_TINT**2))
    by_ink = brightness * float(np.clip(over, 1.0, MOST_OVER)) * ink / darkness
    # No channel is darker than it is seen.
    by_ink *= max(1.0, float((paper / by_ink).max()))
    known = 1 - shares
    if known.any():
        by_channel = ink * (known @ paper) / (known @ ink)
        by_ink += (by_channel - by_ink) * known.max()
    return np.asarray(paper + shares * np.maximum(by_ink - paper, 0.0), np.float64)


def _mean_over(excess: float) -> float:
    """Mean logarithm of how much brighter paper is than it can be seen, by that of black ink's excess over the rule.

    The mean is over the positive exposures, where exposures and inks are normally distributed.
    """
    variance = INK_SPREAD**2 + EXPOSURE_SPREAD**2
    middle = EXPOSURE_SPREAD**2 / variance * excess
    spread = INK_SPREAD * EXPOSURE_SPREAD / math.sqrt(variance)
    # Far below 0 the mean of the tail is near 0 anyway.
    z = max(middle / spread, -5.0)
    above = 0.5 * math.erfc(-z / math.sqrt(2))
    return spread * (z + math.exp(-(z**2) / 2) / (math.sqrt(2 * math.pi) * above))


def _ring(sides: tuple[float, float]) -> Float:
    """(n, 2) places around the square, in sides from its centre, at two distances in sides."""
    return np.concatenate([[(x, r), (x, -r), (r, x), (-r, x)] for r in sides for x in ALONG])


def _linear_at(tracked: TrackedFrame, places: Float, light: LightOnPrint | None) -> Float:
    """(m, 3) linear RGB of those places (n, 2) of the print in view, as it would be in full light."""
    column, row = np.round(print_pixels(tracked, places)).T
    width, height = tracked.frame.size
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    bgr = tracked.frame.image_bgr[row[seen].astype(int), column[seen].astype(int)]
    linear = LINEAR_FROM_SRGB_8BIT[bgr[:, ::-1]]
    return np.asarray(linear if light is None else linear / light.level_at(places[seen]))

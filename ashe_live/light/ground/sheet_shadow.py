"""The printed sheet's own shadow: a body that lies in every picture, whatever else stands or is painted there.

Card is thick and paper curls, so that a sheet's edges stand a little above the ground. The sides that face away from
the light cast a strip of shadow beyond the paper, those that face it none. How high an edge stands is not known: the
strips constrain the light's azimuth, and not its elevation. What darkens the ground along all four sides alike, as
sharpening does, cancels.
"""

import math
from dataclasses import dataclass
from operator import attrgetter

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.pixels.sheet import ADDED
from ashe_live.light.pixels.view import View

OUTWARDS = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])  # right, above, left, below
ALONG = np.linspace(-0.42, 0.42, 48)  # lines of samples across a side, in the marker's sides from its middle
LEAST_SEEN = 0.5  # share of a side's lines that lie in the picture
STEP_PX = 0.5  # between samples of a line
BLUR_PX = 5.0  # from an edge, beyond which the camera's blur does not reach
SEARCHED = 0.05  # sides, around the measured end of the paper, where its edge is looked for
BESIDE = 0.13  # sides beyond the edge that are looked at; the last GROUND of them are the lit ground
GROUND = 0.06
WIDTHS_PX = (1.0, 1.5, 2.5, 4.0, 6.0, 9.0, 14.0, 20.0)  # of strips, up to WIDEST sides
WIDEST = 0.1
NARROW_PX = 2.0  # a strip that blur thins out may be as pale as it will; a wider one lacks LEAST_LOST of the light
LEAST_LOST = 0.25
EDGE_PX, NOISE = 0.3, 0.05  # standard deviations of the edge's place, and of a profile over its ground
LEAST_STEP = 0.02  # from paper to ground, over the ground: a smaller one holds the edge's place no better
EDGE_BLUR, EDGE_MARGIN = 2.0, 3  # in samples: blur before the steepest place is looked for; not looked for at the ends
LEAST_BESIDE_PX = 9.0  # that are looked at beyond the edge, however small the marker is
# Samples of a line by which the paper's and the ground's light are measured, the latter at least.
PAPER_SAMPLES, LEAST_SAMPLES = 5, 6
# Darkness beside a sheet that has no thickness, in sides: by patterns, objects and their shadows (root mean square of
# `away` of the sets `scenes` and `scenes_more`, docs/accuracy/one_picture.md).
OTHERWISE = 0.018
INDEPENDENT = 1 / 3  # of neighbouring lines
# Of azimuths about the direction from which a clear shadow comes (von Mises): `ashe-live bench fit-judge --sheets`.
CONCENTRATION = 5.0
# Of clear shadows, those that something else casts beside the sheet: of 87 that the same command counts, 62 point away
# from the light to 45 degrees, where a quarter does by chance.
OTHERS = 0.3
MEDIAN_OVER_MEAN = 1.25  # standard deviation of a median over that of a mean, of normal variables
LUMINANCE_BGR = np.ascontiguousarray(REC709_LUMINANCE[::-1])


@dataclass(frozen=True, slots=True, eq=False)
class SheetShadow:
    """What is darker beyond the sheet's edges on one side than on the other."""

    away: Float  # (2,) sides, marker frame: width times share of light lost, which points away from the light
    clear: float  # 0 to 1, the share of its square that patterns and noise do not explain

    def log_odds(self, to_light_marker: Float, concentration: float = CONCENTRATION) -> float:
        """How much likelier this shadow is in such a light than in lights from anywhere, in nats.

        Azimuths are von Mises distributed about where the shadow comes from, the narrower the clearer it is, and even
        where something else casts it. A light straight overhead has no azimuth, and the shadow says nothing of it.
        """
        across = float(np.hypot(*to_light_marker[:2]) * np.hypot(*self.away))
        if across < 1e-9:
            return 0.0
        narrow = concentration * self.clear
        towards = -float(to_light_marker[:2] @ self.away) / across
        own = math.exp(narrow * towards) / float(np.i0(narrow))
        return math.log((1 - OTHERS) * own + OTHERS)


@dataclass(frozen=True, slots=True, eq=False)
class _EdgeResponse:
    """How the camera shows an edge from dark to light."""

    away_px: Float  # (n,) from where half of the step is reached
    response: Float  # (n,) share of the step, 0 to 1

    def at(self, away_px: Float) -> Float:
        """(m,) the share of the step at other distances."""
        return np.interp(away_px, self.away_px, self.response, left=0.0, right=1.0)


@dataclass(frozen=True, slots=True, eq=False)
class _Strip:
    """The strip of shadow that was fitted to a profile."""

    width_px: float
    amplitude: float  # share of light that it lacks
    weights: Float  # (n,) by which the amplitude follows from the profile
    cost: float  # sum of squares that it leaves


def sheet_shadow_in(view: View) -> SheetShadow | None:
    """The shadow beside the sheet of `view`; None where its edges are not seen, or the marker is on no small sheet."""
    view = view.taken or view
    if view.body is not None or view.page is not None:
        return None
    luminance = (cv2.LUT(view.image_bgr, LINEAR_FROM_SRGB_8BIT) @ LUMINANCE_BGR).astype(np.float32)
    lines = _Lines(luminance, image_from_plane(view.camera, view.T_cam_marker), view.side_m)
    edge = _edge_response(lines)
    if edge is None:
        return None
    ends = (view.sheet.ends - ADDED).tolist()
    strips = np.array([_strip(lines, side, end, edge) for side, end in enumerate(ends)])
    seen = np.isfinite(strips[:, 0])
    if not seen.any():
        return None
    strips[~seen] = 0.0
    # Nothing is brighter beside a sheet; and what is dark on all sides singles out none of them.
    dark = np.maximum(strips[:, 0], 0.0)
    dark = np.maximum(dark - (dark.min() if seen.all() else 0.0), 0.0)
    away = dark @ OUTWARDS
    squared = float(away @ away)
    noise = 0.5 * float((strips[:, 1] ** 2).sum())
    return SheetShadow(away, squared / (squared + OTHERWISE**2 + noise))


@dataclass(frozen=True, slots=True, eq=False)
class _Lines:
    """Samples of the picture along lines that run outwards across the sheet's sides."""

    luminance: np.ndarray[tuple[int, ...], np.dtype[np.float32]]  # (h, w) linear
    image_from_marker: Float  # (3, 3) of (x, y, 1) in metres
    side_m: float

    def across(self, side: int, outwards: Float) -> Float:
        """(n, lines) luminance so many sides (n,) from the marker's centre; without lines that leave the picture."""
        outward = OUTWARDS[side]
        aside = np.array([-outward[1], outward[0]])
        places = self.side_m * (outwards[:, None, None] * outward + ALONG[:, None] * aside)
        pixels = np.insert(places, 2, 1.0, axis=-1) @ self.image_from_marker.T
        if pixels[..., 2].min() <= 0:
            return np.empty((len(outwards), 0))
        x, y = np.moveaxis(pixels[..., :2] / pixels[..., 2:], -1, 0).astype(np.float32)
        height, width = self.luminance.shape
        seen = ((x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)).all(axis=0)
        if seen.mean() < LEAST_SEEN:
            return np.empty((len(outwards), 0))
        return cv2.remap(self.luminance, x[:, seen], y[:, seen], cv2.INTER_LINEAR).astype(np.float64)

    def px_per_side(self, side: int, outwards: float) -> float:
        """Pixels across a side so many sides from the centre, along its outward line; 0 behind the camera."""
        ends = np.array([(*(OUTWARDS[side] * self.side_m * (outwards + d)), 1.0) for d in (-0.05, 0.05)])
        first, last = ends @ self.image_from_marker.T
        if min(first[2], last[2]) <= 0:
            return 0.0
        return float(np.hypot(*(last[:2] / last[2] - first[:2] / first[2]))) / 0.1


def _edge_response(lines: _Lines) -> _EdgeResponse | None:
    """How the camera shows an edge, by those of the black square; None where none is seen."""
    away = np.arange(-BLUR_PX, BLUR_PX + STEP_PX / 2, STEP_PX)
    responses = []
    for side in range(4):
        scale = lines.px_per_side(side, 0.5)
        across = lines.across(side, 0.5 + away / scale) if scale else np.empty((0, 0))
        if not across.size:
            continue
        profile = np.median(across, axis=1)
        ink, paper = profile[:3].mean(), profile[-3:].mean()
        if paper > ink:
            responses.append((profile - ink) / (paper - ink))
    if not responses:
        return None
    response = np.median(responses, axis=0)
    half_way_px = float(np.interp(0.5, np.maximum.accumulate(response), away))
    return _EdgeResponse(away - half_way_px, response)


def _strip(lines: _Lines, side: int, end: float, edge: _EdgeResponse) -> tuple[float, float]:
    """Width times share of light lost of the strip beyond the paper's end, and its deviation, in sides; NaN: not seen.

    end: about where the paper ends, in sides from the marker's centre.
    """
    scale = lines.px_per_side(side, end)
    found = _edge_near(lines, side, end, scale) if scale else None
    if found is None:
        return math.nan, 0.0
    away = np.arange(-BLUR_PX, max(LEAST_BESIDE_PX, BESIDE * scale) + STEP_PX / 2, STEP_PX)
    across = lines.across(side, found + away / scale)
    if not across.size:
        return math.nan, 0.0
    ground = float(np.median(across[-max(LEAST_SAMPLES, int(GROUND * scale / STEP_PX)) :]))
    paper = float(np.median(across[:PAPER_SAMPLES]))
    if ground <= 0:
        return math.nan, 0.0
    lost = 1 - across / ground
    strip = _fitted_strip(away, np.median(lost, axis=1), edge, paper / ground, WIDEST * scale)
    by_line = strip.weights @ lost
    spread = MEDIAN_OVER_MEAN * SIGMA_OVER_MAD * float(np.median(np.abs(by_line - np.median(by_line))))
    deviation = math.hypot(spread / math.sqrt(INDEPENDENT * len(by_line)), 0.5 * math.sqrt(strip.cost / len(away)))
    is_too_pale = strip.width_px > NARROW_PX and strip.amplitude < LEAST_LOST
    amplitude = 0.0 if is_too_pale else strip.amplitude
    return amplitude * strip.width_px / scale, deviation * strip.width_px / scale


def _edge_near(lines: _Lines, side: int, end: float, scale: float) -> float | None:
    """Where the paper ends near `end`, in sides from the marker's centre: at the steepest place; None: not seen.

    scale: pixels across a side there.
    """
    nearby = np.arange(-SEARCHED, SEARCHED, STEP_PX / 2 / scale)
    around = lines.across(side, end + nearby) if len(nearby) > 2 * EDGE_MARGIN else np.empty((0, 0))
    if not around.size:
        return None
    slope = np.abs(np.gradient(cv2.GaussianBlur(np.median(around, axis=1), (0, 0), EDGE_BLUR).ravel()))
    return end + float(nearby[EDGE_MARGIN + int(slope[EDGE_MARGIN:-EDGE_MARGIN].argmax())])


def _fitted_strip(away: Float, lost: Float, edge: _EdgeResponse, paper: float, widest_px: float) -> _Strip:
    """The strip that fits best the share of light (n,) that is lost at places (n,), in px from the paper's end.

    Fitted are the step from paper to ground as the camera shows edges, its place within EDGE_PX, and a strip of each of
    WIDTHS_PX. paper: its light over the ground's.
    """
    step = edge.at(away)
    moved = (edge.at(away + STEP_PX) - edge.at(away - STEP_PX)) / (2 * STEP_PX)
    held = np.zeros((4, 4))
    held[2, 2] = (NOISE / (EDGE_PX * max(abs(paper - 1), LEAST_STEP))) ** 2
    fits = []
    for width in WIDTHS_PX:
        if width > max(widest_px, NARROW_PX):
            break
        terms = np.stack([np.ones_like(away), step, moved, step - edge.at(away - width)], axis=1)
        solved = np.linalg.solve(terms.T @ terms + held, terms.T)
        found = solved @ lost
        cost = float(((lost - terms @ found) ** 2).sum() + held[2, 2] * found[2] ** 2)
        fits.append(_Strip(width, float(found[3]), solved[3], cost))
    return min(fits, key=attrgetter("cost"))

"""Undoes the shadow that crosses a print: in deep shade, white is darker than what is grey in the sun.

The print is known, and so is where it is white. If its white shows two levels of light, as beside an object in the sun,
each sample is divided by the light that falls on it, so that what compares it with the print need not know of shadows.
Where a penumbra is too wide for two levels, its light is that of a round source that a straight border hides in part.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.tracking.edges.edge_profiles import Light

# Shadow ratios between which two levels of white are taken for a shadow: above, a print is recognised as it is; below,
# white in the shade is as dark as ink in the light.
DEEPEST, PALEST = 0.06, 0.65
# White in the shade is at least so many times as bright as ink in the light, and nearly all white has at least this
# share of the light that falls on it; else some of it is another print's ink.
ABOVE_INK, LEAST_WHITE = 1.2, 0.6
LEAST_SHARE = 0.03  # of the white, on either side of the shadow's edge; "nearly all" is all but this share
# Least reflectance of what counts as white, over the paper's, and the largest of what counts as ink.
WHITE, INK = 0.85, 0.15
ROUNDS = 4  # of parting the white into two levels
# The light on neighbouring samples that differs by this share of the brighter one's is a shadow's edge.
EDGE = 0.1
MOST_EDGE = 0.4  # share of the samples that lie on such edges: more leave too little of a print to compare
NEIGHBOURS = np.ones((3, 3), np.uint8)
TINY = np.float32(1e-6)  # of linear light, so that its log is finite
BRIGHTEST_INK = 0.95  # quantile of ink that stands for the brightest, as a few samples are noise
# A penumbra is fitted to at most so many samples of white, in so many steps, until one lowers the squared error by less
# than this share.
MOST_FITTED, FIT_STEPS, FITTED = 250, 25, 1e-3
# Largest root mean square by which the logarithm of white may differ from it. Painted penumbrae leave 0.06, a single
# cell of another print, whose ink is at -3, leaves 0.4.
MOST_UNEXPLAINED = 0.1
DARKEST = -12.0  # the least logarithm of a level that a fit goes to, and minus the largest
LARGEST_STEP = 3.0  # of each unknown at once


@dataclass(frozen=True, slots=True, eq=False)
class Shade:
    """A shadow on a print's samples."""

    light: Light  # (n, n) that falls on each, over what falls beside the shadow
    edge: Mask  # (n, n) where that changes
    expected: Light  # (n, n) the print's samples in the light beside the shadow

    def removed_from(self, samples: Light) -> Light:
        """(n, n) `samples` as if there were no shadow; at its edge they say nothing, and are those of the print."""
        return np.where(self.edge, self.expected, samples / self.light)


class PrintShade:
    """Finds the shadow whose edge crosses one print, by where that is white and black; made once for all pictures."""

    def __init__(self, print_samples: Float, cell: int, margin: int) -> None:
        """`print_samples` (n, n): the print and the paper around it, from 0 to 1; `cell`, `margin`: samples along a
        cell, and along the width of the paper.
        """
        self._cell = cell
        self._print = print_samples.astype(np.float32)
        self._white, self._black = _inside(print_samples > WHITE), _inside(print_samples < INK)
        within = slice(margin, -margin)
        is_within = np.zeros_like(self._white)
        is_within[within, within] = True
        self._white_within = is_within[self._white]
        # Of each sample, which is the nearest one that is white or black.
        known = self._white | self._black
        _, nearest = cv2.distanceTransformWithLabels(
            (~known).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
        )
        places = np.zeros(int(nearest.max()) + 1, np.intp)
        places[nearest[known]] = np.flatnonzero(known)
        self._nearest = places[nearest]

    def white_of(self, samples: Light) -> Light:
        """(m,) of `samples` (n, n) those that are white, and not at an edge, in the print."""
        return np.asarray(samples[self._white], dtype=np.float32)

    def on(self, samples: Light) -> Shade | None:
        """The shadow whose edge crosses `samples` (n, n) of linear light, taken where the print is thought to be."""
        white = samples[self._white]
        # Nearly every frame ends here.
        if not len(white) or float(white.min()) > PALEST * float(white.max()):
            return None
        levels = self._levels(white, samples[self._black])
        if levels is None:
            return None
        ratio, bright, ink = levels
        known = np.ones_like(samples)
        # In a penumbra white shows its light by itself.
        known[self._white] = on_white = np.clip(white / bright, ratio, 1)
        if np.quantile(white / on_white, LEAST_SHARE) < LEAST_WHITE * bright:
            return None
        nearer = self._nearer_to_shaded(white < bright * np.sqrt(ratio))
        of_shade = samples[self._black & (nearer > 0)]
        if len(of_shade) and float(np.median(of_shade)) > LEAST_WHITE * ratio * bright:
            return None  # something grey lies over the print, and hides ink as well
        # Where white of both kinds is near, darkness tells; elsewhere another print's white in the shade would pass for
        # ink in the light.
        is_dark = samples < ink * np.sqrt(ratio)
        is_shaded = np.where(np.abs(nearer) < self._cell, is_dark, nearer > 0)
        known[self._black] = np.where(is_shaded[self._black], ratio, 1)
        light = known.ravel()[self._nearest]
        edge = cv2.erode(light, NEIGHBOURS) < (1 - EDGE) * cv2.dilate(light, NEIGHBOURS)
        if np.count_nonzero(edge) > MOST_EDGE * edge.size:
            return None
        return Shade(light, np.asarray(edge, dtype=np.bool_), ink + (bright - ink) * self._print)

    def penumbra_on(self, samples: Light) -> Shade | None:
        """A shadow with a straight border of any width across `samples` (n, n) as in `on`, by the light on its white.

        It is that of a round source beside a straight border. Its five unknowns cannot imitate the cells of another
        print.
        """
        white = samples[self._white]
        if not len(white) or float(white.min()) > PALEST * float(white.max()) or not self._black.any():
            return None
        n = len(samples)
        y, x = np.indices(samples.shape) / ((n - 1) / 2) - 1
        seen = np.log(np.maximum(white, TINY)).astype(np.float64)
        every = -(-len(white) // MOST_FITTED)
        penumbra = _fitted_penumbra(x[self._white][::every], y[self._white][::every], seen[::every])
        if penumbra is None:
            return None
        fitted = np.exp(_log_light(penumbra, x, y)[0])
        unexplained = seen - np.log(fitted[self._white])
        if not float(unexplained @ unexplained) <= MOST_UNEXPLAINED**2 * len(white):
            return None
        bright = float(fitted[self._white].max())
        light = np.clip(fitted / bright, DEEPEST, 1).astype(np.float32)
        edge = cv2.erode(light, NEIGHBOURS) < (1 - EDGE) * cv2.dilate(light, NEIGHBOURS)
        if np.count_nonzero(edge) > MOST_EDGE * edge.size:
            edge = np.zeros_like(edge)  # so wide a border is known within it as well
        ink = float(np.median(samples[self._black] / light[self._black]))
        return Shade(light, np.asarray(edge, dtype=np.bool_), (ink + (bright - ink) * self._print).astype(np.float32))

    def _levels(self, white: Light, black: Light) -> tuple[float, float, float] | None:
        """The shadow's ratio, and the levels of white and ink in the light; None where white (m,) and black (k,) show
        no shadow that paper and ink can be told in.
        """
        levels = _two_levels(white)
        if levels is None or not len(black):
            return None
        dark, bright = levels
        ratio = dark / bright
        ink = _lit_ink(black, ratio)
        if not DEEPEST < ratio < PALEST or dark < ABOVE_INK * ink:
            return None
        is_lit = white > bright * np.sqrt(ratio)
        within, around = is_lit[self._white_within], is_lit[~self._white_within]
        # Else it is a bright floor around a narrow margin.
        is_within = within.any() or 2 * np.count_nonzero(around) <= len(around)
        return (ratio, bright, ink) if is_within else None

    def _nearer_to_shaded(self, shaded_white: Mask) -> Light:
        """(n, n) by how many samples the nearest white in the shade is nearer than that in the light; (m,) of white."""
        return self._distance_to(~shaded_white) - self._distance_to(shaded_white)

    def _distance_to(self, of_white: Mask) -> Light:
        """(n, n) samples from the nearest white of which `of_white` (m,) is true."""
        others = np.ones_like(self._white, np.uint8)
        others[self._white] = ~of_white
        return np.asarray(cv2.distanceTransform(others, cv2.DIST_L2, 3), dtype=np.float32)


def _two_levels(white: Light) -> tuple[float, float] | None:
    """The darker and the brighter level of two; None where nearly all of `white` (m,) is on one."""
    brightness = np.log(np.maximum(white, TINY))
    threshold = 0.5 * float(brightness.min() + brightness.max())
    for _ in range(ROUNDS):
        is_lit = brightness > threshold
        if not LEAST_SHARE <= float(is_lit.mean()) <= 1 - LEAST_SHARE:
            return None
        dark, bright = float(np.median(brightness[~is_lit])), float(np.median(brightness[is_lit]))
        threshold = 0.5 * (dark + bright)
    return float(np.exp(dark)), float(np.exp(bright))


def _lit_ink(black: Light, ratio: float) -> float:
    """The level of ink in the light, where some of `black` (m,) may lie in a shadow of this `ratio`."""
    return float(np.median(black[black >= np.sqrt(ratio) * np.quantile(black, BRIGHTEST_INK)]))


def _inside(mask: Mask) -> Mask:
    """(n, n) of `mask`, what nothing else neighbours: in a picture, edges mix black and white."""
    return np.asarray(cv2.erode(mask.astype(np.uint8), NEIGHBOURS), dtype=np.bool_)


def _log_light(penumbra: Float, x: Float, y: Float) -> tuple[Float, Float]:
    """(...) logarithm of the light at x, y (...), and (..., 5) its derivatives by the `penumbra`: the logarithms of its
    two levels, and the three coefficients of where the border lies on the source.
    """
    first, second = np.exp(penumbra[0]), np.exp(penumbra[1])
    # Where the border lies on the source's disc, from -1 to 1.
    place = np.clip(penumbra[2] * x + penumbra[3] * y + penumbra[4], -1, 1)
    half_chord = np.sqrt(1 - place * place)
    share = 0.5 + (place * half_chord + np.arcsin(place)) / np.pi
    light = first + (second - first) * share
    slope = (second - first) * 2 / np.pi * half_chord
    derivatives = np.stack([first * (1 - share), second * share, slope * x, slope * y, slope], axis=-1)
    return np.log(light), np.asarray(derivatives / light[..., None])


def _fitted_penumbra(x: Float, y: Float, seen: Float) -> Float | None:
    """(5,) the penumbra, as in `_log_light`, that explains the logarithms `seen` (m,) of white at x, y (m,) best, by
    Levenberg and Marquardt; None where they are all alike.
    """
    plane = np.linalg.lstsq(np.column_stack([np.ones_like(x), x, y]), seen, rcond=None)[0]
    steepness = float(np.hypot(plane[1], plane[2]))
    dark, bright = np.quantile(seen, (LEAST_SHARE, 1 - LEAST_SHARE))
    if steepness <= 0 or bright <= dark:
        return None
    # First as steep at its middle as the plane.
    across = 0.5 * np.pi / (bright - dark) * plane[1:]
    middle = int(np.argmin(np.abs(seen - 0.5 * (dark + bright))))
    penumbra = np.array([dark, bright, *across, -(across[0] * x[middle] + across[1] * y[middle])])
    damping = 1e-3
    fitted, derivatives = _log_light(penumbra, x, y)
    left = seen - fitted
    for _ in range(FIT_STEPS):
        normal = derivatives.T @ derivatives
        step = np.linalg.solve(normal + np.diag(damping * np.diag(normal) + 1e-9), derivatives.T @ left)
        # Where the border is wider than the print, its levels are out of sight and may be anything.
        tried = penumbra + np.clip(step, -LARGEST_STEP, LARGEST_STEP)
        tried[:2] = np.clip(tried[:2], DARKEST, -DARKEST)
        fitted, tried_derivatives = _log_light(tried, x, y)
        tried_left = seen - fitted
        gained = float(left @ left - tried_left @ tried_left)
        if gained <= 0:
            damping *= 5
            continue
        is_last = gained < FITTED * float(left @ left)
        penumbra, left, derivatives, damping = tried, tried_left, tried_derivatives, 0.2 * damping
        if is_last:
            break
    return penumbra

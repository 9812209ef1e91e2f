"""The shift that a shadow gives to the ground's colours, found by voting (a Hough transform in colour space).

A shadow shifts every colour of the ground by one vector (in logs of linear light). Each unlit pixel votes for the
shifts that would make it a shadow of each colour of the lit ground; modes of the vote are candidates. Several shifts
are kept, as an object of one colour votes for one too: the geometry decides between them.
"""

from collections.abc import Iterable, Sequence
from functools import cache

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, distinct
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.pixels.log_colour import linear_rgb, log_opponent_of_linear
from ashe_live.light.pixels.mixtures import Mixture

# The vote's bins: log brightness, chroma red to blue, chroma green.
BIN = np.array([0.06, 0.06, 0.05])
LOWEST = np.array([-4.5, -1.6, -0.3])
BINS = np.array([72, 34, 18])
# Standard deviations of a shadow pixel's colour from its ground's shifted colour, in log-opponent units.
SHIFT_NOISE = np.array([0.12, 0.12, 0.1])
# The prior (10): the log brightness at which half of the shifts are dark enough for a shadow, and over how much that
# changes; the standard deviation by which a shadow may be redder than its ground; and of green per red over blue, as
# daylight changes.
DARK, DARK_OVER, REDDER, GREEN_BY_RED = -0.25, 0.06, 0.2, -0.25
LEAST_PEAK = 0.04  # of the votes at the highest peak
COMMON = 0.02  # weight of a palette colour, above which it is voted for
FINE = 0.6  # width of a mode, in units of that noise, narrow enough to separate two lights' shifts
HUE_DEVIATION = 0.18  # standard deviation of `hue_of` of true shifts
# No shadow is farther from daylight's hues: what is would be a part of an object of another colour.
LARGEST_HUE = 0.4
# But a known shadow has any hue that has so many times the votes of the plausible one. (Of 173 looked-at pictures two
# show a shadow of no plausible hue, with 6 and 10 times; one more has 2.5 times, and all others less than twice.)
ANY_HUE = 3.0
MOST_VOTERS, LEAST_VOTERS = 1500, 25  # unlit pixels that vote; where there are fewer, no shift is found


def hue_of(shift: Float) -> float:
    """How far a shift (3,) is from those under daylight, of which green changes in proportion to blue."""
    _, red_blue, green = shift
    return float(abs(green - GREEN_BY_RED * red_blue))


def voted_for(colours: Float32, ground: LitGround, count: int, widths: Sequence[float] = (1.0,)) -> list[list[Float]]:
    """Up to `count` modes (3,) of the vote of unlit colours (n, 3), by falling number of votes: a list for each width.

    widths: of the kernel of the mean shift that finds modes, in units of SHIFT_NOISE.
    """
    if len(colours) < LEAST_VOTERS:
        return [[] for _ in widths]
    offsets, weights = _votes(colours, ground.palette)
    starts = _most_voted(offsets, weights, count)
    modes = (_modes(offsets, weights, starts, width) for width in widths)
    return [_without_alike(shift for shift in each if hue_of(shift) <= LARGEST_HUE) for each in modes]


def shadow_shifts(votes: Sequence[Sequence[Float]]) -> list[Float]:
    """The modes (3,) of several votes, without those that are like one of an earlier vote."""
    return _without_alike(shift for each in votes for shift in each)


def shift_within(colours: Float32, ground: LitGround) -> Float | None:
    """(3,) the strongest mode of the vote of colours (n, 3) from inside a shadow; None if there are too few.

    On a patterned ground, a wrong shift may turn one of its colours into the shadow of another; only on the true one do
    all colours agree.
    """
    (shifts,) = voted_for(colours, ground, 1)
    return shifts[0] if shifts else None


def shift_of_known_shadow(colours: Float32, ground: LitGround, approximate: Float) -> Float:
    """(3,) as `shift_within`, and the approximate shift (3,) where that finds none; or the mode near the difference of
    means from the ground, if that has ANY_HUE times as many votes.

    Cameras render dark colours more saturated than bright ones, so that on a coloured ground a shadow's hue may be one
    that no daylight has.
    """
    voted = shift_within(colours, ground)
    plausible = approximate if voted is None else voted
    offsets, weights = _votes(colours, ground.palette)
    if len(colours) < LEAST_VOTERS or not len(offsets):
        return plausible
    start = np.asarray(np.average(offsets, axis=0, weights=weights), np.float64)
    found = np.asarray(_modes(offsets, weights, start[None], 1.0)[0])
    of_found, of_plausible = (_support(offsets, weights, each) for each in (found, plausible))
    return found if of_found > ANY_HUE * of_plausible else plausible


def shift_near(colours: Float32, ground: LitGround, shift: Float) -> Float | None:
    """(3,) the mode of the vote of colours (n, 3) nearest to an approximate `shift` (3,); None if there are too few."""
    if len(colours) < LEAST_VOTERS:
        return None
    offsets, weights = _votes(colours, ground.palette)
    return np.asarray(_modes(offsets, weights, shift[None], FINE)[0])


def _votes(colours: Float32, palette: Mixture) -> tuple[Float32, Float32]:
    """(n k, 3) shifts of the colours from each of the palette's k common colours, and (n k,) the votes' weights."""
    colours = colours[:: len(colours) // MOST_VOTERS + 1]
    common = palette.weights > COMMON
    centres, weights = palette.centres[common], palette.weights[common]
    return (colours[:, None, :] - centres).reshape(-1, 3), np.tile(weights, len(colours))


def _most_voted(offsets: Float32, weights: Float32, count: int) -> Float:
    """(p, 3) up to `count` shifts about which the likeliest ones have most votes; arguments as for `_votes`."""
    bins = np.floor((offsets - LOWEST.astype(np.float32)) / BIN.astype(np.float32)).astype(np.intp)
    inside = np.logical_and.reduce([(along >= 0) & (along < size) for along, size in zip(bins.T, BINS, strict=True)])
    flat = np.ravel_multi_index(tuple(bins[inside].T), tuple(BINS))
    votes = np.bincount(flat, weights[inside], int(np.prod(BINS))).reshape(tuple(BINS))
    peaks = _peaks(_blurred(np.asarray(votes, dtype=np.float64)) * _plausibility(), count)
    return np.asarray(LOWEST + (peaks + 0.5) * BIN)


def _without_alike(shifts: Iterable[Float]) -> list[Float]:
    """The shifts (3,) in order, without those within the noise of an earlier one."""
    return distinct(shifts, lambda shift, other: bool(np.abs((shift - other) / SHIFT_NOISE).max() < 1))


def shadow_ratio(ground: LitGround, shift: Float) -> Float:
    """(3,) shadow ratio in linear RGB, shadowed over lit ground, as the weighted mean over the palette's colours."""
    lit = linear_rgb(ground.palette.centres)
    shaded = linear_rgb(ground.palette.centres + shift)
    weights = (ground.palette.weights / ground.palette.weights.sum())[:, None]
    return np.asarray(
        np.clip((weights * shaded).sum(axis=0) / np.maximum((weights * lit).sum(axis=0), 1e-6), 1e-3, 1.0)
    )


def shift_of_ratio(ground: LitGround, ratio_rgb: Float) -> Float:
    """(3,) the weighted mean shift of the palette's colours for a shadow ratio (3,) in linear RGB."""
    lit = np.maximum(linear_rgb(ground.palette.centres), 0.0)
    shifts = log_opponent_of_linear(lit * ratio_rgb) - log_opponent_of_linear(lit)
    return np.asarray(np.average(shifts, axis=0, weights=ground.palette.weights))


@cache
def _plausibility() -> Float:
    """Prior on shifts, one number per bin, from (10) of docs/maths.

    Shadows are darker than lit ground, and lit by the sky alone: as blue as it or bluer, with green in proportion.
    """
    brightness, red_blue, green = (
        low + (np.arange(n) + 0.5) * size for low, n, size in zip(LOWEST, BINS, BIN, strict=True)
    )
    darker = 1 / (1 + np.exp((brightness - DARK) / DARK_OVER))
    bluer = np.exp(-0.5 * (np.maximum(red_blue, 0) / REDDER) ** 2)
    daylight = np.exp(-0.5 * ((green[None] - GREEN_BY_RED * red_blue[:, None]) / HUE_DEVIATION) ** 2)
    return np.asarray(darker[:, None, None] * (bluer[:, None] * daylight)[None])


def _blurred(votes: Float) -> Float:
    # To OpenCV, a picture of as many channels as bins along the last axis; then these are its rows' pixels.
    kernel, beyond = np.array([0.25, 0.5, 0.25]), cv2.BORDER_CONSTANT
    blurred = cv2.sepFilter2D(votes, -1, kernel, kernel, borderType=beyond).reshape(-1, votes.shape[2])
    blurred = cv2.sepFilter2D(blurred, -1, kernel, np.ones(1), borderType=beyond)
    return np.asarray(blurred, dtype=np.float64).reshape(votes.shape)


def _peaks(votes: Float, count: int) -> Float:
    """(p, 3) bins of up to `count` local maxima, highest first; those of less than LEAST_PEAK are left out."""
    rest, least = votes.copy(), LEAST_PEAK * votes.max()
    peaks: list[tuple[np.intp, ...]] = []
    while len(peaks) < count:
        peak = i, j, k = np.unravel_index(rest.argmax(), rest.shape)
        if rest[peak] <= least:
            break
        peaks.append(peak)
        rest[max(0, i - 2) : i + 3, max(0, j - 2) : j + 3, max(0, k - 2) : k + 3] = 0
    return np.array(peaks, dtype=np.float64).reshape(-1, 3)


def _support(offsets: Float32, weights: Float32, shift: Float) -> float:
    """The votes for a shift (3,), by the kernel of `_modes` of width 1."""
    away = np.square((offsets - shift) / SHIFT_NOISE).sum(axis=1)
    return float(weights @ np.exp(-0.5 * away))


def _modes(offsets: Float32, weights: Float32, shifts: Float, width: float) -> Float:
    """(p, 3) the modes of the vote near each of `shifts` (p, 3), by mean shift with a Gaussian kernel."""
    noise = (width * SHIFT_NOISE).astype(np.float32)
    votes, modes = offsets / noise, (shifts / noise).astype(np.float32)
    squares = np.add.reduce([along**2 for along in votes.T])  # a tenth of the time of a sum over so short an axis
    for _ in range(3):
        away = squares - 2 * (modes @ votes.T) + (modes**2).sum(axis=1)[:, None]
        closeness = weights * np.exp(-0.5 * away)
        total = closeness.sum(axis=1)[:, None]
        modes += (closeness @ votes - total * modes) / np.maximum(total, 1e-9)
    return np.asarray(modes * noise, dtype=np.float64)

"""A phone or tablet whose screen shows the marker: how far it reaches, with the shadow that it casts beside itself.

Its dark rim stands out from the ground all around the marker, and would join the objects and shadows that touch it.
"""

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.pixels.page_lines import FARTHEST, PageLines
from ashe_live.light.pixels.sheet import ADDED, Sheet

DARK = 2.0  # log brightness by which a rim is darker than the white beside the marker: seven times
# A rim begins at most BORDER samples, in which blur mixes both, beyond the white: what is less than WHITE darker than
# the margin.
WHITE, BORDER = 0.5, 6
LIGHTER = 1.0  # log brightness by which what follows a rim is brighter, be that the device's own shadow
BEYOND = 25  # samples from a rim's end, half a side of the marker, from which on most is ground
IN_SHADOW = 0.5  # log brightness by which a device's own shadow is darker than the ground, at least
TOGETHER, SHARE = 1, 0.4  # samples within which a rim ends, on this share of a side's lines
SIDES, SEEN_SIDES = 3, 2  # that have a rim, and on which its end is seen: on a bright side light may fall on it


def screen_around(lines: PageLines) -> Sheet | None:
    """What a device covers whose screen shows the marker that the lines begin at; None where it is on no screen.

    Outwards from the marker's margin something much darker follows on nearly all sides, and ends on straight lines. The
    device's own shadow beside it is part of what it covers.
    """
    brightness = lines.after[..., 0] - np.median(lines.before[:, :, 0, 0], axis=1)[:, None, None]
    # Something dark farther out is no rim.
    left_white = np.logical_or.accumulate(brightness < -WHITE, axis=2)
    left_before = np.concatenate([np.zeros_like(left_white[..., :BORDER]), left_white[..., :-BORDER]], axis=2)
    is_rim = np.logical_or.accumulate((brightness < -DARK) & ~left_before, axis=2)
    darkest = np.minimum.accumulate(brightness, axis=2)
    is_beyond = is_rim & (brightness > darkest + LIGHTER) & lines.seen
    is_beyond = np.logical_or.accumulate(is_beyond, axis=2)
    ground = brightness[..., BEYOND:][is_beyond[..., :-BEYOND] & lines.seen[..., BEYOND:]]
    if not len(ground):
        return None
    is_ground = is_beyond & (brightness > np.median(ground) - IN_SHADOW) & lines.seen
    ends = is_ground.argmax(axis=2)  # 0 where none is
    leaves = (ends == 0) & ~lines.seen[..., -1] & ~(left_white & ~is_rim & lines.seen).any(axis=2)
    rims = [_common(lines.outwards, ends[side], leaves[side]) for side in range(4)]
    if sum(rim is not None for rim in rims) < SIDES or sum(rim is not None and rim[1] for rim in rims) < SEEN_SIDES:
        return None
    return Sheet(*(ADDED + (_end_of_white(lines, side) if rim is None else rim[0]) for side, rim in enumerate(rims)))


def _common(outwards: Float, ends: NDArray[np.intp], leaves: Mask) -> tuple[float, bool] | None:
    """Where a side's rim ends, in sides of the marker, and whether that is seen; None if its lines' ends (n,) differ.

    leaves: (n,) lines that leave the picture in white or in the rim, which then may end anywhere beyond.
    """
    counts = np.array([np.count_nonzero(np.abs(ends - end) <= TOGETHER) if end else 0 for end in ends])
    if counts.max() >= SHARE * len(ends):
        return float(outwards[ends[int(counts.argmax())]]), True
    return (FARTHEST, False) if np.count_nonzero(leaves) > (1 - SHARE) * len(ends) else None


def _end_of_white(lines: PageLines, side: int) -> float:
    """Where half of a side's lines leave what looks like paper, in sides of the marker."""
    last = np.count_nonzero(lines.is_paper[side], axis=1)
    return float(lines.outwards[min(int(np.median(last)), len(lines.outwards) - 1)])

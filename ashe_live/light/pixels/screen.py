"""A phone or tablet whose screen shows the marker: how far it reaches, with the shadow that it throws beside itself.

Its dark rim stands out from the ground all around the marker, and would join the objects and shadows that touch it.
"""

import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.light.pixels.page_lines import FARTHEST, STEP, WINDOW, PageLines
from ashe_live.light.pixels.sheet import ADDED, Sheet

REACH = 0.45  # of the lines across a side, from its middle: the marker's square alone
DARK = 2.0  # log brightness by which a rim is darker than the white beside the marker: seven times
LIGHTER = 1.0  # and than what follows it
TOGETHER, SHARE = 1, 0.4  # samples within which a rim ends, on this share of a side's lines
SIDES, SEEN_SIDES = 3, 2  # that have a rim, and on which its end is seen: on a bright side light may fall on it


def screen_around(image_bgr: Image, camera: Camera, T_cam_marker: Float, side_m: float, paper: Sheet) -> Sheet | None:
    """What a device covers whose screen shows the marker, in a picture (h, w, 3) without distortion; None without one.

    Outwards from the marker's margin something much darker follows on nearly all sides, and ends on straight lines.
    paper: how far the margin reaches, if it were a printed one.
    """
    lines = PageLines.of(image_bgr, camera, T_cam_marker, side_m, np.full(4, REACH))
    rims = [_end_of_rim(lines, side) for side in range(4)]
    if sum(rim is not None for rim in rims) < SIDES or sum(rim is not None and rim[1] for rim in rims) < SEEN_SIDES:
        return None
    margins = (paper.right, paper.above, paper.left, paper.below)
    return Sheet(*(margin if rim is None else rim[0] + ADDED for rim, margin in zip(rims, margins, strict=True)))


def _end_of_rim(lines: PageLines, side: int) -> tuple[float, bool] | None:
    """Where the dark rim on one side ends, in sides of the marker, and whether that is seen; None without a rim.

    Where the picture ends before that, the rim may be anywhere beyond.
    """
    seen = lines.seen[side]
    is_dark = lines.after[side, ..., 0] < np.median(lines.before[side, :, 0, 0]) - DARK
    ends = np.array([_end_of_first_run(line) for line in is_dark & seen])
    if np.count_nonzero(ends) < SHARE * len(ends):
        left = np.count_nonzero(seen.sum(axis=1) < seen.shape[1]) > SHARE * len(ends) and not ends.any()
        return (FARTHEST, False) if left else None
    counts = np.array([np.count_nonzero(np.abs(ends - end) <= TOGETHER) if end else 0 for end in ends])
    if counts.max() < SHARE * len(ends):
        return None
    end = int(ends[int(counts.argmax())])
    beyond = min(end + WINDOW, seen.shape[1] - 1)
    rise = lines.after[side, :, beyond, 0] - lines.after[side, :, : end + 1, 0].min(axis=1)
    if np.median(rise[counts == counts.max()]) < LIGHTER:
        return None
    return float(lines.outwards[end]) + STEP, bool(seen[counts == counts.max(), beyond].mean() > SHARE)


def _end_of_first_run(is_dark: Mask) -> int:
    """The index (of n) after the first dark samples in a row; 0 if none are, or if they go on to the last."""
    changes = np.flatnonzero(np.diff(np.concatenate([[False], is_dark]).astype(np.int8)))
    return int(changes[1]) if len(changes) > 1 else 0

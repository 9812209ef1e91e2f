"""A whole page laid down as it was printed: where its paper ends, and by what it differs from the ground.

Things stand on such a page and shadows fall onto it, so that it is ground, but of another colour. Both are lit alike:
along its edges, in light as in shadow, one ratio of linear light parts ground from paper, whatever lies there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.square import PAGE_FOOT_MM
from ashe_live.light.pixels.page_ground import PageGround, commonest_change, ground_around
from ashe_live.light.pixels.page_lines import BESIDE, FARTHEST, HALF, LINES, TOGETHER, PageLines, around, largest_beside
from ashe_live.light.pixels.sheet import ADDED, LARGEST_SHEET, MarkerPicture, Sheet

EVEN = 0.1  # largest difference between a page's right and left
# Least share, and number, of the lines beside the marker that end together where a side's paper does, as shadows and
# objects end the others; and of lines all along that side.
SHARE, FEWEST = 0.4, 6
SHARE_ALONG, FEWEST_ALONG = 0.25, 3
MOST = 0.75  # share of the lines both right and left that end together, above which the two ends may differ
SIDES = 2  # of a page whose ends are seen, at least
# Width and height of pages (mm) as they are printed: the marker is in their middle above a foot.
PRINTED_MM = (210, 297), (215.9, 279.4), (297, 420)
PLACED = 0.06  # how far, in sides, an end may be from where it is on such a page
PROPORTIONS = 0.03  # largest relative difference of height over width from such a page's, wherever on it the marker is
LONGEST = 1.7  # of a page, over its width; legal paper has 1.65


@dataclass(frozen=True, slots=True)
class PageAround:
    """Where a page ends right, above, left and below of the marker's centre, in its sides; and what lies around it."""

    ends: tuple[float, ...]
    # Whether that end is; if not, what is paper and what ground beyond LARGEST_SHEET is unknown.
    is_seen: tuple[bool, ...]
    ground: PageGround

    def between(self, side_m: float) -> list[Float]:
        """(4, 3) m each, marker frame: the corners of areas along its border that may be paper or ground."""
        right, above, left, below = (end + ADDED for end in self.ends)
        begins = [(end if seen else LARGEST_SHEET) - ADDED for end, seen in zip(self.ends, self.is_seen, strict=True)]
        return [
            Sheet(right, above, -begins[0], below).corners(side_m),
            Sheet(right, above, left, -begins[1]).corners(side_m),
            Sheet(-begins[2], above, left, below).corners(side_m),
            Sheet(right, -begins[3], left, below).corners(side_m),
        ]


def page_around(lines: PageLines, picture: MarkerPicture) -> PageAround | None:
    """The page that the marker is printed on; None if it is a small sheet.

    A page ends where many lines outwards leave the paper's colour at one distance: shadows and objects on it end each
    line at another. lines: of that picture, beside the marker.
    """
    shares = [_share_ending(*side) for side in zip(lines.is_end, lines.seen, strict=True)]
    ends = [_clearest_end(is_end, share) for is_end, share in zip(lines.is_end, shares, strict=True)]
    is_off_centre = _is_off_centre(*_places_of(ends, lines), np.array([share.max() for share in shares]))
    if not is_off_centre:
        ends = [_nearest_end(is_end, share) for is_end, share in zip(lines.is_end, shares, strict=True)]
    first, seen = _places_of(ends, lines)
    if not (is_off_centre or _is_page(first, seen)):
        return None
    paper, change = commonest_change(lines, ends)
    reaches = np.where(seen, first, BESIDE).tolist()
    ends = [end if end is None or lines.ends_in(side, end, change) else None for side, end in enumerate(ends)]
    lines = PageLines.of(picture, reaches)
    if is_off_centre:
        printed = np.full(4, np.nan)
    else:
        ends[0], ends[2] = _in_the_middle(lines, ends[0], ends[2])
        printed = _as_printed(lines, ends[0], change)
    found = [_end(lines, side, end, change, place) for side, (end, place) in enumerate(zip(ends, printed, strict=True))]
    distances, is_seen = zip(*found, strict=True)
    known = [int(np.abs(lines.outwards - end).argmin()) if seen else None for end, seen in found]
    return PageAround(distances, is_seen, ground_around(lines, known, paper, change))


def _is_page(ends: Float, seen: Mask) -> bool:
    """Whether sides that end there (4,), where that is seen (4,), are a page's, and not a marker's that was cut out.

    A large marker leaves a page hardly any margin on either side, but more below. Where something stands on the page's
    end on one side, the others may be those of a page that is printed.
    """
    right, above, left, below = ends
    upright = bool(seen[[0, 2]].all() and abs(right - left) < EVEN)
    if seen.all() and above + below > LONGEST * (right + left):
        upright = False  # something else than paper goes on there
    large = seen & (ends >= LARGEST_SHEET)
    if np.count_nonzero(seen) < SIDES:
        return False
    return bool(large.any() if upright else (large == seen).all()) or _are_of_a_print(ends, large)


def _are_of_a_print(ends: Float, large: Mask) -> bool:
    """Whether two of the `large` ends (4,), other than right and left, are in the proportions of a printed page."""
    (sides,) = np.nonzero(large)
    for shape in _printed_shapes():
        for side in sides:
            fits = np.abs(ends[sides] - ends[side] * shape[sides] / shape[side]) < PLACED
            if np.ptp(shape[sides[fits]]) > 0:
                return True
    return False


def _is_off_centre(ends: Float, seen: Mask, shares: Float) -> bool:
    """Whether sides that all end there (4,) are those of a page on which another program has put the marker aside.

    shares: (4,) of the lines that end there, all but one of which nothing stands before.
    """
    right, above, left, below = ends
    if not seen.all() or np.sort(shares)[1] < MOST or abs(right - left) < EVEN or ends.max() < LARGEST_SHEET:
        return False
    across, along = sorted((right + left, above + below))
    shapes = np.array(PRINTED_MM)
    return bool(np.abs(along / across / (shapes[:, 1] / shapes[:, 0]) - 1).min() < PROPORTIONS)


def _printed_shapes() -> Float:
    """(p, 4) how far each printed page reaches right, above, left and below of its marker's centre, in half widths."""
    width, height = np.array(PRINTED_MM).T
    return np.asarray(np.column_stack([width, height - PAGE_FOOT_MM, width, height + PAGE_FOOT_MM]) / width[:, None])


def _share_ending(is_end: Mask, seen: Mask) -> Float:
    """(n,) of a side's lines (lines, n) that are seen, the part that end together at each place."""
    return np.asarray(_ending_together(is_end, TOGETHER) / np.maximum(seen.sum(axis=0), FEWEST))


def _nearest_end(is_end: Mask, share: Float) -> int | None:
    """The nearest place at which many of the lines (lines, n) end together; None if there is none."""
    if share.max() < SHARE:
        return None
    first = int((share >= SHARE).argmax())
    return _middle(is_end, first + int(share[first : first + 2 * TOGETHER + 1].argmax()))


def _clearest_end(is_end: Mask, share: Float) -> int | None:
    """Where most of the lines (lines, n) end together: beyond words, which end those that they are before."""
    return None if share.max() < SHARE else _middle(is_end, int(share.argmax()))


def _places_of(ends: Sequence[int | None], lines: PageLines) -> tuple[Float, Mask]:
    """(4,) how far away the ends are, in sides, and (4,) whether they are seen."""
    return lines.outwards[[end or 0 for end in ends]], np.array([end is not None for end in ends])


def _in_the_middle(lines: PageLines, right: int | None, left: int | None) -> tuple[int | None, int | None]:
    """The ends on the right and on the left, where the one that fewer lines show gives way to the other.

    Markers are printed in the middle of a page's width; a white object beside the page, or a shadow, shifts one end.
    """
    if right is None or left is None:
        either = left if right is None else right
        return either, either
    shares = [_ending_together(lines.is_end[side], TOGETHER)[end] / LINES for side, end in ((0, right), (2, left))]
    if abs(lines.outwards[right] - lines.outwards[left]) < EVEN or min(shares) > MOST:
        return right, left
    clearer = right if shares[0] > shares[1] else left
    return clearer, clearer


def _as_printed(lines: PageLines, half: int | None, ground: Float) -> Float:
    """(4,) where the page ends, in sides, if it is one that is printed as wide; NaN where few lines end there.

    half: the end on the right; ground: (3,) log-opponent colour of the ground less the paper's.
    """
    none = np.full(4, np.nan)
    if half is None:
        return none
    places = lines.outwards[half] * _printed_shapes()
    there = np.zeros(places.shape)
    for side in (1, 3):
        is_end = _changes_to(ground, lines, side)
        near = np.abs(lines.outwards - places[:, side, None]) < PLACED
        there[:, side] = [is_end[:, each].any(axis=1).sum() for each in near]
    likeliest = int(there.sum(axis=1).argmax())
    return np.where(there[likeliest] >= FEWEST_ALONG, places[likeliest], none)


def _changes_to(ground: Float, lines: PageLines, side: int) -> Mask:
    """(lines, n) where a side's lines leave the paper by a change of colour in the direction of `ground`, (3,)."""
    part = np.where(lines.is_paper[side], (lines.after[side] - lines.before[side]) @ ground / (ground @ ground), 0.0)
    return np.asarray((part > HALF) & (part >= largest_beside(part)))


def _end(lines: PageLines, side: int, common: int | None, ground: Float, printed: float) -> tuple[float, bool]:
    """Where the paper ends on one side, in sides, and whether that is seen there.

    common: where many lines end together, as something that hides the page's end may end them sooner. printed: where
    the end of a printed page is seen by a few, or NaN. ground: as for `_as_printed`.
    """
    at = None if common is None else float(lines.outwards[common])
    if np.isfinite(printed) and (at is None or at < printed - PLACED):
        return float(printed), True
    return _farthest_paper(lines, side, ground) if at is None else (at, True)


def _farthest_paper(lines: PageLines, side: int, ground: Float) -> tuple[float, bool]:
    """Where the paper ends on a side where things hide its end, in sides, and whether that is seen there.

    If it is not, that is where the second farthest of the lines leaves it, as one may go on along something white.
    ground: (3,) log-opponent colour of the ground less the paper's.
    """
    seen = lines.seen[side]
    from_paper = lines.before[side] - np.median(lines.before[side, :, 0], axis=0)
    is_lit = np.linalg.norm(from_paper, axis=2) < np.linalg.norm(from_paper - ground, axis=2)
    is_end = _changes_to(ground, lines, side)
    farthest = np.where(lines.is_paper[side] & is_lit, np.arange(1, seen.shape[1] + 1), 0).max(axis=1)
    # Of those lines that are seen as far out, as others leave the picture on the paper.
    together = _ending_together(is_end, 1) / np.maximum(SHARE_ALONG * seen.sum(axis=0), FEWEST_ALONG)
    if together.max() >= 1:
        return float(lines.outwards[_middle(is_end, int(together.argmax()))]), True
    if np.count_nonzero((farthest > 0) & (farthest == seen.sum(axis=1))) >= SHARE * len(farthest):
        return FARTHEST, True
    return float(lines.outwards[max(int(np.sort(farthest)[-2]) - 1, 0)]), False


def _middle(is_end: Mask, place: int) -> int:
    """The mean of the ends of lines (lines, n) around a place."""
    near = around(place)
    ends = is_end[:, near].sum(axis=0)
    return int(near.start) + round(float(np.average(np.arange(len(ends)), weights=ends)))


def _ending_together(is_end: Mask, within: int) -> Float:
    """(n,) how many of the lines (lines, n) end at a place, or within so many samples of it."""
    padded = np.pad(is_end, ((0, 0), (within, within)))
    return np.asarray(sliding_window_view(padded, 2 * within + 1, axis=1).any(axis=-1).sum(axis=0), dtype=np.float64)

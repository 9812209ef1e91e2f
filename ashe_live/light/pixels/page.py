"""A whole page laid down as it was printed: where its paper ends, and the picture as if it had the ground's colour.

Things stand on such a page and shadows fall onto it, so that it is ground, but of another colour. Both are lit alike:
along its edges, in light as in shadow, the same ratio of linear light parts ground from paper, whatever lies there.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import image_from_plane, project
from ashe_live.light.pixels.log_colour import DARKEST, linear_rgb, log_opponent
from ashe_live.light.pixels.sheet import ADDED, USUAL_SHEET, Sheet

# Distances from the marker's centre, in its sides: from where on there is paper, and how far its end is looked for. The
# lower end of an A4 page lies 3.4 sides below a marker of 50 mm.
PAPER, FARTHEST = 0.555, 3.6
LEAST = 1.1  # of a page's longest side: a smaller sheet is a marker with its margin, on which nothing stands
EVEN = 0.1  # largest difference between a page's right and left
STEP = 0.02  # between samples
LINES = 24  # of samples across a side
BESIDE = 0.45  # reach of these lines from a side's middle; where a side's end is not seen, all along the page
WINDOW = 4  # samples on either side of an end, whose medians are compared: print is thinner than half of them
CHANGE = 0.2  # log-opponent distance between these medians from which on something ends
# Of paper, from the margin's colour: largest difference of chroma, and of log brightness, lit unevenly or in a shadow.
SAME_CHROMA, BRIGHTER, DARKER = 0.25, 0.5, 1.6
BLUER = 0.6  # and how much bluer, for each unit that it is darker
CLEAR = 3  # samples from an end, beyond which blur mixes no colours
TOGETHER = 2  # samples within which lines end together
# Of a side's lines, those that do so where the paper ends, as shadows and objects end others; of those all along it.
SHARE, FEWEST = 0.4, 6
MOST = 0.75  # of the lines of both sides: each then ends where it does
SHARE_ALONG, FEWEST_ALONG = 0.25, 3
SIDES = 2  # of a page whose ends are seen, at least
HALF = 0.5  # of the change of colour that ends the paper elsewhere
ALIKE = 0.2  # log-opponent distance within which two changes of colour are alike


@dataclass(frozen=True, slots=True)
class Page:
    """Where a page ends right, above, left and below of the marker's centre, in its sides; and what lies around it."""

    ends: tuple[float, ...]
    is_seen: tuple[bool, ...]  # whether that end is; if not, it is not told what is paper and what ground beyond LEAST
    ground_over_paper: tuple[float, ...]  # linear RGB

    def between(self, side_m: float) -> list[Float]:
        """(4, 3) m each, marker frame: the corners of areas along its border that may be paper or ground."""
        right, above, left, below = (end + ADDED for end in self.ends)
        begins = [(end if seen else LEAST) - ADDED for end, seen in zip(self.ends, self.is_seen, strict=True)]
        return [
            Sheet(right, above, -begins[0], below).corners(side_m),
            Sheet(right, above, left, -begins[1]).corners(side_m),
            Sheet(-begins[2], above, left, below).corners(side_m),
            Sheet(right, -begins[3], left, below).corners(side_m),
        ]


@dataclass(frozen=True, slots=True, eq=False)
class _Lines:
    """Colours along lines that run outwards across the four sides."""

    outwards: Float  # (n,) distances from the centre
    before: Float32  # (4, lines, n, 3) log-opponent: medians of what lies just before these places
    after: Float32  # (4, lines, n, 3) and from there on
    seen: Mask  # (4, lines, n) whether all of that lies in the picture
    is_paper: Mask  # (4, lines, n) whether there is paper up to here
    is_end: Mask  # (4, lines, n) whether something ends the paper here, or the light on it

    @staticmethod
    def of(image_bgr: Image, camera: Camera, T_cam_marker: Float, side_m: float, reaches: Float) -> "_Lines":
        """Lines beside each other up to these reaches (4,) right, above, left and below of the centre, in sides."""
        outwards = np.arange(PAPER, FARTHEST, STEP)
        right, above, left, below = reaches
        out, y = np.meshgrid(outwards, np.linspace(-below, above, LINES))
        x = np.meshgrid(outwards, np.linspace(-left, right, LINES))[1]
        places = np.stack([(out, y), (x, out), (-out, y), (x, -out)])  # right, above, left, below
        plane = np.insert(side_m * places.transpose(0, 2, 3, 1), 2, 1.0, axis=3)
        x, y, depth = np.moveaxis(plane @ image_from_plane(camera, T_cam_marker).T, 3, 0)
        ahead = depth > 1e-9 * side_m
        x, y = (np.where(ahead, each / np.where(ahead, depth, 1), -1.0).astype(np.float32) for each in (x, y))
        width, height = camera.size
        seen = ahead & (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
        seen = np.logical_and.accumulate(seen, axis=2)
        samples = cv2.remap(image_bgr, x.reshape(-1, len(outwards)), y.reshape(-1, len(outwards)), cv2.INTER_LINEAR)
        colours = log_opponent(np.asarray(samples, dtype=np.uint8), 0).reshape(*x.shape, 3)
        margin = np.median(colours[:, :, : WINDOW - 1], axis=2, keepdims=True)
        padded = np.concatenate([np.repeat(margin, WINDOW - 1, axis=2), colours], axis=2)
        medians = _medians(padded)
        last = len(outwards) - WINDOW + 1
        before, after, seen = medians[:, :, : last - 1], medians[:, :, WINDOW:], seen[:, :, WINDOW:]
        paper = np.median(before[:, :, 0], axis=1)[:, None, None]
        is_paper = np.logical_and.accumulate(_is_paper(before, paper), axis=2) & seen
        size = np.where(is_paper, np.linalg.norm(after - before, axis=3), 0.0)
        is_end = (size > CHANGE) & (size >= _largest_beside(size))
        return _Lines(outwards[1:last] - STEP / 2, before, after, seen, is_paper, is_end)

    def colours_beside(self, ends: Sequence[int | None]) -> Iterator[tuple[Float32, Float32]]:
        """Of each side whose end is known, on the lines that end there: (n, 3) of the paper and of what follows it."""
        for side, end in enumerate(ends):
            if end is not None:
                these = self.is_end[side][:, _around(end)].any(axis=1)
                beyond = min(end + CLEAR, len(self.outwards) - 1)
                yield self.before[side, these, end - CLEAR], self.after[side, these, beyond]


def page_around(image_bgr: Image, camera: Camera, T_cam_marker: Float, side_m: float) -> Page | None:
    """The page that the marker is printed on, in a picture (h, w, 3) without distortion; None if it is a small sheet.

    A page ends where many lines outwards leave the paper's colour at one distance: shadows and objects on it end each
    line at another.
    """
    reaches = np.full(4, BESIDE)
    lines = _Lines.of(image_bgr, camera, T_cam_marker, side_m, reaches)
    ends = [_common_end(*side) for side in zip(lines.is_end, lines.seen, strict=True)]
    seen = np.array([end is not None for end in ends])
    first = lines.outwards[[end or 0 for end in ends]]
    if not _is_page(first, seen):
        return None
    paper, ground = (np.concatenate(each) for each in zip(*lines.colours_beside(ends), strict=True))
    change = _commonest(ground - paper)
    lit = np.median(paper, axis=0)
    reaches[seen] = first[seen]
    lines = _Lines.of(image_bgr, camera, T_cam_marker, side_m, reaches)
    ends[0], ends[2] = _in_the_middle(lines, ends[0], ends[2])
    found = [
        _farthest_paper(lines, side, change) if end is None else (float(lines.outwards[end]), True)
        for side, end in enumerate(ends)
    ]
    return Page(
        tuple(end for end, _ in found),
        tuple(is_seen for _, is_seen in found),
        tuple((np.maximum(linear_rgb(lit + change), 0) / np.maximum(linear_rgb(lit), DARKEST)).tolist()),
    )


def _is_page(ends: Float, seen: Mask) -> bool:
    """Whether sides that end there (4,), where that is seen (4,), are a page's, and not a marker's that was cut out.

    A large marker leaves a page hardly any margin on either side, but more below.
    """
    right, _, left, _ = ends
    upright = bool(seen[[0, 2]].all() and abs(right - left) < EVEN)
    large = seen & (ends >= LEAST)
    return int(np.count_nonzero(seen)) >= SIDES and bool(large.any() if upright else (large == seen).all())


def _medians(colours: Float32) -> Float32:
    """(4, lines, n, 3) of each WINDOW = 4 colours in a row, which are half of what their largest and smallest leave."""
    count = colours.shape[2] - WINDOW + 1
    several = [colours[:, :, i : i + count] for i in range(WINDOW)]
    return np.asarray((sum(several) - np.maximum.reduce(several) - np.minimum.reduce(several)) / 2, dtype=np.float32)


def _is_paper(colours: Float32, paper: Float32) -> Mask:
    """Whether colours (..., 3) are those of the paper, lit more or less than the margin is, or in a shadow."""
    brighter, redder, purpler = np.moveaxis(colours - paper, -1, 0)
    # A shadow is lit by the sky, which is bluer, and green in proportion.
    bluer = BLUER * np.clip(-brighter, 0, DARKER)
    same = (redder < SAME_CHROMA) & (redder > -SAME_CHROMA - bluer) & (np.abs(purpler + redder / 4) < SAME_CHROMA)
    return np.asarray(same & (brighter < BRIGHTER) & (brighter > -DARKER))


def _largest_beside(size: Float) -> Float:
    """(..., n) the largest of the sizes within a window on either side."""
    padded = np.pad(size, [*[(0, 0)] * (size.ndim - 1), (WINDOW, WINDOW)])
    return np.asarray(sliding_window_view(padded, 2 * WINDOW + 1, axis=-1).max(axis=-1))


def _common_end(is_end: Mask, seen: Mask) -> int | None:
    """The nearest place at which many of the lines (lines, n) end together; None if there is none."""
    share = _ending_together(is_end, TOGETHER) / np.maximum(seen.sum(axis=0), FEWEST)
    if share.max() < SHARE:
        return None
    first = int((share >= SHARE).argmax())
    return _middle(is_end, first + int(share[first : first + 2 * TOGETHER + 1].argmax()))


def _in_the_middle(lines: _Lines, right: int | None, left: int | None) -> tuple[int | None, int | None]:
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


def _farthest_paper(lines: _Lines, side: int, ground: Float) -> tuple[float, bool]:
    """Where the paper ends on a side where things hide its end, in sides, and whether that is seen there.

    If it is not, that is where the second farthest of the lines leaves it, as one may go on along something white.
    ground: (3,) log-opponent colour of the ground less the paper's.
    """
    seen = lines.seen[side]
    from_paper = lines.before[side] - np.median(lines.before[side, :, 0], axis=0)
    is_lit = np.linalg.norm(from_paper, axis=2) < np.linalg.norm(from_paper - ground, axis=2)
    part = np.where(lines.is_paper[side], (lines.after[side] - lines.before[side]) @ ground / (ground @ ground), 0.0)
    is_end = (part > HALF) & (part >= _largest_beside(part))
    farthest = np.where(lines.is_paper[side] & is_lit, np.arange(1, seen.shape[1] + 1), 0).max(axis=1)
    # Of those lines that are seen as far out, as others leave the picture on the paper.
    together = _ending_together(is_end, 1) / np.maximum(SHARE_ALONG * seen.sum(axis=0), FEWEST_ALONG)
    if together.max() >= 1:
        return float(lines.outwards[_middle(is_end, int(together.argmax()))]), True
    if np.count_nonzero((farthest > 0) & (farthest == seen.sum(axis=1))) >= SHARE * len(farthest):
        return FARTHEST, True
    return float(lines.outwards[max(int(np.sort(farthest)[-2]) - 1, 0)]), False


def _around(place: int) -> slice:
    return slice(max(place - TOGETHER, 0), place + TOGETHER + 1)


def _middle(is_end: Mask, place: int) -> int:
    """The mean of the ends of lines (lines, n) around a place."""
    near = _around(place)
    ends = is_end[:, near].sum(axis=0)
    return int(near.start) + round(float(np.average(np.arange(len(ends)), weights=ends)))


def _ending_together(is_end: Mask, within: int) -> Float:
    """(n,) how many of the lines (lines, n) end at a place, or within so many samples of it."""
    padded = np.pad(is_end, ((0, 0), (within, within)))
    return np.asarray(sliding_window_view(padded, 2 * within + 1, axis=1).any(axis=-1).sum(axis=0), dtype=np.float64)


def _commonest(changes: Float) -> Float:
    """(3,) the mean of the changes (n, 3) that are like the one that most are like: a pattern's have several."""
    alike = np.linalg.norm(changes[:, None] - changes, axis=2) < ALIKE
    return np.asarray(changes[alike[int(alike.sum(axis=1).argmax())]].mean(axis=0), dtype=np.float64)


def shown_as_ground(page: Page, image_bgr: Image, camera: Camera, T_cam_marker: Float, side_m: float) -> Image:
    """The picture (h, w, 3) without distortion as if the page had the colour of the ground that it lies on.

    Beside the marker it stays paper, by which the exposure is judged.
    """
    inside = np.zeros(image_bgr.shape[:2], np.uint8)
    for sheet, value in ((Sheet(*page.ends), 1), (USUAL_SHEET, 0)):
        outline = project(camera, T_cam_marker, sheet.corners(side_m))
        if not np.isfinite(outline).all():
            return image_bgr
        cv2.fillConvexPoly(inside, np.round(outline.clip(-1e4, 1e4) * 16).astype(np.int32), value, shift=4)
    linear = LINEAR_FROM_SRGB_8BIT[:, None] * np.array(page.ground_over_paper[::-1])
    table = np.round(255 * srgb_from_linear(np.minimum(linear, 1))).astype(np.uint8)
    return np.where(inside[..., None] > 0, cv2.LUT(image_bgr, table[:, None]), image_bgr)

"""Lines across a page's paper and beyond: the colours along them, and where they may leave the paper."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.pixels.sheet import PAPER_FROM, MarkerPicture, lines_outwards

# Distance from the marker's centre, in its sides, up to which paper's end is looked for: an A4 page ends at
# most 5.4 sides from the middle of a marker of 50 mm, which other programs put into a corner.
FARTHEST = 5.6
STEP = 0.02  # between samples
LINES = 24  # of samples across a side
BESIDE = 0.45  # their reach from a side's middle: across the marker's square alone
WINDOW = 4  # samples on either side of an end, whose medians are compared: print is thinner than half of them
CHANGE = 0.2  # log-opponent distance between these medians from which on something ends
# Of paper, from the margin's colour: largest difference of chroma, and of log brightness, lit unevenly or in a shadow.
SAME_CHROMA, BRIGHTER, DARKER = 0.25, 0.5, 1.6
BLUER = 0.6  # and how much bluer, for each unit that it is darker
BLUEST = 1.5  # the same under a clear sky alone: what is bluer is no paper
CLEAR = 3  # samples from an end, beyond which blur mixes no colours
TOGETHER = 2  # samples within which lines end together
# Of the change of colour where paper ends: the largest difference from it, and the share of lines that are within.
HALF, SHARE_ALIKE = 0.5, 0.25


@dataclass(frozen=True, slots=True, eq=False)
class PageLines:
    """Colours along lines that run outwards across the four sides."""

    outwards: Float  # (n,) distances from the centre
    reaches: tuple[float, ...]  # (4,) of the lines right, above, left and below of the centre
    before: Float32  # (4, lines, n, 3) log-opponent: medians of what lies just before these places
    after: Float32  # (4, lines, n, 3) and from there on
    seen: Mask  # (4, lines, n) whether all of that lies in the picture
    is_paper: Mask  # (4, lines, n) whether there is paper up to here
    is_end: Mask  # (4, lines, n) whether something ends the paper here, or the light on it

    @staticmethod
    def of(picture: MarkerPicture, reaches: Sequence[float] = 4 * (BESIDE,)) -> "PageLines":
        """Lines beside each other up to these reaches (4,) right, above, left and below of the centre, in sides."""
        outwards = np.arange(PAPER_FROM, FARTHEST, STEP)
        colours, _, is_seen = picture.colours_at(_places(outwards, reaches))
        seen = np.logical_and.accumulate(is_seen, axis=2)
        margin = np.median(colours[:, :, : WINDOW - 1], axis=2, keepdims=True)
        padded = np.concatenate([np.repeat(margin, WINDOW - 1, axis=2), colours], axis=2)
        medians = _medians(padded)
        last = len(outwards) - WINDOW + 1
        before, after, seen = medians[:, :, : last - 1], medians[:, :, WINDOW:], seen[:, :, WINDOW:]
        paper = np.median(before[:, :, 0], axis=1)[:, None, None]
        is_paper = np.logical_and.accumulate(_is_paper(before, paper), axis=2) & seen
        size = np.where(is_paper, np.linalg.norm(after - before, axis=3), 0.0)
        is_end = (size > CHANGE) & (size >= largest_beside(size))
        return PageLines(outwards[1:last] - STEP / 2, tuple(reaches), before, after, seen, is_paper, is_end)

    def colours_beside(self, ends: Sequence[int | None]) -> Iterator[tuple[Float32, Float32]]:
        """Of each side whose end is known, on the lines that end there: (n, 3) of the paper and of what follows it."""
        for side, end in enumerate(ends):
            if end is not None:
                yield self._beside(side, end)

    def places_beside(self, side: int, end: int) -> Float:
        """(n, 2) where the lines that end there on a side do, in sides from the centre."""
        places = _places(self.outwards[[end]], self.reaches)[side, :, 0]
        return np.asarray(places[self._ending(side, end)])

    def ends_in(self, side: int, end: int, change: Float) -> bool:
        """Whether enough of the lines that end there change their colour as paper and ground do, and not an object.

        change: (3,) log-opponent.
        """
        paper, beyond = self._beside(side, end)
        alike = np.linalg.norm(beyond - paper - change, axis=1) < HALF * np.linalg.norm(change)
        return bool(np.count_nonzero(alike) >= SHARE_ALIKE * max(1, len(alike)))

    def _beside(self, side: int, end: int) -> tuple[Float32, Float32]:
        """(n, 3) colours of the paper and of what follows it, on the lines of one side that end there."""
        these = self._ending(side, end)
        # A narrow margin ends before there are so many samples of it.
        within, beyond = max(end - CLEAR, 0), min(end + CLEAR, len(self.outwards) - 1)
        return self.before[side, these, within], self.after[side, these, beyond]

    def _ending(self, side: int, end: int) -> Mask:
        """(lines,) which of a side's lines end there."""
        return np.asarray(self.is_end[side][:, around(end)].any(axis=1))


def _places(outwards: Float, reaches: Sequence[float]) -> Float:
    """(4, lines, n, 2) places in the marker's sides, on lines beside each other up to reaches (4,), as in `of`."""
    right, above, left, below = reaches
    return lines_outwards(outwards, np.linspace(-left, right, LINES), np.linspace(-below, above, LINES))


def _medians(colours: Float32) -> Float32:
    """(4, lines, n, 3) of each WINDOW = 4 colours in a row, which are half of what their largest and smallest leave."""
    count = colours.shape[2] - WINDOW + 1
    several = [colours[:, :, i : i + count] for i in range(WINDOW)]
    return np.asarray((sum(several) - np.maximum.reduce(several) - np.minimum.reduce(several)) / 2, dtype=np.float32)


def _is_paper(colours: Float32, paper: Float32) -> Mask:
    """Whether colours (..., 3) are those of the paper, lit more or less than the margin is, or in a shadow."""
    brighter = (colours - paper)[..., 0]
    return np.asarray(_has_chroma_of(paper, colours, BLUER) & (brighter < BRIGHTER) & (brighter > -DARKER))


def is_coloured(colours: Float32, paper: Float) -> Mask:
    """Whether colours (..., 3) have a chroma that the paper has in no light, and are light enough to have one."""
    return np.asarray(~_has_chroma_of(paper, colours, BLUEST) & ((colours - paper)[..., 0] > -DARKER))


def _has_chroma_of(paper: Float | Float32, colours: Float32, bluer: float) -> Mask:
    """Whether colours (..., 3) have the chroma that the paper has in light or in a shadow, which is bluer."""
    brighter, redder, purpler = np.moveaxis(colours - paper, -1, 0)
    # A shadow is lit by the sky, which is bluer, and green in proportion.
    least = -SAME_CHROMA - bluer * np.clip(-brighter, 0, DARKER)
    return np.asarray((redder < SAME_CHROMA) & (redder > least) & (np.abs(purpler + redder / 4) < SAME_CHROMA))


def largest_beside(size: Float) -> Float:
    """(..., n) the largest of the sizes within a window on either side."""
    padded = np.pad(size, [*[(0, 0)] * (size.ndim - 1), (WINDOW, WINDOW)])
    return np.asarray(sliding_window_view(padded, 2 * WINDOW + 1, axis=-1).max(axis=-1))


def around(place: int) -> slice:
    """The samples at which lines end together with one that ends there."""
    return slice(max(place - TOGETHER, 0), place + TOGETHER + 1)

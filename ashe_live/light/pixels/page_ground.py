"""The ground that a page lies on: by how much its colour differs from that of the paper, at each place.

Along a page's edges both are lit alike, and one ratio of linear light parts them. But a table that shines mirrors the
sky towards one side of the page more than towards the other, where paper, which is matt, does not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.pixels.log_colour import DARKEST, linear_rgb
from ashe_live.light.pixels.page_lines import PageLines

ALIKE = 0.2  # log-opponent distance within which two changes of colour are alike
# Of the change from place to place, for each side of the marker: standard deviation before it is seen. Of 18 looked-at
# pages two lay on glossy wood, where brightness changed by 0.1 and 0.2 a side; on other ground by 0.01 to 0.04.
BY_PLACE_SIGMA = 0.1
RIDGE = 1e-6  # by which the commonest change stands where no line is left
CORRELATED = 4.0  # lines that cross one patch of a pattern, and count as one
ROUNDS, WIDEST, NARROWER = 12, 0.6, 0.8  # of reweighting: the loss's scale in the first one, and from each to the next


@dataclass(frozen=True, slots=True)
class PageGround:
    """The paper's colour, and that of the ground around it where both are lit as the paper beside the marker is."""

    paper: tuple[float, ...]  # log-opponent
    # Log-opponent: what the ground differs by at the marker's centre, and what each side to the right and up adds.
    change: tuple[tuple[float, ...], ...]

    def lit_at(self, places: Float) -> Float:
        """(n, 3) log-opponent colours of the lit ground at places (n, 2) in the marker's sides from its centre."""
        at_centre, by_place = np.array(self.change[0]), np.array(self.change[1:])
        return np.asarray(np.array(self.paper) + at_centre + places @ by_place)

    def over_paper_at(self, places: Float) -> Float:
        """(n, 3) linear RGB of the ground over that of the paper, at places as in `lit_at`."""
        paper = np.maximum(linear_rgb(np.array(self.paper)), DARKEST)
        return np.asarray(np.maximum(linear_rgb(self.lit_at(places)), 0) / paper)


def commonest_change(lines: PageLines, ends: Sequence[int | None]) -> tuple[Float, Float]:
    """(3,) the paper's colour and (3,) how most of the ground differs from it, log-opponent, by lines that end there.

    That is the mean of those changes of colour that are like the one that most are like, as a pattern has several.
    """
    paper, ground = (np.concatenate(each) for each in zip(*lines.colours_beside(ends), strict=True))
    changes = ground - paper
    alike = np.linalg.norm(changes[:, None] - changes, axis=2) < ALIKE
    common = changes[alike[int(alike.sum(axis=1).argmax())]].mean(axis=0)
    return np.median(paper, axis=0), np.asarray(common, dtype=np.float64)


def ground_around(lines: PageLines, ends: Sequence[int | None], paper: Float, common: Float) -> PageGround:
    """The ground by all lines that end there; paper, common: as of `commonest_change`, from which the fit starts.

    Iteratively reweighted least squares, with Cauchy's weights against patterns and what hides the page's ends.
    """
    change = np.zeros((3, 3))
    change[0] = common
    beside = list(lines.colours_beside(ends))
    if beside:
        papers, grounds = (np.concatenate(each) for each in zip(*beside, strict=True))
        places = np.concatenate([lines.places_beside(side, end) for side, end in enumerate(ends) if end is not None])
        changes, at = grounds - papers, np.insert(places, 0, 1.0, axis=1)
        start, by_place = change, CORRELATED * (ALIKE / BY_PLACE_SIGMA) ** 2
        prior = np.diag([RIDGE, by_place, by_place])
        for number in range(ROUNDS):
            scale = max(ALIKE, WIDEST * NARROWER**number)
            weight = 1 / (1 + (np.linalg.norm(changes - at @ change, axis=1) / scale) ** 2)
            away = np.linalg.solve((at.T * weight) @ at + prior, (at.T * weight) @ (changes - at @ start))
            change = start + away
    return PageGround(tuple(paper.tolist()), tuple(tuple(row) for row in change.tolist()))

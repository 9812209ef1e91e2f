"""Where the sheet lies: all of its paper, and what it throws onto the ground."""

import numpy as np
import pytest

from ashe_live.render.cover.sheet import sheet_of

SIZE, SIDE_PX = 600, 120.0
AXIS = (np.arange(SIZE) + 0.5 - SIZE / 2) / SIDE_PX
X, Y = np.meshgrid(AXIS, AXIS)
PAPER = np.maximum(np.abs(X), np.abs(Y)) < 0.68
GROUND = np.ones((SIZE, SIZE), bool)


def _plane(ground: float) -> np.ndarray:
    """(n, n, 3) linear RGB: a black square on white paper, on even ground with grain."""
    grain = np.random.default_rng(3).normal(0, 0.02, (SIZE, SIZE))
    grey = np.where(PAPER, 0.8, ground + grain)
    grey[np.maximum(np.abs(X), np.abs(Y)) < 0.5] = 0.04
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


def test_paper_on_darker_ground_is_covered_and_hardly_more() -> None:
    mask = sheet_of(_plane(0.3), GROUND, SIDE_PX).mask
    assert mask[PAPER].all()
    assert not mask[np.maximum(np.abs(X), np.abs(Y)) > 0.68 + 0.12].any()


@pytest.mark.parametrize(("ground", "middle", "width"), [(0.3, 0.0, 1.2), (0.72, 0.0, 1.2), (0.8, 0.5, 0.3)])
def test_the_shadow_of_a_lifted_edge_is_covered_also_where_paper_looks_like_ground(
    ground: float, middle: float, width: float
) -> None:
    """On white ground no side is seen by a lifted corner: the square and a margin, then paper, then the shadow."""
    plane = _plane(ground)
    shadow = (np.abs(X - middle) < width / 2) & (Y > 0.68) & (Y < 0.75)
    plane[shadow] *= 0.1
    assert sheet_of(plane, GROUND, SIDE_PX).mask[shadow].all()


def test_paper_on_light_ground_whose_bright_joints_reach_it_is_covered_to_its_edges() -> None:
    """What is as bright as paper and touches it is no reason to leave the sheet's rim in view."""
    plane = _plane(0.5)
    joints = ~PAPER & ((np.abs(X - 0.2) < 0.03) | (np.abs(Y + 0.3) < 0.03))
    plane[joints] = 0.8
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[PAPER].all()
    assert not mask[np.maximum(np.abs(X), np.abs(Y)) > 0.68 + 0.12].any()


def test_a_side_of_the_sheet_that_is_not_seen_is_as_far_as_the_others() -> None:
    plane = _plane(0.5)
    beside = (X > 0.5) & ~PAPER
    plane[beside] = 0.78
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[PAPER].all()
    assert not mask[beside & (X > 0.68 + 0.12)].any()


@pytest.mark.parametrize("slope", [(0.0, 0.3), (-0.25, 0.2)])
def test_where_the_light_falls_off_over_it_a_sheet_on_ground_like_paper_ends_at_its_edges(
    slope: tuple[float, float],
) -> None:
    """By a lamp, paper far from it is darker than ground near it: that is no reason to take it all for a page."""
    light = np.exp(slope[0] * X + slope[1] * Y).astype(np.float32)[..., None]
    found = sheet_of(_plane(0.7) * light, GROUND, SIDE_PX)
    assert found.mask[PAPER].all()
    assert not found.mask[np.maximum(np.abs(X), np.abs(Y)) > 0.68 + 0.15].any()
    assert found.surroundings.all()


def test_a_shadow_along_one_side_is_no_slope_of_the_light() -> None:
    plane = _plane(0.3)
    plane[Y > 0.4] *= 0.4
    assert sheet_of(plane, GROUND, SIDE_PX).mask[PAPER & (Y < 0.4)].all()


@pytest.mark.parametrize("others", [1.05, 1.2, 2.1])
def test_of_a_page_that_goes_on_beyond_reach_the_marker_alone_is_covered(others: float) -> None:
    """Else its other end would stay, and end in the middle of nothing."""
    plane = _plane(0.3)
    page = np.maximum(X, np.abs(Y)) < others
    plane[page & ~PAPER] = 0.8
    away = np.maximum(np.abs(X), np.abs(Y))
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[away < 0.5].all()
    assert not mask[away > 0.6 + 0.12].any()


def test_white_paper_on_a_white_table_is_covered_to_the_fine_lines_that_its_edges_throw() -> None:
    plane = _plane(0.8)
    lines = (np.abs(np.maximum(np.abs(X), -Y) - 0.69) < 0.015) & (Y < 0.69)  # left, right and below
    plane[lines] *= 0.9
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[PAPER | lines].all()
    assert not mask[np.maximum(np.abs(X), np.abs(Y)) > 0.69 + 0.12].any()


def test_print_on_white_paper_is_not_the_edge_that_a_slightly_darker_table_shows() -> None:
    plane = _plane(0.74)
    page = (np.abs(X) < 1.2) & (np.abs(Y) < 1.7)
    plane[page & ~PAPER] = 0.8
    plane[(np.abs(X) < 0.6) & (np.abs(Y + 1.4) < 0.015)] = 0.5
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[page].all()
    assert not mask[(np.abs(X) > 1.2 + 0.12) | (np.abs(Y) > 1.7 + 0.12)].any()


def test_what_ends_far_from_white_paper_on_a_white_table_is_not_its_sheet() -> None:
    """Neither the picture's border nor a round thing that stands there is the edge of a sheet."""
    plane = _plane(0.8)
    seen = X < 1.4
    plane[~seen] = 0.0
    thing = np.hypot(X + 1.5, Y) < 0.6
    plane[thing] = (0.1, 0.4, 0.05)
    mask = sheet_of(plane, seen, SIDE_PX).mask
    assert mask[np.maximum(np.abs(X), np.abs(Y)) < 0.6].all()
    assert not mask[thing].any()
    assert not mask[np.maximum(np.abs(X), np.abs(Y)) > 1.0].any()


def test_a_dark_thing_beside_the_sheet_is_not_covered_as_the_shadow_of_a_lifted_edge_is() -> None:
    plane = _plane(0.4)
    thing = (np.abs(X) < 0.5) & (Y > 0.76) & (Y < 1.5)
    shadow = (np.abs(X) < 0.6) & (Y < -0.68) & (Y > -0.8)
    plane[thing | shadow] = 0.05
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[PAPER | shadow].all()
    assert not mask[thing & (Y > 0.68 + 0.12)].any()


def test_speckles_as_bright_as_paper_are_no_edge() -> None:
    """At every distance most lines outwards show another colour, but none does for long."""
    plane = _plane(0.8)
    phases = np.random.default_rng(1).integers(0, 3, (SIZE, 1))
    speckles = (np.arange(SIZE) + phases) % 3 < 2
    plane[speckles & ~PAPER] = 0.5
    plane[~PAPER & (np.abs(Y) < 0.03)] = 0.8
    mask = sheet_of(plane, GROUND, SIDE_PX).mask
    assert mask[np.maximum(np.abs(X), np.abs(Y)) < 0.6].all()
    assert not mask[np.abs(X) > 1.0].any()

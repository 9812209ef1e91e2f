"""Contours below a pixel, and what may lie beyond them."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.shape.outlines.contours import contour_of
from ashe_live.light.shape.outlines.silhouettes import Outlines, observe_outlines


def disc(x: float, y: float, radius: float, shape: tuple[int, int] = (120, 160)) -> Mask:
    rows, columns = np.indices(shape)
    return np.asarray(np.hypot(columns - x, rows - y) <= radius)


def outlines_of(body: Mask, shadow: Mask, unreliable: Mask | None = None, undecided: Mask | None = None) -> Outlines:
    outlines = observe_outlines(body, [shadow], unreliable, 32, undecided=undecided)
    assert outlines is not None
    return outlines


@pytest.mark.parametrize("radius", [3.0, 10.3, 40.7])
def test_a_disc_is_measured_below_a_pixel(radius: float) -> None:
    contour = contour_of(disc(80.2, 60.4, radius))
    assert contour is not None
    distance = np.hypot(*(contour.hull_px - (80.2, 60.4)).T)
    assert abs(distance.mean() - radius) < 0.25
    assert np.abs(distance - radius).max() < 0.6


def test_specks_are_no_part_of_it() -> None:
    speckled = disc(60, 60, 20)
    speckled[5:7, 150:153] = True
    clean, dirty = contour_of(disc(60, 60, 20)), contour_of(speckled)
    assert clean is not None
    assert dirty is not None
    assert np.allclose(clean.hull_px, dirty.hull_px)


def test_nothing_has_no_contour() -> None:
    assert contour_of(np.zeros((20, 30), bool)) is None


def test_beyond_the_frame_anything_may_be() -> None:
    outlines = outlines_of(disc(60, 60, 20), disc(150, 60, 25))
    assert outlines.most_px[1, 0] == math.inf
    assert outlines.most_px[1, 16] == outlines.least_px[1, 16]
    assert outlines.seen[0].all()


def test_behind_the_object_the_shadow_ends_within_its_outline() -> None:
    body = disc(60, 60, 25)
    outlines = outlines_of(body, disc(85, 60, 20) & ~body)
    assert outlines.seen[1, 0]  # to the right, away from the object
    assert not outlines.seen[1, 16]
    assert outlines.most_px[1, 16] == pytest.approx(outlines.most_px[0, 16])


def test_what_is_unreliable_bounds_nothing() -> None:
    body = disc(60, 60, 20)
    unreliable = np.zeros_like(body)
    unreliable[:, 70:] = True
    outlines = outlines_of(body & ~unreliable, disc(30, 90, 20) & ~unreliable, unreliable)
    assert outlines.most_px[0, 0] == math.inf
    assert outlines.seen[0, 16]


def test_a_straight_edge_is_known_although_its_ends_are_not() -> None:
    """A strip that comes from behind the object and leaves the frame."""
    body = disc(40, 60, 20)
    strip = np.zeros(body.shape, dtype=np.uint8)
    cv2.fillConvexPoly(strip, np.array([(40, 50), (200, 75), (200, 95), (40, 70)], dtype=np.int32), 1)
    outlines = outlines_of(body, (strip > 0) & ~body)
    extra = outlines.directions[32:]
    assert len(extra) == 2
    assert outlines.seen[1, 32:].all()
    across = np.array([-25.0, 160.0]) / math.hypot(25, 160)
    assert sorted(extra @ across) == pytest.approx([-1.0, 1.0], abs=1e-3)


# The whole, where it cannot be told what is whose

BODY, SHADOW = disc(60, 60, 25), disc(90, 60, 25)


def test_without_doubt_the_whole_bounds_nothing() -> None:
    for undecided in (None, np.zeros_like(BODY)):
        outlines = outlines_of(BODY, SHADOW & ~BODY, undecided=undecided)
        assert outlines.least_px.shape == outlines.most_px.shape == (3, len(outlines.directions))
        assert (outlines.least_px[-1] == -math.inf).all()
        assert (outlines.most_px[-1] == math.inf).all()


def test_where_either_may_reach_the_whole_is_measured() -> None:
    """Between an object's left part and its shadow's right one, all may be of one or the other."""
    whole = BODY | SHADOW
    undecided = whole.copy()
    undecided[:, :51] = undecided[:, 100:] = False
    outlines = outlines_of(BODY & ~undecided, SHADOW & ~BODY & ~undecided, undecided=undecided)
    reaches = np.array([(np.argwhere(whole)[:, ::-1] - outlines.centre_px) @ u for u in outlines.directions]).max(
        axis=1
    )
    seen = outlines.seen
    # Up and down only undecided pixels end; left the object's own and right the shadow's.
    for straight in (8, 24):
        assert list(seen[:, straight]) == [False, False, True]
        assert outlines.least_px[-1, straight] == pytest.approx(reaches[straight], abs=0.6)
    for side, own in ((16, 0), (0, 1)):
        assert seen[own, side]
        assert outlines.least_px[own, side] == pytest.approx(reaches[side], abs=0.6)
    # What is bounded holds the true outlines.
    for own, mask in enumerate((BODY, SHADOW)):
        points = np.argwhere(mask)[:, ::-1] - outlines.centre_px
        true = (points @ outlines.directions.T).max(axis=0)
        assert (true >= outlines.least_px[own] - 0.6).all()
        assert (true <= outlines.most_px[own] + 0.6).all()


def test_beyond_the_frame_the_whole_is_not_measured() -> None:
    body, shadow = disc(130, 60, 20), disc(155, 60, 20)
    undecided = (body | shadow) & (np.indices(body.shape)[1] > 140)
    outlines = outlines_of(body & ~undecided, disc(110, 70, 15) & ~body, undecided=undecided)
    assert not outlines.seen[-1, 0]

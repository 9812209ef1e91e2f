"""Which other views are used, and their span."""

import dataclasses
import math

import pytest

from ashe_live.core.transforms import view_direction
from ashe_live.light.views.selection import span_rad, usable
from tests.light.painted_scenes import paint
from tests.light.synthetic_masks import camera_towards

SMALL = (64, 48)


def seen_from(heading_deg: float, distance_m: float = 0.5):
    pose = camera_towards((0.0, 0.0), distance_m, 45.0, heading_deg)
    return paint(size=SMALL, T_cam_marker=pose).tracked


def test_the_views_that_differ_most_come_first_and_fewer_are_a_subset_of_more() -> None:
    first, others = seen_from(90), [seen_from(heading) for heading in (91, 120, 100, 95)]
    assert usable(first, others, 1) == [others[1]]
    assert usable(first, others, 2) == [others[1], others[2]]
    assert len(usable(first, others, 9)) == 4


def test_frames_that_are_added_do_not_displace_those_that_answers_began_with() -> None:
    first, few = seen_from(90), [seen_from(heading) for heading in (120, 104, 112)]
    between = [seen_from(heading) for heading in (106, 114, 97, 121, 109)]
    began_with = usable(first, few, 7)
    assert len(began_with) == 3
    assert usable(first, few + between, 7)[:3] == began_with


def test_views_without_a_marker_or_from_one_place_are_left_out() -> None:
    first = seen_from(90)
    without = dataclasses.replace(seen_from(120), marker=None)
    assert usable(first, [without, first, seen_from(90, 0.4)], 5) == []


def test_the_span_is_the_angle_at_the_marker() -> None:
    # Two views 45 degrees above the ground, a quarter turn apart: the cosine is sin(45)^2.
    directions = [view_direction(seen_from(heading).marker.T_cam_marker) for heading in (0, 90, 45)]
    assert span_rad(directions) == pytest.approx(math.acos(0.5), abs=1e-6)
    assert span_rad(directions[:1]) == 0

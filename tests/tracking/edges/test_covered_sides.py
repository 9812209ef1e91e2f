"""A square's sides are the print's, or what lies over them: what is covered is left out, never believed."""

import dataclasses
from functools import cache

import cv2
import numpy as np
import pytest

from ashe_live.bench.track.frames import Cover, Flaws, PrintedMarker, ground
from ashe_live.bench.track.measures import turn_deg
from ashe_live.bench.track.takes import CELLS, SIDE_M, SMALL, SPEC, pose_at
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.square import mean_side_px, square_corners
from ashe_live.core.transforms import project
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.edge_profiles import LightPatch, linear_light
from ashe_live.tracking.edges.print_alignment import in_units
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import frame

MARKER = parse_marker(SPEC)
POSE = pose_at(0.55, 25, 20)
# Of the chi-squared distribution with six degrees of freedom.
BEYOND_1_IN_1000 = 22.46
CORNERS = project(SMALL, POSE, square_corners(SIDE_M))


@cache
def picture(flaws: Flaws) -> Image:
    return PrintedMarker(MARKER.bitmap(CELLS), SIDE_M, SMALL, flaws, 4).painted(
        [POSE], np.random.default_rng(0), ground(SMALL)
    )


def view_of(image: Image, camera: Camera = SMALL) -> LightPatch:
    return LightPatch(linear_light(image[:, :, 0]), camera, np.zeros(2))


@pytest.mark.parametrize("light", [0.03, 0.3, 0.75])
@pytest.mark.parametrize("side", range(4))
@pytest.mark.parametrize("reach", [(0.1, 0.05), (0.04, 0.08)])
def test_a_strip_along_a_side_makes_no_confident_lie(light: float, side: int, reach: tuple[float, float]) -> None:
    clean, covered = (picture(Flaws(cover=cover)) for cover in (None, Cover(side, *reach, (-0.2, 1.2), 0.01, light)))
    for clean_frames in (0, 10):
        tracker = MarkerTracker(MARKER, SMALL, SIDE_M, BALANCED.tracking)
        for index in range(clean_frames):
            tracker.track(frame(clean, index))
        found = tracker.track(frame(covered, clean_frames)).marker
        assert found is None or turn_deg(found.measured_T_cam_marker, POSE) < 2
        if clean_frames:
            assert found is not None


def test_the_inside_of_the_print_leads_back_from_a_displaced_side() -> None:
    view = view_of(picture(Flaws()))
    for side in range(4):
        displaced = CORNERS.copy()
        ends, others = [side, (side + 1) % 4], [(side - 1) % 4, (side + 2) % 4]
        displaced[ends] += 0.1 * (CORNERS[others] - CORNERS[ends])
        alignment = MARKER.alignment
        blurred = alignment.blurred(view, displaced)
        seen = alignment.look(alignment.sampled(blurred, displaced), mean_side_px(displaced))
        found = alignment.aligned(blurred, displaced, seen)
        assert found is not None
        assert np.abs(in_units(CORNERS, found.corners_px)).max() < 0.01


def test_a_print_is_one_in_its_own_order_alone() -> None:
    alignment = MARKER.alignment
    view = view_of(picture(Flaws()))
    assert alignment.is_print(alignment.sampled(view, CORNERS))
    for turns in (1, 2, 3):
        turned = np.roll(CORNERS, turns, axis=0)
        assert not alignment.is_print(alignment.sampled(view, turned))
    even = dataclasses.replace(view, light=np.full_like(view.light, 0.3))
    assert not alignment.is_print(alignment.sampled(even, CORNERS))


def test_a_lens_is_undone_where_samples_are_taken() -> None:
    lens = dataclasses.replace(SMALL, dist=np.array((-0.3, 0.1, 0.0, 0.0, 0.0)))
    pose = pose_at(0.55, 25, 20, (0.15, 0.09))
    image = PrintedMarker(MARKER.bitmap(CELLS), SIDE_M, lens, Flaws(), 4).painted(
        [pose], np.random.default_rng(0), ground(lens)
    )
    corners, alignment = project(lens, pose, square_corners(SIDE_M)), MARKER.alignment
    assert alignment.is_print(alignment.sampled(view_of(image, lens), corners))
    assert not alignment.is_print(alignment.sampled(view_of(image), corners))


@pytest.mark.parametrize("light", [0.03, 0.3, 0.75])
def test_a_strip_across_the_middle_is_no_reason_to_be_wrong_and_sure(light: float) -> None:
    """It leaves the four sides as they are, but looks like edges inside that have bled."""
    across = Cover(0, 0.56, -0.46, (-0.2, 1.2), 0.02, light)
    found = MarkerTracker(MARKER, SMALL, SIDE_M, BALANCED.tracking).track(frame(picture(Flaws(cover=across)))).marker
    if found is None:
        return
    turn = cv2.Rodrigues(found.T_cam_marker[:3, :3] @ POSE[:3, :3].T)[0].ravel()
    error = np.concatenate([turn, found.T_cam_marker[:3, 3] - POSE[:3, 3]])
    assert error @ np.linalg.solve(found.covariance, error) < BEYOND_1_IN_1000


def test_a_print_that_is_partly_covered_does_not_say_how_far_its_edges_bleed() -> None:
    def bleed_px(cover: Cover | None) -> float | None:
        view = view_of(picture(Flaws(gamma=2.2, cover=cover)))
        samples = MARKER.alignment.sampled(MARKER.alignment.blurred(view, CORNERS), CORNERS)
        return MARKER.alignment.bleed_px(samples, 131.0)

    clean_px = bleed_px(None)
    assert clean_px is not None
    assert clean_px > 0.2
    assert bleed_px(Cover(0, 0.56, -0.46, (-0.2, 1.2), 0.02, 0.75)) is None

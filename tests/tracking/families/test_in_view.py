"""Any marker of a known family is named, and nothing else is taken for one."""

import cv2
import numpy as np
import pytest

from ashe_live.bench.track import frames
from ashe_live.bench.track.frames import Flaws
from ashe_live.bench.track.takes import SIDE_M, SMALL, pose_at
from ashe_live.tracking.families.in_view import in_view_text, markers_in_view, mirrored_in_view
from ashe_live.tracking.families.layout import in_words
from ashe_live.tracking.families.markers import parse_marker
from tests.painted_cubes import CAMERA, CubeScene, looking, painted, sun

SPECS = ("aruco:4x4_50:7", "aruco:5x5_250:200", "apriltag:36h11:12", "aruco:6x6_100:50", "aruco:7x7_1000:999")


RARE = ("aruco:mip_36h12:40", "apriltag:36h10:2000", "apriltag:25h9:3", "apriltag:16h5:7", "aruco:original:700")


def table(*specs: str, side_px: int = 120) -> np.ndarray:
    """Prints side by side on grey, a little blurred and turned."""
    grey = np.full((480, 640), 200, np.uint8)
    for place, spec in enumerate(specs):
        left = 60 + 200 * place
        grey[100 : 100 + side_px, left : left + side_px] = parse_marker(spec).bitmap(side_px)
        side_px -= 20
    turned = cv2.warpAffine(grey, cv2.getRotationMatrix2D((320, 240), 12, 1), (640, 480), borderValue=200)
    return cv2.cvtColor(cv2.GaussianBlur(turned, (0, 0), 1.0), cv2.COLOR_GRAY2BGR)


@pytest.mark.parametrize("spec", [*SPECS, *RARE])
def test_a_marker_is_named_as_it_is_asked_for(spec: str) -> None:
    """Of every family, also those that few people print."""
    assert markers_in_view(table(spec)) == (spec,)


@pytest.mark.parametrize("spec", [*SPECS, "aruco:4x4_50:0", "aruco:4x4_50:23"])
def test_in_mirror_image_a_marker_is_no_other_and_named_as_what_it_is(spec: str) -> None:
    """4x4_50:0 and :23, cell by cell, are 4x4_1000:871 and :811 mirrored."""
    mirrored = np.ascontiguousarray(table(spec)[:, ::-1])
    assert markers_in_view(mirrored) == ()
    assert mirrored_in_view(mirrored) == (spec,)
    assert mirrored_in_view(table(spec)) == ()


def test_several_are_named_the_largest_first() -> None:
    assert markers_in_view(table(*SPECS[:3])) == SPECS[:3]


@pytest.mark.parametrize("spec", [SPECS[0], "aruco:4x4_50:21"])
def test_equal_ones_are_one_name_and_no_cube(spec: str) -> None:
    assert markers_in_view(table(spec, spec)) == (spec,)


def test_a_large_picture_is_looked_at_too() -> None:
    large = cv2.resize(table(SPECS[0]), None, fx=4, fy=4, interpolation=cv2.INTER_CUBIC)
    assert markers_in_view(large) == SPECS[:1]


@pytest.mark.parametrize("shape", [(1, 1), (1, 16_384), (3, 16_384), (16_384, 3)])
def test_nothing_is_in_a_picture_of_a_few_rows(shape: tuple[int, int]) -> None:
    assert markers_in_view(np.full((*shape, 3), 200, np.uint8)) == ()


def test_nothing_is_in_an_even_picture() -> None:
    assert markers_in_view(np.full((480, 640, 3), 120, np.uint8)) == ()


@pytest.mark.parametrize("seed", range(5))
def test_squares_and_noise_are_no_markers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    picture = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    for _ in range(40):
        x, y, side = (int(value) for value in rng.integers((0, 0, 20), (560, 400, 80)))
        picture[y : y + side, x : x + side] = rng.integers(0, 255, 3)
    assert markers_in_view(cv2.GaussianBlur(picture, (0, 0), 1.5)) == ()


def test_two_faces_of_the_cube_are_the_cube_and_one_is_a_marker() -> None:
    whole = painted(CubeScene(CAMERA, looking(0.35, 45, 40), [sun(200, 40)]))
    assert markers_in_view(whole) == ("cube",)
    from_above = painted(CubeScene(CAMERA, looking(0.35, 8, 0), [sun(200, 40)]))
    assert markers_in_view(from_above) == ("aruco:4x4_50:18",)


@pytest.mark.parametrize(("distance_m", "tilt_deg", "azimuth_deg"), [(0.5, 20, 45), (0.5, 32, 45), (0.7, 26, 10)])
def test_a_cube_is_one_from_high_above_too(distance_m: float, tilt_deg: float, azimuth_deg: float) -> None:
    """There its sides are a few pixels high."""
    seen = painted(CubeScene(CAMERA, looking(distance_m, tilt_deg, azimuth_deg), [sun(200, 40)]))
    assert markers_in_view(seen) == ("cube",)


@pytest.mark.parametrize("other", ["aruco:4x4_50:7", "aruco:4x4_50:23"])
def test_a_flat_marker_with_a_number_of_the_cubes_is_no_cube_beside_others(other: str) -> None:
    assert markers_in_view(table("aruco:4x4_50:18", other)) == ("aruco:4x4_50:18", other)


def test_a_sentence_on_the_paper_cube_does_not_speak_of_the_model_of_that_name() -> None:
    assert in_view_text(("cube", "aruco:4x4_50:7")) == "the paper cube and aruco:4x4_50:7 are in view"
    assert in_words("cube+aruco:4x4_50:7") == "the paper cube with aruco:4x4_50:7 beside it"


@pytest.mark.parametrize("ratio", [0.3, 0.2, 0.12])
def test_a_shadows_edge_across_it_hides_no_name(ratio: float) -> None:
    for seed in range(6):
        rng, flaws, place = np.random.default_rng(seed), Flaws(shadow_ratio=ratio), pose_at(0.5, 25, 30)
        image = frames.PrintedMarker(parse_marker(SPECS[1]).bitmap(7), SIDE_M, SMALL, flaws).painted([place], rng)
        assert markers_in_view(image) == (SPECS[1],)


@pytest.mark.parametrize(
    ("spec", "cells"),
    [("aruco:4x4_50:27", 6), ("aruco:5x5_50:6", 7), ("apriltag:36h11:25", 8), ("aruco:6x6_250:100", 8)],
)
def test_a_small_blurred_marker_is_named(spec: str, cells: int) -> None:
    """50 pixels wide, as in a picture of 480: bright cells bleed over single dark ones."""
    rng = np.random.default_rng(4)
    for azimuth_deg in (0, 30, 75):
        place, flaws = pose_at(1.0, 35, azimuth_deg), Flaws(blur_px=1.6, noise=2.0)
        image = frames.PrintedMarker(parse_marker(spec).bitmap(cells), SIDE_M, SMALL, flaws).painted([place], rng)
        assert markers_in_view(image) == (spec,)


def test_beside_a_marker_random_cells_are_hardly_ever_one() -> None:
    """Squares with a black border; the 1000 codes of 16 cells alone would take 6 % of those of four cells a side."""
    rng, named = np.random.default_rng(8), []
    for _ in range(8):
        squares = [parse_marker(SPECS[2]).bitmap(72)]
        for cells in (*[4] * 12, 5, 6, 7):
            square = np.pad(rng.integers(0, 2, (cells, cells)).astype(np.uint8) * 255, 1)
            squares.append(cv2.resize(square, (72, 72), interpolation=cv2.INTER_NEAREST))
        margins = np.pad(squares, ((0, 0), (20, 20), (20, 20)), constant_values=230)
        page = np.concatenate(np.concatenate(margins.reshape(4, 4, *margins.shape[1:]), axis=1), axis=1)
        found = markers_in_view(cv2.cvtColor(cv2.GaussianBlur(page, (0, 0), 1.0), cv2.COLOR_GRAY2BGR))
        assert SPECS[2] in found
        named += [spec for spec in found if spec != SPECS[2]]
    assert len(named) <= 3  # of 120

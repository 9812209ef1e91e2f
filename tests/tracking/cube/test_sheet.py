"""The cube's sheet: in true size, on one page, and folded up it has every print where the tracker expects it."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.errors import UserError
from ashe_live.tracking.cube.faces import CORNERS, FACES, FIRST_ID, TAG_SHARE
from ashe_live.tracking.cube.sheet import ADVICE, FLAP_MM, SLANT, largest_edge_mm, write_cube_sheet
from ashe_live.tracking.families.layout import cube_layout
from tests.printed_page import as_printed, corners_mm

EDGE_M = 0.06


def sheet(folder: Path, edge_m: float = EDGE_M, paper: str = "a4") -> tuple[Image, float]:
    """The printed page (h, w), and its millimetres a pixel."""
    path = folder / f"{paper}.png"
    write_cube_sheet(path, cube_layout(), edge_m, paper)
    return as_printed(path)


def turned(points: Float, on_axis: Float, axis: Float, angle: float) -> Float:
    return (points - on_axis) @ cv2.Rodrigues(np.asarray(axis, float) * angle)[0].T + on_axis


@pytest.mark.parametrize(("edge_m", "paper"), [(0.06, "a4"), (0.06, "letter"), (0.03, "a4"), (0.09, "a3")])
def test_folded_along_its_lines_the_sheet_is_the_cube_that_is_tracked(
    tmp_path: Path, edge_m: float, paper: str
) -> None:
    found = corners_mm(*sheet(tmp_path, edge_m, paper))
    assert sorted(found) == [FIRST_ID + number for number in range(len(FACES))]
    # The page as it lies on the table, printed side up, the top face's centre at the origin: x right, y up.
    middle = found[FIRST_ID].mean(axis=0)
    layout = cube_layout()
    for number, member in enumerate(layout.members):
        flat = np.column_stack([(found[FIRST_ID + number] - middle) * (1, -1) / 1000, np.zeros(4)])
        away = flat.mean(axis=0)
        if number:
            # Each side hangs on the top by the fold between them, and is folded down by a right angle.
            way = np.round(away / edge_m)
            flat = turned(flat, 0.5 * edge_m * way, np.cross((0, 0, 1), way), np.pi / 2)
        on_table = flat + np.array((0, 0, edge_m))
        assert on_table == pytest.approx(edge_m * member.corners, abs=1e-4)


def test_cut_along_its_lines_the_net_is_one_piece_of_six_faces_and_a_flap_for_each_open_edge(tmp_path: Path) -> None:
    """Of a cube's twelve edges five hold the net together, and seven are glued."""
    fine, fine_mm = sheet(tmp_path)
    page = cv2.erode(fine, np.ones((4, 4), np.uint8))[::4, ::4].copy()  # no line is lost
    edge_mm, mm_per_px = 1000 * EDGE_M, 4 * fine_mm
    middle = corners_mm(fine, fine_mm)[FIRST_ID].mean(axis=0) / mm_per_px
    _, left, _, _ = cv2.floodFill(page.copy(), None, (2, 2), 77)
    _, parts = cv2.connectedComponents((left != 77).astype(np.uint8), connectivity=4)
    piece = parts == parts[round(middle[1]), round(middle[0])]
    flap_mm2 = FLAP_MM * (edge_mm - SLANT * FLAP_MM)
    assert np.count_nonzero(piece) * mm_per_px**2 == pytest.approx(6 * edge_mm**2 + 7 * flap_mm2, rel=0.02)
    # The middles of the folds, in edges from the top's: each is a line of dashes.
    between = [(0, -0.5), (0, 0.5), (0, 1.5), (-0.5, 0), (0.5, 0)]
    at_flaps = [(-1, -0.5), (-1, 0.5), (1, -0.5), (1, 0.5), (-0.5, 2), (0.5, 2), (0, 2.5)]
    for x, y in between + at_flaps:
        along = np.linspace(-0.45, 0.45, 400)[:, None] * ((0, 1) if x % 1 else (1, 0))
        u, v = np.round(middle + edge_mm / mm_per_px * (along + np.array((x, y)))).astype(int).T
        around = np.min([page[v + i, u + j] for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)
        assert 0.4 < np.mean(around < 220) < 0.85
        assert piece[v, u].all()
    # To the right of it, below the arm, each line of words stands by itself, and nothing is printed over another.
    words = page[round(middle[1] + 0.5 * edge_mm / mm_per_px) :, round(middle[0] + 0.5 * edge_mm / mm_per_px) :] < 220
    words &= ~piece[-words.shape[0] :, -words.shape[1] :]
    begins = np.diff(words.any(axis=1).astype(int), prepend=0) == 1
    assert np.count_nonzero(begins) == 1 + len(ADVICE) + 1


def test_the_ruler_is_a_hundred_millimetres_long(tmp_path: Path) -> None:
    page, mm_per_px = sheet(tmp_path)
    below_the_net = page[int(0.6 * len(page)) :, : int(28 / mm_per_px)]
    inked = below_the_net < 128
    column = int(inked.sum(axis=0).argmax())
    rows = np.flatnonzero(inked[:, column])
    assert (rows[-1] - rows[0]) * mm_per_px == pytest.approx(100, abs=0.3)


@pytest.mark.parametrize("paper", ["a4", "letter", "a3"])
def test_the_largest_cube_stays_within_what_printers_reach(tmp_path: Path, paper: str) -> None:
    page, mm_per_px = sheet(tmp_path, largest_edge_mm(paper) / 1000, paper)
    rim = int(7.5 / mm_per_px)
    inside = np.zeros_like(page, dtype=bool)
    inside[rim:-rim, rim:-rim] = True
    assert page[~inside].min() == 255


def test_around_each_print_the_face_is_white_but_for_its_number_at_the_lower_left(tmp_path: Path) -> None:
    page, mm_per_px = sheet(tmp_path)
    found = corners_mm(page, mm_per_px)
    margin_mm = (1 - TAG_SHARE) / 2 * 1000 * EDGE_M
    for number in range(len(FACES)):
        corners = found[FIRST_ID + number]  # of the upright print, from the top-left one clockwise
        inks = []
        for at, corner in enumerate(corners):
            along = [(corner - corners[at - step]) / np.linalg.norm(corner - corners[at - step]) for step in (1, 3)]
            x, y = np.round((corner + margin_mm / 2 * np.sum(along, axis=0)) / mm_per_px).astype(int)
            around = round(0.45 * margin_mm / mm_per_px)
            inks.append((page[y - around : y + around, x - around : x + around] < 250).mean())
        assert inks[:3] == pytest.approx([0, 0, 0], abs=1e-3)
        assert 0.01 < inks[3] < 0.1
        # And beside the sides nothing is printed.
        for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            out = np.array((other - one)[::-1] * (1, -1)) / np.linalg.norm(other - one)
            places = np.linspace(one, other, 50)[:, None] + margin_mm * np.linspace(0.1, 0.9, 9)[:, None] * out
            x, y = np.round(places / mm_per_px).astype(int).reshape(-1, 2).T
            assert page[y, x].min() > 250


@pytest.mark.parametrize("edge_m", [0.0, 0.02, 0.065, 0.2, float("nan"), float("inf")])
def test_an_edge_that_fits_no_page_is_one_line_with_its_remedy(tmp_path: Path, edge_m: float) -> None:
    path = tmp_path / "cube.pdf"
    with pytest.raises(UserError) as caught:
        write_cube_sheet(path, cube_layout(), edge_m)
    assert "--side from 0.03 to 0.064" in caught.value.remedy
    assert not path.exists()


@pytest.mark.parametrize(("edge_m", "fits_a3"), [(0.02, False), (0.07, True), (0.3, False)])
def test_larger_paper_is_advised_only_where_the_cube_fits_on_it(tmp_path: Path, edge_m: float, fits_a3: bool) -> None:
    with pytest.raises(UserError) as caught:
        write_cube_sheet(tmp_path / "cube.pdf", cube_layout(), edge_m)
    assert ("--paper a3" in caught.value.remedy) == fits_a3
    assert ("too small" in caught.value.message) == (edge_m < 0.03)


def test_a_face_looks_away_from_the_cubes_middle_and_lies_on_its_surface() -> None:
    for face in FACES:
        assert np.cross(face.right, face.up) @ (face.centre - (0, 0, 0.5)) == pytest.approx(0.5)
        whole = face.corners()
        assert all(np.abs(CORNERS - corner).sum(axis=1).min() < 1e-12 for corner in whole)
    assert not any(face.centre[2] < 0.4 for face in FACES)


def test_only_pages_are_printed_and_no_file_is_overwritten_unasked(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot print to 'a\.jpg'"):
        write_cube_sheet(tmp_path / "a.jpg", cube_layout(), EDGE_M)
    path = tmp_path / "a.png"
    path.write_text("mine")
    with pytest.raises(UserError, match="exists"):
        write_cube_sheet(path, cube_layout(), EDGE_M)
    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]
    write_cube_sheet(path, cube_layout(), EDGE_M, overwrite=True)
    assert path.read_bytes().startswith(b"\x89PNG")

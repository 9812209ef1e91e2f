"""The sheet to print: true size, white margin, and a marker that the tracker finds in it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.square import PAGE_FOOT_MM
from ashe_live.errors import UserError
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import parse_target
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.families.printing import write_marker_sheet
from ashe_live.tracking.tracker import MarkerTracker
from tests.printed_page import as_printed, assert_advice_holds
from tests.tracking.conftest import SPECS, frame

ARUCO = parse_marker("aruco:4x4_50:3")


@pytest.mark.parametrize(("spec", "side_mm"), [*((spec, 80) for spec in SPECS), (SPECS[0], 25), (SPECS[0], 300)])
def test_the_tracker_finds_the_square_at_its_true_size(
    marker_of: Callable[[str], Marker], tmp_path: Path, spec: str, side_mm: float
) -> None:
    path = tmp_path / "marker.png"
    marker = marker_of(spec)
    write_marker_sheet(path, marker, side_mm / 1000)
    with PIL.Image.open(path) as sheet:
        dpi_x, dpi_y = sheet.info["dpi"]
        grey = np.asarray(sheet.convert("L"))
    assert dpi_x == dpi_y
    camera = Camera.from_focal(grey.shape[::-1], 5000)
    found = MarkerTracker(marker, camera, side_mm / 1000, BALANCED.tracking).track(frame(np.dstack([grey] * 3))).marker
    assert found is not None
    corners_mm = found.corners_px / dpi_x * 25.4
    sides_mm = np.linalg.norm(np.roll(corners_mm, -1, axis=0) - corners_mm, axis=1)
    assert sides_mm == pytest.approx(side_mm, abs=0.1)
    # Upright on the page, and white around it for an eighth of its side.
    assert corners_mm[1] - corners_mm[0] == pytest.approx((side_mm, 0), abs=0.1)
    left, top = np.round(found.corners_px[0]).astype(int)
    right, bottom = np.round(found.corners_px[2]).astype(int)
    quiet = int(side_mm / 8 / 25.4 * dpi_x) - 3
    around = grey[top - quiet : bottom + quiet, left - quiet : right + quiet].copy()
    around[quiet - 3 : 3 - quiet, quiet - 3 : 3 - quiet] = 255
    assert around.min() == 255
    assert (left + right) / 2 == pytest.approx(grey.shape[1] / 2, abs=2)


def test_the_ruler_is_a_hundred_millimetres_long(tmp_path: Path) -> None:
    path = tmp_path / "marker.png"
    write_marker_sheet(path, ARUCO, 0.08)
    with PIL.Image.open(path) as sheet:
        dpi = sheet.info["dpi"][0]
        grey = np.asarray(sheet.convert("L"))
    foot = grey[int(grey.shape[0] * 0.8) :]
    row = foot[int((foot < 128).sum(axis=1).argmax())]
    inked = np.flatnonzero(row < 128)
    assert (inked[-1] - inked[0]) / dpi * 25.4 == pytest.approx(100, abs=0.3)
    assert len(inked) == inked[-1] - inked[0] + 1


@pytest.mark.parametrize(
    ("paper", "side_m", "size_mm"),
    [
        ("a4", 0.08, (210, 297)),
        ("a4", 0.2, (297, 420)),
        ("a4", 0.3, (420, 594)),
        ("a4", 0.4, (594, 841)),
        ("a4", 0.6, (841, 1189)),
        ("letter", 0.08, (215.9, 279.4)),
        ("letter", 0.2, (279.4, 431.8)),
        ("letter", 0.3, (431.8, 558.8)),
        ("letter", 0.4, (558.8, 863.6)),
        ("letter", 0.6, (863.6, 1117.6)),
    ],
)
def test_a_pdf_is_one_page_of_true_size_larger_for_a_large_marker(
    tmp_path: Path, paper: str, side_m: float, size_mm: tuple[float, float]
) -> None:
    path = tmp_path / "marker.PDF"
    write_marker_sheet(path, ARUCO, side_m, paper=paper)
    assert path.read_bytes().startswith(b"%PDF")
    grey, mm_per_px = as_printed(path)
    assert np.array(grey.shape[::-1]) * mm_per_px == pytest.approx(size_mm, abs=0.1)
    # The ring around the cells is black all around.
    middle = round((size_mm[1] - PAGE_FOOT_MM) / 2 / mm_per_px), round(size_mm[0] / 2 / mm_per_px)
    for line, at in ((grey[middle[0]], size_mm[0] / 2), (grey[: 2 * middle[0], middle[1]], middle[0] * mm_per_px)):
        inked_mm = np.flatnonzero(line < 128) * mm_per_px
        inked_mm = inked_mm[np.abs(inked_mm - at) < 0.6 * 1000 * side_m]  # without the word above
        assert (inked_mm[0], inked_mm[-1]) == pytest.approx((at - 500 * side_m, at + 500 * side_m), abs=2.5 * mm_per_px)


@pytest.mark.parametrize("side_m", [0.03, 0.08])
def test_above_the_marker_it_says_where_up_is_and_nothing_is_beside_it(tmp_path: Path, side_m: float) -> None:
    path = tmp_path / "marker.png"
    write_marker_sheet(path, ARUCO, side_m)
    grey, mm_per_px = as_printed(path)
    rows, columns = np.nonzero(grey < 128)
    x, y = columns * mm_per_px - 105, (297 - PAGE_FOOT_MM) / 2 - rows * mm_per_px  # from the marker's middle, y up
    half, quiet = 500 * side_m, 125 * side_m
    above = y > half + 0.2
    assert np.abs(x[above]).max() < 5
    assert y[above].min() == pytest.approx(half + quiet + 2.5, abs=1.5)
    assert y[above].max() < half + quiet + 7
    beside = (y > -half - quiet) & ~above
    assert max(np.abs(x[beside]).max(), np.abs(y[beside]).max()) < half + 0.2


@pytest.mark.parametrize(
    ("spec", "paper"), [("aruco:4x4_50:3", "a4"), ("grid:4x4_50:2x12", "letter"), ("grid:4x4_50:12x2", "a3")]
)
def test_the_largest_size_that_it_advises_is_the_largest_that_fits_any_page(
    tmp_path: Path, spec: str, paper: str
) -> None:
    path, target = tmp_path / "marker.pdf", parse_target(spec)
    assert_advice_holds(lambda side_m: write_marker_sheet(path, target, side_m, True, paper), "a size")


@pytest.mark.parametrize("suffix", [".pdf", ".png"])
def test_a_picture_of_any_name_is_printed(tmp_path: Path, picture_file: Path, suffix: str) -> None:
    """Of several lines, and of bytes that are no text."""
    odd = picture_file.rename(picture_file.with_name("a\nb\udcff\x1b.png"))
    path = tmp_path / f"marker{suffix}"
    write_marker_sheet(path, parse_marker(f"image:{odd}"), 0.08)
    assert path.stat().st_size > 1000


def test_a_long_name_stays_within_what_printers_reach(tmp_path: Path, picture_file: Path) -> None:
    """Its letters are smaller; those of the words beside it are as large as ever."""
    long = picture_file.rename(picture_file.with_name(f"{'the sign above the door ' * 6}.png"))
    inked_mm = []
    for number, spec in enumerate(("aruco:4x4_50:3", f"image:{long}")):
        path = tmp_path / f"marker{number}.png"
        write_marker_sheet(path, parse_marker(spec), 0.08)
        grey, mm_per_px = as_printed(path)
        assert all(edge.min() == 255 for edge in (grey[:, : int(8 / mm_per_px)], grey[:, -int(8 / mm_per_px) :]))
        foot = grey[-round((PAGE_FOOT_MM - 4) / mm_per_px) : -round((PAGE_FOOT_MM - 12) / mm_per_px)] < 128
        rows, columns = (np.flatnonzero(foot.any(axis=axis)) * mm_per_px for axis in (1, 0))
        inked_mm.append((np.ptp(columns), np.ptp(rows)))
    (usual_width, usual_height), (width, height) = inked_mm
    assert usual_width < 80 < 185 < width
    assert height < usual_height


@pytest.mark.parametrize("side_m", [0.0, -0.08, 0.005, 2.0, float("nan"), float("inf")])
def test_a_size_that_no_page_fits_is_refused(tmp_path: Path, side_m: float) -> None:
    with pytest.raises(UserError, match="no page fits"):
        write_marker_sheet(tmp_path / "marker.png", ARUCO, side_m)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["marker.jpg", "marker", "marker.svg"])
def test_another_suffix_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=r"name a \.pdf or a \.png"):
        write_marker_sheet(tmp_path / name, ARUCO, 0.08)


def test_an_existing_file_is_kept_unless_overwriting(tmp_path: Path) -> None:
    path = tmp_path / "marker.png"
    path.write_text("mine", encoding="ascii")
    with pytest.raises(UserError, match="exists"):
        write_marker_sheet(path, ARUCO, 0.08)
    assert path.read_text(encoding="ascii") == "mine"
    write_marker_sheet(path, ARUCO, 0.08, overwrite=True)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert list(tmp_path.iterdir()) == [path]

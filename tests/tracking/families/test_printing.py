"""The sheet to print: true size, white margin, and a marker that the tracker finds in it."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.core.camera import Camera
from ashe_live.errors import UserError
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.families.printing import write_marker_sheet
from ashe_live.tracking.tracker import MarkerTracker
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
        ("letter", 0.08, (215.9, 279.4)),
        ("letter", 0.2, (279.4, 431.8)),
        ("letter", 0.3, (431.8, 558.8)),
        ("letter", 0.6, (863.6, 1117.6)),
    ],
)
def test_a_pdf_is_one_page_of_true_size_larger_for_a_large_marker(
    tmp_path: Path, paper: str, side_m: float, size_mm: tuple[float, float]
) -> None:
    path = tmp_path / "marker.PDF"
    write_marker_sheet(path, ARUCO, side_m, paper=paper)
    content = path.read_bytes()
    assert content.startswith(b"%PDF")
    (box,) = re.findall(rb"/MediaBox \[(.*?)\]", content)
    # A PDF's unit is 1/72 inch.
    assert [float(number) / 72 * 25.4 for number in box.split()] == pytest.approx([0, 0, *size_mm], abs=0.1)


@pytest.mark.parametrize("suffix", [".pdf", ".png"])
def test_a_picture_of_any_name_is_printed(tmp_path: Path, picture_file: Path, suffix: str) -> None:
    """Of several lines, and of bytes that are no text."""
    odd = picture_file.rename(picture_file.with_name("a\nb\udcff\x1b.png"))
    path = tmp_path / f"marker{suffix}"
    write_marker_sheet(path, parse_marker(f"image:{odd}"), 0.08)
    assert path.stat().st_size > 1000


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

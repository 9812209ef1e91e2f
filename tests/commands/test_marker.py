"""`ashe-live marker`, and what `webcam` says where there is no camera."""

import shlex
import sys

import cv2
import numpy as np
import pytest

from ashe_live.commands.flags.option_groups import DEFAULT_MARKER
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.viewing import setup
from ashe_live.tracking.families.layout import usual_side_m
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.viewer.windows import marker_window
from tests.printed_page import as_printed, corners_mm


@pytest.mark.parametrize(
    ("arguments", "numbers", "side_mm"),
    [
        ((), [0], 80),
        (("--marker", "aruco:4x4_50:7", "--size-mm", "60"), [7], 60),
        (("--marker", "grid:4x4_50:2x1:5", "--size-mm", "50"), [5, 6], 50),
        (("--cube",), range(18, 23), 0.7 * 60),
        (("--cube", "--side", "0.05", "--paper", "letter"), range(18, 23), 0.7 * 50),
    ],
)
@pytest.mark.parametrize("suffix", [".pdf", ".png"])
def test_what_is_printed_has_its_true_size(run, tmp_path, arguments, numbers, side_mm, suffix):
    path = tmp_path / f"marker{suffix}"
    outcome = run("marker", "--out", path, *arguments)
    assert outcome.status == 0
    assert outcome.out[0].startswith(f"{path}: print it at 100 %")
    found = corners_mm(*as_printed(path))
    assert sorted(found) == [*numbers]
    for corners in found.values():
        assert np.linalg.norm(np.roll(corners, 1, axis=0) - corners, axis=1) == pytest.approx(side_mm, abs=0.15)


@pytest.mark.parametrize(
    ("arguments", "spec", "side_m"),
    [
        ((), "aruco:4x4_50:0", 0.08),
        (("--size-mm", "150"), "aruco:4x4_50:0", 0.15),
        (("--marker", "grid:4x4_50:3x2", "--size-mm", "50"), "grid:4x4_50:3x2", 0.05),
    ],
)
def test_the_flags_that_it_names_are_those_for_the_print(run, tmp_path, arguments, spec, side_m):
    (line,) = run("marker", "--out", tmp_path / "marker.png", *arguments).out
    flags = line.partition("; use it with ")[2]
    options = parsed(["webcam", *shlex.split(flags)])
    assert options.marker == spec
    assert (options.marker_size or usual_side_m(options.marker)) == side_m


@pytest.mark.parametrize(
    ("arguments", "needs"),
    [
        ((), ""),
        (("--size-mm", "150"), ""),
        (("--size-mm", "185"), " on A3 paper (297 x 420 mm), as A4 is too small"),
        (("--size-mm", "185", "--paper", "a3"), ""),
        (("--size-mm", "250", "--paper", "a3"), " on A2 paper (420 x 594 mm), as A3 is too small"),
        (("--size-mm", "185", "--paper", "letter"), " on tabloid paper (279 x 432 mm), as letter is too small"),
    ],
)
def test_a_page_that_the_printer_s_paper_does_not_hold_is_announced(run, tmp_path, arguments, needs):
    (line,) = run("marker", "--out", tmp_path / "marker.png", *arguments).out
    assert f"print it at 100 %{needs}, " in line


def test_an_existing_sheet_is_left_alone(run, tmp_path):
    path = tmp_path / "marker.pdf"
    path.write_bytes(b"precious")
    assert "--overwrite" in run("marker", "--out", path).refusal
    assert path.read_bytes() == b"precious"
    assert run("marker", "--out", path, "--overwrite").status == 0
    assert path.read_bytes().startswith(b"%PDF")


def test_a_picture_is_not_replaced_by_the_sheet_made_of_it(run, tmp_path):
    path = tmp_path / "mine.png"
    cv2.imwrite(str(path), parse_marker("aruco:4x4_50:7").bitmap(160))
    drawn = path.read_bytes()
    assert "is also read" in run("marker", "--marker", f"image:{path}", "--out", path, "--overwrite").refusal
    assert path.read_bytes() == drawn
    assert run("marker", "--marker", f"image:{path}", "--out", tmp_path / "sheet.png").status == 0


@pytest.mark.parametrize("arguments", [("--marker", "aruco:4x4_50:50"), ("--marker", "aruco:nine:1")])
def test_a_marker_that_does_not_exist_is_one_line(run, tmp_path, arguments):
    assert run("marker", "--out", tmp_path / "marker.png", *arguments).refusal
    assert list(tmp_path.iterdir()) == []


def test_a_cube_is_printed_by_either_of_its_names(run, tmp_path):
    outcome = run("marker", "--cube", "--out", tmp_path / "cube.pdf", "--side", "0.05", "--paper", "letter")
    assert outcome.status == 0
    assert "--marker cube --marker-size 0.05" in outcome.out[0]
    assert (tmp_path / "cube.pdf").read_bytes().startswith(b"%PDF")
    usual = run("marker", "--marker", "cube", "--out", tmp_path / "same.pdf")
    assert usual.status == 0
    assert "--marker-size" not in usual.out[0]
    assert run("marker", "--marker", "cube", "--cube", "--out", tmp_path / "both.pdf").status == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--cube", "--show"), "no use"),
        (("--show", "--size-mm", "50"), "--size-mm is for printing"),
        (("--cube", "--out", "cube.pdf", "--side", "0.07"), "--side from 0.03 to 0.064"),
        (("--cube", "--out", "cube.pdf", "--side", "-1"), "not a number"),
        (("--out", "flat.pdf", "--side", "0.05"), "--side is a cube's edge: give --cube with it"),
        (
            ("--cube", "--out", "cube.pdf", "--size-mm", "50"),
            "of a flat marker: give a cube's edge in metres by --side",
        ),
        (("--cube", "--out", "cube.pdf", "--marker", "aruco:4x4_50:3"), "by another `marker --marker aruco:4x4_50:3`"),
        (("--out", "cube.pdf", "--marker", "cube+aruco:4x4_50:3"), "by another `marker --marker aruco:4x4_50:3`"),
    ],
)
def test_a_marker_that_cannot_be_is_one_line(run, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert words in run("marker", *arguments).refusal
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only X11 and Wayland name their display")
@pytest.mark.parametrize("display", [None, "no display"])
def test_without_a_display_there_is_no_marker_on_it(run, monkeypatch, display):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if display is not None:
        monkeypatch.setenv("DISPLAY", display)
    refusal = run("marker", "--show").refusal
    assert "--out marker.pdf" in refusal
    assert "--headless" not in refusal, "no flag of this command"


@pytest.mark.parametrize("spec", ["aruco:4x4_50:0", "apriltag:36h11:7"])
def test_a_marker_on_the_screen_says_with_which_flags_it_is_found(run, monkeypatch, spec):
    shown = []
    monkeypatch.setattr(setup, "has_display", lambda: True)
    monkeypatch.setattr(marker_window, "show_marker", lambda name, _square, flags: shown.append((name, *flags)))
    assert run("marker", "--show", "--marker", spec).status == 0
    assert shown == [(spec,) if spec == DEFAULT_MARKER else (spec, f"--marker {spec}")]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="cameras are files on Linux only")
def test_a_camera_that_is_not_there_is_one_line(run):
    assert "/dev/video987" in run("webcam", "--camera", "/dev/video987", "--hfov", "60").refusal

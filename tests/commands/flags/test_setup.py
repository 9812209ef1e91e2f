"""The camera and the tracker that several commands make of the same options."""

import argparse
import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture.photo import PhotoSource
from ashe_live.commands.flags.parser import build_parser
from ashe_live.commands.flags.setup import assumed_note, camera_chooser, cameras_of_all, make_tracker
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame
from ashe_live.tracking.families.layout import usual_side_m
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal_tracker import FocalTracker
from tests.capture.test_photo import with_exif
from tests.conftest import HFOV_DEG, SIDE_M, Film

PictureOfBox = Callable[..., Image]


def options(*flags: str | Path) -> argparse.Namespace:
    return build_parser().parse_args(["estimate", "a.png", *map(str, flags)])


def test_one_focal_length_for_pictures_of_two_sizes_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    camera_for = camera_chooser(argparse.Namespace(camera_file=None, focal_px=600.0, hfov=None))
    for size in ((640, 480), (480, 640), (640, 480)):
        assert camera_for(size).K[0, 0] == 600
    assert capsys.readouterr().err == ""
    for _ in range(2):
        camera_for((1280, 960))
    (line,) = capsys.readouterr().err.splitlines()
    assert "--focal-px 600 is taken for pictures of 1280x960 as well as of 640x480" in line


def test_the_camera_is_that_of_the_flag_and_assumed_without_one(film: Film) -> None:
    for size in ((320, 240), (640, 480)):
        wide = camera_chooser(options("--hfov", "71"))(size)
        assert (wide.size, wide.source, wide.hfov_deg) == (size, "flag", pytest.approx(71))
        calibrated = camera_chooser(options("--camera-file", film.camera_file))(size)
        assert (calibrated.size, calibrated.source, calibrated.hfov_deg) == (size, "file", pytest.approx(HFOV_DEG))
        assert camera_chooser(options())(size).source == "assumed"


@pytest.mark.parametrize(("flags", "source"), [((), "exif"), (("--hfov", "60"), "flag")])
def test_a_photo_states_its_focal_length_where_nobody_gave_one(
    flags: tuple[str, ...], source: str, tmp_path: Path
) -> None:
    stating, plain = with_exif(tmp_path / "a.jpg", grey(), 26), tmp_path / "b.jpg"
    cv2.imwrite(str(plain), grey())
    with PhotoSource(stating) as states, PhotoSource(plain) as says_nothing:
        frame = Frame(grey(), 0, 0.0)
        assert make_tracker(options(*flags), source=states).track(frame).camera.source == source
        otherwise = make_tracker(options(*flags), source=says_nothing).track(frame).camera.source
        assert otherwise == make_tracker(options(*flags)).track(frame).camera.source != "exif"


def grey() -> Image:
    return np.full((48, 64, 3), 90, np.uint8)


def test_a_focal_length_is_learned_where_nobody_gave_one_and_a_size_and_a_filter_are_as_given() -> None:
    assert isinstance(make_tracker(options()), FocalTracker)
    assert make_tracker(options()).filters
    assert make_tracker(options()).side_m == 0.08
    given = make_tracker(options("--hfov", "60", "--marker-size", "0.05"))
    assert not isinstance(given, FocalTracker)
    assert given.side_m == 0.05
    of_cube = make_tracker(options("--marker", "cube"))
    assert of_cube.side_m == usual_side_m("cube") != usual_side_m("aruco:4x4_50:0")
    read = parse_marker("aruco:4x4_50:7")
    assert make_tracker(options(), marker=read).marker is read
    assert not make_tracker(build_parser().parse_args(["play", "a.mp4", "--no-filter"])).filters


def test_an_assumed_field_of_view_is_said_of_a_marker_alone(picture_of_box: PictureOfBox) -> None:
    seen = make_tracker(options("--hfov", "50")).track(Frame(picture_of_box(-100), 0, 0.0))
    assert seen.marker is not None
    assert assumed_note(seen) is None
    assumed = dataclasses.replace(seen, camera=Camera.from_hfov((640, 480), 50, "assumed"))
    assert "50 degrees are assumed" in (assumed_note(assumed) or "")
    assert assumed_note(dataclasses.replace(assumed, marker=None)) is None


def test_what_one_photo_of_a_camera_leaves_open_another_one_tells(tmp_path: Path, picture_of_box: PictureOfBox) -> None:
    photos = [tmp_path / name for name in ("none.jpg", "stone.png", "from_above.png", "aslant.png", "stating.jpg")]
    photos[0].write_bytes(b"damaged")
    from_above = np.full((480, 640, 3), 200, np.uint8)
    cv2.imwrite(str(photos[1]), from_above)  # shows no marker
    from_above[150:330, 230:410] = parse_marker("aruco:4x4_50:0").bitmap(180)[..., None]
    cv2.imwrite(str(photos[2]), from_above)
    cv2.imwrite(str(photos[3]), picture_of_box(-100))
    with_exif(photos[4], grey(), 26)  # of another size, and needs no other
    unknown, known = options("--marker-size", f"{SIDE_M}"), options("--hfov", "60")
    alone, together = (cameras_of_all(some, unknown, camera_chooser(unknown)) for some in (photos[:3], photos))
    assert alone[640, 480].source == "assumed"
    assert together.keys() == {(640, 480)}
    camera, truth_px = together[640, 480], 320 / math.tan(math.radians(HFOV_DEG / 2))
    assert camera.source == "estimated"
    assert abs(camera.K[0, 0] - truth_px) < 3 * camera.focal_sigma_px < 0.1 * truth_px
    assert cameras_of_all(photos, known, camera_chooser(known)) == {}

"""What a window opens later: the next camera that is there, and files, with the flags of the start."""

import argparse
from pathlib import Path

import cv2
import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.cameras import Device, name_of
from ashe_live.capture.opening import open_source
from ashe_live.commands import demo
from ashe_live.commands.flags.marker_choice import tracker_maker, with_marker, with_marker_in
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.viewing import later_sources
from ashe_live.commands.viewing.later_sources import LaterSources
from ashe_live.commands.viewing.setup import ViewerSetup
from ashe_live.core.camera import Size
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal.focal import FocalEstimate
from ashe_live.tracking.focal.focal_memory import FocalMemory
from tests.painted_cubes import CAMERA, CubeScene, looking, painted, sun
from tests.patience import PATIENCE_S
from tests.viewer.conftest import FakeSource

PICTURE = np.full((48, 64, 3), 200, np.uint8)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[int]:
    """The numbers of cameras that were opened."""
    numbers: list[int] = []

    def camera(number: int, _size: object) -> FakeSource:
        numbers.append(number)
        return FakeSource(is_live=True)

    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(later_sources, "WebcamSource", camera)
    return numbers


def options_of(*arguments: str) -> argparse.Namespace:
    return parsed(arguments)


def attached(monkeypatch: pytest.MonkeyPatch, *numbers: int) -> None:
    monkeypatch.setattr(
        later_sources, "connected", lambda: [Device(number, f"camera {number}", None) for number in numbers]
    )


def test_cameras_go_round(monkeypatch: pytest.MonkeyPatch, opened: list[int]) -> None:
    attached(monkeypatch, 0, 2, 5)
    later = LaterSources(options_of("webcam", "--camera", "2", "--hfov", "60"))
    for _ in range(4):
        later(None).close()
    assert opened == [5, 0, 2, 5]


def test_a_camera_that_was_named_by_its_path_is_not_another_one(
    monkeypatch: pytest.MonkeyPatch, opened: list[int]
) -> None:
    devices = [Device(number, f"camera {number}", f"/dev/video{number}") for number in (0, 2)]
    monkeypatch.setattr(later_sources, "connected", lambda: devices)
    later = LaterSources(options_of("webcam", "--camera", "/dev/video0", "--hfov", "60"))
    for _ in range(2):
        later(None).close()
    assert opened == [2, 0]


def test_the_next_camera_is_as_the_flags_say_and_what_was_learned_of_it_is_recalled(
    monkeypatch: pytest.MonkeyPatch,
    opened: list[int],  # noqa: ARG001 - the folders
) -> None:
    attached(monkeypatch, 0, 2)
    sizes: list[Size] = []

    def camera(_number: int, size: Size) -> FakeSource:
        sizes.append(size)
        return FakeSource(is_live=True)

    monkeypatch.setattr(later_sources, "WebcamSource", camera)
    FocalMemory(name_of(2, later_sources.connected())).keep(FocalEstimate((64, 48), 71.5, 0.5, 60))
    pipeline = LaterSources(options_of("webcam", "--size", "640x480"))(None)
    tracked = pipeline.frames.take(20.0)
    pipeline.close()
    assert sizes == [(640, 480)]
    assert tracked is not None
    assert tracked.camera.K[0, 0] == pytest.approx(71.5)


def test_from_a_clip_the_first_camera_comes(monkeypatch: pytest.MonkeyPatch, opened: list[int]) -> None:
    attached(monkeypatch, 1, 3)
    LaterSources(options_of("play", "clip.mp4", "--hfov", "60"))(None).close()
    assert opened == [1]


@pytest.mark.usefixtures("opened")
def test_a_camera_that_cannot_be_followed_is_free_again(monkeypatch: pytest.MonkeyPatch) -> None:
    cameras = [FakeSource(is_live=True)]
    attached(monkeypatch, 0)
    monkeypatch.setattr(later_sources, "WebcamSource", lambda *_: cameras[0])
    missing = options_of("play", "clip.mp4", "--camera-file", "gone.json")
    with pytest.raises(UserError, match=r"gone\.json"):
        LaterSources(missing)(None)
    assert cameras[0].closed.is_set()


@pytest.mark.parametrize("numbers", [(), (0,)])
def test_that_there_is_no_other_is_said(monkeypatch: pytest.MonkeyPatch, opened: list[int], numbers) -> None:
    attached(monkeypatch, *numbers)
    with pytest.raises(UserError, match="no other camera is connected"):
        LaterSources(options_of("webcam", "--camera", "0"))(None)
    assert opened == []


def test_a_file_is_played_with_the_flags_of_the_start(tmp_path: Path) -> None:
    PIL.Image.fromarray(PICTURE).save(tmp_path / "a.png")
    pipeline = LaterSources(options_of("webcam", "--marker", "aruco:4x4_50:7", "--hfov", "70"))(tmp_path / "a.png")
    tracked = pipeline.frames.take(PATIENCE_S)
    pipeline.close()
    assert pipeline.marker == "aruco:4x4_50:7"
    assert tracked is not None
    assert tracked.camera.hfov_deg == pytest.approx(70)


def save_photo_of(number: int, path: Path) -> None:
    """Of a marker on grey, seen from above."""
    grey = np.full((480, 640), 190, np.uint8)
    grey[150:290, 80:220] = parse_marker(f"aruco:4x4_50:{number}").bitmap(140)
    PIL.Image.fromarray(np.dstack([cv2.GaussianBlur(grey, (0, 0), 0.8)] * 3)).save(path)


def test_each_file_has_its_own_marker_where_nobody_named_any(tmp_path: Path) -> None:
    for number in (7, 3):
        save_photo_of(number, tmp_path / f"{number}.png")
    first = options_of("play", str(tmp_path / "7.png"), "--hfov", "60")
    with open_source(tmp_path / "7.png") as source:
        chosen = with_marker_in(source, first)
    assert chosen.marker == "aruco:4x4_50:7"
    for options, marker in ((chosen, 3), (with_marker(chosen, "aruco:4x4_50:7"), 7)):
        pipeline = LaterSources(options)(tmp_path / "3.png")
        pipeline.close()
        assert pipeline.marker == f"aruco:4x4_50:{marker}"


def test_no_marker_is_looked_for_in_a_camera_before_it_is_shown() -> None:
    """There may be none yet."""
    options, camera = options_of("webcam", "--hfov", "60"), FakeSource(is_live=True)
    assert with_marker_in(camera, options) is options
    assert camera.reads == 0


def test_files_are_opened_also_where_the_first_one_showed_the_paper_cube(tmp_path: Path) -> None:
    scene = CubeScene(CAMERA, looking(0.4, 45, 30), [sun(200, 35)])
    PIL.Image.fromarray(painted(scene)[..., ::-1]).save(tmp_path / "cube.png")
    save_photo_of(7, tmp_path / "7.png")
    PIL.Image.fromarray(PICTURE).save(tmp_path / "none.png")
    with open_source(tmp_path / "cube.png") as source:
        chosen = with_marker_in(source, options_of("play", str(tmp_path / "cube.png"), "--hfov", "60"))
    assert chosen.marker == "cube"
    for name, marker in (("7", "aruco:4x4_50:7"), ("none", "cube"), ("cube", "cube")):
        pipeline = LaterSources(chosen)(tmp_path / f"{name}.png")
        pipeline.close()
        assert pipeline.marker == marker


def test_beside_the_demo_as_well(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The marker of its own clip is known, that of another is not."""
    shown: list[ViewerSetup] = []
    monkeypatch.setattr(demo, "has_display", lambda: True)
    monkeypatch.setattr(demo, "show_in_window", lambda setup: shown.append(setup) or 0)
    demo.run(options_of("demo"))
    shown[0].source.close()
    save_photo_of(7, tmp_path / "7.png")
    pipeline = LaterSources(shown[0].options)(tmp_path / "7.png")
    pipeline.close()
    assert pipeline.marker == "aruco:4x4_50:7"


def test_trackers_are_made_for_other_markers_and_fields_of_view(tmp_path: Path) -> None:
    calibration = tmp_path / "camera.json"
    calibration.write_text(
        '{"size": [64, 48], "K": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]], "dist": [0, 0, 0, 0, 0]}'
    )
    make = tracker_maker(options_of("play", "clip.mp4", "--camera-file", str(calibration)))
    frame = Frame(PICTURE, 0, 0.0)
    as_given, wide = make(None, None), make("apriltag:36h11:4", 80.0)
    assert (as_given.marker.spec, wide.marker.spec) == ("aruco:4x4_50:0", "apriltag:36h11:4")
    assert as_given.track(frame).camera.K[0, 0] == 50
    assert wide.track(frame).camera.hfov_deg == pytest.approx(80)


def test_trackers_are_made_after_the_files_of_the_flags_have_gone(tmp_path: Path) -> None:
    """A key asks for another tracker at any time."""
    calibration, printed = tmp_path / "camera.json", tmp_path / "print.png"
    calibration.write_text(
        '{"size": [64, 48], "K": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]], "dist": [0, 0, 0, 0, 0]}'
    )
    assert cv2.imwrite(str(printed), parse_marker("aruco:4x4_50:7").bitmap(96))
    make = tracker_maker(
        options_of("play", "clip.mp4", "--camera-file", str(calibration), "--marker", f"image:{printed}")
    )
    calibration.unlink()
    printed.unlink()
    assert make(None, 80.0).marker.spec == f"image:{printed}"
    assert make("aruco:4x4_50:3", None).track(Frame(PICTURE, 0, 0.0)).camera.K[0, 0] == 50


def test_a_cube_that_is_followed_later_needs_no_caster() -> None:
    make = tracker_maker(options_of("play", "clip.mp4", "--hfov", "60", "--caster", "sphere:0.02"))
    assert make("cube", None).marker.spec == "cube"

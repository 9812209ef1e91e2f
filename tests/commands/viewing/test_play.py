"""`ashe-live play --headless`: reproducible, bounded, polite about files, and clear about what is wrong."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import av
import cv2
import jsonschema
import numpy as np
import pytest
from PIL import Image

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.core.contract import SCHEMA
from ashe_live.errors import UserError
from ashe_live.light.live.worker_messages import WorkerFailure
from ashe_live.viewer.output.report import Report
from ashe_live.viewer.view_options import WHOLE
from tests.checkout import CHECKOUT
from tests.commands.conftest import InstantWorker, contract
from tests.shipped_scenes import CASES
from tests.thin_rod import unevenness, write_rod

pytestmark = pytest.mark.usefixtures("instant")
# Ground over the marker takes longer than all else of a short run: it is asked for where it is what a test is about.
HEADLESS = ("--headless", "--hfov", "55", "--quality", "fast", "--no-hide-marker")


def frames_of(path: Path) -> list[np.ndarray]:
    with ClipSource(path) as clip:
        return [frame.image_bgr for frame in clip]


def strongest_difference(a: np.ndarray, b: np.ndarray) -> int:
    """Over small patches, as single pixels suffer from the encoding."""
    patches = [cv2.blur(image, (5, 5)).astype(int) for image in (a, b)]
    return int(np.abs(patches[0] - patches[1]).max())


def size_of(path: Path) -> tuple[int, int]:
    with ClipSource(path) as clip:
        return clip.size


def poses(report: Path) -> list:
    return [frame["T_cam_marker"] for frame in json.loads(report.read_text())["frames"]]


@pytest.fixture
def play(run, film):
    """Plays the film without a window."""
    return lambda *arguments: run("play", film.path, *HEADLESS, *arguments)


def test_twice_gives_the_same_poses_and_the_same_pictures(play, film, tmp_path):
    for name in "ab":
        outcome = play("--out", tmp_path / f"{name}.mp4", "--report", tmp_path / f"{name}.json", "--hide-marker")
        assert outcome.status == 0
        assert outcome.err == []
    assert poses(tmp_path / "a.json") == poses(tmp_path / "b.json")
    first, second = ([frame.tobytes() for frame in frames_of(tmp_path / f"{name}.mp4")] for name in "ab")
    assert first == second
    assert len(first) == len(set(first)) == film.frame_count

    report = json.loads((tmp_path / "a.json").read_text())
    jsonschema.validate(report, contract())
    assert [frame["index"] for frame in report["frames"]] == list(range(film.frame_count))
    assert report["summary"]["found"] == film.frame_count
    assert len(report["estimates"]) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"a.mp4", "b.mp4", "a.json", "b.json"}


def test_the_model_is_drawn_and_lit_from_the_first_frame_on(play, tmp_path):
    play("--out", tmp_path / "cube.mp4", "--estimate-at", 6)
    play("--out", tmp_path / "tree.mp4", "--estimate-at", 6, "--model", "tree")
    play("--out", tmp_path / "unlit.mp4", "--estimate-at", 999)
    cube, tree, unlit = (frames_of(tmp_path / f"{name}.mp4") for name in ("cube", "tree", "unlit"))
    assert all(strongest_difference(a, b) > 60 for a, b in zip(cube, tree, strict=True))
    # What is not lit alike differs by far more than the encoding does.
    assert all(strongest_difference(a, b) > 30 for a, b in zip(cube, unlit, strict=True))


def test_frames_size_and_estimate_at_are_respected(play, tmp_path):
    out, report = tmp_path / "o.mp4", tmp_path / "r.json"
    play("--frames", 8, "--size", "200x150", "--estimate-at", 6, "--out", out, "--report", report)
    assert len(frames_of(out)) == 8
    assert size_of(out) == (200, 150)
    assert [estimate["frame"] for estimate in json.loads(report.read_text())["estimates"]] == [6]


def test_a_loop_needs_an_end_and_goes_on_to_it(play, film, tmp_path):
    assert play("--loop").status == 2
    report = tmp_path / "r.json"
    play("--loop", "--frames", film.frame_count + 3, "--report", report)
    indices = [frame["index"] for frame in json.loads(report.read_text())["frames"]]
    assert indices == [*range(film.frame_count), 0, 1, 2]


def test_an_estimate_that_was_never_asked_for_is_said(play):
    outcome = play("--estimate-at", 500)
    assert "light: not estimated" in outcome.out[-1]
    assert any("500" in line for line in outcome.err)


@pytest.mark.parametrize("option", ["--out", "--report"])
def test_an_existing_file_is_refused_and_left_alone_until_overwrite(play, tmp_path, option):
    path = tmp_path / ("old.mp4" if option == "--out" else "old.json")
    path.write_bytes(b"precious")
    assert "--overwrite" in play("--frames", 2, option, path).refusal
    assert path.read_bytes() == b"precious"
    assert play("--frames", 2, option, path, "--overwrite").status == 0
    assert path.read_bytes() != b"precious"
    assert [left.name for left in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(
    "flags",
    [
        ("--caster", "{}"),
        ("--marker", "image:{}"),
        ("--marker", "cube+image:{}"),
        ("--model", "cube", "--model", "pattern:{}=mug"),
    ],
)
def test_what_a_flag_reads_is_not_replaced_by_an_output(play, tmp_path, flags):
    path = tmp_path / "mine"
    path.write_bytes(b"precious")
    other = tmp_path / "other"
    other.hardlink_to(path)
    for output in (path, other):
        assert "is also read" in play(*(flag.format(path) for flag in flags), "--report", output, "--overwrite").refusal
    assert path.read_bytes() == other.read_bytes() == b"precious"


@pytest.mark.parametrize("flag", [None, "--camera-file", "--as-shown"])
def test_neither_the_clip_nor_a_file_of_a_flag_is_replaced_by_an_output(run, film, tmp_path, flag):
    clip, own = tmp_path / "clip.mp4", tmp_path / ("clip.mp4" if flag is None else "own.json")
    clip.write_bytes(film.path.read_bytes())
    if flag is not None:
        own.write_bytes(film.camera_file.read_bytes())
    before = own.read_bytes()
    read = () if flag is None else (flag, own)
    for output in ("--out", "--report"):
        asked = ("--headless", "--frames", 1, *read, output, own, "--overwrite")
        assert "is also read" in run("play", clip, *asked).refusal
    assert own.read_bytes() == before


def test_the_settings_are_not_replaced_by_an_output(play, run, film, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    settings_path().parent.mkdir()
    settings_path().write_text('model = "mug"')
    commands = (
        lambda *output: play("--frames", 1, "--report", *output),
        lambda *output: run("calibrate", "--headless", "--camera", film.path, "--out", *output),
    )
    for command in commands:
        assert "is also read" in command(settings_path(), "--overwrite").refusal
    assert settings_path().read_text() == 'model = "mug"'


def test_what_a_model_reads_beside_it_is_not_replaced_by_an_output(play, tmp_path):
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    (tmp_path / "m.mtl").write_text("newmtl m\nmap_Kd red.png\n")
    faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    (tmp_path / "a.obj").write_text(f"mtllib m.mtl\nusemtl m\n{faces}")
    model = {"model": str(tmp_path / "a.obj"), "marker": None, "seat": 0, "scale": 1, "turn_rad": 0, "shift_m": [0, 0]}
    frame = {"frame": 0, "models": [model], "estimate": None, "parts": WHOLE.value, "hides_marker": None}
    (tmp_path / "shown.json").write_text(json.dumps({"schema": SCHEMA, "shown": [frame]}))
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for file in ("a.obj", "m.mtl"):  # which that file alone names
        shown = "--as-shown", tmp_path / "shown.json", "--report", tmp_path / file, "--overwrite"
        assert "is also read" in play("--frames", 1, *shown).refusal
    for models in (("a.obj",), ("cube", "a.obj")):
        flags = [word for name in models for word in ("--model", tmp_path / name if name == "a.obj" else name)]
        for flag, file in (("--out", "red.png"), ("--report", "m.mtl")):
            assert "is also read" in play(*flags, "--frames", 1, flag, tmp_path / file, "--overwrite").refusal
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--out", "missing/o.mp4"), "no folder"),
        (("--out", "."), "is a folder"),
        (("--out", "o.avi"), ".mp4"),
        (("--report", "missing/r.json"), "no folder"),
        (("--model", "teapot"), "no model"),
        (("--model", "missing.glb"), "missing.glb"),
    ],
)
def test_what_cannot_be_is_one_line_and_leaves_nothing(play, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert said in play(*arguments).refusal
    assert list(tmp_path.iterdir()) == []


def test_a_model_given_as_the_clip_is_called_one(run, tmp_path):
    (tmp_path / "ball.STL").write_text("solid ball")
    line = run("play", tmp_path / "ball.STL", "--headless").refusal
    assert "ball.STL is a model" in line
    assert "--model" in line


def test_a_malformed_model_is_one_line(play, files):
    assert "broken.glb" in play("--model", files["broken_model"]).refusal


def test_a_calibration_of_another_shape_is_refused(run, film, files):
    assert "aspect ratio" in run("play", film.path, "--headless", "--camera-file", files["tall_camera"]).refusal


def test_a_clip_without_the_marker_is_said_with_status_3(play):
    outcome = play("--marker", "aruco:4x4_50:9")
    assert outcome.status == 3
    assert "aruco:4x4_50:9" in outcome.err[0]


def test_a_photo_is_one_frame(run, files, tmp_path):
    report = tmp_path / "r.json"
    outcome = run("play", files["photo"], *HEADLESS, "--report", report)
    assert outcome.status == 0
    content = json.loads(report.read_text())
    assert len(content["frames"]) == len(content["estimates"]) == 1


def test_a_truncated_clip_is_said_in_one_line(run, files):
    outcome = run("play", files["truncated"], *HEADLESS)
    (line,) = outcome.err
    assert "truncated" in line
    assert outcome.status == 0


def test_picture_and_light_are_kept_though_the_report_finds_no_room(run, files, tmp_path, monkeypatch):
    def refuse(*_):
        raise UserError("cannot write r.json (no room)", "make some")

    monkeypatch.setattr(Report, "write", refuse)
    out = tmp_path / "p.png"
    outcome = run("play", files["photo"], *HEADLESS, "--out", out, "--report", tmp_path / "r.json")
    assert outcome.status == 2
    assert "cannot write r.json" in outcome.err[-1]
    assert "azimuth" in outcome.out[0]
    assert cv2.imread(str(out)) is not None


def test_what_is_thinner_than_a_pixel_is_whole_without_a_window(run, tmp_path):
    """As on a GPU; `fast` has one sample a pixel."""
    cone, rod, uneven = CASES["clean_cone"], write_rod(tmp_path / "rod.obj"), {}
    seen = cone.image_path, "--hfov", f"{cone.camera.hfov_deg}", "--marker", cone.marker_spec
    for quality in ("fast", "balanced"):
        out = tmp_path / f"{quality}.png"
        drawn = "--quality", quality, "--model", rod, "--up", "z", "--layers", "model", "--out", out
        assert run("play", *seen, "--headless", "--no-hide-marker", *drawn).status == 0
        uneven[quality] = unevenness(cv2.imread(str(out), cv2.IMREAD_UNCHANGED)[..., 3])
    assert uneven["balanced"] < 0.3 < uneven["fast"]


def test_a_report_needs_headless(run, film, tmp_path):
    assert "--headless" in run("play", film.path, "--hfov", "55", "--report", tmp_path / "r.json").refusal


def subprocess_run(*arguments: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
    variables_left = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        [sys.executable, "-m", "ashe_live", *map(str, arguments)],
        env={**variables_left, "PYTHONPATH": str(CHECKOUT), **variables},
        capture_output=True,
        text=True,
    )


def test_without_a_display_a_window_is_refused_in_one_line(film):
    done = subprocess_run("play", film.path, "--hfov", "55")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "--headless" in line


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL is Linux's way")
def test_without_opengl_it_says_what_to_install_in_one_line(film, tmp_path):
    done = subprocess_run(
        "play", film.path, *HEADLESS, "--out", tmp_path / "o.mp4", __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere.json"
    )
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "OpenGL" in line
    assert "apt-get install" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL is Linux's way")
def test_without_the_egl_library_it_says_so_too(film):
    done = subprocess_run("play", film.path, *HEADLESS, GLCONTEXT_LINUX_LIBEGL="libnowhere.so")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "OpenGL" in line


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="X11 is Linux's way")
def test_a_display_that_is_not_there_is_one_line(film):
    done = subprocess_run("play", film.path, "--hfov", "55", DISPLAY=":987")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "window" in line


def test_what_is_left_out_of_a_model_is_reported_once(play, tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nl 1 2\n")
    outcome = play("--model", tmp_path / "a.obj", "--up", "-z", "--frames", "2")
    assert outcome.status == 0
    assert [line for line in outcome.err if "a.obj" in line] == ["ashe-live: a.obj: points and lines are left out"]


def test_layers_alone_lie_over_nothing(play, tmp_path):
    out = tmp_path / "over.mov"
    assert play("--out", out, "--layers", "both", "--frames", "2").status == 0
    with av.open(str(out)) as clip:
        first, *_ = (frame.to_ndarray(format="bgra") for frame in clip.decode(video=0))
    assert (first[..., 3] == 0).mean() > 0.3
    assert (first[..., 3] > 250).sum() > 50


def test_the_model_alone_is_without_what_covers_the_marker(play, tmp_path):
    opaque = {}
    for layers in ("both", "model"):
        for flag in ("--hide-marker", "--no-hide-marker"):
            out = tmp_path / f"{layers}{flag}.mov"
            assert play("--out", out, "--layers", layers, flag, "--frames", "1").status == 0
            with av.open(str(out)) as clip:
                (frame, *_) = (each.to_ndarray(format="bgra") for each in clip.decode(video=0))
            opaque[layers, flag] = int((frame[..., 3] > 250).sum())
    assert opaque["both", "--hide-marker"] > 1.2 * opaque["both", "--no-hide-marker"]
    assert opaque["model", "--hide-marker"] == opaque["model", "--no-hide-marker"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--layers", "both"), "--layers are written without a window"),
        (("--layers", "model", "--out", "a.mp4"), "let its name end in .mov (ProRes 4444)"),
        (("--layers", "glow", "--out", "a.mov"), "invalid choice"),
    ],
)
def test_layers_need_a_clip_that_can_hold_them(play, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert said in play(*arguments).refusal
    assert list(tmp_path.glob("a.*")) == []


def write_sheet(path: Path, tops: dict[int, tuple[int, int]], family: int) -> tuple[np.ndarray, int]:
    """A picture of markers, seen from straight above, and their side in pixels; `tops`: rows and columns by numbers."""
    sheet, side = np.full((480, 640, 3), 235, np.uint8), 110
    dictionary = cv2.aruco.getPredefinedDictionary(family)
    for number, (top, left) in tops.items():
        marker = cv2.aruco.generateImageMarker(dictionary, number, side)
        sheet[top : top + side, left : left + side] = marker[..., None]
    cv2.imwrite(str(path), sheet)
    return sheet, side


def test_a_model_without_a_number_stands_on_the_marker_in_view_that_has_none(run, tmp_path):
    """Nobody names a marker: 5 is followed, as 3 has a model of its own, and both are of the family in the picture."""
    tops = {5: (185, 100), 3: (185, 400)}
    sheet, side = write_sheet(tmp_path / "sheet.png", tops, cv2.aruco.DICT_APRILTAG_36h11)
    out = tmp_path / "out.png"
    named = ("--model", "tree", "--model", "3=mug")
    outcome = run("play", tmp_path / "sheet.png", *HEADLESS, *named, "--out", out)
    assert outcome.status == 0
    assert any("apriltag:36h11:5 is in view and is followed" in line for line in outcome.err)
    change = np.abs(cv2.imread(str(out)).astype(int) - sheet).max(axis=2)
    for top, left in tops.values():
        assert change[top : top + side, left : left + side].mean() > 20


@pytest.mark.parametrize("broken", ["model", "display"])
def test_an_error_is_said_alone(run, tmp_path, monkeypatch, broken):
    """And not after what was found in a picture that is then not shown."""
    write_sheet(tmp_path / "sheet.png", {5: (185, 265)}, cv2.aruco.DICT_APRILTAG_36h11)
    (tmp_path / "model.obj").write_text("no mesh")
    monkeypatch.setattr("ashe_live.commands.viewing.window.has_display", lambda: False)
    asked = (*HEADLESS, "--model", tmp_path / "model.obj") if broken == "model" else ()
    assert broken in run("play", tmp_path / "sheet.png", *asked).refusal


@pytest.mark.parametrize(("kind", "written"), [("photo", "FILE.png"), ("film", "VIDEO.mp4")])
def test_without_a_display_it_is_said_what_may_be_written_instead(run, tmp_path, film, monkeypatch, kind, written):
    write_sheet(tmp_path / "sheet.png", {0: (185, 265)}, cv2.aruco.DICT_4X4_50)
    played = film.path if kind == "film" else tmp_path / "sheet.png"
    monkeypatch.setattr("ashe_live.commands.viewing.window.has_display", lambda: False)
    line = run("play", played, "--hfov", "55").refusal
    assert line.endswith(f"give --headless --out {written}")
    assert run("play", played, *HEADLESS, "--out", tmp_path / written).status == 0


@pytest.mark.parametrize("shown", [True, False])
def test_a_model_whose_own_marker_no_picture_shows_is_named(run, tmp_path, shown):
    tops = {0: (185, 80), **({7: (185, 400)} if shown else {})}
    write_sheet(tmp_path / "sheet.png", tops, cv2.aruco.DICT_4X4_50)
    models = "--marker=aruco:4x4_50:0", "--model=cube", "--model=7=cube"
    outcome = run("play", tmp_path / "sheet.png", *HEADLESS, *models)
    assert outcome.status == 0
    told = ["ashe-live: no picture shows aruco:4x4_50:7: what stands there is not drawn"]
    assert [line for line in outcome.err if "no picture" in line] == ([] if shown else told)


def test_what_was_measured_or_assumed_of_a_camera_that_nobody_gave_is_said(run, files, tmp_path):
    write_sheet(tmp_path / "from_above.png", {0: (185, 265)}, cv2.aruco.DICT_4X4_50)
    for photo, said in ((files["photo"], "the marker"), (tmp_path / "from_above.png", "degrees are assumed")):
        unknown = "play", photo, *(flag for flag in HEADLESS if flag not in ("--hfov", "55"))
        (line,) = run(*unknown).err
        assert said in line
        assert run(*unknown, "--hfov", "55").err == []


def test_an_estimate_that_failed_is_said_at_the_end(run, files, monkeypatch):
    monkeypatch.setattr(InstantWorker, "wait", lambda *_: WorkerFailure(0, "no answer in 120 s"))
    outcome = run("play", files["photo"], *HEADLESS)
    assert outcome.err == ["ashe-live: the estimate failed: no answer in 120 s"]
    assert "light: not estimated" in outcome.out[0]


def test_a_model_stands_on_each_marker(run, tmp_path):
    """Two markers on a sheet seen from straight above: each model covers its own, and the one without a model stays."""
    tops = {0: (185, 60), 7: (185, 265), 9: (185, 470)}
    sheet, side = write_sheet(tmp_path / "sheet.png", tops, cv2.aruco.DICT_4X4_50)
    pictures = []
    for number, models in enumerate((["0=cube"], ["0=cube", "7=mug"])):
        out = tmp_path / f"{number}.mp4"
        named = [word for model in models for word in ("--model", model)]
        assert run("play", tmp_path / "sheet.png", *HEADLESS, *named, "--out", out).status == 0
        pictures.append(frames_of(out)[0].astype(int))
    change = np.abs(pictures[1] - pictures[0]).max(axis=2)
    changed = {number: change[top : top + side, left : left + side].mean() for number, (top, left) in tops.items()}
    assert changed[7] > 20
    assert changed[9] < 2
    assert np.abs(pictures[0] - sheet)[185:295, 60:170].mean() > 20


def test_a_photo_becomes_a_picture_with_and_without_what_it_shows(run, film, tmp_path):
    """Both layers, with their transparency, over the photo give the picture itself."""
    photo = frames_of(film.path)[0]
    cv2.imwrite(str(tmp_path / "photo.png"), photo)
    whole, layers = tmp_path / "whole.png", tmp_path / "layers.png"
    for arguments in (("--out", whole), ("--out", layers, "--layers", "both")):
        assert run("play", tmp_path / "photo.png", *HEADLESS, "--hide-marker", *arguments).status == 0
    drawn = cv2.imread(str(layers), cv2.IMREAD_UNCHANGED).astype(float)
    cover = drawn[..., 3:] / 255
    assert 0 < cover.mean() < 1
    over = drawn[..., :3] * cover + photo * (1 - cover)
    shown = cv2.imread(str(whole), cv2.IMREAD_UNCHANGED)
    assert shown.shape == photo.shape
    assert np.abs(over - shown).max() <= 2


def test_a_name_of_another_kind_is_refused_before_anything_is_read(run, tmp_path):
    outcome = run("play", tmp_path / "gone.mp4", *HEADLESS, "--out", "a.avi")
    assert "a.avi is of no kind that is recorded: let its name end in .mp4" in outcome.refusal


@pytest.mark.usefixtures("heeds_signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_play_that_is_asked_to_end_keeps_its_report(play, tmp_path, monkeypatch, number):
    report, add = tmp_path / "r.json", Report.add_frame

    def add_and_ask(self, *args) -> None:
        add(self, *args)
        if len(self.frames) == 3:
            signal.raise_signal(number)

    monkeypatch.setattr(Report, "add_frame", add_and_ask)
    outcome = play("--loop", "--frames", 100, "--size", "200x150", "--report", report)
    assert outcome.status == 128 + number
    assert len(json.loads(report.read_text())["frames"]) == 3
    assert any("r.json (3 frames)" in line for line in outcome.err)


@pytest.mark.parametrize("is_renamed", [False, True])
def test_it_is_said_where_a_recording_is_whose_name_was_taken_or_whose_folder_was_renamed(
    play, tmp_path, monkeypatch, is_renamed
):
    before, after, add = tmp_path / "before", tmp_path / "after", Report.add_frame
    before.mkdir()

    def add_and_come_between(self, *args) -> None:
        add(self, *args)
        if is_renamed:
            before.rename(after)
        else:
            (before / "o.mp4").write_text("precious")

    monkeypatch.setattr(Report, "add_frame", add_and_come_between)
    outcome = play("--size", "200x150", "--frames", 1, "--out", before / "o.mp4")
    assert outcome.status == 0
    (line,) = outcome.err
    recorded = after / "o.mp4" if is_renamed else before / "o-2.mp4"
    assert line.endswith(f"was renamed meanwhile: see {recorded}" if is_renamed else f"stays as it is: see {recorded}")
    assert len(frames_of(recorded)) == 1


@pytest.mark.parametrize("flags", [("o.mp4",), ("o.mov", "--layers", "both")])
def test_what_was_recorded_until_its_clip_was_gone_is_kept(run, film, tmp_path, monkeypatch, flags):
    """As with a camera that is unplugged: an hour of poses, and of pictures, was lost with it."""
    out, report, clip, add = tmp_path / flags[0], tmp_path / "r.json", tmp_path / "clip.mp4", Report.add_frame
    clip.write_bytes(film.path.read_bytes())

    def add_and_lose(self, *args) -> None:
        add(self, *args)
        clip.unlink(missing_ok=True)

    monkeypatch.setattr(Report, "add_frame", add_and_lose)
    size = "--size", "200x150", "--loop", "--frames", 100
    outcome = run("play", clip, *HEADLESS, *size, "--report", report, "--out", out, *flags[1:])
    assert outcome.status == 2
    assert len(frames_of(out)) == len(json.loads(report.read_text())["frames"]) == film.frame_count
    for file in (out, report):
        assert any(f"saved {file} ({film.frame_count} frames)" in line for line in outcome.err)
    assert sum("there is no file" in line for line in outcome.err) == 1


def test_of_a_full_disk_is_said_once(play, tmp_path, monkeypatch):
    """Of the recording; the report that goes with it finds room or does not."""

    def full(self, *_args) -> None:
        raise UserError(f"cannot write {self.path} (No space left on device)", "make room")

    def refused(*_args) -> None:
        raise UserError("cannot write r.json (No space left on device)", "make room")

    monkeypatch.setattr(Recorder, "write", full)
    monkeypatch.setattr(Report, "write", refused)
    outcome = play("--frames", 3, "--out", tmp_path / "o.mp4", "--report", tmp_path / "r.json")
    assert "o.mp4 (No space left" in outcome.refusal

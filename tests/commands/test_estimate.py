"""`ashe-live estimate`: one line a file, whatever the file; the exit status; the contract."""

import base64
import re
import resource
import shutil
import signal
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.commands.flags.option_groups import DEFAULT_ESTIMATOR
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.drawing.light_text import light_text
from ashe_live.light.estimators import estimator
from ashe_live.tracking.families.markers import parse_marker
from tests.commands.conftest import InstantEstimator

pytestmark = pytest.mark.usefixtures("instant")
KNOWN = ("--hfov", "55")
BASE64 = re.compile(r"data:image/jpeg;base64,([^\"]+)")


def test_a_photo_is_answered(run, files):
    outcome = run("estimate", "--json", *KNOWN, files["photo"])
    (record,) = outcome.records
    assert outcome.status == 0
    assert outcome.err == []
    assert record["marker"]["found"]
    assert record["marker"]["reprojection_rms_px"] < 1
    assert record["camera"]["source"] == "flag"
    assert record["light"] == record["lights"][0]
    assert record["timing_ms"]["detect"] > 0
    assert record["timing_ms"]["total"] == pytest.approx(record["timing_ms"]["detect"] + 1.0)


def test_the_pose_is_the_true_one(run, files, film):
    (record,) = run("estimate", "--json", "--camera-file", film.camera_file, files["photo"]).records
    eye = -np.array(record["marker"]["T_cam_marker"])[:3, :3].T @ np.array(record["marker"]["T_cam_marker"])[:3, 3]
    angle = np.radians(-100)
    np.testing.assert_allclose(eye, (0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.4), atol=0.015)
    assert record["camera"]["source"] == "file"


def test_a_model_is_not_taken_for_a_damaged_clip(run, tmp_path):
    model = tmp_path / "ball.STL"
    model.write_bytes(b"solid ball")
    assert "ball.STL is a model" in run("estimate", *KNOWN, model).refusal


def test_files_of_a_folder_in_which_there_is_no_marker_share_a_line(run, files, tmp_path):
    """In JSON, and where they are named, each has its own."""
    for name in ("a.png", "c.png", "d.png"):
        shutil.copy(files["empty_table"], tmp_path / name)
    shutil.copy(files["photo"], tmp_path / "b.png")
    outcome = run("estimate", *KNOWN, tmp_path)
    assert outcome.status == 3
    answer, others = outcome.out
    assert "azimuth" in answer
    assert [name in others for name in ("a.png", "b.png", "c.png", "d.png")] == [True, False, True, True]
    assert len(run("estimate", *KNOWN, tmp_path / "a.png", tmp_path / "c.png").out) == 2
    assert len(run("estimate", *KNOWN, "--json", tmp_path).records) == 4


def test_a_short_name_stands_before_its_answer_as_any_other(run, files, tmp_path, monkeypatch):
    """Though its letters are in what is said of it."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(files["empty_table"], "n")
    Path("d").mkdir()
    empty_table, folder, missing = run("estimate", *KNOWN, "n", "d", "x").out
    assert empty_table.startswith("n: no marker found")
    assert folder.startswith("d: there is no photo")
    assert missing.startswith("there is no file x")


def test_equal_markers_are_reported(run, files, tmp_path):
    twice = tmp_path / "twice.png"
    cv2.imwrite(str(twice), np.tile(cv2.imread(str(files["photo"])), (1, 2, 1)))
    (said,) = (line for line in run("estimate", *KNOWN, twice).err if "equal markers" in line)
    assert "twice.png" in said


def test_every_light_is_named(run, files, monkeypatch):
    lights = Light((0.0, 0.3, 1.0)), Light((1.0, 0.0, 1.0))
    made = estimator.ESTIMATORS[DEFAULT_ESTIMATOR]

    def two(preset):
        class Two(type(made(preset))):
            def estimate(self, tracked, others=()):
                return replace(super().estimate(tracked, others), illumination=Illumination(lights))

        return Two()

    monkeypatch.setitem(estimator.ESTIMATORS, DEFAULT_ESTIMATOR, two)
    (line,) = run("estimate", *KNOWN, files["photo"]).out
    assert all(light_text(light, decimals=1) in line for light in lights)


def test_without_a_light_the_status_is_4(run, files, go_dark):
    go_dark()
    outcome = run("estimate", "--json", *KNOWN, files["photo"])
    (record,) = outcome.records
    assert outcome.status == 4
    assert record["light"]["kind"] == "none"
    assert record["light"]["reason"] == "no shadow found beside the object"
    assert record["lights"] == []
    assert "no clear light: no shadow" in run("estimate", *KNOWN, files["photo"]).out[0]


def test_without_a_marker_the_status_is_3(run, files):
    outcome = run("estimate", "--json", *KNOWN, files["empty_table"])
    (record,) = outcome.records
    assert outcome.status == 3
    assert record["error"] is None
    assert not record["marker"]["found"]
    assert run("estimate", *KNOWN, files["empty_table"]).out[0].count("no marker found: ") == 1


NAMES = {"missing": "no.mp4", "pattern": "*.jpg", "folder": "folder", "empty": "empty.mp4"}


@pytest.mark.parametrize("name", ["garbage", *NAMES])
def test_an_unreadable_file_is_a_line_too_and_status_2(run, tmp_path, files, name):
    (tmp_path / "empty.mp4").touch()
    (tmp_path / "folder").mkdir()
    path = files["garbage"] if name == "garbage" else tmp_path / NAMES[name]
    outcome = run("estimate", "--json", *KNOWN, path)
    (record,) = outcome.records
    assert outcome.status == 2
    assert record["file"] == str(path)
    assert record["error"]
    assert "\n" not in record["error"]
    assert record["marker"] is record["camera"] is record["frame"] is None
    assert run("estimate", *KNOWN, path).out[0].count(str(path)) == 1


def test_an_address_is_named_once_and_as_it_was_given(run):
    address = "https://example.org/a.jpg"
    (line,) = run("estimate", *KNOWN, address).out
    assert line.startswith(f"{address} is an address, and nothing is fetched")
    assert line.count("example.org") == 1
    (record,) = run("estimate", "--json", *KNOWN, address).records
    assert record["file"] == address


@pytest.mark.parametrize(
    ("names", "status"),
    [
        (("photo", "photo"), 0),
        (("photo", "empty_table", "photo"), 3),
        (("photo", "garbage", "empty_table"), 2),
        (("empty_table", "garbage"), 2),
    ],
)
def test_of_several_files_the_worst_counts(run, files, names, status):
    outcome = run("estimate", "--json", *KNOWN, *(files[name] for name in names))
    assert [record["file"] for record in outcome.records] == [str(files[name]) for name in names]
    assert outcome.status == status


def test_no_light_is_worse_than_an_answer_and_better_than_no_marker(run, files, go_dark):
    go_dark()
    assert run("estimate", *KNOWN, files["photo"], files["photo"]).status == 4
    assert run("estimate", *KNOWN, files["photo"], files["empty_table"]).status == 3


@pytest.fixture
def fail_on_dark(monkeypatch):
    """From its call on, the estimator raises this on dark pictures."""

    def fail(error):
        made = estimator.ESTIMATORS[DEFAULT_ESTIMATOR]

        def failing(preset):
            class Failing(type(made(preset))):
                def estimate(self, tracked, others=()):
                    if tracked.frame.image_bgr.mean() < 60:
                        raise error
                    return super().estimate(tracked, others)

            return Failing()

        monkeypatch.setitem(estimator.ESTIMATORS, DEFAULT_ESTIMATOR, failing)

    return fail


@pytest.fixture
def folder(files, tmp_path):
    """Four photos, of which the second and the third are dark."""
    photo = cv2.imread(str(files["photo"]))
    for name, scale in {"a": 1.0, "b": 0.3, "c": 0.3, "d": 1.0}.items():
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.uint8(photo * scale))
    return tmp_path


def test_a_fault_on_one_picture_is_its_line_and_status_1_and_the_others_are_answered(run, folder, fail_on_dark):
    fail_on_dark(IndexError("index 3\x1b[31m is out of bounds\nand more"))
    sheet = folder / "sheet.html"
    outcome = run("estimate", "--json", *KNOWN, folder, "--sheet", sheet)
    assert outcome.status == 1
    a, b, c, d = (record["error"] for record in outcome.records)
    assert a is None
    assert d is None
    assert b == c
    assert "IndexError: index 3" in b
    assert "test_estimate.py, line" in b
    # The traceback of one and the same fault is shown once, and nothing in it reaches the terminal as a sequence.
    assert sum(line.startswith("Traceback") for line in outcome.err) == 1
    assert any("IndexError" in line for line in outcome.err)
    assert all(line.isprintable() for line in outcome.err)
    page = sheet.read_text()
    assert len(BASE64.findall(page)) == 2
    assert page.count("IndexError") == 2


def test_what_a_picture_alone_is_to_blame_for_is_its_line_without_a_traceback(run, folder, fail_on_dark):
    fail_on_dark(MemoryError())
    outcome = run("estimate", *KNOWN, folder)
    assert outcome.status == 2
    assert ["not enough memory" in line for line in outcome.out] == [False, True, True, False]
    assert outcome.err == []


def test_a_fault_on_pictures_taken_together_is_one_line_of_them(run, folder, fail_on_dark):
    fail_on_dark(KeyError("lost"))
    outcome = run("estimate", *KNOWN, folder / "b.png", folder / "c.png", "--together")
    assert outcome.status == 1
    (line,) = outcome.out
    assert line.startswith(str(folder / "b.png"))
    assert "KeyError" in line


def test_of_a_clip_the_first_steady_frame_is_used_or_the_asked_one(run, film):
    (record,) = run("estimate", "--json", *KNOWN, film.path).records
    assert 0 < record["frame"] < film.frame_count
    (record,) = run("estimate", "--json", *KNOWN, "--estimate-at", 7, film.path).records
    assert record["frame"] == 7


def test_a_frame_that_the_clip_does_not_have_is_refused(run, film):
    assert f"from 0 to {film.frame_count - 1}" in run("estimate", *KNOWN, "--estimate-at", 500, film.path).refusal


@pytest.mark.parametrize(("frames", "at"), [("0:0", 5), ("3:6", 2), ("3:6", 7)])
def test_a_frame_beyond_those_to_look_at_is_refused(run, film, frames, at):
    outcome = run("estimate", *KNOWN, "--frames", frames, "--estimate-at", at, film.path)
    assert f"--estimate-at {at} is not within --frames" in outcome.refusal


def test_a_truncated_clip_is_used_as_far_as_it_goes(run, files):
    outcome = run("estimate", "--json", *KNOWN, files["truncated"])
    (record,) = outcome.records
    assert (outcome.status, record["error"]) == (0, None)
    assert "truncated" in "".join(outcome.err)


def test_a_calibration_of_another_shape_is_refused(run, files):
    assert "aspect ratio" in run("estimate", "--camera-file", files["tall_camera"], files["photo"]).refusal


def test_a_calibration_of_the_same_shape_is_rescaled(run, files, tmp_path):
    camera = tmp_path / "large.json"
    camera.write_text('{"size": [640, 480], "K": [[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]], "dist": []}')
    (record,) = run("estimate", "--json", "--camera-file", camera, files["photo"]).records
    np.testing.assert_allclose(record["camera"]["K"], [[300, 0, 159.5], [0, 300, 119.5], [0, 0, 1]])


def test_a_field_of_view_that_the_marker_tells_is_not_said_to_be_assumed(run, files):
    outcome = run("estimate", "--json", files["photo"], files["photo"])
    assert [record["camera"]["source"] for record in outcome.records] == ["estimated", "estimated"]
    # The marker in the photo tells more than what is assumed of any camera.
    assert all(0 < record["camera"]["focal_sigma_px"] < 0.2 * record["camera"]["K"][0][0] for record in outcome.records)
    assert outcome.err == []


def test_an_assumed_field_of_view_is_announced_once(run, tmp_path):
    photo = tmp_path / "from_above.png"
    picture = np.full((480, 640), 200, np.uint8)
    picture[150:330, 230:410] = parse_marker("aruco:4x4_50:0").bitmap(180)
    cv2.imwrite(str(photo), picture)
    outcome = run("estimate", "--json", photo, photo)
    assert [record["camera"]["source"] for record in outcome.records] == ["assumed", "assumed"]
    (line,) = outcome.err
    assert "60 degrees are assumed" in line


def test_repeat_gives_medians_of_the_same_answer(run, files):
    (record,) = run("estimate", "--json", *KNOWN, "--repeat", 3, files["photo"]).records
    assert record["timing_ms"]["fit"] == 1.0
    assert record["timing_ms"]["segment"] is None


def test_the_answer_of_repeated_estimates_is_the_one_without(run, film, monkeypatch):
    """Also where frames before it have a part in its pose, which a marker that is looked for anew does not have."""

    def as_seen(self, tracked, others=()):  # noqa: ARG001
        light = Light(-tracked.marker.T_cam_marker[2, :3])
        return LightEstimate(
            self.name, tracked.frame.index, Illumination((light,)), timing_ms={"fit": 1.0, "total": 1.0}
        )

    monkeypatch.setattr(InstantEstimator, "estimate", as_seen)
    asked = "estimate", "--json", "--estimate-at", 11, film.path
    (once,), (again,) = run(*asked).records, run(*asked, "--repeat", 2).records
    for record in (once, again):
        del record["timing_ms"]
    assert again == once


def test_the_steps_of_every_estimate_are_kept_on_sheets_of_their_own(run, files, tmp_path):
    folder = tmp_path / "new" / "steps"
    for runs in (1, 2):
        outcome = run("estimate", "--json", *KNOWN, "--debug", folder, files["photo"], files["empty_table"])
        assert outcome.status == 3
        assert len(outcome.records) == 2
        sheets = list(folder.iterdir())
        assert len(sheets) == runs  # none without a marker
        assert all(cv2.imread(str(sheet)).shape[1] >= 960 for sheet in sheets)
    assert any(str(sheet) in outcome.err[0] for sheet in sheets)


def test_an_answer_is_given_though_its_steps_find_no_room(run, files, tmp_path):
    """A full disk is not known before something is written."""
    folder = tmp_path / "steps"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))
    try:
        outcome = run("estimate", "--json", *KNOWN, "--debug", folder, files["photo"], files["photo"])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert outcome.status == 2
    assert [record["light"] is not None for record in outcome.records] == [True, True]
    assert [line for line in outcome.err if "without its steps: cannot write" in line] == outcome.err
    assert list(folder.iterdir()) == []


def test_steps_that_cannot_be_kept_are_refused_before_anything_is_estimated(run, files):
    assert "is a file, not a folder" in run("estimate", *KNOWN, "--debug", files["photo"], files["photo"]).refusal


def test_no_folder_for_steps_is_made_where_there_are_none(run, files, tmp_path):
    """Neither where something else is wrong, nor where no picture has a marker."""
    folder, sheet = tmp_path / "new" / "steps", tmp_path / "page.html"
    sheet.write_text("mine")
    steps = ("estimate", *KNOWN, "--debug", folder)
    assert run(*steps, "--sheet", sheet, files["photo"]).status == 2
    assert run(*steps, "--together", files["photo"]).status == 2
    assert run(*steps, tmp_path / "gone.png").status == 2
    assert run(*steps, files["empty_table"]).status == 3
    assert not folder.parent.exists()


def test_a_sheet_may_lie_in_the_new_folder_of_the_steps_and_not_be_it(run, files, tmp_path):
    folder = tmp_path / "new.html"
    steps = ("estimate", *KNOWN, "--debug", folder, files["photo"], "--sheet")
    assert run(*steps, folder).status == 2
    assert not folder.exists()
    assert run(*steps, folder / "page.html").status == 0
    assert (folder / "page.html").exists()
    assert len(list(folder.glob("*.png"))) == 1


def test_a_folder_and_a_pattern_stand_for_the_pictures_in_them(run, files, film, tmp_path):
    for name in ("b.png", "a.PNG", ".hidden.png", "notes.txt", "sub.png/inner.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(files["photo"], tmp_path / name)
    shutil.copy(film.path, tmp_path / "c.mp4")

    def answered(*names):
        outcome = run("estimate", "--json", *KNOWN, *names)
        assert outcome.status == 0
        said.extend(outcome.err)
        return [str(Path(record["file"]).relative_to(tmp_path)) for record in outcome.records]

    said: list[str] = []
    assert answered(tmp_path) == ["a.PNG", "b.png", "c.mp4"]
    assert [line for line in said if line.endswith("photos or clips: notes.txt")]
    assert answered(tmp_path / "?.png", files["photo"].parent / "../" / tmp_path / "c.mp4") == ["b.png", "c.mp4"]
    assert answered(tmp_path / "**" / "inner.*") == ["sub.png/inner.png"]


@pytest.mark.parametrize(
    ("pattern", "matched"),
    [
        ("../photos/*.png", ["../photos/a.png"]),
        ("../.taken/*.png", ["../.taken/b.png"]),
        ("../.taken/.*.png", ["../.taken/.c.png"]),
        ("../**/*.png", ["../photos/a.png"]),
    ],
)
def test_a_pattern_matches_hidden_files_only_where_it_says_so(run, files, tmp_path, monkeypatch, pattern, matched):
    """As those that macOS writes beside each photo on a card."""
    for name in ("photos/a.png", "photos/._a.png", ".taken/b.png", ".taken/.c.png", "here/notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(files["photo"], tmp_path / name)
    monkeypatch.chdir(tmp_path / "here")
    outcome = run("estimate", "--json", *KNOWN, pattern)
    assert [record["file"] for record in outcome.records] == matched


def test_a_file_whose_name_looks_like_a_pattern_is_that_file(run, files, tmp_path):
    for name in ("cup[1].png", "cup1.png"):
        shutil.copy(files["photo"], tmp_path / name)
    (record,) = run("estimate", "--json", *KNOWN, tmp_path / "cup[1].png").records
    assert record["file"].endswith("cup[1].png")


def test_the_sheet_has_a_picture_of_every_file_that_has_one_and_escapes_what_it_says(run, files, tmp_path):
    named = tmp_path / "<b>&amp;.png"
    shutil.copy(files["photo"], named)
    sheet = tmp_path / "sheet.html"
    outcome = run("estimate", *KNOWN, "--sheet", sheet, named, files["garbage"], files["empty_table"])
    assert outcome.status == 2
    text = sheet.read_text(encoding="utf-8")
    assert text.count("<figure>") == 3
    pictures = [cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), 1) for data in BASE64.findall(text)]
    assert [picture.shape for picture in pictures] == [(240, 320, 3)] * 2
    photo, drawn = cv2.imread(str(files["photo"])), pictures[0]
    assert (np.abs(drawn.astype(int) - photo).max(axis=2) > 60).any()  # the arrow
    assert "&lt;b&gt;&amp;amp;.png" in text
    assert "<b>" not in text
    assert "no marker found" in text
    assert not re.search(r"""(src|href)=["'](?!data:)""", text)


@pytest.mark.parametrize("flags", [("--caster", "{}"), ("--marker", "pattern:{}"), ("--marker", "cube+image:{}")])
def test_what_a_flag_reads_is_not_replaced_by_the_sheet(run, files, tmp_path, flags):
    path, other = tmp_path / "mine.html", tmp_path / "other.html"
    path.write_bytes(b"precious")
    other.hardlink_to(path)
    for sheet in (path, other):
        named = (flag.format(path) for flag in flags)
        outcome = run("estimate", *KNOWN, files["photo"], *named, "--sheet", sheet, "--overwrite")
        assert "is also read" in outcome.refusal
    assert path.read_bytes() == other.read_bytes() == b"precious"


def test_a_batch_that_is_interrupted_leaves_a_sheet_of_what_was_answered(run, folder, fail_on_dark):
    sheet = folder / "sheet.html"
    fail_on_dark(KeyboardInterrupt())
    outcome = run("estimate", *KNOWN, folder, "--sheet", sheet)
    assert outcome.status == 130
    assert len(outcome.out) == len(BASE64.findall(sheet.read_text())) == 1


@pytest.mark.usefixtures("heeds_signals")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_batch_that_is_asked_to_end_leaves_a_sheet_too(run, folder, monkeypatch, number):
    """As by a terminal that is closed."""
    sheet = folder / "sheet.html"
    estimate = InstantEstimator.estimate

    def asked(self, tracked, others=()):
        if tracked.frame.image_bgr.mean() < 60:
            signal.raise_signal(number)
        return estimate(self, tracked, others)

    monkeypatch.setattr(InstantEstimator, "estimate", asked)
    outcome = run("estimate", *KNOWN, folder, "--sheet", sheet)
    assert outcome.status == 128 + number
    assert len(outcome.out) == len(BASE64.findall(sheet.read_text())) == 1


@pytest.mark.parametrize("name", ["sheet.pdf", "sheet.png", "sheet"])
def test_a_sheet_that_is_not_named_as_a_page_is_refused(run, files, tmp_path, name):
    assert "let its name end in .html" in run("estimate", *KNOWN, "--sheet", tmp_path / name, files["photo"]).refusal
    assert list(tmp_path.iterdir()) == []


def test_a_sheet_is_not_overwritten_unasked(run, files, tmp_path):
    sheet = tmp_path / "sheet.html"
    sheet.write_text("mine")
    assert "--overwrite" in run("estimate", *KNOWN, "--sheet", sheet, files["photo"]).refusal
    assert sheet.read_text() == "mine"
    assert run("estimate", *KNOWN, "--sheet", sheet, "--overwrite", files["photo"]).status == 0
    assert "<figure>" in sheet.read_text(encoding="utf-8")


def test_a_pattern_ends_where_links_lead_back_to_their_folder(run, tmp_path, monkeypatch):
    """Two such links make as many paths as there are ways to alternate between them."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "photos"
    folder.mkdir()
    for name in ("a", "b"):
        (folder / name).symlink_to(".")
    (folder / "note.txt").write_text("no picture")
    (folder / ".hidden.txt").write_text("no picture")
    outcome = run("estimate", "photos/**/*.txt")
    (line,) = outcome.out
    assert line.startswith("photos/note.txt is not a clip")

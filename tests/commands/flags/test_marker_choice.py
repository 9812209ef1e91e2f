"""Where nobody names a marker, the one that is in view is followed; else it is said which ones there are."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture.recording.recorder import Recorder
from ashe_live.commands.flags.marker_choice import SHOW_IT
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.families.seen_instead import ALL_BLACK, ALL_WHITE
from tests.shipped_scenes import FOLDER

pytestmark = pytest.mark.usefixtures("instant")
OTHER = "aruco:5x5_50:9"


@pytest.fixture
def photo(tmp_path):
    """Of prints on grey, seen from above."""

    def photo(*specs: str) -> str:
        grey = np.full((480, 640), 190, np.uint8)
        for place, spec in enumerate(specs):
            grey[150:290, 80 + 240 * place : 220 + 240 * place] = parse_marker(spec).bitmap(140)
        path = tmp_path / "photo.png"
        assert cv2.imwrite(str(path), cv2.GaussianBlur(grey, (0, 0), 0.8))
        return str(path)

    return photo


def test_the_one_marker_in_view_is_followed(run, photo):
    outcome = run("estimate", photo(OTHER), "--hfov", "60", "--json")
    assert outcome.status == 0
    assert outcome.records[0]["marker"]["found"], outcome
    assert f"{OTHER} is in view and is followed, as no --marker was given" in " ".join(outcome.err)


def test_of_many_photos_with_that_marker_it_is_said_once(run, photo, tmp_path):
    first = Path(photo(OTHER))
    shutil.copy(first, tmp_path / "again.png")
    outcome = run("estimate", first, tmp_path / "again.png", "--hfov", "60", "--json")
    assert [record["marker"]["found"] for record in outcome.records] == [True, True]
    assert sum("is followed" in line for line in outcome.err) == 1


def test_the_usual_marker_is_followed_whatever_else_is_in_view(run, photo):
    outcome = run("estimate", photo("aruco:4x4_50:0", OTHER), "--hfov", "60", "--json")
    assert outcome.records[0]["marker"]["found"], outcome
    assert "is followed" not in " ".join(outcome.err)


def test_of_several_none_is_taken(run, photo):
    outcome = run("estimate", photo(OTHER, "apriltag:36h11:5"), "--hfov", "60")
    assert outcome.status == 3
    assert "choose one, as by --marker " in " ".join(outcome.err)
    assert OTHER in " ".join(outcome.out)
    assert "apriltag:36h11:5" in " ".join(outcome.out)


def test_a_marker_that_is_named_is_never_replaced_and_what_is_there_is_said(run, photo):
    outcome = run("estimate", photo(OTHER), "--hfov", "60", "--marker", "aruco:4x4_50:3")
    assert outcome.status == 3
    assert f"{OTHER} is in view: --marker {OTHER}" in " ".join(outcome.out)
    record = json.loads(run("estimate", photo(OTHER), "--hfov", "60", "--marker", "aruco:4x4_50:3", "--json").out[0])
    assert record["markers_in_view"] == [OTHER]


def test_a_marker_that_is_named_and_not_there_is_named_in_the_answer(run, photo):
    """Also where no other is there; one that nobody has named is not."""
    wanted, headless = "aruco:4x4_50:3", ("--headless", "--quality", "fast")
    for there in ((), (OTHER,)):
        for command in (["estimate", photo(*there)], ["play", photo(*there), *headless]):
            outcome = run(*command, "--hfov", "60", "--marker", wanted)
            assert outcome.status == 3
            assert f"photo.png: the marker {wanted} was not found: " in " ".join([*outcome.out, *outcome.err])
    cube = run("estimate", photo(), "--hfov", "60", "--marker", "cube")
    assert "photo.png: the paper cube was not found: " in " ".join(cube.out)
    for command in (["estimate", photo()], ["play", photo(), *headless]):
        outcome = run(*command, "--hfov", "60")
        said = " ".join([*outcome.out, *outcome.err])
        assert "photo.png: no marker found: " in said
        assert "aruco" not in said


def test_of_a_mirrored_photo_it_is_said_and_no_other_marker_is_followed(run, photo):
    """The usual marker is, mirrored, another one of a thousand of its kind."""
    path = photo("aruco:4x4_50:0")
    cv2.imwrite(path, cv2.imread(path)[:, ::-1])
    for command in (["estimate", path], ["play", path, "--headless", "--quality", "fast"]):
        for named in ((), ("--marker", "aruco:4x4_50:0")):
            outcome = run(*command, "--hfov", "60", *named)
            said = " ".join([*outcome.out, *outcome.err])
            assert outcome.status == 3
            assert "aruco:4x4_50:0 is in view, but in mirror image: " in said
            assert "871" not in said


def test_the_reason_in_json_is_that_of_the_line(run, photo):
    """Of what is mirrored, black, or shows another marker, it was "no marker found" alone."""
    path = photo("aruco:4x4_50:7")
    seven = cv2.imread(path)
    usual, other = (), ("--marker", "aruco:4x4_50:3")
    for picture, said, choices in (
        (seven[:, ::-1], "in mirror image", (usual, other)),
        (np.zeros_like(seven), ALL_BLACK, (usual, other)),
        (np.full_like(seven, 255), ALL_WHITE, (usual, other)),
        (np.full_like(seven, 128), SHOW_IT, (usual, other)),
        (seven, "aruco:4x4_50:7 is in view", (other,)),
    ):
        cv2.imwrite(path, picture)
        for named in choices:
            (line,) = run("estimate", path, "--hfov", "60", *named).out
            (record,) = run("estimate", path, "--hfov", "60", *named, "--json").records
            assert line == f"{path}: {record['light']['reason']}"
            assert said in line


def test_a_photo_is_shown_with_the_marker_that_is_in_it(run, photo):
    headless = ("--hfov", "60", "--headless", "--quality", "fast", "--no-hide-marker")
    outcome = run("play", photo(OTHER), *headless, "--frames", "2")
    assert outcome.status == 0
    assert "marker in 1 of 1 frames" in " ".join(outcome.out)
    outcome = run("play", photo(OTHER), *headless, "--marker", "aruco:4x4_50:3")
    assert outcome.status == 3
    assert f"{OTHER} is in view: --marker {OTHER}" in " ".join(outcome.err)


@pytest.fixture
def late_clip(photo, tmp_path):
    """Twelve black frames, then twelve with the marker, 6 of each a second."""

    def clip() -> str:
        shown = cv2.imread(photo(OTHER))
        path = tmp_path / "late.mp4"
        with Recorder(path, (640, 480), 6) as recorder:
            for number in range(24):
                recorder.write(shown if number >= 12 else np.zeros_like(shown), number / 6)
        return str(path)

    return clip


def test_a_clip_may_begin_without_its_marker(run, late_clip):
    """As one that begins black, or beside the table, does: in a file nobody can point to the marker while it plays."""
    clip, camera = late_clip(), ("--hfov", "60")
    (record,) = run("estimate", clip, *camera, "--json").records
    assert record["marker"]["found"]
    outcome = run("play", clip, *camera, "--headless", "--quality", "fast", "--no-hide-marker")
    assert "marker in 12 of 24 frames" in " ".join(outcome.out)


def test_a_clip_is_searched_for_its_marker_where_it_is_looked_at(run, late_clip):
    clip = late_clip()
    (record,) = run("estimate", clip, "--hfov", "60", "--frames", "20:", "--json").records
    assert record["marker"]["found"]
    outcome = run("estimate", clip, "--hfov", "60", "--frames", "0:10")
    assert outcome.status == 3
    assert "is followed" not in " ".join(outcome.err)


def test_where_no_pose_explains_the_marker_the_camera_is_doubted(run):
    photo = str(FOLDER / "clean_box.jpg")
    assert run("estimate", photo).status == 0
    for command in (["estimate", photo], ["play", photo, "--headless", "--quality", "fast"]):
        outcome = run(*command, "--hfov", "179")
        assert outcome.status == 3
        said = " ".join([*outcome.out, *outcome.err])
        assert "not as this camera would see it: check --hfov" in said
        assert "--marker aruco" not in said

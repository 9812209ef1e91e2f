"""Several views of one scene: frames of a clip, and photos taken together."""

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture.recording.recorder import Recorder
from ashe_live.commands.flags import option_groups
from ashe_live.core.arrays import Image
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators import estimator
from ashe_live.light.live.key_views import span_of

KNOWN = ("--hfov", "55")


@dataclasses.dataclass(frozen=True)
class CountingEstimator:
    """Sees the light overhead, and says which views it was given."""

    name: str = "proxy"

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        views = tracked.frame.index, *(other.frame.index for other in others)
        span_rad = span_of([tracked, *others]) if others else None
        light = Illumination((Light((0.0, 0.3, 1.0)),))
        return LightEstimate(self.name, views[0], light, timing_ms={"total": 1.0}, views=views, span_rad=span_rad)


@pytest.fixture(autouse=True)
def counting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(estimator, "ESTIMATORS", {"proxy": lambda _preset: CountingEstimator()})


def written(path: Path, image: Image) -> Path:
    cv2.imwrite(str(path), image)
    return path


@pytest.fixture(scope="module")
def table(picture_of_box, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Three photos of one table, from three sides."""
    folder = tmp_path_factory.mktemp("table")
    sides = {"a": -100, "b": -92, "c": -84}
    return [written(folder / f"{name}.png", picture_of_box(azimuth)) for name, azimuth in sides.items()]


def test_a_photo_that_the_estimator_does_not_use_is_said(run, table, monkeypatch):
    """As with a paper cube, whose light is told by one picture."""
    asked = CountingEstimator.estimate
    monkeypatch.setattr(
        CountingEstimator, "estimate", lambda self, tracked, others=(): asked(self, tracked, others[1:])
    )
    outcome = run("estimate", *KNOWN, "--together", *table)
    assert outcome.status == 0
    (line,) = [line for line in outcome.err if "not used" in line]
    assert str(table[1]) in line.split("not used")[0]
    assert line.endswith(f"the answer rests on {table[0]} and {table[2]}")
    monkeypatch.setattr(CountingEstimator, "estimate", asked)
    assert not [line for line in run("estimate", *KNOWN, "--together", *table).err if "not used" in line]


def test_a_clip_is_answered_from_several_of_its_frames(run, film):
    outcome = run("estimate", "--json", "--camera-file", film.camera_file, film.path)
    (record,) = outcome.records
    assert outcome.status == 0
    frames = record["views"]["frames"]
    assert frames[0] == record["frame"]
    assert 2 < len(set(frames)) == len(frames) <= 12
    assert record["views"]["files"] is None
    assert record["views"]["span_deg"] > 2
    assert f"{len(frames)} views over" in run("estimate", "--camera-file", film.camera_file, film.path).out[0]


def test_views_of_a_still_camera_are_none_beside_the_frame(run, table, tmp_path):
    clip = tmp_path / "still.mp4"
    picture = cv2.imread(str(table[0]))
    with Recorder(clip, (640, 480), 30.0) as recorder:
        for index in range(20):
            recorder.write(picture, index / 30)
    (record,) = run("estimate", "--json", *KNOWN, clip).records
    assert record["error"] is None
    assert record["views"] is None


@pytest.mark.parametrize("views", [1, 2, 5])
def test_at_most_so_many_views_are_used_and_one_is_no_view_beside_it(run, film, views):
    (record,) = run("estimate", "--json", "--camera-file", film.camera_file, "--views", views, film.path).records
    if views == 1:
        assert record["views"] is None
    else:
        assert len(record["views"]["frames"]) == views


def test_views_are_chosen_from_the_frames_that_are_named(run, film):
    known = "--camera-file", film.camera_file
    (record,) = run("estimate", "--json", *known, "--frames", "2:9", film.path).records
    assert all(2 <= index <= 9 for index in record["views"]["frames"])
    (record,) = run("estimate", "--json", *known, "--frames", "2:9", "--estimate-at", 6, film.path).records
    assert record["frame"] == record["views"]["frames"][0] == 6
    assert all(2 <= index <= 9 for index in record["views"]["frames"])


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (("--frames", "30"), "'30' is not a range of frames"),
        (("--frames", "9:3"), "'9:3' is not a range of frames"),
        (("--frames", "a:b"), "'a:b' is not a range of frames"),
        (("--frames", "-4:8"), "--frames"),
        (("--frames", "5:9", "--estimate-at", 12), "not within --frames"),
        (("--frames", "5000:"), "there is no frame 5000"),
        (("--views", 0), "from 1 to 12"),
        (("--views", 13), "from 1 to 12"),
        (("--together",), "two files or more"),
    ],
)
def test_what_cannot_be_is_said_in_one_line_with_status_2(run, film, flags, said):
    assert said in run("estimate", *KNOWN, film.path, *flags).refusal


def test_a_photo_is_not_spoken_of_as_frames(run, table):
    (line,) = run("estimate", *KNOWN, table[0]).out
    assert "frame" not in line
    for flags in (("--estimate-at", 3), ("--frames", "3:")):
        assert f"it is a photo: leave {flags[0]} out" in run("estimate", *KNOWN, table[0], *flags).refusal


def test_photos_taken_together_have_one_answer(run, table):
    outcome = run("estimate", "--json", *KNOWN, "--together", *table)
    (record,) = outcome.records
    assert outcome.status == 0
    assert record["file"] == str(table[0])
    assert record["views"]["files"] == [str(path) for path in table]
    assert record["views"]["frames"] == [0, 0, 0]
    # The camera stands so high that it turns by less than its azimuth.
    assert record["views"]["span_deg"] == pytest.approx(16 * 0.5 / np.hypot(0.5, 0.4), abs=1)
    (line,) = run("estimate", *KNOWN, "--together", *table).out
    assert line.startswith(f"{table[0]}, {table[1]} and {table[2]}: azimuth")


def test_a_clip_and_photos_may_be_taken_together_and_each_view_says_where_it_is_from(run, table, film):
    (record,) = run("estimate", "--json", *KNOWN, "--views", 4, "--together", table[0], table[1], film.path).records
    assert len(record["views"]["files"]) == len(record["views"]["frames"]) <= 4
    assert record["views"]["files"][:2] == [str(table[0]), str(table[1])]


def test_what_is_of_no_use_together_has_its_own_line_and_the_rest_is_answered(run, table, files, tmp_path):
    outcome = run("estimate", "--json", *KNOWN, "--together", table[0], files["garbage"], tmp_path / "no.png", table[1])
    assert outcome.status == 2
    assert [bool(record["error"]) for record in outcome.records] == [True, True, False]
    assert outcome.records[-1]["views"]["files"] == [str(table[0]), str(table[1])]
    outcome = run("estimate", "--json", *KNOWN, "--together", files["empty_table"], table[0])
    assert outcome.status == 3
    assert outcome.records[-1]["views"] is None
    assert outcome.records[-1]["light"]["kind"] == "directional"


def test_a_file_that_cannot_even_be_looked_at_costs_none_of_the_others(run, table):
    """A name that is too long, as one in a folder that must not be entered, is an error of the system's."""
    outcome = run("estimate", "--json", *KNOWN, "--together", "x" * 300, *table)
    assert outcome.status == 2
    assert "cannot read" in outcome.records[0]["error"]
    assert outcome.records[-1]["views"]["files"] == [str(path) for path in table]


def test_a_photo_in_another_light_is_left_out_and_named(run, table, picture_of_box, tmp_path):
    evening = written(tmp_path / "evening.png", picture_of_box(-98, 60.0))
    outcome = run("estimate", "--json", *KNOWN, "--together", table[0], evening, table[1])
    (record,) = outcome.records
    assert record["views"]["files"] == [str(table[0]), str(table[1])]
    (line,) = outcome.err
    assert str(evening) in line


def test_a_first_photo_that_shows_another_scene_than_most_is_left_out_and_named(run, table, picture_of_box, tmp_path):
    """A hand may be in it."""
    evening = written(tmp_path / "evening.png", picture_of_box(-98, 60.0))
    outcome = run("estimate", "--json", *KNOWN, "--together", evening, *table)
    (record,) = outcome.records
    assert record["file"] == str(table[0])
    assert record["views"]["files"] == [str(path) for path in table]
    (line,) = outcome.err
    assert line.split(": ")[1] == str(evening)
    # One against one, nothing tells which of them is the odd one.
    (record,) = run("estimate", "--json", *KNOWN, "--together", evening, table[0]).records
    assert record["file"] == str(evening)


def test_a_clip_is_answered_for_the_scene_that_most_of_it_shows(run, picture_of_box, tmp_path):
    """Unless its frame is named."""
    clip = tmp_path / "clip.mp4"
    with Recorder(clip, (640, 480), 30.0) as recorder:
        for index in range(40):
            recorder.write(picture_of_box(-100 + 0.25 * index, 60.0 if index < 9 else 200.0), index / 30)
    (record,) = run("estimate", "--json", *KNOWN, clip).records
    assert record["frame"] >= 9
    assert record["views"]["frames"][0] == record["frame"]
    assert all(index >= 9 for index in record["views"]["frames"])
    (record,) = run("estimate", "--json", *KNOWN, "--estimate-at", 5, clip).records
    assert record["frame"] == 5


def test_photos_of_an_unknown_camera_determine_it_together(run, table):
    (record,) = run("estimate", "--json", "--together", *table).records
    alone = [json.loads(line) for line in run("estimate", "--json", *table).out]
    focal = 320 / np.tan(np.radians(55 / 2))
    errors = [abs(each["camera"]["K"][0][0] / focal - 1) for each in (record, *alone)]
    assert errors[0] <= max(errors[1:]) + 0.01
    assert record["camera"]["focal_sigma_px"] <= 1.05 * max(each["camera"]["focal_sigma_px"] for each in alone)


def test_photos_determine_their_camera_together_by_whichever_marker_is_in_them(run, table, monkeypatch):
    monkeypatch.setattr(option_groups, "DEFAULT_MARKER", "aruco:4x4_50:17")
    spec = "aruco:4x4_50:0"
    named, unnamed = (run("estimate", "--json", "--together", *flags, *table) for flags in (("--marker", spec), ()))
    assert spec in unnamed.err[0]
    assert unnamed.records[0]["camera"] == named.records[0]["camera"]
    assert named.records[0]["camera"]["source"] == "estimated"


def test_a_first_photo_without_a_marker_does_not_say_which_one_is_followed(run, table, files, monkeypatch):
    monkeypatch.setattr(option_groups, "DEFAULT_MARKER", "aruco:4x4_50:17")
    outcome = run("estimate", "--json", *KNOWN, "--together", files["empty_table"], *table)
    assert [bool(record["marker"]["found"]) for record in outcome.records] == [False, True]


def test_a_sheet_and_the_steps_are_made_of_them_too(run, table, tmp_path):
    sheet, steps = tmp_path / "light.html", tmp_path / "steps"
    outcome = run("estimate", *KNOWN, "--together", *table, "--sheet", sheet, "--debug", steps)
    assert outcome.status == 0
    assert sheet.read_text(encoding="utf-8").count("<figure>") == 1
    assert len(list(steps.glob("*.png"))) == 1

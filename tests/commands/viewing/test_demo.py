"""`ashe-live demo` without a display: a video and a contact sheet, in the current folder."""

import json
from dataclasses import replace

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.commands import demo
from ashe_live.commands.demo import Thumbnails
from ashe_live.viewer.view_options import ShownParts


def test_without_a_display_it_leaves_a_video_and_a_sheet_and_says_where(run, instant, tmp_path, monkeypatch):  # noqa: ARG001
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    outcome = run("demo", "--frames", "20", "--quality", "fast", "--no-hide-marker")
    assert outcome.status == 0
    assert outcome.err == []
    (video,) = tmp_path.glob("*.mp4")
    (sheet,) = tmp_path.glob("*.png")
    assert str(video) in outcome.out[-1]
    assert str(sheet) in outcome.out[-1]
    assert "from the truth" in outcome.out[0]
    with ClipSource(video) as clip:
        assert len(list(clip)) == 20
    with PIL.Image.open(sheet) as picture:
        assert picture.width > 1000


def test_what_was_recorded_in_a_window_is_shown_again_without_text(run, instant, tmp_path, monkeypatch):  # noqa: ARG001
    monkeypatch.chdir(tmp_path)
    stand = {"model": "mug", "marker": None, "seat": 0, "scale": 1.5, "turn_rad": 1.0, "shift_m": [0.0, 0.0]}
    shown = [
        {"frame": frame, "models": [stand], "estimate": None, "parts": parts.value, "hides_marker": False}
        for frame, parts in ((0, ShownParts.WHOLE), (3, ShownParts.VIDEO_ALONE))
    ]
    (tmp_path / "shown.json").write_text(json.dumps({"schema": 1, "shown": shown}))
    (tmp_path / "made").mkdir()
    flags = ("--headless", "--frames", "6", "--quality", "fast", "--out", "made/again.mp4")
    outcome = run("demo", "--as-shown", "shown.json", *flags)
    assert outcome.status == 0
    (sheet,) = (tmp_path / "made").glob("*.png")
    assert outcome.out[-1] == f"see made/again.mp4 and made/{sheet.name}"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["made", "shown.json"]
    with ClipSource(tmp_path / "made" / "again.mp4") as again, ClipSource(shipped_clip().path) as clip:
        pairs = [(again.read().image_bgr.astype(int), clip.read().image_bgr.astype(int)) for _ in range(6)]
    differs = [np.abs(mine - bare).mean() for mine, bare in pairs]
    assert min(differs[:3]) > 3 > 2.5 > max(differs[3:])
    assert np.abs(pairs[0][0] - pairs[0][1])[:40, :200].mean() < 2.5, "where text would be"


def test_in_a_window_the_clip_begins_again_and_what_is_opened_later_may_show_any_marker(run, tmp_path, monkeypatch):
    setups = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(demo, "has_display", lambda: True)
    monkeypatch.setattr(demo, "show_in_window", lambda setup: setups.append(setup) or 3)
    assert run("demo").status == 3
    (setup,) = setups
    clip, options = shipped_clip(), setup.options
    assert (options.loop, options.headless, options.takes_any_marker) == (True, False, True)
    assert (options.marker, options.marker_size) == (clip.marker_spec, clip.marker_side_m)
    assert setup.shows_light
    np.testing.assert_array_equal(setup.true_to_light_marker, clip.to_light_marker)
    assert list(tmp_path.iterdir()) == []


def test_models_for_other_markers_alone_do_not_make_one_of_these_the_clips(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "no model is for" in run("demo", "--headless", "--model", "3=mug").refusal


@pytest.mark.parametrize("flags", [("--out", "own.mp4"), ("--out", "new.mp4", "--report", "linked.mp4")], ids=" ".join)
def test_the_clip_that_is_played_is_not_replaced(run, instant, tmp_path, monkeypatch, flags):  # noqa: ARG001
    shipped = shipped_clip()
    own = replace(shipped, path=tmp_path / "own.mp4")
    content = shipped.path.read_bytes()
    own.path.write_bytes(content)
    (tmp_path / "linked.mp4").hardlink_to(own.path)
    monkeypatch.setattr(demo, "shipped_clip", lambda: own)
    monkeypatch.chdir(tmp_path)
    outcome = run("demo", "--headless", "--frames", "2", "--quality", "fast", "--overwrite", *flags)
    assert "is also read" in outcome.refusal
    assert own.path.read_bytes() == (tmp_path / "linked.mp4").read_bytes() == content


@pytest.mark.parametrize("frames", [1, 5, 12, 24, 25, 26, 240, 1000])
def test_moments_spread_over_the_whole_and_stay_few(frames):
    thumbnails = Thumbnails(12)
    for frame in range(frames):
        thumbnails.add(frame, frame / 10)
        assert len(thumbnails._kept) <= 24
    chosen, labels = thumbnails.spread()
    assert len(chosen) == len(labels) == min(frames, 12)
    assert chosen == sorted(set(chosen))
    assert chosen[0] == 0
    assert chosen[-1] >= 0.9 * (frames - 1)
    assert labels[0] == "0.0 s"

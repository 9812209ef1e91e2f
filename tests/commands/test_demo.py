"""`ashe-live demo` without a display: a video and a contact sheet, in the current folder."""

import PIL.Image
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.commands.demo import Thumbnails


def test_without_a_display_it_leaves_a_video_and_a_sheet_and_says_where(run, instant, tmp_path, monkeypatch):  # noqa: ARG001
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    outcome = run("demo", "--frames", "20", "--quality", "fast")
    assert outcome.status == 0
    assert outcome.err == []
    (video,) = tmp_path.glob("*.mp4")
    (sheet,) = tmp_path.glob("*.png")
    assert str(video) in outcome.out[-1]
    assert str(sheet) in outcome.out[-1]
    assert "from the truth" in outcome.out[0]
    with ClipSource(video) as clip:
        assert len(list(iter(clip.read, None))) == 20
    with PIL.Image.open(sheet) as picture:
        assert picture.width > 1000


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

"""Clips of two fields a picture: no teeth along what moves, and the numbers and times of the pictures as they were."""

from pathlib import Path

import av
import numpy as np
import pytest
from av.video.frame import VideoFrame

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.deinterlacing import progressive
from ashe_live.core.arrays import Image

COUNT, STEP_PX = 12, 6


def field(number: int) -> Image:
    """A bar that moves by STEP_PX from field to field, above a pattern that stands still."""
    image = np.full((96, 160, 3), 60, np.uint8)
    left = 4 + STEP_PX * number
    image[:48, left : left + 12] = 220
    image[52::4] = 140
    return image


def woven(path: Path, quarter_turns: int = 0) -> Path:
    """COUNT pictures."""
    with av.open(str(path), "w") as container:
        options = {"flags": "+ildct+ilme", "g": "4", "bf": "0", "qmin": "1", "qmax": "2", "b": "8M"}
        stream = container.add_stream("mpeg2video", rate=25, options=options)
        stream.width, stream.height, stream.pix_fmt = 160, 96, "yuv420p"
        stream.set_display_rotation(90.0 * quarter_turns)
        for number in range(COUNT):
            image = field(2 * number)
            image[1::2] = field(2 * number + 1)[1::2]
            container.mux(stream.encode(VideoFrame.from_ndarray(image, "bgr24")))
        container.mux(stream.encode(None))
    return path


def test_a_picture_too_small_for_the_filter_is_shown_as_it_is(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "tiny.mp4"), "w") as container:
        stream = container.add_stream("mpeg2video", rate=25, options={"flags": "+ildct+ilme"})
        stream.width, stream.height, stream.pix_fmt = 16, 2, "yuv420p"
        for _ in range(3):
            container.mux(stream.encode(VideoFrame.from_ndarray(np.full((2, 16, 3), 90, np.uint8), "bgr24")))
        container.mux(stream.encode(None))
    with ClipSource(tmp_path / "tiny.mp4") as clip:
        assert [frame.size for frame in clip] == [(16, 2)] * 3


def teeth(image: Image) -> float:
    """How much neighbouring lines differ, where in each field all of them are equal."""
    moving = image[4:44, :, 1].astype(float)
    return float(np.abs(np.diff(moving, axis=0)).max())


@pytest.mark.parametrize("suffix", [".mp4", ".mpg"])
def test_what_moves_has_no_teeth_and_what_stands_is_kept(tmp_path: Path, suffix: str) -> None:
    with ClipSource(woven(tmp_path / f"camcorder{suffix}")) as clip:
        frames = list(clip)
    assert [frame.index for frame in frames] == list(range(COUNT))
    np.testing.assert_allclose([frame.time_s for frame in frames], np.arange(COUNT) / 25, atol=1e-6)
    for frame in frames:  # the first and the last too, which have no picture before or after them
        assert teeth(frame.image_bgr) < 40
        np.testing.assert_allclose(frame.image_bgr[60:92].astype(int), field(0)[60:92].astype(int), atol=14)


def test_to_and_fro_gives_the_same_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = woven(tmp_path / "camcorder.mp4")
    with ClipSource(path) as clip:
        frames = list(clip)
    for kept in (2, 2 * COUNT):
        with ClipSource(path) as clip:
            monkeypatch.setattr(clip, "_kept", kept)
            for index in (9, 2, COUNT - 1, 5, 8, 0, 4, 7, 8):  # every fourth is a keyframe
                clip.seek_frame(index)
                frame = clip.read()
                assert frame is not None
                assert (frame.index, frame.time_s) == (index, frames[index].time_s)
                np.testing.assert_array_equal(frame.image_bgr, frames[index].image_bgr)


def test_one_picture_alone_is_shown(tmp_path: Path) -> None:
    with av.open(str(woven(tmp_path / "camcorder.mp4"))) as clip:
        first = next(video for video in clip.decode(video=0) if isinstance(video, VideoFrame))
    assert [video.pts for video in progressive([first])] == [first.pts]


def test_where_their_size_changes_none_is_lost(tmp_path: Path) -> None:
    """As where a call or a screen was recorded: those that are still in the filter come first."""
    path = woven(tmp_path / "camcorder.mp4")
    with av.open(str(path)) as clip:
        videos = [video for video in clip.decode(video=0) if isinstance(video, VideoFrame)]
    smaller = [video.reformat(width=80, height=48) for video in videos]
    woven_and_plain = [*videos[:5], *smaller[:4], *videos[5:]]
    shown = list(progressive(woven_and_plain))
    assert [(video.width, video.pts) for video in shown] == [(video.width, video.pts) for video in woven_and_plain]


def test_a_picture_is_still_turned_upright(tmp_path: Path) -> None:
    with ClipSource(woven(tmp_path / "phone.mp4", quarter_turns=1)) as clip:
        turned = list(clip)
    with ClipSource(woven(tmp_path / "camcorder.mp4")) as clip:
        for frame, as_held in zip(turned, clip, strict=True):
            np.testing.assert_array_equal(frame.image_bgr, np.rot90(as_held.image_bgr))

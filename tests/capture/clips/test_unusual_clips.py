"""Clips as few programs write them, or that were cut where few are: read rightly, or refused in one clear line."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from av.video.frame import VideoFrame

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from tests.capture.conftest import frames_of


def write(path: Path, images: list[Image], codec: str, pixels: str, **options: str) -> None:
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=25, options={"bf": "0", **options})
        (stream.height, stream.width), stream.pix_fmt = images[0].shape[:2], pixels
        for image in images:
            container.mux(stream.encode(VideoFrame.from_ndarray(image, "bgr24").reformat(format=pixels)))
        container.mux(stream.encode(None))


@pytest.mark.parametrize("matrix", ["YCgCo", "bt2020c", "ICtCp"])
def test_colours_that_ffmpeg_cannot_convert_are_named(
    tmp_path: Path, picture: Callable[[int], Image], matrix: str
) -> None:
    """It says "Operation not supported" of the first picture, which was passed on as if files or space were missing."""
    path = tmp_path / "a.mp4"
    write(path, [picture(0)], "libx264", "yuv444p", **{"x264-params": f"colormatrix={matrix}"})
    with pytest.raises(UserError, match="stores its colours in a way that is not read") as refused:
        ClipSource(path)
    assert str(path) in refused.value.message


def test_of_a_picture_in_jpeg_that_is_cut_nothing_is_shown(tmp_path: Path) -> None:
    """As of a webcam's AVI: below the cut was whatever had been in memory, another one at each reading."""
    path = tmp_path / "a.avi"
    noise = np.random.default_rng(5).integers(90, 120, (96, 128, 3)).astype(np.uint8)
    write(path, [noise] * 8, "mjpeg", "yuvj420p")
    with av.open(str(path)) as clip:
        last = [packet for packet in clip.demux(video=0) if packet.size][-1]
    assert last.pos is not None
    path.write_bytes(path.read_bytes()[: last.pos + last.size * 9 // 10])
    with ClipSource(path) as source:
        frames = list(source)
        assert source.note == "a.avi is truncated or damaged: only 7 frames could be read"
        source.seek(1e9)
        at_end = source.read()
        assert at_end is not None
    assert len(frames) == 7
    np.testing.assert_array_equal(at_end.image_bgr, frames[-1].image_bgr)
    for frame in frames:
        assert np.abs(frame.image_bgr.astype(int) - noise).max() < 40


@pytest.mark.parametrize("times", [[0] * 12, [*range(5), 4, *range(5, 11)]], ids=["all", "two"])
def test_frames_at_one_time_are_shown_one_after_the_other(
    tmp_path: Path, picture: Callable[[int], Image], times: list[int]
) -> None:
    """Where a file gives frames no duration all were shown at once, and a recording of them took no time."""
    path = tmp_path / "a.mkv"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mjpeg", rate=25)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuvj420p"
        container.start_encoding()
        for i, time in enumerate(times):
            packet = av.Packet(cv2.imencode(".jpg", picture(i))[1].tobytes())
            packet.stream, packet.pts, packet.dts, packet.time_base = stream, time, time, Fraction(1, 25)
            packet.is_keyframe = True
            container.mux(packet)
    frames = frames_of(path)
    assert len(frames) == 12
    times_s = [frame.time_s for frame in frames]
    assert min(np.diff(times_s)) == pytest.approx(0.02)
    assert max(np.diff(times_s)) == pytest.approx(0.04, abs=2e-3)
    with ClipSource(path) as source:
        for place in (7, 3, 11, 5, 0):
            source.seek(times_s[place])
            found = source.read()
            assert found is not None
            assert (found.index, found.time_s) == (place, times_s[place])


def test_what_comes_before_the_first_keyframe_is_no_grey_haze(tmp_path: Path, picture: Callable[[int], Image]) -> None:
    """A clip that was cut between keyframes, in MPEG-4 part 2: FFmpeg begins with a change of plain grey."""
    whole, cut = tmp_path / "whole.avi", tmp_path / "cut.avi"
    write(whole, [picture(i) for i in range(24)], "mpeg4", "yuv420p", g="10", sc_threshold="1000000000", qscale="2")
    with av.open(str(whole)) as clip, av.open(str(cut), "w") as target:
        stream = target.add_stream_from_template(clip.streams.video[0])
        for number, packet in enumerate(clip.demux(clip.streams.video[0])):
            if number >= 4 and packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    frames = frames_of(whole)
    assert len(frames) == 24
    with ClipSource(cut) as source:
        seen = list(source)
        assert source.note == "cut.avi is truncated or damaged: only 14 frames could be read"
    for frame, original in zip(seen, frames[10:], strict=True):
        np.testing.assert_array_equal(frame.image_bgr, original.image_bgr)

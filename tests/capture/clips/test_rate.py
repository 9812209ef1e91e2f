"""A clip whose header has no rate of frames has the one that its frames' times say."""

import struct
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.video.frame import VideoFrame

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.rate import FALLBACK_FPS
from ashe_live.core.arrays import Image
from ashe_live.viewer.output.recording import Slots

# How long each frame is shown, as Matroska writes it; and what its readers pass over.
DEFAULT_DURATION, VOID = b"\x23\xe3\x83", 0xEC
DURATION = b"\x44\x89\x88"  # of all that is in the file, 8 bytes


def browsers_clip(path: Path, picture: Callable[[int], Image], times_ms: Sequence[int]) -> Path:
    """Times alone and no rate, as `MediaRecorder` writes WebM; with a length, as once it was copied by FFmpeg."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libvpx", rate=30, options={"deadline": "realtime", "lag-in-frames": "0"})
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        stream.codec_context.time_base = Fraction(1, 1000)
        for i, time_ms in enumerate(times_ms):
            frame = VideoFrame.from_ndarray(picture(i), "bgr24")
            frame.pts, frame.time_base = time_ms, Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    content = bytearray(path.read_bytes())
    at = content.index(DEFAULT_DURATION)
    size = 4 + (content[at + 3] & 0x7F)
    content[at : at + size] = bytes([VOID, 0x80 | (size - 2), *bytes(size - 2)])
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("pause_ms", [0, 1000], ids=["", "a pause"])
@pytest.mark.parametrize("period_ms", [23, 40])
def test_it_is_that_of_the_first_frames(
    tmp_path: Path, picture: Callable[[int], Image], period_ms: int, pause_ms: int
) -> None:
    """FFmpeg guesses 333 a second or more, by which every frame would come too late to be shown, and the end be cut."""
    times_ms = [period_ms * i + i * 7919 % 9 + (pause_ms if i > 5 else 0) for i in range(50)]
    with ClipSource(browsers_clip(tmp_path / "a.webm", picture, times_ms)) as source:
        assert source.fps == pytest.approx(1000 / period_ms, rel=0.02)
        frames = list(source)
        np.testing.assert_allclose([frame.time_s for frame in frames], np.array(times_ms) / 1000, atol=1e-6)
        assert source.note is None


def test_the_length_is_known_though_it_is_not_stated(tmp_path: Path, picture: Callable[[int], Image]) -> None:
    """Else the window has no time bar."""
    path = browsers_clip(tmp_path / "a.webm", picture, [33 * i for i in range(30)])
    content = path.read_bytes()
    at = content.index(DURATION, 0, 1000)
    path.write_bytes(content[:at] + bytes([VOID, 0x80 | 9]) + content[at + 2 :])
    with ClipSource(path) as source:
        assert source.duration_s == pytest.approx(0.033 * 29)
        assert [frame.index for frame in source] == list(range(30))
        source.rewind()
        assert source.duration_s == pytest.approx(0.033 * 29)


def test_a_single_frame_has_the_usual_one(tmp_path: Path, picture: Callable[[int], Image]) -> None:
    with ClipSource(browsers_clip(tmp_path / "a.webm", picture, [0])) as source:
        assert source.fps == FALLBACK_FPS


def test_of_raw_dv_it_is_that_of_its_pictures_and_not_the_unit_of_their_times(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "a.dv"), "w") as container:
        stream = container.add_stream("dvvideo", rate=25)
        stream.width, stream.height, stream.pix_fmt = 720, 576, "yuv420p"
        for level in (60, 90, 120):
            image = np.full((576, 720, 3), level, np.uint8)
            container.mux(stream.encode(VideoFrame.from_ndarray(image, "bgr24")))
        container.mux(stream.encode(None))
    with ClipSource(tmp_path / "a.dv") as source:
        assert source.fps == pytest.approx(25)


@pytest.mark.parametrize("fps", [50, 12])
def test_of_a_stream_without_a_container_it_is_the_one_in_its_own_header(
    tmp_path: Path, picture: Callable[[int], Image], fps: int
) -> None:
    """As small computers' cameras write them. FFmpeg gives each of these 25."""
    with av.open(str(tmp_path / "a.h264"), "w") as container:
        stream = container.add_stream("libx264", rate=fps)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        for i in range(10):
            container.mux(stream.encode(VideoFrame.from_ndarray(picture(i), "bgr24")))
        container.mux(stream.encode(None))
    with ClipSource(tmp_path / "a.h264") as source:
        assert source.fps == fps
        np.testing.assert_allclose([frame.time_s for frame in source], np.arange(10) / fps, atol=1e-9)


def phones_clip(path: Path, picture: Callable[[int], Image], periods_s: Sequence[Fraction]) -> Path:
    """MP4, each frame shown for its own time."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=30)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        stream.codec_context.time_base = Fraction(1, 90_000)
        for i in range(len(periods_s)):
            frame = VideoFrame.from_ndarray(picture(i), "bgr24")
            frame.pts, frame.time_base = round(90_000 * sum(periods_s[:i])), Fraction(1, 90_000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


SHORT, LONG = Fraction(1, 30), Fraction(1, 10)


@pytest.mark.parametrize(
    "periods_s",
    [
        [SHORT] * 60,
        [SHORT] * 60 + [LONG] * 30,  # the light was turned off
        [LONG] * 30 + [SHORT] * 60,
        [SHORT] * 30 + [Fraction(100)] + [SHORT] * 30,  # of a screen on which nothing moved
        [SHORT] * 15,
    ],
    ids=["even", "darker", "brighter", "a pause", "short"],
)
def test_of_uneven_times_it_is_the_rate_at_which_no_frame_is_left_out(
    tmp_path: Path, picture: Callable[[int], Image], periods_s: list[Fraction]
) -> None:
    """By the mean a window's recording has no room for a third to all but one of the frames."""
    with ClipSource(phones_clip(tmp_path / "a.mp4", picture, periods_s)) as source:
        assert source.fps is not None
        slots = Slots(source.fps)
        times_s = [frame.time_s for frame in source]
        taken = [slots.time_s(time_s, frame) for frame, time_s in enumerate(times_s)]
        assert source.duration_s == pytest.approx(times_s[-1], abs=1e-3)
        assert source.note is None
    assert source.fps == pytest.approx(30, rel=0.001)
    assert len(taken) == len(periods_s)
    assert None not in taken


def test_frames_that_come_late_and_at_once_after_a_hiccup_do_not_make_it_faster(
    tmp_path: Path, picture: Callable[[int], Image]
) -> None:
    periods_s = [SHORT] * 100 + [8 * SHORT] + [SHORT / 20] * 7 + [SHORT] * 150
    with ClipSource(phones_clip(tmp_path / "a.mp4", picture, periods_s)) as source:
        assert source.fps == pytest.approx(30, rel=0.01)


def test_parts_of_a_clip_that_was_cut_on_the_phone_are_not_counted_twice(
    tmp_path: Path, picture: Callable[[int], Image]
) -> None:
    """Its list of edits names two parts; the frames before the second are decoded for it, and not shown."""
    path = phones_clip(tmp_path / "a.mp4", picture, [SHORT] * 60)
    content = bytearray(path.read_bytes())
    ticks_a_frame = 3000
    (movie_ticks_a_second,) = struct.unpack_from(">I", content, content.index(b"mvhd") + 16)
    # Duration in the movie's ticks, where it begins in the track's own, and its speed: ISO/IEC 14496-12, 8.6.6.
    parts = [
        (movie_ticks_a_second // 2, 3 * ticks_a_frame, 1 << 16),
        (movie_ticks_a_second, 30 * ticks_a_frame, 1 << 16),
    ]
    table = b"elst" + struct.pack(">II", 0, len(parts)) + b"".join(struct.pack(">IiI", *part) for part in parts)
    at = content.index(b"edts") - 4
    before = int.from_bytes(content[at : at + 4], "big")
    box = struct.pack(">I4sI", len(table) + 12, b"edts", len(table) + 4) + table
    content[at : at + before] = box
    for name in (b"moov", b"trak"):
        of = content.index(name) - 4
        size = int.from_bytes(content[of : of + 4], "big") + len(box) - before
        content[of : of + 4] = size.to_bytes(4, "big")
    path.write_bytes(content)
    with ClipSource(path) as source:
        assert source.fps == pytest.approx(30, rel=0.01)
        assert len(list(source)) == 45

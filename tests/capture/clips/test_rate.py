"""A clip whose header has no rate of frames has the one that its frames' times say."""

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
@pytest.mark.parametrize("period_ms", [33, 66])
def test_it_is_that_of_the_first_frames(
    tmp_path: Path, picture: Callable[[int], Image], period_ms: int, pause_ms: int
) -> None:
    """FFmpeg guesses a thousand a second, by which every frame would come too late to be shown, and the end be cut."""
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

"""Files as FFmpeg reads and writes them: how far it may look, what goes wrong in writing, and what headers state."""

import errno
import io
import os
import signal
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from ashe_live.capture import container
from ashe_live.capture.container import (
    Searched,
    WrittenContainer,
    has_decoding_times_alone,
    opened_container,
    stated_length,
    stated_ratio,
    video_in,
)
from ashe_live.process.signals import ended_by_signals

MOST_BYTES = 100
FRAMES, FPS = 12, 25


@pytest.fixture
def short_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(container, "MOST_BYTES_TO_A_PACKET", MOST_BYTES)


@pytest.mark.usefixtures("short_search")
def test_a_file_is_read_to_its_end_as_long_as_packets_are_found_in_it() -> None:
    file = Searched(io.BytesIO(bytes(10 * MOST_BYTES)))

    def packets() -> Iterator[int]:
        while content := file.read(MOST_BYTES - 1):
            yield len(content)

    assert sum(file.following(packets())) == 10 * MOST_BYTES


@pytest.mark.usefixtures("short_search")
def test_a_file_ends_where_nothing_is_found_in_it() -> None:
    stream = io.BytesIO(bytes(10 * MOST_BYTES))
    file = Searched(stream)
    assert len(file.read(1000)) == MOST_BYTES
    # What was looked through comes as one packet, after which there is nothing to look for.
    assert list(file.following(iter("a"))) == ["a"]
    assert file.read(1000) == b""
    file.go_on()
    assert len(file.read(1000)) == MOST_BYTES


def made(muxer: str, codec: str = "mpeg4", b_frames: int = 0, title: str = "") -> Searched:
    """A clip without recorder."""
    stream = io.BytesIO()
    with av.open(stream, "w", format=muxer) as output:
        output.metadata["title"] = title
        video: Any = output.add_stream(codec, rate=FPS)
        video.width, video.height, video.pix_fmt, video.time_base = 64, 48, "yuv420p", Fraction(1, FPS)
        video.codec_context.max_b_frames = b_frames
        for index in range(FRAMES):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 20 * index, np.uint8))
            frame.pts, frame.time_base = index, Fraction(1, FPS)
            output.mux(video.encode(frame))
        output.mux(video.encode())
    return Searched(stream)


def content_of(file: Searched) -> bytes:
    file.seek(0)
    return file.read(10**9)


@pytest.mark.parametrize(
    ("muxer", "b_frames", "is_so"), [("avi", 0, False), ("avi", 2, True), ("mp4", 2, False), ("matroska", 0, False)]
)
def test_only_an_avi_with_pictures_in_another_order_does_not_say_which(muxer: str, b_frames: int, is_so: bool) -> None:
    with opened_container(made(muxer, b_frames=b_frames)) as clip:
        stream = video_in(clip)
        assert stream is not None
        assert has_decoding_times_alone(clip, stream) is is_so


@pytest.mark.parametrize(("muxer", "length_s"), [("avi", FRAMES / FPS), ("mp4", FRAMES / FPS), ("matroska", 0.0)])
def test_a_length_is_stated_in_the_streams_unit_and_by_matroska_not_at_all(muxer: str, length_s: float) -> None:
    with opened_container(made(muxer)) as clip:
        stream = video_in(clip)
        assert stream is not None
        assert stream.time_base is not None
        assert float(stated_length(clip, stream) * stream.time_base) == pytest.approx(length_s)


def test_of_a_cut_avi_the_header_tells_how_long_it_was() -> None:
    content = content_of(made("avi"))
    pictures = content.index(b"movi")
    with opened_container(Searched(io.BytesIO(content[: (pictures + len(content)) // 2]))) as clip:
        stream = video_in(clip)
        assert stream is not None
        assert stream.duration != FRAMES
        assert stated_length(clip, stream) == FRAMES


def test_text_in_another_encoding_is_no_reason_to_refuse_a_clip() -> None:
    content = content_of(made("avi", title="Cafe in Koln"))
    assert b"Cafe in Koln" in content
    content = content.replace(b"Cafe in Koln", "Café in Köln".encode("latin-1"))
    with opened_container(Searched(io.BytesIO(content))) as clip:
        assert len([packet for packet in clip.demux(video=0) if packet.size]) == FRAMES


class Disk(io.BytesIO):
    """Is full, or cannot be sought in, for a while."""

    error: OSError | None = None

    def write(self, content: Any) -> int:
        if self.error is not None:
            raise self.error
        return super().write(bytes(content)[:7])  # as much as it takes at once

    def seek(self, offset: int, whence: int = 0) -> int:
        if self.error is not None:
            raise self.error
        return super().seek(offset, whence)


def write(written: WrittenContainer) -> None:
    assert written.write(b"what is lost") == len(b"what is lost")


def seek(written: WrittenContainer) -> None:
    written.seek(3)


@pytest.mark.parametrize("fails", [write, seek])
def test_after_the_first_error_what_was_written_stays_and_the_error_is_told(
    fails: Callable[[WrittenContainer], None],
) -> None:
    disk = Disk()
    written = WrittenContainer(disk, {})
    assert written.write(b"what is written") == len(b"what is written")
    written.check()
    full, broken = OSError(errno.ENOSPC, "full"), OSError(errno.EIO, "broken")
    for disk.error in (full, broken):
        fails(written)
    disk.error = None
    written.write(b"what comes later")
    assert disk.getvalue() == b"what is written"
    with pytest.raises(OSError, match="full"):
        written.check()
    with pytest.raises(OSError, match="full"):
        written.close()


def test_a_file_is_written_past_its_buffer_and_stays_open(tmp_path: Path) -> None:
    with (tmp_path / "a.mp4").open("w+b") as file:
        written = WrittenContainer(file, {})
        written.write(b"at once")
        assert (tmp_path / "a.mp4").read_bytes() == b"at once"
        assert written.seek(2) == written.tell() == 2
        written.close()
        assert not file.closed


@pytest.mark.parametrize("called", ["read", "seek"])
def test_a_request_to_end_while_ffmpeg_reads_waits_and_costs_nothing_of_the_clip(clip: Path, called: str) -> None:
    """FFmpeg would take what is raised there for the end of a damaged file."""

    class Interrupting(io.BytesIO):
        def read(self, most_bytes: int | None = -1) -> bytes:
            return self._ask("read") or super().read(most_bytes)

        def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
            return self._ask("seek") or super().seek(offset, whence)

        def _ask(self, what: str) -> None:
            if what == called:
                signal.raise_signal(signal.SIGTERM)

    with ended_by_signals() as end_if_asked:
        with opened_container(Searched(Interrupting(clip.read_bytes()))) as container:
            assert sum(1 for _ in container.decode(video=0)) == 60
        with pytest.raises(SystemExit):
            end_if_asked()


class Rational:
    """As PyAV 19 has FFmpeg's numbers: false where there is none."""

    def __init__(self, numerator: int, denominator: int) -> None:
        self.numerator, self.denominator = numerator, denominator

    def __bool__(self) -> bool:
        return self.numerator != 0 and self.denominator != 0


@pytest.mark.parametrize("kind", [Fraction, Rational])
def test_a_stated_ratio_is_a_fraction_whatever_kind_of_number_pyav_has(kind: Callable[[int, int], Any]) -> None:
    assert stated_ratio(kind(1001, 30_000)) == Fraction(1001, 30_000)
    assert stated_ratio(kind(0, 1)) is None


@pytest.mark.parametrize("unknown", [None, Rational(0, 1), Rational(1, 0), Rational(0, 0)])
def test_an_unknown_ratio_is_none(unknown: Rational | None) -> None:
    assert stated_ratio(unknown) is None

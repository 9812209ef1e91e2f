"""Clips with transparency, as another program reads them."""

import shutil
from pathlib import Path

import av
import numpy as np
import pytest

from ashe_live.capture.recording.transparent import TransparentRecorder
from ashe_live.errors import UserError

SIZE = (64, 48)
COLOURS = ((200, 40, 40, 255), (40, 200, 40, 128), (40, 40, 200, 0))  # BGRA, of a third of the picture each


def picture() -> np.ndarray:
    image = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    for number, colour in enumerate(COLOURS):
        image[16 * number : 16 * (number + 1)] = colour
    return image


def decoded(path: Path) -> list[tuple[float, np.ndarray]]:
    with av.open(str(path)) as clip:
        stream = clip.streams.video[0]
        # FFmpeg's own decoder of VP9 leaves transparency out.
        decoder = av.CodecContext.create("libvpx-vp9", "r") if path.suffix == ".webm" else stream.codec_context
        packets = [packet for packet in clip.demux(stream) if packet.size]
        frames = [
            (float(packet.pts * packet.time_base), frame) for packet in packets for frame in decoder.decode(packet)
        ]
        return [(time_s, frame.to_ndarray(format="bgra")) for time_s, frame in frames]


@pytest.mark.parametrize("suffix", [".mov", ".webm"])
def test_colours_transparency_and_times_come_back(tmp_path: Path, suffix: str) -> None:
    times = [0.0, 0.04, 0.2]
    with TransparentRecorder(tmp_path / f"a{suffix}", SIZE, 25.0) as recorder:
        for time_s in times:
            recorder.write(picture(), time_s)
    assert recorder.path == tmp_path / f"a{suffix}"
    frames = decoded(recorder.path)
    assert [time_s for time_s, _ in frames] == pytest.approx(times, abs=1e-3)
    for _, image in frames:
        for number, colour in enumerate(COLOURS):
            inner = image[16 * number + 4 : 16 * number + 12, 8:-8].reshape(-1, 4).astype(float).mean(axis=0)
            assert inner[3] == pytest.approx(colour[3], abs=3)
            if colour[3]:
                assert inner[:3] == pytest.approx(colour[:3], abs=8)


@pytest.mark.parametrize("suffix", [".mov", ".webm"])
def test_any_rate_that_a_clip_states_is_one_that_can_be_written(tmp_path: Path, suffix: str) -> None:
    """As of a damaged header."""
    with TransparentRecorder(tmp_path / f"a{suffix}", SIZE, 90_000.0) as recorder:
        recorder.write(picture(), 0.0)
    assert len(decoded(recorder.path)) == 1


@pytest.mark.parametrize("name", ["a.mp4", "a", "a.avi"])
def test_other_kinds_have_no_transparency(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=r"is no clip with transparency: let its name end in \.mov"):
        TransparentRecorder(tmp_path / name, SIZE, 25.0)


def test_nothing_is_replaced_and_nothing_left_of_what_has_no_picture(tmp_path: Path) -> None:
    (tmp_path / "a.mov").write_bytes(b"mine")
    with pytest.raises(UserError, match="exists"):
        TransparentRecorder(tmp_path / "a.mov", SIZE, 25.0)
    assert (tmp_path / "a.mov").read_bytes() == b"mine"
    TransparentRecorder(tmp_path / "b.mov", SIZE, 25.0).close()
    with pytest.raises(UserError, match="1x48 cannot be recorded"):
        TransparentRecorder(tmp_path / "c.mov", (1, 48), 25.0)
    assert [path.name for path in tmp_path.iterdir()] == ["a.mov"]


def test_what_appears_under_its_name_meanwhile_stays(tmp_path: Path) -> None:
    wanted = tmp_path / "a.mov"
    with TransparentRecorder(wanted, SIZE, 25.0) as recorder:
        recorder.write(picture(), 0.0)
        wanted.write_bytes(b"mine")
    assert wanted.read_bytes() == b"mine"
    assert recorder.path == tmp_path / "a-2.mov"
    assert len(decoded(recorder.path)) == 1


@pytest.mark.parametrize("suffix", [".mov", ".webm"])
def test_a_time_that_does_not_ascend_costs_no_picture(tmp_path: Path, suffix: str) -> None:
    with TransparentRecorder(tmp_path / f"a{suffix}", SIZE, 25.0) as recorder:
        for time_s in (0.0, 0.2, 0.1, 0.2):
            recorder.write(picture(), time_s)
    assert [time_s for time_s, _ in decoded(recorder.path)] == pytest.approx([0.0, 0.2, 0.2, 0.2], abs=3e-3)


def test_where_it_can_be_given_no_name_that_is_said(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    recorder = TransparentRecorder(folder / "a.mov", SIZE, 25.0)
    recorder.write(picture(), 0.0)
    shutil.rmtree(folder)
    with pytest.raises(UserError, match="cannot write"):
        recorder.close()


def test_a_full_disk_is_said_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = TransparentRecorder(tmp_path / "a.mov", SIZE, 25.0)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder._written, "check", full)
    with recorder:
        with pytest.raises(UserError, match="No space left"):
            recorder.write(picture(), 0.0)
        assert list(tmp_path.iterdir()) == [], "at once"
    assert recorder.frame_count == 0
    assert list(tmp_path.iterdir()) == []

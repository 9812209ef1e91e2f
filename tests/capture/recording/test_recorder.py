"""What goes into a Recorder comes out of a ClipSource; what goes wrong leaves no broken file under the final name."""

import itertools
import os
import resource
import shutil
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

import av
import numpy as np
import pytest

from ashe_live.capture.recording import fragments as fragments_module
from ashe_live.capture.recording.fragments import IN_THE_MAKING, copy_whole_fragments, made_playable
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.recording.transparent import TransparentRecorder
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from tests.capture.conftest import frames_of

Draw = Callable[[int], Image]


def test_round_trip_keeps_count_size_order_and_times(clip: Path, picture: Draw) -> None:
    frames = frames_of(clip)
    assert [frame.index for frame in frames] == list(range(60))
    assert {frame.size for frame in frames} == {(96, 64)}
    np.testing.assert_allclose([frame.time_s for frame in frames], np.arange(60) / 25, atol=1e-9)
    for frame in frames:
        assert np.abs(frame.image_bgr.astype(int) - picture(frame.index)).mean() < 6


def test_times_of_the_caller_are_kept_from_the_first_frame_on(tmp_path: Path, picture: Draw) -> None:
    times = 1000.0 + np.array([0.0, 0.016, 0.05, 0.05, 0.3, 0.301])
    with Recorder(tmp_path / "a.mp4", (96, 64), 60) as recorder:
        for i, time_s in enumerate(times):
            recorder.write(picture(i), float(time_s))
    read = [frame.time_s for frame in frames_of(tmp_path / "a.mp4")]
    np.testing.assert_allclose(read, times - 1000.0, atol=2e-5)
    assert (np.diff(read) > 0).all()


@pytest.mark.parametrize("fps", [2.0, 25.0])
def test_the_last_frame_is_shown_for_as_long_as_one_is(tmp_path: Path, picture: Draw, fps: float) -> None:
    with Recorder(tmp_path / "a.mp4", (96, 64), fps) as recorder:
        recorder.write(picture(0), 0.0)
        recorder.write(picture(1), 0.3)
    with av.open(str(tmp_path / "a.mp4")) as clip:
        assert clip.duration / av.time_base == pytest.approx(0.3 + 1 / fps, abs=1e-3)


def test_a_time_before_the_last_is_shown_right_after_it(tmp_path: Path, picture: Draw) -> None:
    """As of streams whose clock jumps back: the picture is not lost, and the clip's times ascend."""
    with Recorder(tmp_path / "a.mp4", (96, 64), 60) as recorder:
        for index, time_s in enumerate((5.0, 5.1, 1.0, 5.2)):
            recorder.write(picture(index), time_s)
    times = [frame.time_s for frame in frames_of(tmp_path / "a.mp4")]
    np.testing.assert_allclose(times, [0.0, 0.1, 0.1, 0.2], atol=2e-5)
    assert (np.diff(times) > 0).all()


@pytest.mark.parametrize("fps", [0.2, 10.0, 25.0])
def test_every_two_seconds_begins_a_part_that_can_be_decoded_by_itself(
    tmp_path: Path, picture: Draw, fps: float
) -> None:
    """So much is lost at most of a recording that breaks off, and passed to seek in it."""
    times = np.arange(0, 7 if fps > 1 else 20, 1 / fps)
    with Recorder(tmp_path / "a.mp4", (96, 64), fps) as recorder:
        for time_s in times:
            recorder.write(picture(0), float(time_s))
    with av.open(str(tmp_path / "a.mp4")) as clip:
        begins = [float(each.pts * each.time_base) for each in clip.demux(video=0) if each.size and each.is_keyframe]
    assert begins == pytest.approx([time_s for time_s in times if fps < 1 or time_s % 2 < 1e-6], abs=1e-3)


def test_colours_survive(tmp_path: Path) -> None:
    """Patches over the whole cube of colours; 4:2:0 and compression cost some levels, a wrong matrix twenty or more."""
    levels = np.array([0, 64, 128, 192, 255], np.uint8)
    colours = np.stack(np.meshgrid(levels, levels, levels), axis=-1).reshape(5, 25, 3)
    image = np.repeat(np.repeat(colours, 32, axis=0), 32, axis=1)
    with Recorder(tmp_path / "a.mp4", (800, 160), 30) as recorder:
        for index in range(3):
            recorder.write(image, index / 30)
    for frame in frames_of(tmp_path / "a.mp4"):
        error = frame.image_bgr[16::32, 16::32].astype(int) - colours
        assert np.abs(error).max() <= 8
        assert np.abs(error.mean(axis=(0, 1))).max() < 2


def test_stream_is_what_phones_and_browsers_play(clip: Path) -> None:
    content = clip.read_bytes()
    assert 0 < content.index(b"moov") < content.index(b"mdat")
    assert b"moof" not in content
    with av.open(str(clip)) as container:
        stream = container.streams.video[0]
        codec = stream.codec_context
        assert (codec.name, codec.pix_fmt, stream.frames) == ("h264", "yuv420p", 60)
        # 1: BT.709 in each of FFmpeg's lists; range 1: limited.
        assert (codec.colorspace, codec.color_primaries, codec.color_trc, codec.color_range) == (1, 1, 1, 1)
        assert stream.average_rate == 25
        assert stream.duration is not None
        assert stream.time_base is not None
        assert float(stream.duration * stream.time_base) == pytest.approx(60 / 25)


def test_odd_sizes_lose_the_last_column_and_row(tmp_path: Path) -> None:
    image = np.zeros((65, 97, 3), np.uint8)
    image[:, :40] = 200
    with Recorder(tmp_path / "a.mp4", (97, 65), 30) as recorder:
        recorder.write(image, 0.0)
    (frame,) = frames_of(tmp_path / "a.mp4")
    assert frame.size == (96, 64)
    assert np.abs(frame.image_bgr.astype(int) - image[:64, :96]).mean() < 4


def test_flipped_views_are_written_as_they_look(tmp_path: Path, picture: Draw) -> None:
    """OpenGL's rows run upwards, so the viewer hands over views with negative strides."""
    with Recorder(tmp_path / "a.mp4", (96, 64), 30) as recorder:
        recorder.write(picture(3)[::-1, ::-1], 0.0)
    (frame,) = frames_of(tmp_path / "a.mp4")
    assert np.abs(frame.image_bgr.astype(int) - picture(3)[::-1, ::-1]).mean() < 6


def test_existing_file_is_refused_before_anything_is_written(clip: Path) -> None:
    before = clip.read_bytes()
    with pytest.raises(UserError, match="exists already"):
        Recorder(clip, (96, 64), 30)
    assert clip.read_bytes() == before
    assert list(clip.parent.iterdir()) == [clip]


def test_overwriting_replaces_only_at_the_end(clip: Path, picture: Draw) -> None:
    with Recorder(clip, (96, 64), 30, overwrite=True) as recorder:
        recorder.write(picture(0), 0.0)
        assert len(frames_of(clip)) == 60
    assert len(frames_of(clip)) == 1


@pytest.mark.parametrize("name", ["missing/a.mp4", "a.avi", ".", "a" * 300 + ".mp4"])
def test_unusable_names_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError):
        Recorder(tmp_path / name, (96, 64), 30)
    assert list(tmp_path.iterdir()) == []


def test_without_frames_no_file_is_left(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mp4", (96, 64), 30):
        pass
    assert list(tmp_path.iterdir()) == []


def write_seven_and_fail(recorder: Recorder, picture: Draw) -> None:
    for i in range(7):
        recorder.write(picture(i), i / 30)
    raise KeyError("in mid-run")


def test_clip_is_finished_after_an_exception_and_close_may_be_repeated(tmp_path: Path, picture: Draw) -> None:
    recorder = Recorder(tmp_path / "a.mp4", (96, 64), 30)
    with pytest.raises(KeyError), recorder:
        write_seven_and_fail(recorder, picture)
    recorder.close()
    assert len(frames_of(tmp_path / "a.mp4")) == 7
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]
    with pytest.raises(ValueError, match="closed"):
        recorder.write(picture(0), 0.0)


def test_another_size_in_mid_stream_is_the_callers_fault(tmp_path: Path, picture: Draw) -> None:
    with Recorder(tmp_path / "a.mp4", (96, 64), 30) as recorder:
        recorder.write(picture(0), 0.0)
        with pytest.raises(ValueError, match="in a recording of"):
            recorder.write(np.zeros((64, 98, 3), np.uint8), 1.0)
        with pytest.raises(ValueError, match="float64 in a recording of"):
            recorder.write(np.zeros((64, 96, 3)), 1.0)
    assert len(frames_of(tmp_path / "a.mp4")) == 1


@pytest.fixture
def files_of_60_kb_at_most() -> Iterator[None]:
    """Writing beyond fails as it does on a full disk (Python ignores the signal that would come with it)."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def write_forever(recorder: Recorder, image: Image) -> None:
    for i in itertools.count():
        recorder.write(np.roll(image, i * 7, axis=1), i / 2)


@pytest.mark.usefixtures("files_of_60_kb_at_most")
def test_full_disk_saves_what_was_recorded(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (64, 96, 3), np.uint8)
    recorder = Recorder(tmp_path / "a.mp4", (96, 64), 2)
    with pytest.raises(UserError, match="the first part of the recording is saved"):
        write_forever(recorder, noise)
    recorder.close()
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]
    with av.open(str(tmp_path / "a.mp4")) as clip:
        assert len(list(clip.decode(video=0))) >= 4, "to its end, without an error"


@pytest.mark.parametrize("kind", [Recorder, TransparentRecorder])
def test_a_disk_that_is_full_already_is_said_before_anything_is_recorded(
    tmp_path: Path, kind: type[Recorder | TransparentRecorder]
) -> None:
    """By the one that writes its header at once, or with the first picture."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, hard))
    try:
        if kind is Recorder:
            with pytest.raises(UserError, match="cannot write"):
                Recorder(tmp_path / "a.mp4", (96, 64), 30)
        else:
            with (
                pytest.raises(UserError, match="cannot write"),
                TransparentRecorder(tmp_path / "a.mov", (96, 64), 30) as it,
            ):
                it.write(np.full((64, 96, 4), 255, np.uint8), 0.0)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("most_bytes", [3_000, 12_000, 30_000])
def test_a_disk_that_is_full_at_closing_is_said(tmp_path: Path, most_bytes: int) -> None:
    """All pictures still are in the encoder, or in the fragment that closing would write."""
    noise = np.random.default_rng(0).integers(0, 256, (64, 96, 3), np.uint8)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    recorder = Recorder(tmp_path / "a.mp4", (96, 64), 30)
    for i in range(40):
        recorder.write(np.roll(noise, i * 7, axis=1), i / 30)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, hard))
    try:
        with pytest.raises(UserError, match="cannot write"):
            recorder.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    left = list(tmp_path.iterdir())
    assert left in ([], [tmp_path / "a.mp4"])
    if left:
        assert 0 < len(frames_of(left[0])) < 40


def test_a_copy_that_is_not_whole_is_not_trusted(
    tmp_path: Path, picture: Draw, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The fragments are the clip then."""
    whole = fragments_module.with_index_first

    def cut(fragments: BinaryIO, clip: BinaryIO, pictures: int) -> None:
        whole(fragments, clip, pictures)
        clip.truncate(clip.seek(0, 2) * 3 // 4)

    monkeypatch.setattr(fragments_module, "with_index_first", cut)
    with Recorder(tmp_path / "a.mp4", (96, 64), 30) as recorder:
        for i in range(70):
            recorder.write(picture(i), i / 30)
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]
    assert len(frames_of(tmp_path / "a.mp4")) == 70


def test_what_a_disk_has_lost_without_a_word_is_said(
    tmp_path: Path, picture: Draw, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the fragments themselves: what is left of them is kept."""

    def lose(fragments: BinaryIO, _clip: BinaryIO, _pictures: int) -> None:
        fragments.truncate(fragments.seek(0, 2) * 3 // 4)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(fragments_module, "with_index_first", lose)
    recorder = Recorder(tmp_path / "a.mp4", (96, 64), 10)
    for i in range(70):
        recorder.write(picture(i), i / 10)
    with pytest.raises(UserError, match=r"not all of it could be written.*the first part .* is saved as .*a\.mp4"):
        recorder.close()
    assert list(tmp_path.iterdir()) == [recorder.path]
    assert 20 <= len(frames_of(recorder.path)) < 70


@pytest.mark.parametrize("kind", [Recorder, TransparentRecorder])
@pytest.mark.parametrize(
    ("error", "raised"),
    [
        (OSError(28, "No space left on device"), UserError),
        (av.error.InvalidDataError(1, "x"), UserError),
        (KeyboardInterrupt(), KeyboardInterrupt),
    ],
)
def test_what_cannot_even_begin_leaves_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    kind: type[Recorder | TransparentRecorder],
    error: BaseException,
    raised: type[BaseException],
) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(kind, "_begin", fail)
    with pytest.raises(raised):
        kind(tmp_path / ("a.mp4" if kind is Recorder else "a.mov"), (96, 64), 25.0)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("fps", [0.0, -25.0, float("inf"), float("nan")])
def test_a_rate_that_no_clip_has_is_refused_before_there_is_a_file(tmp_path: Path, fps: float) -> None:
    with pytest.raises(ValueError, match="frames a second"):
        Recorder(tmp_path / "a.mp4", (96, 64), fps)
    assert list(tmp_path.iterdir()) == []


def test_what_appears_under_its_name_meanwhile_stays(tmp_path: Path, picture: Draw) -> None:
    wanted = tmp_path / "a.mp4"
    with Recorder(wanted, (96, 64), 30) as recorder, Recorder(wanted, (96, 64), 30) as other:
        recorder.write(picture(0), 0.0)
        for index in range(2):
            other.write(picture(1), index / 30)
        wanted.write_text("precious")
    assert wanted.read_text() == "precious"
    assert len(frames_of(recorder.path)) == 1
    assert len(frames_of(other.path)) == 2
    for clip in (recorder.path, other.path):  # what was saved beside it is finished all the same
        assert [kind for _, kind in boxes(clip.read_bytes())][:2] == [b"ftyp", b"moov"]
        assert IN_THE_MAKING.encode() not in clip.read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"a.mp4", "a-2.mp4", "a-3.mp4"}


def test_a_folder_that_is_renamed_takes_its_recording_along(tmp_path: Path, picture: Draw) -> None:
    before, after = tmp_path / "before", tmp_path / "after"
    before.mkdir()
    with Recorder(before / "a.mp4", (96, 64), 30) as recorder:
        recorder.write(picture(0), 0.0)
        before.rename(after)
    assert recorder.path == after / "a.mp4"
    assert len(frames_of(recorder.path)) == 1
    assert list(tmp_path.rglob("*")) == [after, after / "a.mp4"]


def test_that_the_folder_has_been_removed_is_said(tmp_path: Path, picture: Draw) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    recorder = Recorder(folder / "a.mp4", (96, 64), 30)
    recorder.write(picture(0), 0.0)
    shutil.rmtree(folder)
    with pytest.raises(UserError, match="cannot write"):
        recorder.close()
    recorder.close()


def test_where_the_folder_was_write_protected_meanwhile_it_is_said_where_the_recording_is(
    tmp_path: Path, picture: Draw, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorder = Recorder(tmp_path / "a.mp4", (96, 64), 30)
    recorder.write(picture(0), 0.0)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    for owner, name in ((os, "link"), (Path, "replace"), (Path, "unlink")):
        monkeypatch.setattr(owner, name, refuse)
    with pytest.raises(UserError, match=r"Permission denied.*saved as") as raised:
        recorder.close()
    monkeypatch.undo()
    assert str(recorder.path) in raised.value.message
    assert len(frames_of(recorder.path)) == 1


def test_a_long_name_is_no_obstacle(tmp_path: Path, picture: Draw) -> None:
    wanted = tmp_path / ("ä" * 124 + ".mp4")  # 252 bytes of the 255 that a name may have
    with Recorder(wanted, (96, 64), 30) as recorder:
        recorder.write(picture(0), 0.0)
    assert len(frames_of(wanted)) == 1


def boxes(clip: bytes) -> list[tuple[int, bytes]]:
    """Where each box of an MP4 file begins, and its kind."""
    found, at = [], 0
    while at + 8 <= len(clip):
        length, kind = struct.unpack_from(">I4s", clip, at)
        found.append((at, kind))
        at += length
    return found


@pytest.fixture(scope="module")
def fragments(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """What a recording of seven seconds has written when it breaks off: three fragments of two seconds."""
    folder, noise = tmp_path_factory.mktemp("fragments"), np.random.default_rng(0)
    with Recorder(folder / "clip.mp4", (64, 48), 30) as recorder:
        for index in range(210):
            recorder.write(noise.integers(0, 256, (48, 64, 3), dtype=np.uint8), index / 30)
        (partial,) = folder.iterdir()
        return partial.read_bytes()


@pytest.mark.parametrize("further", [0, 1, 7, 8, 100, 400])
@pytest.mark.parametrize("kind", [b"moof", b"mdat"])
def test_wherever_it_breaks_off_the_whole_fragments_can_be_played(
    tmp_path: Path, fragments: bytes, kind: bytes, further: int
) -> None:
    last = [at for at, of_kind in boxes(fragments) if of_kind == kind][-1]
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(fragments[: last + further])
    with broken.open("rb") as file, (tmp_path / "copy.mp4").open("wb") as copy:
        copy_whole_fragments(file, copy)
    # Half a fragment's header hides what comes before it; half of its pictures do not.
    at, broken_off = [box for box in boxes(fragments) if box[0] <= last + further][-1]
    whole = last + further if broken_off == b"mdat" and last + further >= at + 8 else at
    assert (tmp_path / "copy.mp4").read_bytes() == fragments[:whole]
    assert len(frames_of(tmp_path / "copy.mp4")) >= 60
    with broken.open("r+b") as file:
        assert made_playable(file)
    with av.open(str(broken)) as clip:
        list(clip.decode(video=0))
    assert len(frames_of(broken)) >= 60


def test_what_breaks_off_before_its_first_picture_is_nothing(tmp_path: Path, fragments: bytes) -> None:
    first = next(at for at, kind in boxes(fragments) if kind == b"moof")
    for length in (0, 3, 8, 40, first, first + 20):
        broken = tmp_path / "broken.mp4"
        broken.write_bytes(fragments[:length])
        with broken.open("r+b") as file:
            assert not made_playable(file)

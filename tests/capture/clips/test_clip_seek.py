"""After a seek a clip gives the very frames, numbers and times that it gives when it is read through."""

import weakref
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.video.frame import VideoFrame

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.index import ClipIndex
from ashe_live.capture.clips.pictures import ClipPictures
from ashe_live.capture.container import Searched
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from tests.capture.conftest import frames_of
from tests.shared_data import SHARED

REAL = SHARED / "real"
COUNT = 80
EVEN = [40 * i for i in range(COUNT)]  # milliseconds
UNEVEN = [40 * i + (i * 7919) % 31 for i in range(COUNT)]
# Ways to jump: near and far, on, just before and beyond frames of every kind.
JUMPS = (41, 40, 3, 79, 78, 60, 61, 0, 33, 17, 16, 15, 70, 1, 0, 79)


@pytest.fixture
def film(tmp_path: Path, picture: Callable[[int], Image]) -> Callable[..., Path]:
    """Writes a clip frame by frame at given times."""

    def film(times_ms: list[int], name: str = "film.mp4", turns: int = 0, codec: str = "libx264", **options: str):
        path = tmp_path / name
        with av.open(str(path), "w", options={"avoid_negative_ts": "disabled"}) as container:
            stream = container.add_stream(codec, rate=25, options=options)
            stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
            tick_ms = 40 if path.suffix == ".avi" else 1  # AVI has no times, only a rate
            stream.codec_context.time_base = Fraction(tick_ms, 1000)
            stream.set_display_rotation(90.0 * turns)
            for i, time_ms in enumerate(times_ms):
                frame = VideoFrame.from_ndarray(picture(i), "bgr24")
                frame.pts, frame.time_base = time_ms // tick_ms, Fraction(tick_ms, 1000)
                container.mux(stream.encode(frame))
            container.mux(stream.encode(None))
        return path

    return film


def assert_same(frame: Frame | None, wanted: Frame) -> None:
    assert frame is not None
    assert (frame.index, frame.time_s) == (wanted.index, wanted.time_s)
    np.testing.assert_array_equal(frame.image_bgr, wanted.image_bgr)


def assert_seeks_right(path: Path, count: int = COUNT) -> None:
    """By number, by time and between two times; then the clip goes on, through to its end."""
    frames = frames_of(path)
    assert len(frames) == count
    with ClipSource(path) as source:
        for place in JUMPS:
            source.seek_frame(place)
            assert_same(source.read(), frames[place])
            source.seek(frames[place].time_s)
            assert_same(source.read(), frames[place])
            later_s = frames[min(place + 1, count - 1)].time_s
            source.seek((frames[place].time_s + later_s) / 2)
            assert_same(source.read(), frames[place])
        source.seek(frames[50].time_s)
        for wanted in frames[50:]:
            assert_same(source.read(), wanted)
        assert source.read() is None
        assert source.note is None
        for time_s, wanted in ((1e9, frames[-1]), (-1.0, frames[0])):
            source.seek(time_s)
            assert_same(source.read(), wanted)
        source.seek_frame(count)
        assert source.read() is None
        source.seek_frame(-3)
        assert_same(source.read(), frames[0])


@pytest.mark.parametrize(
    "options",
    [
        pytest.param({"bf": "0", "g": "12"}, id="no B-frames"),
        pytest.param({"bf": "3", "g": "12", "x264-params": "b-adapt=0"}, id="B-frames"),
        pytest.param({"bf": "3", "g": "12", "x264-params": "b-adapt=0:open-gop=1:scenecut=0"}, id="open groups"),
        pytest.param({"bf": "3", "g": "250", "x264-params": "scenecut=0"}, id="one group"),
        pytest.param({"bf": "0", "x264-params": "intra-refresh=1:keyint=12"}, id="no keyframes"),
    ],
)
@pytest.mark.parametrize("times_ms", [EVEN, UNEVEN, [time + 7000 for time in UNEVEN]], ids=["even", "uneven", "late"])
def test_frames_after_a_seek_are_those_of_the_whole(film, options: dict[str, str], times_ms) -> None:
    assert_seeks_right(film(times_ms, **options))


@pytest.mark.parametrize("name", ["film.mkv", "film.ts", "film.avi", "film.mov", "film.mp4"])
def test_whatever_the_container(film, name: str) -> None:
    assert_seeks_right(film(EVEN, name, bf="0" if name.endswith("avi") else "2", g="12"))


def test_whatever_the_codec(film) -> None:
    assert_seeks_right(film(EVEN, "film.avi", codec="mpeg4", g="12"))
    assert_seeks_right(film(EVEN, "film.mkv", codec="mjpeg", strict="unofficial"))


@pytest.mark.parametrize("shift_ms", [0, 17], ids=["equal times", "times between"])
def test_of_clips_that_were_joined_byte_by_byte(film, tmp_path: Path, shift_ms: int) -> None:
    """As camcorders' are: the second part's times begin anew, and its frames are shown after the first part's."""
    parts = [film([time + shift for time in EVEN], f"{shift}.ts", bf="2", g="12") for shift in (2000, 2000 + shift_ms)]
    joined = tmp_path / "joined.ts"
    joined.write_bytes(b"".join(part.read_bytes() for part in parts))
    with joined.open("rb") as file:
        assert ClipIndex.read(file) is None
    times_s = [frame.time_s for frame in frames_of(joined)]
    np.testing.assert_allclose(times_s, 0.04 * np.arange(2 * COUNT), atol=1e-6)
    assert_seeks_right(joined, 2 * COUNT)


def test_where_pictures_are_decoded_in_another_order_and_no_times_say_which(film) -> None:
    path = film(EVEN, "film.avi", bf="2", g="12")
    np.testing.assert_allclose([frame.time_s for frame in frames_of(path)], 0.04 * np.arange(COUNT), atol=1e-6)
    assert_seeks_right(path)


def test_frames_that_are_passed_over_are_decoded_only_and_the_last_one_stays(film, monkeypatch) -> None:
    path = film(EVEN, g="12", bf="2")
    frames, made = frames_of(path), []
    make = ClipSource._upright_bgr
    monkeypatch.setattr(ClipSource, "_upright_bgr", lambda clip, video: made.append(video.pts) or make(clip, video))
    asked = []
    with ClipSource(path) as clip:
        made.clear()
        assert not clip.pass_over(lambda time_s: asked.append(time_s) or True)
        assert_same(clip.read(), frames[0])
        for _ in range(4):
            assert clip.pass_over(lambda time_s: asked.append(time_s))
        assert_same(clip.read(), frames[5])
        clip.seek_frame(3)  # back over what was passed
        assert_same(clip.read(), frames[3])
        while clip.pass_over(lambda _time_s: False):
            pass
        assert_same(clip.read(), frames[-1])
        assert not clip.pass_over(lambda _time_s: False)
        assert clip.read() is None
        assert clip.note is None
    assert asked == [frame.time_s for frame in frames[:5]]
    assert len(made) == 4


def test_of_a_rotated_clip(film) -> None:
    path = film(UNEVEN, turns=1, bf="2", g="12")
    assert frames_of(path)[0].size == (64, 96)
    assert_seeks_right(path)


def test_without_any_times(film) -> None:
    """A bare stream: counted from the start."""
    path = film(EVEN, "film.h264", bf="2", g="12")
    with path.open("rb") as file:
        assert ClipIndex.read(file) is None
    assert_seeks_right(path)


def test_where_pictures_are_hardly_kept(film, monkeypatch) -> None:
    monkeypatch.setattr("ashe_live.capture.clips.clip.KEPT_BYTES", 1)
    assert_seeks_right(film(UNEVEN, bf="3", g="12"))
    assert_seeks_right(film(EVEN, "film.h264", bf="2", g="12"))


@pytest.mark.parametrize("name", ["film.mp4", "film.mkv", "film.mov"])
def test_the_index_tells_every_frames_time_and_where_decoding_can_begin(film, name: str) -> None:
    path = film([time + 7000 for time in UNEVEN], name, bf="2", g="12", **{"x264-params": "scenecut=0"})
    with path.open("rb") as file:
        index = ClipIndex.read(file)
    assert index is not None
    times_s = [float((pts - index.pts[0]) * index.time_base) for pts in index.pts]
    np.testing.assert_allclose(times_s, (np.array(UNEVEN) - UNEVEN[0]) / 1000, atol=1e-3)
    assert index.keyframes == tuple(range(0, COUNT, 12))
    assert index.duration_s == times_s[-1]
    for frame in (0, 11, 12, 40, COUNT - 1):
        assert index.frame_of(index.pts[frame]) == index.frame_at(times_s[frame]) == frame
        assert index.keyframe_before(frame) == frame // 12 * 12
        assert index.frame_at(times_s[frame] - 1e-3) == max(0, frame - 1)
    assert index.frame_of(None) is index.frame_of(index.pts[-1] + 1) is index.frame_of(index.pts[4] + 1) is None


class Told:
    """A packet that can be asked whether anybody holds it."""

    def __init__(self, packet) -> None:
        self.pts, self.size = packet.pts, packet.size
        self.is_discard, self.is_keyframe = packet.is_discard, packet.is_keyframe


def test_the_index_is_read_without_keeping_what_is_in_the_clip(film, monkeypatch) -> None:
    """All packets together are as large as the file, and a file may name the same bytes many times."""
    path = film(EVEN)
    alive: list[int] = []
    following = Searched.following

    def watched(searched, packets):
        told: list[weakref.ref[Told]] = []
        for packet in following(searched, packets):
            one = Told(packet)
            told.append(weakref.ref(one))
            yield one
            alive.append(sum(each() is not None for each in told))

    monkeypatch.setattr(Searched, "following", watched)
    with path.open("rb") as file:
        index = ClipIndex.read(file)
    assert index is not None
    assert len(index.pts) == COUNT
    assert max(alive) <= 2  # the one before is still held by the loops as the next one is asked for


@pytest.mark.parametrize("name", ["film.mp4", "film.mkv", "film.ts"])
def test_a_jump_decodes_from_the_keyframe_before_it_alone(film, monkeypatch, name: str) -> None:
    """Also in MPEG's streams, where FFmpeg goes to the keyframe after the one it is asked for."""
    path = film(EVEN, name, bf="2", g="12", **{"x264-params": "scenecut=0"})
    frames = frames_of(path)
    with ClipSource(path) as source:
        monkeypatch.setattr(source, "rewind", lambda: pytest.fail("opened again"))
        monkeypatch.setattr(source, "_kept", 2)
        for place in (70, 30, 55, 13):
            passed: list[int] = []
            take = source._next

            def counted(take=take, passed=passed):
                passed.append(1)
                return take()

            with monkeypatch.context() as counting:
                counting.setattr(source, "_next", counted)
                source.seek_frame(place)
            assert len(passed) <= place % 12 + 1
            assert_same(source.read(), frames[place])
        for place in (60, 35, 12):  # by time as well, also where decoding begins with the very frame
            source.seek(frames[place].time_s)
            assert_same(source.read(), frames[place])


def test_an_index_that_is_wrong_is_not_believed(film, monkeypatch) -> None:
    """Its keyframes are none."""
    path = film(EVEN, bf="2", g="30")
    monkeypatch.setattr(ClipIndex, "keyframe_before", lambda _self, frame: max(0, frame - 2))
    assert_seeks_right(path)


def test_stepping_back_in_a_long_group_decodes_nothing_again(film, monkeypatch) -> None:
    path = film(EVEN, g="250")
    frames = frames_of(path)
    with ClipSource(path) as source:
        source.seek_frame(60)
        monkeypatch.setattr(source, "_jump", lambda _keyframe: pytest.fail("decoded again"))
        for place in range(60, 10, -1):
            source.seek_frame(place)
            assert_same(source.read(), frames[place])


def test_damage_is_no_end_and_known_damage_is_counted_as_before(damaged_clip: Path) -> None:
    with ClipSource(damaged_clip) as source:
        frames = list(source)
        for place in (len(frames) - 1, 5, len(frames) // 2):
            source.seek_frame(place)
            assert_same(source.read(), frames[place])
        source.seek(1e9)
        assert_same(source.read(), frames[-1])


def test_where_a_jump_meets_damage_frames_are_counted_from_the_start(film) -> None:
    """They have the numbers that they have when all are read; the index, in which damaged ones count, does not."""
    path = film(EVEN, "film.mkv", bf="0", g="12", **{"x264-params": "scenecut=0"})
    with av.open(str(path)) as container:
        packets = [(each.pos, each.size) for each in container.demux(video=0) if each.size]
    content = bytearray(path.read_bytes())
    for at, size in (packets[20], packets[21], packets[54]):
        start = content.index(bytes(1), at)  # behind Matroska's own words
        content[start + 8 : at + size] = bytes(at + size - start - 8)
    path.write_bytes(content)
    frames = frames_of(path)
    assert COUNT - 40 < len(frames) < COUNT
    with ClipSource(path) as source:
        for place in (57, 33, 0):
            source.seek_frame(place)
            assert_same(source.read(), frames[place])
            source.rewind()


@pytest.mark.parametrize("frames_left", [60, 40, 25])
def test_the_last_frame_of_a_clip_that_is_cut_is_found_at_once(film, frames_left: int) -> None:
    """The index has the one that is cut as well, and nobody knows yet that it cannot be read."""
    path = film(EVEN, "film.flv", codec="flv1", g="12")
    with av.open(str(path)) as container:
        starts = [each.pos for each in container.demux(video=0) if each.size]
    path.write_bytes(path.read_bytes()[: (starts[frames_left] + starts[frames_left + 1]) // 2])
    frames = frames_of(path)
    assert len(frames) == frames_left
    for time_s in (frames[-1].time_s, frames[-1].time_s + 0.05, 1e9):
        with ClipSource(path) as source:
            source.seek(time_s)
            assert_same(source.read(), frames[-1])
            assert source.read() is None


@pytest.mark.parametrize("name", ["film.ts", "film.h264"])
def test_a_length_that_is_not_stated_is_that_of_what_was_read(film, name: str) -> None:
    """By the first part's length alone, five seconds forwards in the second of two parts led back into the first."""
    path = film([time + 2000 for time in EVEN], name, bf="2", g="12")
    if name == "film.ts":
        path.write_bytes(2 * path.read_bytes())
    with ClipSource(path) as source:
        at_first_s = source.duration_s
        assert source.read() is not None
        assert source.duration_s == at_first_s
        *_, last = source
        assert at_first_s is None or at_first_s < 0.6 * last.time_s
        assert source.duration_s == pytest.approx(last.time_s)
        source.rewind()
        assert source.duration_s == pytest.approx(last.time_s)


@pytest.mark.parametrize("name", ["film.mp4", "film.mkv"])
def test_the_duration_is_known_before_the_end(film, name: str) -> None:
    """Wherever the first picture is, from which Matroska's header does not count."""
    with ClipSource(film([time + 7000 for time in EVEN], name, bf="2")) as source:
        assert source.duration_s == pytest.approx(EVEN[-1] / 1000, abs=0.005)
        assert source.read() is not None
        assert source.duration_s == pytest.approx(EVEN[-1] / 1000, abs=0.005), "however little of it was read"
        assert len(list(source)) == COUNT - 1
        assert source.note is None
        source.seek(1.0)
        source.rewind()
        assert source.duration_s == pytest.approx(EVEN[-1] / 1000, abs=1e-6)


def test_a_stated_length_is_believed_until_the_frames_are_listed_and_no_more_after_that(film, monkeypatch) -> None:
    """As of a clip with more sound than pictures, which is played again and again."""
    path = film(EVEN, g="12")
    monkeypatch.setattr(ClipPictures, "stated_duration_s", lambda _pictures: 100.0)
    with ClipSource(path) as source:
        assert source.duration_s == 100.0
        source.seek(1.0)
        assert source.duration_s == pytest.approx(EVEN[-1] / 1000)
        source.rewind()
        assert source.duration_s == pytest.approx(EVEN[-1] / 1000)


@pytest.mark.skipif(not REAL.is_dir(), reason="no shared/real beside the checkout")
def test_of_a_phones_clip() -> None:
    path = REAL / "vid_12.mp4"
    frames = frames_of(path)
    with ClipSource(path) as source:
        for place in (70, 35, 0):
            source.seek(frames[place].time_s)
            assert_same(source.read(), frames[place])

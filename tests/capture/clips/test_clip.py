"""Every readable frame of a clip, upright and at its own time; no clip at all is one clear line."""

import os
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from av.stream import Disposition
from av.video.frame import VideoFrame

from ashe_live.capture import container as container_module
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.container import DECODED
from ashe_live.capture.opening import open_source
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.sources import MAX_PIXELS
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from tests.shared_data import SHARED

REAL = SHARED / "real"


def test_whole_clip_has_no_note_and_stays_at_its_end(clip: Path) -> None:
    with ClipSource(clip) as source:
        assert (source.name, source.size, source.fps, source.is_live) == ("clip.mp4", (96, 64), 25.0, False)
        assert len(list(source)) == 60
        assert source.read() is None
        assert source.note is None


def test_rewinding_gives_the_same_frames_again(clip: Path) -> None:
    with ClipSource(clip) as source:
        first = [source.read() for _ in range(20)]
        source.rewind()
        second = [source.read() for _ in range(20)]
        source.seek_frame(12)
        source.rewind()
        assert len(list(source)) == 60
    for before, after in zip(first, second, strict=True):
        assert before is not None
        assert after is not None
        assert (before.index, before.time_s) == (after.index, after.time_s)
        np.testing.assert_array_equal(before.image_bgr, after.image_bgr)


def test_frames_stay_valid_after_later_reads_and_closing(clip: Path, picture: Callable[[int], Image]) -> None:
    with ClipSource(clip) as source:
        frames = list(source)
    assert np.abs(frames[5].image_bgr.astype(int) - picture(5)).mean() < 6


def test_closed_source_is_at_its_end(clip: Path) -> None:
    source = ClipSource(clip)
    source.seek_frame(9)
    source.seek_frame(3)
    source.close()
    source.close()
    assert source.read() is None


@pytest.mark.parametrize("share", [0.9, 0.6])
def test_truncated_clip_gives_the_readable_frames_and_says_so(clip: Path, share: float, tmp_path: Path) -> None:
    with ClipSource(clip) as source:
        whole = list(source)
    content = clip.read_bytes()
    cut = tmp_path / "cut.mp4"
    pictures = content.index(b"mdat")
    cut.write_bytes(content[: pictures + int((len(content) - pictures) * share)])
    with ClipSource(cut) as source:
        frames = list(source)
        assert 10 < len(frames) < 60
        assert source.note is not None
        assert f"only {len(frames)} frames" in source.note
    for frame, original in zip(frames, whole, strict=False):
        np.testing.assert_array_equal(frame.image_bgr, original.image_bgr)


@pytest.mark.parametrize("share", [1.0, 0.6])
def test_a_matroska_clip_that_is_cut_between_packets_says_so(clip: Path, share: float, tmp_path: Path) -> None:
    """Its header alone says how long it should be."""
    whole, cut = tmp_path / "whole.mkv", tmp_path / "cut.mkv"
    with av.open(str(clip)) as source, av.open(str(whole), "w") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(source.streams.video[0]):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    content = whole.read_bytes()
    cut.write_bytes(content[: int(len(content) * share)])
    with ClipSource(cut) as source:
        frames = list(source)
        assert (source.note is None) is (share == 1.0)
        assert len(frames) == 60 if share == 1.0 else f"only {len(frames)} frames" in source.note


def test_a_matroska_clip_whose_sound_goes_on_is_not_called_cut(picture: Callable[[int], Image], tmp_path: Path) -> None:
    with av.open(str(tmp_path / "a.mkv"), "w") as written:
        stream, sound = written.add_stream("mpeg4", rate=25), written.add_stream("pcm_s16le", rate=8000)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        for index in range(10):
            written.mux(stream.encode(VideoFrame.from_ndarray(picture(index), "bgr24")))
        silence = av.AudioFrame.from_ndarray(np.zeros((1, 16_000), np.int16), format="s16", layout="mono")
        silence.sample_rate = 8000
        written.mux([*stream.encode(None), *sound.encode(silence), *sound.encode(None)])
    with ClipSource(tmp_path / "a.mkv") as source:
        assert len(list(source)) == 10
        assert source.note is None


@pytest.mark.parametrize("share", [1.0, 0.3])
def test_of_a_matroska_clip_with_sound_its_tag_says_how_long_its_pictures_are(
    picture: Callable[[int], Image], tmp_path: Path, share: float
) -> None:
    """The sound goes on for twice as long as they do."""
    path = tmp_path / "a.mkv"
    with av.open(str(path), "w") as written:
        stream, sound = written.add_stream("mpeg4", rate=25), written.add_stream("pcm_s16le", rate=8000)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        for index in range(50):
            written.mux(stream.encode(VideoFrame.from_ndarray(picture(index), "bgr24")))
            silence = av.AudioFrame.from_ndarray(np.zeros((1, 640), np.int16), format="s16", layout="mono")
            silence.sample_rate, silence.pts = 8000, 640 * index
            written.mux(sound.encode(silence))
        written.mux([*stream.encode(None), *sound.encode(None)])
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * share)])
    with ClipSource(path) as source:
        assert source.duration_s == pytest.approx(49 / 25, abs=2e-3)
        count = len(list(source))
        assert source.note == (
            None if share == 1.0 else f"a.mkv is truncated or damaged: only {count} frames could be read"
        )


@pytest.mark.parametrize(("name", "codec", "pixels"), [("a.avi", "rawvideo", "bgr24"), ("a.gif", "gif", "rgb8")])
def test_a_clip_that_does_not_state_its_duration_says_that_it_is_cut(
    picture: Callable[[int], Image], tmp_path: Path, name: str, codec: str, pixels: str
) -> None:
    """An AVI states how many pictures it has; a GIF only ends with a mark. Cut anywhere, also between two pictures."""
    path = tmp_path / name
    with av.open(str(path), "w") as written:
        stream = written.add_stream(codec, rate=25)
        stream.width, stream.height, stream.pix_fmt = 96, 64, pixels
        for index in range(30):
            frame = VideoFrame.from_ndarray(picture(index), "bgr24")
            written.mux(stream.encode(frame.reformat(format=pixels)))
        written.mux(stream.encode(None))
    with av.open(str(path)) as clip:
        starts = [packet.pos for packet in clip.demux(video=0) if packet.size]
    with ClipSource(path) as source:
        assert len(list(source)) == 30
        assert source.note is None
    content = path.read_bytes()
    for size in (starts[20], starts[20] + 1, starts[20] + 100, starts[21] - 1):
        path.write_bytes(content[:size])
        with ClipSource(path) as source:
            count = len(list(source))
            assert 19 <= count <= 21
            assert source.note == f"{name} is truncated or damaged: only {count} frames could be read"


def test_damage_in_the_middle_does_not_end_the_clip(damaged_clip: Path) -> None:
    with ClipSource(damaged_clip) as source:
        frames = list(source)
        assert source.note is not None
    assert 10 < len(frames) <= 60
    assert (np.diff([frame.time_s for frame in frames]) > 0).all()


@pytest.mark.parametrize(
    ("container", "codec"),
    [("avi", "mpeg4"), ("matroska", "mpeg4"), ("mpegts", "mpeg2video"), ("flv", "flv"), ("mjpeg", "mjpeg")],
)
def test_what_follows_a_clip_is_not_searched_to_the_end(
    tmp_path: Path, container: str, codec: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1 TB of holes: FFmpeg would look for hours whether a picture is there."""
    monkeypatch.setattr(container_module, "MOST_BYTES_TO_A_PACKET", 5_000_000)
    path = tmp_path / "clip"
    with av.open(str(path), "w", format=container) as written:
        stream = written.add_stream(codec, rate=30)
        stream.width, stream.height = 64, 48
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        for grey in range(6):
            written.mux(stream.encode(VideoFrame.from_ndarray(np.full((48, 64, 3), 40 * grey, np.uint8), "bgr24")))
        written.mux(stream.encode(None))
    os.truncate(path, 1 << 40)
    with ClipSource(path) as source:
        brightness = [frame.image_bgr.mean() for frame in list(source)]
        source.seek_frame(1)
        again = source.read()
        assert again is not None
    assert 4 <= len(brightness) <= 6
    np.testing.assert_allclose(brightness, 40 * np.arange(len(brightness)), atol=4)
    assert again.image_bgr.mean() == brightness[1]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"Not a clip at all.\n" * 99, "not a clip"),
        (b"\x00\x00\x00\x18ftypmp42" + bytes(99), "no list of its pictures: it is cut short"),
    ],
)
def test_what_is_no_clip_is_refused_in_one_line(
    tmp_path: Path, content: bytes, says: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.mp4"
    path.write_bytes(content)
    with pytest.raises(UserError, match=says) as caught:
        ClipSource(path)
    assert "bad.mp4" in caught.value.message
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("has_cover", [False, True])
def test_sound_alone_is_said_to_be_that(tmp_path: Path, has_cover: bool) -> None:
    path = tmp_path / "voice.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=44100)
        if has_cover:
            cover = container.add_stream("mjpeg", rate=25)
            cover.width, cover.height, cover.pix_fmt = 96, 64, "yuvj420p"
            cover.disposition = Disposition.attached_pic
            container.start_encoding()
            grey = VideoFrame.from_ndarray(np.full((64, 96, 3), 90, np.uint8), "bgr24").reformat(format="yuvj420p")
            container.mux([*cover.encode(grey), *cover.encode(None)])
        silence = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        silence.sample_rate = 44100
        container.mux([*stream.encode(silence), *stream.encode(None)])
    with pytest.raises(UserError, match="sound and no picture"):
        ClipSource(path)


def test_clip_cut_before_its_first_picture_is_refused(clip: Path) -> None:
    content = clip.read_bytes()
    clip.write_bytes(content[: content.index(b"mdat") + 8])
    with pytest.raises(UserError, match="no readable picture in it: copy or record it again"):
        ClipSource(clip)


def test_clip_of_pictures_that_are_too_long_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "panorama.mkv"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = 16_386, 2, "yuv420p"
        container.mux(stream.encode(VideoFrame.from_ndarray(np.zeros((2, 16_386, 3), np.uint8), "bgr24")))
        container.mux(stream.encode(None))
    with pytest.raises(UserError, match="longer than 16384 pixels"):
        ClipSource(path)


def test_no_memory_is_spent_on_a_picture_of_too_many_pixels(
    picture: Callable[[int], Image], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither as the file is opened, nor where a clip of small ones goes on with it."""
    small, large = (cv2.imencode(".png", cv2.resize(picture(0), size))[1].tobytes() for size in ((96, 64), (192, 128)))
    alone, grows = tmp_path / "alone.avi", tmp_path / "grows.avi"
    _write_packets(alone, "png", "rgb24", [large])
    _write_packets(grows, "png", "rgb24", [small, large, small])
    assert int(DECODED["max_pixels"]) == MAX_PIXELS
    monkeypatch.setitem(DECODED, "max_pixels", str(192 * 128 - 1))
    with pytest.raises(UserError, match=r"has more than 110 million pixels: scale it down"):
        ClipSource(alone)
    with ClipSource(grows) as source:
        assert len(list(source)) == 2
        assert source.note is not None
        assert "truncated or damaged" in source.note


def test_a_picture_of_very_many_scans_within_a_clip_is_damage(tmp_path: Path) -> None:
    """Each of a few bytes takes as long as the whole picture."""
    noise = np.random.default_rng(0).integers(0, 256, (64, 96, 3), np.uint8)
    good = cv2.imencode(".jpg", noise, [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])[1].tobytes()
    endless = good[:-2] + good[good.rindex(b"\xff\xda") : -2] * 200 + good[-2:]
    path = tmp_path / "a.mkv"
    _write_packets(path, "mjpeg", "yuvj420p", [good, endless, good])
    with ClipSource(path) as source:
        assert len(list(source)) == 2
        assert source.note is not None
        assert "truncated or damaged" in source.note


@pytest.mark.parametrize("far", [2**30, 2**50])
def test_a_time_beyond_all_clips_is_damage(tmp_path: Path, far: int) -> None:
    """In thirtieths of a second, of which 2^50 in ticks of a recording are more than 64 bits hold."""
    jpeg = cv2.imencode(".jpg", np.full((64, 96, 3), 90, np.uint8))[1].tobytes()
    path, recorded = tmp_path / "a.nut", tmp_path / "recorded.mp4"
    _write_packets(path, "mjpeg", "yuvj420p", [jpeg] * 4, times=[0, 1, far, far + 1])
    with ClipSource(path) as source, Recorder(recorded, source.size, 30.0) as recorder:
        frames = list(source)
        for frame in frames:
            recorder.write(frame.image_bgr, frame.time_s)
        np.testing.assert_allclose([frame.time_s for frame in frames], np.arange(4) / 30, atol=1e-6)
        source.seek(3 / 30)
        assert (last := source.read()) is not None
        assert last.index == 3
    with ClipSource(recorded) as source:
        assert len(list(source)) == 4


def _write_packets(
    path: Path, codec: str, pixels: str, contents: list[bytes], times: Sequence[int] | None = None
) -> None:
    """A clip of pictures that are encoded already, the first of 96 x 64; `times` in thirtieths of a second."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=30)
        stream.width, stream.height, stream.pix_fmt = 96, 64, pixels
        container.start_encoding()
        for time, content in zip(times or range(len(contents)), contents, strict=True):
            packet = av.Packet(content)
            packet.stream, packet.pts, packet.dts, packet.time_base = stream, time, time, Fraction(1, 30)
            packet.is_keyframe = True
            container.mux(packet)


@pytest.mark.parametrize("pictures", [1, 3, 12])
def test_pictures_in_jpeg_one_after_the_other_are_a_clip_however_large_and_many(tmp_path: Path, pictures: int) -> None:
    """FFmpeg alone takes what begins with a picture of more bytes than it looks at for that picture."""
    noise = np.random.default_rng(3).integers(0, 256, (480, 640, 3), np.uint8)
    jpeg = cv2.imencode(".jpg", noise)[1].tobytes()
    path = tmp_path / "camera.mjpeg"
    path.write_bytes(jpeg * pictures)
    with open_source(path) as source:
        assert isinstance(source, ClipSource)
        assert [frame.size for frame in list(source)] == [(640, 480)] * pictures
    # SOF0: length, precision, height, width.
    sizes = bytes.fromhex("ffc0001108 01e0 0280"), bytes.fromhex("ffc0001108 3fff 3fff")
    assert jpeg.count(sizes[0]) == 1
    path.write_bytes(jpeg.replace(*sizes) * pictures)
    with pytest.raises(UserError, match="110 million pixels"):
        open_source(path)


def test_pictures_in_jpeg_one_after_the_other_are_a_clip_and_those_of_another_shape_are_said(tmp_path: Path) -> None:
    """As from a recorded call: half the size is the same picture, another shape would bend its angles."""
    bright = cv2.imencode(".jpg", np.full((48, 64, 3), 200, np.uint8))[1].tobytes()
    half = cv2.imencode(".jpg", np.full((24, 32, 3), 100, np.uint8))[1].tobytes()
    upright = cv2.imencode(".jpg", np.full((64, 48, 3), 0, np.uint8))[1].tobytes()
    path = tmp_path / "call.mjpeg"
    path.write_bytes(bright * 3 + half * 3)
    with open_source(path) as source:
        assert [round(frame.image_bgr.mean(), -1) for frame in list(source)] == [200] * 3 + [100] * 3
        assert source.note is None
    path.write_bytes(bright * 3 + upright * 3 + half * 2)
    with open_source(path) as source:
        frames = list(source)
        assert [round(frame.image_bgr.mean(), -1) for frame in frames] == [200] * 3 + [100] * 2
        assert {frame.size for frame in frames} == {(64, 48)}
        assert source.note is not None
        assert "only the 5 of the first are shown" in source.note


def _write_clip(
    path: Path, image: np.ndarray, quarter_turns: int, pixel_aspect: Fraction = Fraction(1), mirrored: bool = False
) -> None:
    """Three times the picture (h, w, 3) BGR, to be shown turned anticlockwise, its pixels so much wider than high.

    mirrored: left to right, after it was turned.
    """
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=30, options={"crf": "10"})
        stream.height, stream.width = image.shape[:2]
        stream.pix_fmt = "yuv420p"
        stream.codec_context.sample_aspect_ratio = pixel_aspect
        stream.set_display_rotation(90.0 * quarter_turns, hflip=mirrored)
        for _ in range(3):
            container.mux(stream.encode(VideoFrame.from_ndarray(image, "bgr24")))
        container.mux(stream.encode(None))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("quarter_turns", [0, 1, 2, 3])
def test_rotation_and_mirroring_of_the_metadata_are_applied(tmp_path: Path, quarter_turns: int, mirrored: bool) -> None:
    path = tmp_path / "phone.mp4"
    image = np.full((64, 96, 3), 40, np.uint8)
    image[:20, :30] = (30, 60, 220)
    _write_clip(path, image, quarter_turns, mirrored=mirrored)
    with ClipSource(path) as source:
        frame = source.read()
        assert frame is not None
        upright = np.rot90(image, quarter_turns)
        upright = upright[:, ::-1] if mirrored else upright
        assert source.size == frame.size == (upright.shape[1], upright.shape[0])
        assert np.abs(frame.image_bgr.astype(int) - upright).mean() < 6
    if mirrored:  # which OpenCV does not know
        return
    turned_by_opencv, opencvs_image = cv2.VideoCapture(str(path)).read()
    assert turned_by_opencv
    assert np.abs(frame.image_bgr.astype(int) - opencvs_image).mean() < 6


@pytest.mark.parametrize(
    ("aspect", "size"),
    [
        (Fraction(4, 3), (128, 64)),
        (Fraction(3, 4), (96, 85)),
        (Fraction(1), (96, 64)),
        (Fraction(1000, 1001), (96, 64)),  # of an encoder that rounds
        (Fraction(400), (96, 64)),  # of a damaged file
    ],
)
@pytest.mark.parametrize("quarter_turns", [0, 1])
def test_squeezed_pixels_become_square(
    tmp_path: Path, aspect: Fraction, size: tuple[int, int], quarter_turns: int
) -> None:
    path = tmp_path / "camcorder.mp4"
    image = np.full((64, 96, 3), 40, np.uint8)
    image[:, 48:] = (30, 60, 220)
    _write_clip(path, image, quarter_turns, aspect)
    with ClipSource(path) as source:
        frame = source.read()
        assert frame is not None
        assert source.size == frame.size == (size if quarter_turns == 0 else size[::-1])
    upright = np.rot90(frame.image_bgr, -quarter_turns).astype(int)
    # The step stays in the middle.
    np.testing.assert_allclose(
        upright[20, [5, size[0] // 2 - 5, size[0] // 2 + 5, size[0] - 5], 2], (40, 40, 220, 220), atol=12
    )


@pytest.mark.skipif(not REAL.is_dir(), reason="no shared/real beside the checkout")
@pytest.mark.parametrize(
    ("name", "size", "count", "last_s"), [("vid_12", (1440, 1080), 79, 2.6), ("vid_5", (848, 480), 485, 16.13)]
)
def test_real_clips_are_read_to_their_last_frame(name: str, size: tuple[int, int], count: int, last_s: float) -> None:
    with ClipSource(REAL / f"{name}.mp4") as source:
        shapes, times = zip(*((frame.size, frame.time_s) for frame in source), strict=True)
        assert source.note is None
    assert set(shapes) == {size}
    assert len(times) == count
    assert times[-1] == pytest.approx(last_s, abs=1e-6)
    np.testing.assert_allclose(np.diff(times), 1 / 30, atol=0.01)

"""Photos as phones, scanners and painting programs write them, as 8-bit BGR, upright."""

import math
import os
import signal
import struct
import zlib
from pathlib import Path

import numpy as np
import PIL.ExifTags
import PIL.Image
import pillow_heif
import pytest

from ashe_live.capture import photo as photo_module
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.isolated_photo import HEIF, read_isolated
from ashe_live.capture.opening import open_source
from ashe_live.capture.photo import PhotoSource
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files import slow_pictures

HEIC = b"\x00\x00\x00\x18ftypheic" + bytes(99)  # begins as such a photo, and has no picture


def read(path: Path) -> Image:
    with PhotoSource(path) as source:
        frame = source.read()
        assert frame is not None
        return frame.image_bgr


@pytest.fixture
def rgb() -> Image:
    image = np.full((40, 60, 3), (200, 120, 30), np.uint8)
    image[:10, :20] = (10, 20, 250)
    return image


def test_gives_one_frame_then_the_end_and_again_after_rewinding(tmp_path: Path, rgb: Image) -> None:
    path = tmp_path / "a.png"
    PIL.Image.fromarray(rgb).save(path)
    with PhotoSource(path) as source:
        assert (source.size, source.fps, source.is_photo) == ((60, 40), None, True)
        for _ in range(2):
            frame = source.read()
            assert frame is not None
            assert (frame.index, frame.time_s) == (0, 0.0)
            np.testing.assert_array_equal(frame.image_bgr, rgb[:, :, ::-1])
            assert source.read() is None
            source.rewind()


def test_a_damaged_tag_says_nothing_against_the_picture(tmp_path: Path, rgb: Image) -> None:
    """A name where the width should be: Pillow cannot write that again, which nobody asks for."""
    exif = PIL.Image.Exif()
    exif[PIL.ExifTags.Base.Make], exif[PIL.ExifTags.Base.Orientation] = "Camera", 6
    damaged = exif.tobytes().replace(b"\x01\x0f", b"\x01\x00")
    path = tmp_path / "a.jpg"
    PIL.Image.fromarray(rgb).save(path, exif=damaged, quality=95, subsampling=0)
    frame = PhotoSource(path).read()
    assert frame is not None
    upright = np.rot90(rgb, -1)[:, :, ::-1]
    assert frame.image_bgr.shape == upright.shape
    assert np.abs(frame.image_bgr.astype(int) - upright).mean() < 3


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_respected(tmp_path: Path, rgb: Image, orientation: int) -> None:
    """How the stored picture is to be changed for each of EXIF's orientations (tag 0x112)."""
    upright = {
        1: rgb,
        2: rgb[:, ::-1],
        3: rgb[::-1, ::-1],
        4: rgb[::-1],
        5: rgb.transpose(1, 0, 2),
        6: np.rot90(rgb, -1),
        7: rgb.transpose(1, 0, 2)[::-1, ::-1],
        8: np.rot90(rgb, 1),
    }[orientation]
    exif = PIL.Image.Exif()
    exif[0x112] = orientation
    PIL.Image.fromarray(rgb).save(tmp_path / "a.jpg", exif=exif, quality=95, subsampling=0)
    PIL.Image.fromarray(rgb).save(tmp_path / "a.tif", exif=exif)  # which Pillow turns as it loads it
    for name in ("a.jpg", "a.tif"):
        image = read(tmp_path / name)
        assert image.shape == upright.shape
        assert np.abs(image.astype(int) - upright[:, :, ::-1]).mean() < 3


def test_grey_of_16_bits_is_reduced(tmp_path: Path) -> None:
    ramp = np.tile(np.linspace(0, 65535, 60).astype(np.uint16), (40, 1))
    PIL.Image.fromarray(ramp).save(tmp_path / "a.png")
    image = read(tmp_path / "a.png")
    np.testing.assert_array_equal(image, np.repeat((ramp >> 8)[:, :, None], 3, axis=2))


def test_a_whole_photo_of_floating_point_numbers_is_not_called_damaged(tmp_path: Path) -> None:
    PIL.Image.fromarray(np.ones((4, 4), np.float32)).save(tmp_path / "a.tiff")
    with pytest.raises(UserError, match="floating-point pixels, which are not read"):
        read(tmp_path / "a.tiff")


@pytest.mark.parametrize("name", ["a.dng", "a.nef", "a.tif"])
def test_the_preview_in_a_raw_photo_is_not_taken_for_the_photo(tmp_path: Path, rgb: Image, name: str) -> None:
    """Raw files are TIFF whose first picture is reduced, as NewSubfileType (tag 254) says; the photo comes later."""
    PIL.Image.fromarray(rgb).save(tmp_path / name, "TIFF", tiffinfo={254: 1})
    with pytest.raises(UserError, match="is a raw photo, of which only a small preview can be read: develop it"):
        open_source(tmp_path / name)


def test_grey_of_8_bits_is_repeated(tmp_path: Path, rgb: Image) -> None:
    PIL.Image.fromarray(rgb[:, :, 0]).save(tmp_path / "a.png")
    np.testing.assert_array_equal(read(tmp_path / "a.png"), np.repeat(rgb[:, :, :1], 3, axis=2))


def planar_tiff(rgb: np.ndarray) -> bytes:
    """TIFF 6.0, without compression: all of red, then all of green, then all of blue."""
    bits, (height, width, _) = 8 * rgb.itemsize, rgb.shape
    values = {256: [width], 257: [height], 258: [bits] * 3, 259: [1], 262: [2], 273: [], 277: [3], 278: [height]}
    values |= {279: [rgb.nbytes // 3] * 3, 284: [2]}
    begin = 8 + 2 + 12 * len(values) + 4  # of what does not fit into the table
    values[273] = [begin + 36 + plane * rgb.nbytes // 3 for plane in range(3)]
    table, more = struct.pack("<H", len(values)), b""
    for tag, numbers in values.items():
        is_long = len(numbers) > 1
        table += struct.pack("<HHII", tag, 4, len(numbers), begin + len(more) if is_long else numbers[0])
        more += struct.pack(f"<{len(numbers)}I", *numbers) if is_long else b""
    assert len(more) == 36
    planes = np.moveaxis(rgb, 2, 0).astype(rgb.dtype.newbyteorder("<")).tobytes()
    return b"II*\0" + struct.pack("<I", 8) + table + bytes(4) + more + planes


def test_a_tiff_of_one_colour_after_the_other_is_right_or_refused(tmp_path: Path, rgb: Image) -> None:
    """Of 16 bits Pillow takes each byte for a pixel: every picture would be two halves, one above the other."""
    (tmp_path / "8.tif").write_bytes(planar_tiff(rgb))
    np.testing.assert_array_equal(read(tmp_path / "8.tif"), rgb[:, :, ::-1])
    (tmp_path / "16.tif").write_bytes(planar_tiff(rgb.astype(np.uint16) * 257))
    with pytest.raises(UserError, match=r"16\.tif has one colour of 16 bits after the other"):
        read(tmp_path / "16.tif")


def test_what_is_transparent_lies_on_white(tmp_path: Path, rgb: Image) -> None:
    alpha = np.full((40, 60, 1), 255, np.uint8)
    alpha[20:] = 0
    PIL.Image.fromarray(np.concatenate([rgb, alpha], axis=2)).save(tmp_path / "a.png")
    image = read(tmp_path / "a.png")
    np.testing.assert_array_equal(image[:20], rgb[:20, :, ::-1])
    assert (image[20:] == 255).all()


@pytest.mark.parametrize(
    ("name", "more", "moves"),
    [
        ("a.webp", 2, True),
        ("a.png", 2, True),
        ("a.avif", 2, True),
        ("a.webp", 0, False),
        ("a.png", 0, False),
        ("a.mpo", 1, False),  # a preview
        ("a.tif", 1, False),  # a page
    ],
)
def test_of_an_animation_the_first_picture_is_shown_and_said_to_be_that(
    tmp_path: Path, rgb: Image, name: str, more: int, moves: bool
) -> None:
    others = [PIL.Image.fromarray(np.ascontiguousarray(rgb[::-1, :: 1 - 2 * i])) for i in range(more)]
    PIL.Image.fromarray(rgb).save(tmp_path / name, save_all=True, append_images=others)
    with open_source(tmp_path / name) as source:
        frame = source.read()
        assert frame is not None
        assert np.abs(frame.image_bgr.astype(int) - rgb[:, :, ::-1]).mean() < 6
        expected = f"{name} is an animation, of which the first picture is shown: convert it to MP4 or GIF"
        assert source.note == (expected if moves else None)


def test_truncated_photo_is_refused_and_not_half_grey(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (80, 80, 3), np.uint8)
    path = tmp_path / "a.jpg"
    PIL.Image.fromarray(noise).save(path)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(UserError, match=r"a\.jpg is damaged"):
        open_source(path)
    assert capfd.readouterr().err == ""


def test_huge_photo_is_refused_by_its_header(tmp_path: Path) -> None:
    """Only the header says that it is large: without the limit, it would be refused as damaged."""
    path = tmp_path / "a.png"
    PIL.Image.new("L", (8, 8)).save(path)
    content = bytearray(path.read_bytes())
    content[16:24] = (20_000).to_bytes(4, "big") * 2
    content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, "big")
    path.write_bytes(content)
    with pytest.raises(UserError, match="million pixels"):
        open_source(path)


@pytest.mark.parametrize("kind", ["webp", "avif", "png", "tif"])
def test_what_a_header_announces_is_not_read_to_the_end_of_a_huge_file(tmp_path: Path, rgb: Image, kind: str) -> None:
    """Pillow keeps all of it in memory."""
    path = tmp_path / f"a.{kind}"
    PIL.Image.fromarray(rgb).save(path)
    with path.open("r+b") as file:
        if kind == "png":  # a text after the header, of 2 GB
            file.seek(33)
            file.write(b"\x7f\xff\xff\xfftEXt")
        file.truncate(20 << 30)
    with pytest.raises(UserError, match=r"has 21,474 MB, and a photo may have 440 MB"):
        open_source(path)


def test_a_large_file_is_read_isolated_to_the_same_picture(
    tmp_path: Path, rgb: Image, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where that begins is a constant: 64 MB would be looked through for seconds."""
    monkeypatch.setattr(photo_module, "LARGE_FILE_BYTES", 100_000)
    isolated = []
    monkeypatch.setattr(
        photo_module, "read_isolated", lambda path, *how: isolated.append(path.name) or read_isolated(path, *how)
    )
    plain = with_exif(tmp_path / "a.jpg", rgb, 26)
    large = tmp_path / "b.jpg"
    large.write_bytes(plain.read_bytes())
    os.truncate(large, 100_001)
    with PhotoSource(large) as source:
        assert source.focal_px == pytest.approx(26 * 60 / 36)
        frame = source.read()
    assert frame is not None
    np.testing.assert_array_equal(frame.image_bgr, read(plain))
    large.write_bytes(plain.read_bytes()[:60])
    os.truncate(large, 100_001)
    with pytest.raises(UserError, match=r"b\.jpg is damaged"):
        open_source(large)
    assert isolated == ["b.jpg"] * 2


def test_a_jpeg_of_very_many_scans_is_refused(tmp_path: Path) -> None:
    """Each of a few bytes takes as long as the whole picture; what looks like one in a trailer counts for nothing."""
    path = tmp_path / "a.jpg"
    noise = np.random.default_rng(0).integers(0, 256, (80, 80, 3), np.uint8)
    PIL.Image.fromarray(noise).save(path, progressive=True)
    content = path.read_bytes()
    path.write_bytes(content + b"\xff\xda" * 999)
    assert read(path).shape == (80, 80, 3)
    scan = content[content.rindex(b"\xff\xda") : -2]
    path.write_bytes(content[:-2] + scan * 999 + content[-2:])
    with pytest.raises(UserError, match=r"in 10\d\d scans"):
        open_source(path)


def test_a_jpeg_of_very_many_parts_is_refused(tmp_path: Path) -> None:
    """Its reader keeps each as an object, for megabytes of four bytes each."""
    path = tmp_path / "a.jpg"
    PIL.Image.new("RGB", (80, 80)).save(path)
    content = path.read_bytes()
    path.write_bytes(content[:2] + b"\xff\xe5\x00\x02" * 10_001 + content[2:])
    with pytest.raises(UserError, match="in more than 10,000 parts"):
        open_source(path)


def bmp_in_run_lengths(size: tuple[int, int], runs: bytes) -> bytes:
    """8 bits a pixel, shades of grey: BI_RLE8."""
    palette = bytes(value for shade in range(256) for value in (shade, shade, shade, 0))
    start = 54 + len(palette)
    begin = struct.pack("<2sIHHI", b"BM", start + len(runs), 0, 0, start)
    return begin + struct.pack("<IiiHHIIiiII", 40, *size, 1, 8, 1, len(runs), 0, 0, 0, 0) + palette + runs


SLOW = {
    "text.ppm": b"P3 2 1 255 0 127 255 # a comment\n255 127 0",
    "text.pbm": b"P1 # a comment\n2 1 1 0",
    "other.ppm": b"P6 2 1 51 " + bytes([0, 10, 51, 51, 10, 0]),
    "twelve_bits.pgm": b"P5 2 1 4095 \x08\x00\x0f\xff",
    "runs.bmp": bmp_in_run_lengths((2, 1), b"\x01\x80\x01\xff\x00\x01"),
}


@pytest.mark.parametrize("name", SLOW)
def test_photos_that_are_decoded_slowly_are_read_where_they_are_small(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(SLOW[name])
    assert read(tmp_path / name).shape == (1, 2, 3)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("text.ppm", b"P3 4000 2600 255\n"),
        ("other.ppm", b"P6 2000 1700 254\n"),
        ("twelve_bits.pgm", b"P5 4000 2600 4095\n"),
        ("runs.bmp", bmp_in_run_lengths((16_384, 6_700), b"\1\1\0\0" * 6_700)),
    ],
)
def test_a_photo_that_would_be_decoded_for_seconds_is_refused(tmp_path: Path, name: str, content: bytes) -> None:
    """By its header: what follows is missing, and would be damage."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError, match=r"is too large for its kind, .* which takes long to read: save it as PNG"):
        open_source(tmp_path / name)
    (tmp_path / name).write_bytes(SLOW[name])
    os.truncate(tmp_path / name, 40_000_001)
    with pytest.raises(UserError, match="is too large for its kind"):
        open_source(tmp_path / name)


@pytest.mark.parametrize(
    "content",
    [
        b"P3 2 1 255\n" + b"#\n" * 1001 + b"0 127 255 255 127 0",
        b"P3 2 1 255 0 127 255 255 127 0" + b" " * 65_536 + b"#\n" * 1001,
        b"P6 #" + b"x" * 65_536 + b"\n2 1 255 012345",
        b"P5 2 1" + b" " * 65_536 + b"255 01",
        b"Pf #" + b"x" * 65_536 + b"\n2 1 -1.0 01234567",
        b"PyRGBA " + b" " * 65_536 + b"2 1 255 01234567",
        b"P6 2 1#\n#\n 2#" + b"x" * 65_536 + b"\n55 012345",
    ],
    ids=["many", "many later", "one long", "spaces", "floating point", "Pillow's own", "within a number"],
)
def test_comments_without_end_are_refused(tmp_path: Path, content: bytes) -> None:
    """Pillow reads a header byte by byte, and for each comment of a text copies all that follows: minutes for 10 MB."""
    (tmp_path / "a.ppm").write_bytes(content)
    with pytest.raises(UserError, match="has comments without end: save it as PNG"):
        open_source(tmp_path / "a.ppm")


@pytest.mark.parametrize(
    ("kind", "mark", "part"),
    [
        ("PNG", b"IDAT", bytes(4) + b"teSt" + zlib.crc32(b"teSt").to_bytes(4, "big")),
        ("JPEG2000", b"jp2h", b"\0\0\0\x08test"),
        ("JPEG2000", b"ihdr", b"\0\0\0\1test" + bytes(7) + b"\x10"),
    ],
    ids=["chunks", "boxes", "boxes in a box"],
)
def test_parts_without_end_are_refused(
    tmp_path: Path, rgb: Image, monkeypatch: pytest.MonkeyPatch, kind: str, mark: bytes, part: bytes
) -> None:
    """Pillow reads them one by one: half a minute for 64 MB of them. What follows the picture does not count."""
    monkeypatch.setattr(slow_pictures, "MOST_PARTS", 50)
    path = tmp_path / "a"
    PIL.Image.fromarray(rgb).save(path, kind)
    content = path.read_bytes()
    at = content.index(mark) - 4
    for count, is_refused in ((40, False), (50, True)):
        changed = bytearray(content[:at] + count * part + content[at:])
        if mark == b"ihdr":
            header = content.index(b"jp2h") - 4
            size = int.from_bytes(content[header : header + 4], "big") + count * len(part)
            changed[header : header + 4] = size.to_bytes(4, "big")
        path.write_bytes(changed + 100 * part)
        if is_refused:
            with pytest.raises(UserError, match=r"is in more than 50 parts, .*: save it as JPEG"):
                open_source(path)
        else:
            np.testing.assert_array_equal(read(path), rgb[:, :, ::-1])


def test_a_picture_all_of_whose_pixels_look_like_spaces_or_comments_is_read(tmp_path: Path) -> None:
    for shade in b" #":
        (tmp_path / "a.ppm").write_bytes(b"P6 200 200 255 " + bytes([shade]) * 120_000)
        assert (read(tmp_path / "a.ppm") == shade).all()
    (tmp_path / "a.pbm").write_bytes(b"P4 1000 1000 " + b"\xff" * 125_000)
    assert (read(tmp_path / "a.pbm") == 0).all()


def test_no_program_is_started_for_a_photo(tmp_path: Path, rgb: Image) -> None:
    """Pillow would have Ghostscript run what is in PostScript."""
    PIL.Image.fromarray(rgb).save(tmp_path / "a.eps")
    with pytest.raises(UserError, match="is not a clip or photo that can be read"):
        open_source(tmp_path / "a.eps")


@pytest.mark.parametrize("size", [(16_385, 2), (2, 16_385)])
def test_longer_photo_than_any_camera_is_refused(tmp_path: Path, size: tuple[int, int]) -> None:
    path = tmp_path / "panorama.png"
    PIL.Image.new("RGB", size).save(path)
    with pytest.raises(UserError, match="longer than 16384 pixels"):
        open_source(path)


def test_kind_is_recognised_by_content_and_only_then_by_name(tmp_path: Path, rgb: Image, clip: Path) -> None:
    PIL.Image.fromarray(rgb).save(tmp_path / "photo.mp4", "PNG")
    clip.rename(tmp_path / "clip.dat")
    assert isinstance(open_source(tmp_path / "photo.mp4"), PhotoSource)
    with open_source(tmp_path / "clip.dat") as source:
        assert isinstance(source, ClipSource)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("none.mp4", None, "there is no file"),
        (".", None, "is a folder"),
        ("empty.jpg", b"", "is empty"),
        ("text.jpg", b"text" * 99, "does not begin as a photo of a known format"),
        ("phone.heic", HEIC, "is damaged"),
        ("phone.mov", HEIC, "is damaged"),
        ("phone", HEIC, "is damaged"),
        ("text.txt", b"text" * 99, "not a clip or photo that can be read"),
        ("hiro.patt", b" 255 0 12" * 99, "is a marker, and no clip or photo"),
    ],
)
def test_unreadable_files_are_one_clear_line(tmp_path: Path, name: str, content: bytes | None, says: str) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError, match=says):
        open_source(tmp_path / name)


def test_damage_of_which_the_decoder_gives_no_reason_is_said_without_one(tmp_path: Path) -> None:
    """Of a PNG whose palette is missing Pillow says nothing, and "damaged ()" was said."""
    path = tmp_path / "a.png"
    PIL.Image.new("P", (4, 4)).save(path)
    content = path.read_bytes()
    begin, end = content.index(b"PLTE") - 4, content.index(b"IDAT") - 4
    path.write_bytes(content[:begin] + content[end:])
    with pytest.raises(UserError, match=r"a\.png is damaged: copy it again"):
        open_source(path)


@pytest.mark.parametrize(("name", "orientation"), [("phone.heic", 6), ("phone.jpg", 1), ("phone.mov", 6), ("phone", 1)])
def test_photos_of_iphones_are_read_whatever_their_name(
    tmp_path: Path, rgb: Image, name: str, orientation: int
) -> None:
    """HEIC states its orientation twice, in its container and in its EXIF data."""
    exif = PIL.Image.Exif()
    exif[PIL.ExifTags.Base.Orientation] = orientation
    exif.get_ifd(PIL.ExifTags.IFD.Exif)[PIL.ExifTags.Base.FocalLengthIn35mmFilm] = 26
    photo = pillow_heif.from_pillow(PIL.Image.fromarray(rgb))
    photo.info["exif"] = exif.tobytes()
    photo.save(tmp_path / "saved.heic", quality=-1, chroma=444)
    (tmp_path / "saved.heic").rename(tmp_path / name)
    upright = rgb if orientation == 1 else np.rot90(rgb, -1)
    with open_source(tmp_path / name) as source:
        assert isinstance(source, PhotoSource)
        assert source.focal_px == pytest.approx(26 * 60 / 36)
        assert source.quarter_turns == (0 if orientation == 1 else 3)
        frame = source.read()
    assert frame is not None
    # Lossless but for the conversion to luma and chroma.
    np.testing.assert_allclose(frame.image_bgr, upright[:, :, ::-1], atol=2)


def test_a_truncated_heic_photo_is_refused(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (80, 80, 3), np.uint8)
    path = tmp_path / "a.heic"
    pillow_heif.from_pillow(PIL.Image.fromarray(noise)).save(path)
    whole = path.read_bytes()
    for left in (20, 300, len(whole) // 2, len(whole) - 10):
        path.write_bytes(whole[:left])
        with pytest.raises(UserError, match=r"a\.heic is damaged"):
            open_source(path)


def crashing(_path: Path, _picture: PIL.Image.Image) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def test_a_photo_that_crashes_its_decoder_is_refused(tmp_path: Path, rgb: Image) -> None:
    path = tmp_path / "a.heic"
    pillow_heif.from_pillow(PIL.Image.fromarray(rgb)).save(path)
    with pytest.raises(UserError, match=r"a\.heic is damaged"):
        read_isolated(path, HEIF, crashing)


def with_exif(path: Path, rgb: Image, millimetres: object, taken: tuple[int, int] | None = None) -> Path:
    exif = PIL.Image.Exif()
    details = exif.get_ifd(PIL.ExifTags.IFD.Exif)
    details[PIL.ExifTags.Base.FocalLengthIn35mmFilm] = millimetres
    if taken is not None:
        details[PIL.ExifTags.Base.ExifImageWidth], details[PIL.ExifTags.Base.ExifImageHeight] = taken
    PIL.Image.fromarray(rgb).save(path, exif=exif)
    return path


def test_the_focal_length_is_that_of_35_mm_film(tmp_path: Path, rgb: Image) -> None:
    """Film 36 mm wide and 24 mm high: a picture of 60x40 has 60 / 36 pixels a millimetre."""
    with PhotoSource(with_exif(tmp_path / "a.jpg", rgb, 26)) as source:
        assert source.focal_px == pytest.approx(26 * 60 / 36)
    with PhotoSource(with_exif(tmp_path / "b.jpg", rgb, 26, taken=(6000, 4000))) as source:
        assert source.focal_px == pytest.approx(26 * 60 / 36)


@pytest.mark.parametrize("cut", [(400, 300), (300, 400), (400, 225), (225, 400), (300, 300), (375, 300), (398, 300)])
def test_what_the_camera_leaves_out_of_its_sensors_picture_changes_no_focal_length(
    tmp_path: Path, cut: tuple[int, int]
) -> None:
    """Phones take 4:3; as 16:9, 5:4 or as a square they state the same, as the lens sees on the same sensor."""
    width, height = cut
    path = with_exif(tmp_path / "a.jpg", np.zeros((height, width, 3), np.uint8), 26, taken=cut)
    with PhotoSource(path) as source:
        assert source.focal_px == pytest.approx(26 * 500 / math.hypot(36, 24), rel=0.004)


def test_no_focal_length_is_better_than_a_wrong_one(tmp_path: Path, rgb: Image) -> None:
    plain = tmp_path / "plain.jpg"
    PIL.Image.fromarray(rgb).save(plain)
    # Not stated, stated as unknown, absurd; cut out of a picture of another shape, and a panorama.
    told_nothing = [plain, with_exif(tmp_path / "0.jpg", rgb, 0), with_exif(tmp_path / "9999.jpg", rgb, 9999)]
    told_nothing.append(with_exif(tmp_path / "cut.jpg", rgb, 26, taken=(4000, 3000)))
    told_nothing.append(with_exif(tmp_path / "wide.jpg", np.tile(rgb, (1, 3, 1)), 26))
    for path in told_nothing:
        with PhotoSource(path) as source:
            assert source.focal_px is None

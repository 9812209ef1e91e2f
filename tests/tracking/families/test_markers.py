"""Specs: what they name, and that each wrong one is refused with one line and a remedy."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import PIL.ExifTags
import PIL.Image
import pytest

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.tracking.families.dictionary_marker import APRILTAG_FAMILIES, DICTIONARIES
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.families.pattern_files import read_pattern_content
from tests.tracking.conftest import SPECS, glyph, pattern_text


@pytest.mark.parametrize("spec", SPECS)
@pytest.mark.parametrize("turns", range(4))
def test_a_printed_bitmap_is_found_with_its_own_top_left_corner_first(
    marker_of: Callable[[str], Marker], spec: str, turns: int
) -> None:
    marker = marker_of(spec)
    bitmap = marker.bitmap(120)
    assert bitmap.shape == (120, 120)
    assert bitmap.dtype == np.uint8
    sheet = np.rot90(cv2.copyMakeBorder(bitmap, 40, 40, 40, 40, cv2.BORDER_CONSTANT, value=255), turns)
    upright = np.array([(40, 40), (159, 40), (159, 159), (40, 159)])
    found = next(iter(marker.find(np.ascontiguousarray(sheet))), None)
    assert found is not None
    # Turned counter-clockwise, the top-left corner goes to where the bottom-left one was.
    assert np.abs(found - np.roll(upright, turns, axis=0)).max() < 2


@pytest.mark.parametrize("spec", SPECS)
def test_another_marker_is_not_found(marker_of: Callable[[str], Marker], spec: str) -> None:
    marker = marker_of(spec)
    for other in SPECS:
        same_picture = {spec.partition(":")[0], other.partition(":")[0]} == {"pattern", "image"}
        if other != spec and not same_picture:
            sheet = cv2.copyMakeBorder(marker_of(other).bitmap(120), 40, 40, 40, 40, cv2.BORDER_CONSTANT, value=255)
            assert not marker.find(sheet), other


@pytest.mark.parametrize("spec", SPECS)
def test_a_marker_that_is_too_small_to_draw_is_wrong_use(marker_of: Callable[[str], Marker], spec: str) -> None:
    with pytest.raises(ValueError, match="pixels"):
        marker_of(spec).bitmap(4)


@pytest.mark.parametrize("name", sorted(DICTIONARIES))
def test_every_dictionary_name_is_understood(name: str) -> None:
    assert parse_marker(f"aruco:{name}:0").spec == f"aruco:{name}:0"


def test_the_families_are_those_that_the_spec_promises() -> None:
    assert {"4x4_50", "5x5_100", "original"} <= set(DICTIONARIES)
    assert set(APRILTAG_FAMILIES) == {"16h5", "25h9", "36h10", "36h11"}


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("", "aruco:4x4_50:0"),
        ("kanji", "pattern:FILE.patt"),
        ("aruco:4x4_50", "aruco:4x4_50:0"),
        ("aruco:4x4_50:x", "aruco:4x4_50:0"),
        ("aruco:4x4_50:-1", "aruco:4x4_50:0"),
        ("aruco:4x4_50:²", "aruco:4x4_50:0"),
        ("aruco:9x9_50:1", "4x4_50"),
        ("aruco:4x4_50:50", "from 0 to 49"),
        ("aruco:4x4_50:99999999999999999999", "from 0 to 49"),
        ("apriltag:4x4_50:1", "36h11"),
        ("apriltag:36h11:587", "from 0 to 586"),
        ("pattern:", "pattern:FILE.patt"),
        ("pattern:/nowhere/at/all.patt", "check the name"),
        ("image:/nowhere/at/all.png", "check the name"),
        ("image:bad\0name.png", "check the name"),
        ("pattern:/", "name a file"),
    ],
)
def test_a_wrong_spec_is_one_line_with_its_remedy(spec: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_marker(spec)
    assert "\n" not in str(caught.value)
    assert words in caught.value.remedy


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "bad.patt is empty"),
        (" ", "holds 0 numbers"),
        ("1 2 3", "holds 3 numbers"),
        ("255 " * 3072 + "1", "holds 3073 numbers"),
        ("256 " * 3072, "beyond a byte"),
        ("-1 " * 3072, "beyond a byte"),
        ("12.5 " * 3072, "whole numbers"),
        ("ü", "whole numbers"),
        ("9" * 5000, "whole numbers"),
        ("9" * 100 + " ", "holds 1 numbers"),
        ("1 " * 40000, "holds 40000 numbers"),
        ("1 " * 300_000, "bytes"),
        ("200 " * 3072, "contrast"),
    ],
)
def test_a_wrong_pattern_file_is_refused(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "bad.patt"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(UserError, match=words):
        parse_marker(f"pattern:{path}")


@pytest.mark.parametrize("side", [16, 32, 64])
@pytest.mark.parametrize("begins_with", ["", "\ufeff"])
def test_a_pattern_file_has_as_many_rows_as_artoolkit_was_asked_for(
    tmp_path: Path, side: int, begins_with: str
) -> None:
    """And a byte order mark where an editor of Windows has saved it."""
    content = np.asarray(cv2.resize(glyph(), (side, side), interpolation=cv2.INTER_NEAREST), dtype=np.uint8)
    path = tmp_path / "f.patt"
    path.write_text(begins_with + pattern_text(content), encoding="utf-8")
    np.testing.assert_array_equal(read_pattern_content(path), content)
    usual = tmp_path / "usual.patt"
    usual.write_text(pattern_text(glyph()), encoding="ascii")
    apart = parse_marker(f"pattern:{path}").bitmap(64).astype(int) - parse_marker(f"pattern:{usual}").bitmap(64)
    assert np.abs(apart).mean() < 10


@pytest.mark.parametrize(
    ("orientation", "shown"),
    [(1, np.copy), (3, lambda grey: grey[::-1, ::-1]), (6, lambda grey: np.rot90(grey, -1)), (2, np.fliplr)],
)
def test_a_photo_of_a_print_is_the_marker_as_it_is_shown(
    tmp_path: Path, picture_file: Path, orientation: int, shown: Callable[[Image], Image]
) -> None:
    """How it is to be turned for EXIF's orientations: a marker's frame is that of its upright print."""
    with PIL.Image.open(picture_file) as picture:
        grey, exif = np.asarray(picture.convert("L")), PIL.Image.Exif()
        exif[PIL.ExifTags.Base.Orientation] = orientation
        picture.save(tmp_path / "turned.png", exif=exif)
    np.testing.assert_array_equal(parse_marker(f"image:{tmp_path / 'turned.png'}").bitmap(128), shown(grey))


def test_a_picture_of_16_bits_is_the_one_of_8(tmp_path: Path, picture_file: Path) -> None:
    grey = cv2.imread(str(picture_file), cv2.IMREAD_GRAYSCALE)
    cv2.imwrite(str(tmp_path / "deep.png"), grey.astype(np.uint16) * 257)
    np.testing.assert_array_equal(parse_marker(f"image:{tmp_path / 'deep.png'}").bitmap(128), grey)


def test_a_picture_is_no_pattern_file_and_the_other_way_round(tmp_path: Path, picture_file: Path) -> None:
    with pytest.raises(UserError, match="is a picture") as caught:
        parse_marker(f"pattern:{picture_file}")
    assert caught.value.remedy == f"name it by image:{picture_file}"
    path = tmp_path / "letter.patt"
    path.write_text(pattern_text(glyph()), encoding="ascii")
    with pytest.raises(UserError) as caught:
        parse_marker(f"image:{path}")
    assert f"pattern:{path}" in caught.value.remedy


def test_a_pattern_that_looks_the_same_turned_is_refused(tmp_path: Path) -> None:
    ring = np.full((16, 16), 240, dtype=np.uint8)
    ring[5:11, 5:11] = 0
    path = tmp_path / "ring.patt"
    path.write_text(pattern_text(ring), encoding="ascii")
    with pytest.raises(UserError, match="the same"):
        parse_marker(f"pattern:{path}")


def test_the_channels_of_a_pattern_file_are_blue_green_and_red(tmp_path: Path) -> None:
    """A letter in the first channel only is blue, which is the darkest of the three in grey."""
    flat = np.full((16, 16), 100)
    spread = {}
    for channel in range(3):
        planes = [flat, flat, flat]
        planes[channel] = np.where(glyph() > 100, 255, 0)
        path = tmp_path / f"{channel}.patt"
        path.write_text(" ".join(str(v) for v in np.array([planes] * 4).ravel()), encoding="ascii")
        spread[channel] = np.ptp(read_pattern_content(path))
    assert spread[0] < spread[2] < spread[1]


@pytest.mark.parametrize(
    ("shape", "value", "words"),
    [
        ((100, 140), 0, "not square"),
        ((100, 103), 0, "not square"),
        ((40, 5000), 0, "too large"),
        ((20, 20), 0, "too small"),
        ((5000, 5000), 0, "too large"),
        ((64, 64), 0, "contrast"),
        ((64, 64), 255, "contrast"),
    ],
)
def test_a_picture_that_is_no_marker_is_refused(tmp_path: Path, shape: tuple[int, int], value: int, words: str) -> None:
    path = tmp_path / "bad.png"
    cv2.imwrite(str(path), np.full(shape, value, dtype=np.uint8))
    with pytest.raises(UserError, match=words):
        parse_marker(f"image:{path}")


@pytest.mark.parametrize("side", [12_000, 30_000])
def test_a_picture_that_says_it_is_enormous_is_refused_in_the_same_words(tmp_path: Path, side: int) -> None:
    """From 89 million pixels on Pillow warns, and from twice as many it refuses them."""
    header = b"IHDR" + struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    path = tmp_path / "enormous.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header)))
    with path.open("ab") as file:
        file.write(struct.pack(">I", 0) + b"IDAT" + struct.pack(">I", zlib.crc32(b"IDAT")))
    with pytest.raises(UserError, match=r"enormous\.png is too large: scale it to at most \d+ pixels a side"):
        parse_marker(f"image:{path}")


def test_a_picture_of_very_many_scans_is_refused(tmp_path: Path) -> None:
    """Each of a few bytes takes as long as the whole picture."""
    path = tmp_path / "endless.jpg"
    noise = np.random.default_rng(0).integers(0, 256, (64, 64), np.uint8)
    content = cv2.imencode(".jpg", noise, [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])[1].tobytes()
    path.write_bytes(content[:-2] + content[content.rindex(b"\xff\xda") : -2] * 200 + content[-2:])
    with pytest.raises(UserError, match=r"in 20\d scans"):
        parse_marker(f"image:{path}")


def test_a_picture_that_is_decoded_for_seconds_is_refused(tmp_path: Path) -> None:
    """A BMP in run lengths, of as many pixels as another picture may have: its header alone."""
    begin = struct.pack("<2sIHHIIiiHHIIiiII", b"BM", 0, 0, 0, 1078, 40, 4096, 4096, 1, 8, 1, 0, 0, 0, 0, 0)
    (tmp_path / "runs.bmp").write_bytes(begin + bytes(1024))
    with pytest.raises(UserError, match="is too large for its kind, a BMP in run lengths"):
        parse_marker(f"image:{tmp_path / 'runs.bmp'}")


def test_a_picture_with_its_white_margin_is_refused(tmp_path: Path, picture_file: Path) -> None:
    path = tmp_path / "margin.png"
    black_square = cv2.imread(str(picture_file), cv2.IMREAD_GRAYSCALE)
    assert black_square is not None
    cv2.imwrite(str(path), cv2.copyMakeBorder(black_square, 20, 20, 20, 20, cv2.BORDER_CONSTANT, value=255))
    with pytest.raises(UserError, match="no black border") as caught:
        parse_marker(f"image:{path}")
    assert "cropped to its edge" in caught.value.remedy


def test_an_empty_picture_is_said_to_be_empty(tmp_path: Path) -> None:
    (tmp_path / "logo.png").touch()
    with pytest.raises(UserError, match=r"logo\.png is empty"):
        parse_marker(f"image:{tmp_path / 'logo.png'}")


def test_what_is_no_picture_is_refused(tmp_path: Path, picture_file: Path) -> None:
    whole = picture_file.read_bytes()
    for content in (b"not a picture", whole[: len(whole) // 2]):
        path = tmp_path / "broken.png"
        path.write_bytes(content)
        with pytest.raises(UserError, match="cannot read"):
            parse_marker(f"image:{path}")

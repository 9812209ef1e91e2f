"""Photos whose colours are not sRGB's: those that a person sees, in sRGB."""

import struct
from pathlib import Path

import numpy as np
import PIL.ExifTags
import PIL.Image
import pillow_heif
import pytest
from PIL import ImageCms

from ashe_live.capture.photo import PhotoSource
from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from tests.capture.clips.test_wide_gamut import (
    BT709,
    BT2020_PRIMARIES,
    HLG_TRANSFER,
    P3,
    P3_PRIMARIES,
    PQ_TRANSFER,
    REC_709,
    REC_2020,
    SRGB_TRANSFER,
    in_primaries,
    xyz_from_rgb,
)

# The columns are R, G and B in XYZ under D50, as profiles state them (SMPTE EG 432-1 and IEC 61966-2-1, adapted).
DISPLAY_P3 = np.array([(0.51512, 0.29198, 0.15710), (0.24120, 0.69225, 0.06657), (-0.00105, 0.04189, 0.78407)])
SRGB = np.array([(0.43607, 0.38515, 0.14307), (0.22249, 0.71687, 0.06061), (0.01392, 0.09708, 0.71410)])
COLOURS = np.array(
    [(0, 0, 0), (64, 64, 64), (180, 180, 180), (255, 255, 255), (200, 100, 60), (60, 120, 50), (40, 60, 160)], np.uint8
)


def profile(xyz_from_rgb: Float, more: bytes = b"") -> bytes:
    """ICC.1:2010 with these primaries and sRGB's curve, and a private tag of `more`."""

    def fixed(*values: float) -> bytes:
        return b"".join(struct.pack(">i", round(value * 65536)) for value in values)

    curve = b"para" + bytes(4) + struct.pack(">HH", 3, 0) + fixed(2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
    tags = {b"wtpt": b"XYZ " + bytes(4) + fixed(0.9642, 1.0, 0.8249)}
    for place, name in enumerate("rgb"):
        tags[f"{name}XYZ".encode()] = b"XYZ " + bytes(4) + fixed(*xyz_from_rgb[:, place])
        tags[f"{name}TRC".encode()] = curve
    if more:
        tags[b"test"] = b"data" + bytes(8) + more
    table, content = struct.pack(">I", len(tags)), b""
    begin = 128 + 4 + 12 * len(tags)
    for name, body in tags.items():
        table += name + struct.pack(">II", begin + len(content), len(body))
        content += body
    size = begin + len(content)
    header = struct.pack(">I4sI4s4s4s", size, bytes(4), 0x04200000, b"mntr", b"RGB ", b"XYZ ") + bytes(12) + b"acsp"
    return header.ljust(68, b"\0") + fixed(0.9642, 1.0, 0.8249).ljust(60, b"\0") + table + content


def photo(path: Path, rgb: Image, icc: bytes) -> Image:
    """Written with that profile, and read: (n, 3) RGB."""
    PIL.Image.fromarray(rgb[None]).save(path, icc_profile=icc)
    frame = PhotoSource(path).read()
    assert frame is not None
    return np.asarray(frame.image_bgr[0, :, ::-1])


def test_display_p3_has_its_true_colours(tmp_path: Path) -> None:
    linear = linear_from_srgb(COLOURS / 255) @ (np.linalg.inv(DISPLAY_P3) @ SRGB).T
    coded = np.rint(255 * srgb_from_linear(np.clip(linear, 0, 1))).astype(np.uint8)
    assert np.abs(coded.astype(int) - COLOURS).max() > 10
    seen = photo(tmp_path / "phone.png", coded, profile(DISPLAY_P3))
    np.testing.assert_allclose(seen.astype(int), COLOURS, atol=2)


def test_a_profile_of_megabytes_counts_as_one_of_kilobytes(tmp_path: Path) -> None:
    """As those of printers, which are tables. Pillow refuses a PNG for one."""
    small, large = profile(DISPLAY_P3), profile(DISPLAY_P3, bytes(2_000_000))
    seen = photo(tmp_path / "small.png", COLOURS, small)
    assert np.abs(seen.astype(int) - COLOURS).max() > 5
    np.testing.assert_array_equal(photo(tmp_path / "large.png", COLOURS, large), seen)


def test_pictures_in_srgb_keep_their_bits(tmp_path: Path) -> None:
    for icc in (profile(SRGB), ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()):
        np.testing.assert_array_equal(photo(tmp_path / "photo.png", COLOURS, icc), COLOURS)


@pytest.mark.parametrize("icc", [b"no profile", profile(DISPLAY_P3)[:200], profile(DISPLAY_P3)[:128] + b"\xff" * 400])
def test_a_damaged_profile_says_nothing_against_the_picture(tmp_path: Path, icc: bytes) -> None:
    np.testing.assert_array_equal(photo(tmp_path / "photo.png", COLOURS, icc), COLOURS)


def test_grey_with_the_profile_of_a_coloured_picture_stays_grey(tmp_path: Path) -> None:
    PIL.Image.fromarray(COLOURS[:4, :1].copy()[..., 0]).save(tmp_path / "grey.png", icc_profile=profile(DISPLAY_P3))
    frame = PhotoSource(tmp_path / "grey.png").read()
    assert frame is not None
    np.testing.assert_array_equal(frame.image_bgr[:, 0], COLOURS[:4])


# Of Adobe RGB (1998), in its Color Image Encoding: R, G and B beside the white D65.
ADOBE = np.array([(0.640, 0.330), (0.210, 0.710), (0.150, 0.060)])


def heic(path: Path, rgb: Image, primaries: int, transfer: int) -> Image:
    """Written in HEIC as patches of these colours (n, 3), stated by numbers, and read: (n, 3) RGB."""
    picture = PIL.Image.fromarray(np.repeat(np.repeat(rgb[None], 64, axis=0), 64, axis=1))
    numbers = {"color_primaries": primaries, "transfer_characteristics": transfer, "matrix_coefficients": 1}
    pillow_heif.from_pillow(picture).save(path, quality=-1, chroma=444, **numbers)
    frame = PhotoSource(path).read()
    assert frame is not None
    return np.asarray(frame.image_bgr[32, 32::64, ::-1])


@pytest.mark.parametrize(
    ("primaries", "transfer", "chromaticities"),
    [
        (BT2020_PRIMARIES, HLG_TRANSFER, REC_2020),
        (P3_PRIMARIES, SRGB_TRANSFER, P3),
        (BT709, SRGB_TRANSFER, REC_709),
    ],
)
def test_heic_has_the_colours_that_its_numbers_state(
    tmp_path: Path, primaries: int, transfer: int, chromaticities: Float
) -> None:
    """As of cameras' HDR, and of phones without a profile."""
    coded = in_primaries(COLOURS, chromaticities)
    np.testing.assert_allclose(heic(tmp_path / "a.heic", coded, primaries, transfer).astype(int), COLOURS, atol=4)


def test_pq_of_a_heic_is_no_grey_haze(tmp_path: Path) -> None:
    """BT.2408, table 1: reference white is 58 % of PQ, and 75 % of HLG, which is shown as it is."""
    greys = np.repeat(np.array([[0], [97], [148]], np.uint8), 3, axis=1)
    seen = heic(tmp_path / "canon.hif", greys, BT2020_PRIMARIES, PQ_TRANSFER)
    np.testing.assert_allclose(seen.astype(int), np.repeat([[0], [97], [191]], 3, axis=1), atol=5)


def of_dcf(path: Path, rgb: Image, index: str, **saved: bytes) -> Image:
    """Written as a camera does that keeps to DCF, by the interoperability index, and read: (n, 3) RGB."""
    exif = PIL.Image.Exif()
    exif.get_ifd(PIL.ExifTags.IFD.Exif)[PIL.ExifTags.IFD.Interop] = {1: index}
    picture = PIL.Image.fromarray(np.repeat(np.repeat(rgb[None], 16, axis=0), 16, axis=1))
    picture.save(path, exif=exif, quality=100, subsampling=0, **saved)
    frame = PhotoSource(path).read()
    assert frame is not None
    return np.asarray(frame.image_bgr[8, 8::16, ::-1])


def test_adobe_rgb_of_a_camera_has_its_true_colours_without_a_profile(tmp_path: Path) -> None:
    linear = linear_from_srgb(COLOURS / 255) @ (np.linalg.inv(xyz_from_rgb(ADOBE)) @ xyz_from_rgb(REC_709)).T
    coded = np.rint(255 * linear.clip(0, 1) ** (256 / 563)).astype(np.uint8)
    assert np.abs(coded.astype(int) - COLOURS).max() > 10
    np.testing.assert_allclose(of_dcf(tmp_path / "a.jpg", coded, "R03").astype(int), COLOURS, atol=4)


def test_srgb_of_a_camera_keeps_its_bits_and_a_profile_goes_before_the_camera(tmp_path: Path) -> None:
    plain = of_dcf(tmp_path / "plain.jpg", COLOURS, "R98")
    np.testing.assert_allclose(plain.astype(int), COLOURS, atol=2)
    np.testing.assert_array_equal(of_dcf(tmp_path / "edited.jpg", COLOURS, "R03", icc_profile=profile(SRGB)), plain)


def test_a_tall_photo_is_converted_to_its_last_row(tmp_path: Path) -> None:
    tall = np.full((601, 1, 3), (200, 100, 60), np.uint8)
    exif = PIL.Image.Exif()
    exif.get_ifd(PIL.ExifTags.IFD.Exif)[PIL.ExifTags.IFD.Interop] = {1: "R03"}
    PIL.Image.fromarray(tall).save(tmp_path / "a.webp", exif=exif, lossless=True)
    frame = PhotoSource(tmp_path / "a.webp").read()
    assert frame is not None
    assert frame.image_bgr[0, 0, 2] > 210
    assert (frame.image_bgr == frame.image_bgr[0]).all()

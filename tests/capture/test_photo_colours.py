"""Photos with an ICC profile: the colours that a person sees, in sRGB."""

import struct
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from PIL import ImageCms

from ashe_live.capture.photo import PhotoSource
from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear

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

"""HDR clips: the colours of what was filmed, in sRGB."""

from pathlib import Path

import av
import numpy as np
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.wide_gamut import hlg_from_pq, srgb_converter
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear

# Numbers of ISO/IEC 23091-2.
BT709, UNSPECIFIED, BT2020_PRIMARIES, P3_PRIMARIES = 1, 2, 9, 12
SRGB_TRANSFER = 13
PQ_TRANSFER, HLG_TRANSFER = 16, 18
# Chromaticities x, y of R, G, B and of their white, D65.
REC_709 = np.array([(0.640, 0.330), (0.300, 0.600), (0.150, 0.060)])
REC_2020 = np.array([(0.708, 0.292), (0.170, 0.797), (0.131, 0.046)])
P3 = np.array([(0.680, 0.320), (0.265, 0.690), (0.150, 0.060)])
D65 = (0.3127, 0.3290)
# sRGB, 8 bits: greys, and colours as things have them.
COLOURS = np.array(
    [(0, 0, 0), (64, 64, 64), (180, 180, 180), (255, 255, 255), (200, 100, 60), (60, 120, 50), (40, 60, 160)]
)


def xyz_from_rgb(primaries: np.ndarray) -> np.ndarray:
    """(3, 3) of linear R, G, B with these chromaticities, as much of each as makes D65 together."""
    columns = np.array([(x / y, 1, (1 - x - y) / y) for x, y in (*primaries, D65)]).T
    return columns[:, :3] * np.linalg.solve(columns[:, :3], columns[:, 3])


def in_primaries(srgb: np.ndarray, primaries: np.ndarray) -> np.ndarray:
    """(n, 3) 8 bits of the same colours."""
    linear = linear_from_srgb(srgb / 255) @ (np.linalg.inv(xyz_from_rgb(primaries)) @ xyz_from_rgb(REC_709)).T
    return np.rint(255 * srgb_from_linear(linear)).astype(np.uint8)


def in_2020(srgb: np.ndarray) -> np.ndarray:
    return in_primaries(srgb, REC_2020)


@pytest.mark.parametrize(
    ("primaries", "transfer", "chromaticities"),
    [
        (BT2020_PRIMARIES, HLG_TRANSFER, REC_2020),
        (UNSPECIFIED, HLG_TRANSFER, REC_2020),  # which has these alone
        (P3_PRIMARIES, SRGB_TRANSFER, P3),
        (P3_PRIMARIES, BT709, P3),
    ],
)
def test_colours_of_wide_primaries_come_back(primaries: int, transfer: int, chromaticities: np.ndarray) -> None:
    convert = srgb_converter(primaries, transfer)
    assert convert is not None
    back = convert(np.ascontiguousarray(in_primaries(COLOURS, chromaticities)[None, :, ::-1]))[0, :, ::-1]
    np.testing.assert_allclose(back.astype(int), COLOURS, atol=2)


@pytest.mark.parametrize("primaries", [BT709, UNSPECIFIED, BT2020_PRIMARIES, P3_PRIMARIES])
def test_pq_is_no_grey_haze_whatever_its_primaries(primaries: int) -> None:
    """Black stays, and reference white, 58 %, is as light as HLG has it: 75 %. All primaries have the same white."""
    convert = srgb_converter(primaries, PQ_TRANSFER)
    assert convert is not None
    greys = np.repeat(np.array([0, 97, 148], np.uint8)[None, :, None], 3, axis=2)
    np.testing.assert_allclose(convert(greys)[0].astype(int).T, [[0, 97, 191]] * 3, atol=3)


def test_a_red_of_pq_with_the_primaries_of_other_pictures_is_that_red() -> None:
    convert = srgb_converter(BT709, PQ_TRANSFER)
    assert convert is not None
    back = convert(np.array([[[0, 0, 148]]], np.uint8))[0, 0]
    np.testing.assert_allclose(back.astype(int), (0, 0, 191), atol=3)


def test_greys_of_hlg_keep_their_bits() -> None:
    """Both sets of primaries have the same white."""
    greys = np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 3, axis=2)
    convert = srgb_converter(BT2020_PRIMARIES, HLG_TRANSFER)
    assert convert is not None
    np.testing.assert_array_equal(convert(greys.copy()), greys)


def test_ordinary_pictures_are_left_as_they_are() -> None:
    assert srgb_converter(BT709, HLG_TRANSFER) is None
    assert srgb_converter(BT709, SRGB_TRANSFER) is None
    assert srgb_converter(UNSPECIFIED, UNSPECIFIED) is None


def test_pq_and_hlg_agree_where_the_recommendation_says_so() -> None:
    """BT.2408, table 1: reference white, 203 nits, is 58 % of PQ and 75 % of HLG; 18 % grey is 38 % of both."""
    np.testing.assert_allclose(hlg_from_pq(np.array([0.58, 0.38])), (0.75, 0.38), atol=0.01)
    signal = hlg_from_pq(np.linspace(0, 1, 500))
    assert (np.diff(signal) >= 0).all()
    assert signal.min() >= 0
    assert signal.max() == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(("transfer", "coded", "seen"), [(HLG_TRANSFER, 0.58, 0.58), (PQ_TRANSFER, 0.58, 0.75)])
def test_a_clip_says_which_colours_it_has(tmp_path: Path, transfer: int, coded: float, seen: float) -> None:
    path = tmp_path / "hdr.mkv"
    grey, rust = np.full(3, round(255 * coded)), np.array((200, 100, 60))
    halves = np.repeat(np.array([grey, in_2020(rust)], np.uint8), 32, axis=0)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv444p10le"
        stream.codec_context.color_primaries = BT2020_PRIMARIES
        stream.codec_context.color_trc = transfer
        picture = av.VideoFrame.from_ndarray(np.tile(halves, (48, 1, 1)), format="rgb24")
        container.mux([*stream.encode(picture), *stream.encode()])
    with ClipSource(path) as clip:
        frame = clip.read()
    assert frame is not None
    left, right = frame.image_bgr[24, [16, 48], ::-1].astype(int)
    np.testing.assert_allclose(left, 255 * seen, atol=5)
    if transfer == HLG_TRANSFER:
        np.testing.assert_allclose(right, rust, atol=6)

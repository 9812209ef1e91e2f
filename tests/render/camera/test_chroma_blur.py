"""How coarse a picture's colours are, of pictures whose colours were blurred by so much."""

import cv2
import numpy as np
import pytest

from ashe_live.render.camera.chroma_blur import TRIED_PX, chroma_blur_px
from ashe_live.render.camera.grain import has_coarse_chroma


def _tiles(seed: int = 2) -> np.ndarray:
    """(160, 160, 3) YCrCb: a sheet of paper on tiles of two colours, with noise in all of it."""
    rng = np.random.default_rng(seed)
    picture = np.full((160, 160, 3), (90, 150, 110), np.float32)
    picture[:, 80:] = (120, 140, 105)
    cv2.fillConvexPoly(picture, np.array([(35, 40), (120, 30), (130, 120), (45, 125)]), (200, 128, 128))
    return cv2.GaussianBlur(picture, (0, 0), 0.6) + rng.normal(0, 1.0, picture.shape).astype(np.float32)


def _photo(ycrcb: np.ndarray) -> np.ndarray:
    return cv2.cvtColor(np.uint8(np.clip(np.round(ycrcb), 0, 255)), cv2.COLOR_YCrCb2BGR)


@pytest.mark.parametrize("sigma", [0.0, 1.0, 1.75, 2.25, 3.25])
def test_the_blur_of_colours_is_found_beside_sharp_brightness(sigma: float) -> None:
    picture = _tiles()
    if sigma:
        picture[..., 1:] = cv2.GaussianBlur(picture[..., 1:], (0, 0), sigma)
    assert chroma_blur_px(_photo(picture)) == pytest.approx(sigma, abs=0.2)


def test_a_blur_of_everything_is_none_of_the_colours() -> None:
    assert chroma_blur_px(cv2.GaussianBlur(_photo(_tiles()), (0, 0), 1.5)) == pytest.approx(0.0, abs=0.5)


def test_a_very_wide_blur_is_the_widest_that_is_tried() -> None:
    picture = _tiles()
    picture[..., 1:] = cv2.GaussianBlur(picture[..., 1:], (0, 0), 7.0)
    assert chroma_blur_px(_photo(picture)) == TRIED_PX[-1]


def test_a_picture_without_colour_or_without_edges_gives_no_measurement() -> None:
    grey = np.repeat(_photo(_tiles())[..., :1], 3, axis=2)
    assert chroma_blur_px(grey) is None
    assert chroma_blur_px(np.full((160, 160, 3), (40, 90, 160), np.uint8)) is None
    assert chroma_blur_px(np.full((6, 5, 3), (40, 90, 160), np.uint8)) is None
    assert not has_coarse_chroma(grey)


def _border(colour: tuple[int, int, int], other: tuple[int, int, int]) -> np.ndarray:
    """(160, 160, 3) YCrCb of two surfaces."""
    picture = np.full((160, 160, 3), colour, np.float32)
    picture[:, 80:] = other
    return cv2.GaussianBlur(picture, (0, 0), 0.6)


def test_one_border_of_two_colours_is_enough_and_a_tint_of_grey_is_too_little() -> None:
    coloured, grey = _border((70, 150, 100), (200, 120, 140)), _border((70, 126, 129), (200, 130, 127))
    coloured[..., 1:] = cv2.GaussianBlur(coloured[..., 1:], (0, 0), 2.0)
    assert chroma_blur_px(_photo(coloured)) == pytest.approx(2.0, abs=0.2)
    assert chroma_blur_px(_photo(grey)) is None


def test_noise_of_one_channel_is_no_border_of_two_surfaces() -> None:
    """Colour and brightness go together in it, from pixel to pixel."""
    picture = np.full((160, 160, 3), 120, np.uint8)
    picture[..., 2] = np.clip(120 + np.random.default_rng(1).normal(0, 20, (160, 160)), 0, 255)
    assert chroma_blur_px(picture) is None


def test_colours_that_do_not_go_with_brightness_tell_nothing() -> None:
    rng = np.random.default_rng(1)
    patches = np.stack([rng.normal(mean, sigma, (40, 40)) for mean, sigma in ((120, 40), (128, 15), (128, 15))], axis=2)
    assert chroma_blur_px(_photo(patches.repeat(4, axis=0).repeat(4, axis=1))) is None

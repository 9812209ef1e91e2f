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

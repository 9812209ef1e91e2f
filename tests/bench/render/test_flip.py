"""FLIP: colours as its paper has them, and what a difference that a person sees must obey."""

import numpy as np
import pytest

from ashe_live.bench.render.flip import flip_error
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear


def _even(colour: tuple[int, int, int]) -> np.ndarray:
    return np.full((40, 60, 3), colour, np.uint8)


# CIE L*a*b* of sRGB's primaries and white under D65, as in any textbook.
BLACK, WHITE = ((0, 0, 0), (0.0, 0.0, 0.0)), ((255, 255, 255), (100.0, 0.0, 0.0))
RED, GREEN, BLUE = (
    ((0, 0, 255), (53.241, 80.092, 67.203)),
    ((0, 255, 0), (87.735, -86.183, 83.180)),
    ((255, 0, 0), (32.297, 79.188, -107.860)),
)


def _hyab(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """The distance of two colours whose chroma is scaled by their lightness: |dL| + |dC|."""
    (light, *ab), (other_light, *other_ab) = one, other
    chroma = np.subtract(np.multiply(ab, 0.01 * light), np.multiply(other_ab, 0.01 * other_light))
    return abs(light - other_light) + float(np.hypot(*chroma))


@pytest.mark.parametrize(("one", "other"), [(BLACK, WHITE), (GREEN, BLUE), (RED, GREEN), (RED, BLACK), (BLUE, WHITE)])
def test_even_pictures_differ_by_their_colours_compressed_so_that_green_differs_from_blue_by_one(one, other) -> None:
    """To the power of 0.7; four tenths of the largest difference count 0.95, and what is beyond them the rest."""
    largest, distance = (_hyab(*labs) ** 0.7 for labs in ((GREEN[1], BLUE[1]), (one[1], other[1])))
    share = distance / largest
    expected = 0.95 / 0.4 * share if share < 0.4 else 0.95 + 0.05 * (share - 0.4) / 0.6
    assert flip_error(_even(one[0]), _even(other[0])) == pytest.approx(np.full((40, 60), expected), abs=1e-4)


def test_near_greys_differ_by_their_lightness() -> None:
    one, other = (116 * np.cbrt(LINEAR_FROM_SRGB_8BIT[level]) - 16 for level in (120, 125))
    expected = 0.95 / 0.4 * ((other - one) / _hyab(GREEN[1], BLUE[1])) ** 0.7
    assert flip_error(_even((120,) * 3), _even((125,) * 3)).mean() == pytest.approx(expected, rel=1e-4)


def test_equal_pictures_do_not_differ() -> None:
    picture = np.random.default_rng(1).integers(0, 256, (40, 60, 3), dtype=np.uint8)
    assert np.abs(flip_error(picture, picture)).max() < 1e-6


def test_what_the_eye_does_not_resolve_is_hardly_a_difference_and_blue_is_resolved_less_than_red() -> None:
    """Stripes 1, 3 and 10 pixels wide, against the even colour of their mean light; 1 is 33 cycles a degree."""

    def error(channels: tuple[int, ...], width_px: int) -> float:
        linear, at = np.full((40, 60, 3), 0.2), np.arange(60) // width_px % 2 == 0
        linear[:, :, channels] += np.where(at, 0.1, -0.1)[:, None]
        encoded = np.round(255 * srgb_from_linear(linear)).astype(np.uint8)
        even = _even((int(np.round(255 * srgb_from_linear(np.float64(0.2)))),) * 3)
        return float(flip_error(encoded, even)[10:30, 20:40].mean())

    assert error((0, 1, 2), 1) < 0.05 * error((0, 1, 2), 10)
    blue, red = (error((channel,), 3) / error((channel,), 10) for channel in (0, 2))
    assert blue < 0.8 * red


def test_error_is_symmetric_and_grows_with_the_difference() -> None:
    grey, near, far = _even((120, 120, 120)), _even((125, 125, 125)), _even((160, 160, 160))
    assert flip_error(grey, far).mean() == pytest.approx(flip_error(far, grey).mean())
    assert 0 < flip_error(grey, near).mean() < 0.5 * flip_error(grey, far).mean()


def test_an_edge_is_seen_more_than_the_same_step_spread_out() -> None:
    grey = _even((120, 120, 120))
    sharp, soft = grey.copy(), grey.copy()
    sharp[:, 30:] = 150
    soft[:] = (120 + 30 * np.clip((np.arange(60) - 5) / 50, 0, 1))[None, :, None]
    # Beside the edge, where both differ from grey by as much.
    assert flip_error(grey, sharp)[20, 30] > flip_error(grey, soft)[20, 54]


def test_an_edge_that_both_pictures_have_adds_nothing() -> None:
    """Beside pictures of the same edge, of which one has a little more light everywhere."""
    linear = np.full((40, 60, 3), 0.1)
    linear[:, 30:] = 0.4
    dark, bright = (np.round(255 * srgb_from_linear(linear + more)).astype(np.uint8) for more in (0.0, 0.05))
    error = flip_error(dark, bright)[20]
    assert error[28:32].max() < 1.05 * max(error[5], error[55])

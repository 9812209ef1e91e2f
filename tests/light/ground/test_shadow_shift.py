"""The shift from lit to shadowed ground, on painted scenes whose ratio of shadow to light is known."""

from collections.abc import Sequence

import numpy as np
import pytest

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.shadow_shift import (
    SHIFT_NOISE,
    shadow_ratio,
    shadow_shifts,
    shift_of_known_shadow,
    shift_within,
    voted_for,
)
from ashe_live.light.pixels.log_colour import CHROMA_WEIGHT, DARKEST
from ashe_live.light.pixels.mixtures import Mixture
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Caster


def log_opponent_of(rgb: Float) -> Float:
    """(3,) of a linear RGB colour."""
    red, green, blue = np.log(rgb + DARKEST)
    return np.array([(red + green + blue) / 3, CHROMA_WEIGHT * (red - blue), CHROMA_WEIGHT * (red + blue - 2 * green)])


def ground_of(colour: Float) -> LitGround:
    """A ground of this one log-opponent colour (3,)."""
    one = np.ones(1, np.float32)
    palette = Mixture(colour[None].astype(np.float32), np.eye(3, dtype=np.float32)[None], one)
    nothing = np.zeros((1, 1), bool)
    return LitGround(
        np.zeros((1, 1, 3), np.float32), np.zeros((5, 3), np.float32), palette, nothing, one[None], nothing
    )


def scattered(colour: Float, count: int) -> Float32:
    """(count, 3) colours that scatter about one (3,)."""
    return (colour + np.random.default_rng(0).normal(0, 0.05, (count, 3))).astype(np.float32)


def shifts_of(ground: LitGround, votes: Sequence[Float32], count: int) -> list[Float]:
    """The modes of several votes, each of colours (n, 3)."""
    return shadow_shifts([shifts for colours in votes for shifts in voted_for(colours, ground, count)])


@pytest.mark.parametrize("ratio", [(1.0, 1.0, 1.0), (0.2, 0.3, 0.45), (0.05, 0.05, 0.05), (0.9, 0.8, 0.7)])
@pytest.mark.parametrize("level", [255, 128, 64])
def test_a_shift_is_a_ratio_on_grounds_light_and_dark(ratio: tuple[float, ...], level: int) -> None:
    lit_rgb = np.array([0.9, 1.0, 0.7]) * LINEAR_FROM_SRGB_8BIT[level]
    lit, shaded = (log_opponent_of(rgb) for rgb in (lit_rgb, lit_rgb * ratio))
    np.testing.assert_allclose(shadow_ratio(ground_of(lit), shaded - lit), ratio, rtol=1e-5)


def test_a_shadow_is_never_brighter_than_its_ground() -> None:
    lit, brighter = (log_opponent_of(np.array(rgb)) for rgb in ((0.4, 0.4, 0.4), (0.6, 0.5, 0.3)))
    assert (shadow_ratio(ground_of(lit), brighter - lit) <= 1).all()


@pytest.mark.parametrize("ground", GROUNDS)
def test_the_shift_of_a_picture_is_the_ratio_it_was_shaded_by(ground: str) -> None:
    here = painted_region(BOX, ground=ground, noise_levels=0.3)
    np.testing.assert_allclose(shadow_ratio(here.ground, here.true_shift), SHADOW_RATIO, rtol=0.05)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_true_shift_is_among_those_voted_for(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    shifts = here.shifts
    assert 1 <= len(shifts) <= BALANCED.shifts
    off = min(np.abs(shadow_ratio(here.ground, shift) / SHADOW_RATIO - 1).max() for shift in shifts)
    # Each brick has its own brightness, so that its shadow has one as well.
    assert off < (0.2 if ground == "bricks" else 0.1)


@pytest.mark.parametrize("ratio", [0.6, 0.2, 0.05, 0.015])
def test_pale_and_nearly_black_shadows_are_voted_for(ratio: float) -> None:
    """Phones make strong shadows black."""
    lit, shaded = (log_opponent_of(np.array([0.5, 0.45, 0.4]) * part) for part in (1.0, ratio))
    shifts = shifts_of(ground_of(lit), [scattered(shaded, 400)], 3)
    assert min(np.abs(shift - (shaded - lit)).max() for shift in shifts) < 0.05


def test_shifts_are_different_ones_and_make_darker() -> None:
    shifts = painted_region(BOX, ground="striped").shifts
    assert len(shifts) > 1
    for i, shift in enumerate(shifts):
        assert shift[0] < 0
        assert all(np.abs((shift - other) / SHIFT_NOISE).max() >= 1 for other in shifts[:i])


@pytest.mark.parametrize("count", [0, 1, 2])
def test_no_more_are_returned_than_asked_for(count: int) -> None:
    here = painted_region(BOX, ground="striped")
    assert len(shifts_of(here.ground, [here.region.colours[here.region.unlit]], count)) == count


def test_a_known_shadow_has_the_hue_that_a_camera_gives_it_on_a_coloured_ground() -> None:
    """A tone curve with contrast takes more from a colour's darkest channel, as if the sky were of that colour."""
    lit_rgb = np.array([0.45, 0.25, 0.1])
    shaded_rgb = lit_rgb * (0.31, 0.18, 0.09)
    lit, shaded = log_opponent_of(lit_rgb), log_opponent_of(shaded_rgb)
    ground = ground_of(lit)
    shadow = scattered(shaded, 300)
    border = (lit + np.linspace(0, 1, 40)[:, None] * (shaded - lit)).astype(np.float32)
    colours = np.concatenate([shadow, border])
    pale = 0.2 * (shaded - lit)
    found = shift_of_known_shadow(colours, ground, pale)
    np.testing.assert_allclose(shadow_ratio(ground, found), shaded_rgb / lit_rgb, rtol=0.15)


@pytest.mark.parametrize("ground", GROUNDS)
def test_a_shadow_under_daylight_has_no_other_hue(ground: str) -> None:
    here = painted_region(BOX, ground=ground, noise_levels=0.3)
    colours = here.region.colours[here.shadow]
    found = shift_of_known_shadow(colours, here.ground, np.zeros(3))
    np.testing.assert_array_equal(found, shift_within(colours, here.ground))


def test_of_a_known_shadow_of_a_few_pixels_the_approximate_shift_stays() -> None:
    here = painted_region(BOX)
    np.testing.assert_array_equal(
        shift_of_known_shadow(here.region.colours[:0].reshape(-1, 3), here.ground, here.true_shift), here.true_shift
    )


def test_a_few_pixels_vote_for_nothing() -> None:
    here = painted_region(BOX)
    colours = here.region.colours[here.region.unlit]
    assert shifts_of(here.ground, [colours[:0]], 5) == []
    assert shifts_of(here.ground, [colours[:10]], 5) == []
    assert shifts_of(here.ground, [], 5) == []


def test_what_is_brighter_than_all_of_the_ground_votes_for_nothing() -> None:
    here = painted_region(BOX)
    brightest = np.full((100, 3), here.ground.palette.centres.max(axis=0) + 1, np.float32)
    assert shifts_of(here.ground, [brightest], 5) == []


def test_many_dark_pixels_elsewhere_do_not_outvote_a_small_shadow() -> None:
    lit, small, large = (log_opponent_of(np.array([0.5, 0.45, 0.4]) * part) for part in (1.0, 0.15, 0.5))
    near, everywhere = scattered(small, 100), np.concatenate([scattered(large, 6000), scattered(small, 100)])

    def is_found(votes: list[Float32]) -> bool:
        return any(np.abs(shift - (small - lit)).max() < 0.1 for shift in shifts_of(ground_of(lit), votes, 3))

    assert not is_found([everywhere])
    assert is_found([near, everywhere])


def test_what_two_votes_agree_on_is_returned_once() -> None:
    lit, shaded = (log_opponent_of(np.array([0.5, 0.45, 0.4]) * part) for part in (1.0, 0.3))
    once = shifts_of(ground_of(lit), [scattered(shaded, 400)], 3)
    assert len(shifts_of(ground_of(lit), [scattered(shaded, 400)] * 2, 3)) == len(once)

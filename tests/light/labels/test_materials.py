"""What pixels cost when taken for lit ground, shadow or object, on painted regions and on ramps between two colours."""

import dataclasses

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.camera import Camera
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.materials import Materials, materials_of, object_cost, with_other_ground
from ashe_live.light.pixels.log_colour import OPPONENT
from ashe_live.light.pixels.mixtures import UNEXPLAINED, Mixture
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import PaintedRegion, painted_region, shift_of
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SIDE_M, VIEW, Caster

LIT = np.array([-1.0, 0.25, 0.02])


def ground_of(*colours: Float) -> LitGround:
    """A ground of these log-opponent colours (3,), each as common as the others."""
    centres = np.array(colours, np.float32)
    covariances = np.tile(0.06**2 * np.eye(3, dtype=np.float32), (len(colours), 1, 1))
    palette = Mixture(centres, covariances, np.full(len(colours), 1 / len(colours), np.float32))
    nothing = np.zeros((1, 1), np.float32)
    return LitGround(nothing[..., None], np.zeros((5, 3), np.float32), palette, nothing > 0, nothing, nothing > 0)


def region_of(colours: Float | Float32) -> Region:
    """A region of these colours (h, w, 3), all of it unlit ground."""
    shape = colours.shape[:2]
    everywhere = np.ones(shape, bool)
    camera = Camera.from_focal(shape[::-1], 400.0)
    view = View(np.zeros((*shape, 3), np.uint8), camera, VIEW, SIDE_M, everywhere)
    return Region(view, colours.astype(np.float32), everywhere, np.s_[: shape[0], : shape[1]], shape)


def ramp(shares: Float, shift: Float) -> Region:
    """Rows of ground of which larger and larger shares lie in a shadow: light adds up, its logs do not.

    Beyond 1, the shadow itself gets deeper.
    """
    ratio = np.exp(np.linalg.solve(OPPONENT, shift))
    inside = np.minimum(shares, 1.0)[:, None]
    mixed = np.log((1 - inside) + inside * ratio) @ OPPONENT.T
    return region_of(np.tile(LIT + mixed + np.maximum(shares - 1, 0)[:, None] * shift, (9, 1, 1)))


def dearest(here: PaintedRegion) -> tuple[Float32, Materials, Float32]:
    """(3, h, w) costs of lit ground, shadow and object; what they are of."""
    materials, own = here.materials, object_cost(here.region, here.body)
    return np.array([materials.lit, materials.shaded, own]), materials, own


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_cheapest_label_is_the_true_one(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    costs, _, _ = dearest(here)
    label = costs.argmin(axis=0)
    lit = here.region.is_ground & ~here.body & ~here.shadow
    for own, mask in enumerate((lit, here.shadow, here.body)):
        assert (label[mask] == own).mean() > 0.85


@pytest.mark.parametrize("ground", GROUNDS)
def test_all_of_the_light_is_lost_in_shadow_and_none_in_light(ground: str) -> None:
    here = painted_region(CYLINDER, ground=ground)
    lit = here.region.is_ground & ~here.body & ~here.shadow
    share = here.materials.light_lost
    assert np.median(share[here.shadow]) == pytest.approx(1, abs=0.1)
    assert np.median(share[lit]) == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("ratio", [(0.22, 0.27, 0.36), (0.4, 0.4, 0.4), (0.1, 0.12, 0.15), (0.55, 0.6, 0.65)])
def test_costs_change_places_half_way_between_light_and_shadow(ratio: tuple[float, ...]) -> None:
    """That is where a blurred edge is."""
    shares, shift = np.linspace(0, 1, 101), shift_of(np.array(ratio))
    materials = materials_of(ramp(shares, shift), ground_of(LIT), shift)
    shaded = (materials.shaded < materials.lit)[4]
    assert np.count_nonzero(np.diff(shaded.astype(int))) == 1
    assert shares[shaded.argmax()] == pytest.approx(0.5, abs=0.1)


def test_the_share_of_light_that_is_lost_is_read_off_the_colours() -> None:
    shares, shift = np.linspace(0, 1, 51), shift_of()
    materials = materials_of(ramp(shares, shift), ground_of(LIT), shift)
    # Colours are quantised, and compared along a line between the two, while those of mixtures lie beside it.
    np.testing.assert_allclose(materials.light_lost[4], shares, atol=0.05)


def test_where_the_sky_is_hidden_too_only_contact_shadow_is_cheap() -> None:
    shift = shift_of()
    region = ramp(np.array([1.0, 1.0, 1.0, 1.0, 1.7, 1.7, 1.7, 1.7]), shift)
    materials = materials_of(region, ground_of(LIT), shift)
    assert (materials.contact <= materials.shaded).all()
    np.testing.assert_allclose(materials.contact[4, 0], materials.shaded[4, 0])
    assert materials.contact[4, -1] < materials.shaded[4, -1] - 2
    assert materials.contact[4, -1] < materials.lit[4, -1]


def test_a_shadow_on_a_dark_tile_is_no_lit_one() -> None:
    """Nor is a dark tile a shadow: each is nearer to a colour of the ground than to any in shadow."""
    dark = LIT + np.array([-0.9, 0.5, -0.1])
    shift = shift_of()
    region = region_of(np.tile(np.array([LIT, dark, LIT + shift, dark + shift]).repeat(9, axis=0), (9, 1, 1)))
    materials = materials_of(region, ground_of(LIT, dark), shift)
    np.testing.assert_array_equal((materials.shaded < materials.lit)[4, 4::9], [False, False, True, True])


def test_an_object_is_recognised_by_its_own_colours() -> None:
    here = painted_region(BOX)
    own = object_cost(here.region, here.body)
    assert np.median(own[here.body]) < np.median(own[here.shadow]) - 5
    assert own.max() <= UNEXPLAINED + 1e-3


def test_of_a_few_pixels_no_colour_is_known() -> None:
    here = painted_region(BOX)
    few = np.zeros_like(here.body)
    np.testing.assert_array_equal(object_cost(here.region, few), UNEXPLAINED)
    few[20, 20:28] = True
    np.testing.assert_array_equal(object_cost(here.region, few), UNEXPLAINED)


@pytest.mark.parametrize("shape", [(1, 1), (1, 30), (30, 1), (12, 15)])
def test_regions_of_any_size_have_costs(shape: tuple[int, int]) -> None:
    region = region_of(np.random.default_rng(0).normal(-1, 1, (*shape, 3)))
    materials = materials_of(region, ground_of(LIT), shift_of())
    nowhere = np.zeros(shape, bool)
    for costs in (materials.lit, materials.shaded, materials.contact, materials.light_lost):
        assert costs.shape == shape
        assert np.isfinite(costs).all()
    for mask in (nowhere, ~nowhere):
        assert np.isfinite(object_cost(dataclasses.replace(region, unlit=mask), mask)).all()


def test_ground_that_an_object_lights_is_no_part_of_it() -> None:
    """Nearly lit ground is cheapest as ground, though an object is said to have its colour; shadow stays shadow."""
    here = painted_region(BOX)
    around = cv2.dilate(here.body.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
    faint = around & ~here.body & ~here.shadow
    region = dataclasses.replace(here.region, unlit=here.region.unlit | faint, faint=faint)
    materials = with_other_ground(here.materials, faint)
    own = object_cost(region, here.body | faint, materials)
    assert (materials.lit[faint] < own[faint]).mean() > 0.95
    assert (own[here.body] < materials.lit[here.body]).mean() > 0.9
    assert (materials.contact[here.shadow] < materials.lit[here.shadow]).mean() > 0.95
    np.testing.assert_array_equal(materials.lit[~faint], here.materials.lit[~faint])

"""Bodies moved until their outlines lie on the picture's borders: true slopes, true places, honest information."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.camera import Size
from ashe_live.core.transforms import angle_between
from ashe_live.light.edges.outline_points import (
    POINTS_PER_OUTLINE,
    OutlinePoints,
    derivatives_by_theta,
    evenly_spaced,
)
from ashe_live.light.explanation.alignment import Alignment, Start
from ashe_live.light.explanation.alignment import aligned as all_aligned
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials
from ashe_live.light.outline_fit.search import information_on_lights
from ashe_live.light.shape.body import Body, LitBody
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.layout import ParameterLayout, light_parameters
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted, outline, predicted
from tests.light.painted_bodies import body_of, costs_of, frame_of, sight_of
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster, overlap
from tests.light.synthetic_masks import direction

LAMP = np.array([*((*BOX.at, 0.0) + 0.3 * direction(200.0, 65.0)), 1.0])
LIGHTS = {
    "one light": at_infinity(np.array([direction(200.0, 40.0)])),
    "two lights": at_infinity(np.array([direction(200.0, 40.0), direction(70.0, 55.0)])),
    "a lamp": LAMP[None],
}
SHAPES = {
    "box": [0.1, 0.05, 0.4, -1.1, -1.3, -0.1],
    "frustum": [0.05, -0.1, 0.0, 0.35, 0.2],
    "sphere": [0.0, 0.1, -0.7],
    "ell": [0.0, 0.0, 0.5, -1.5, -1.2, 0.0, -0.9, 0.0],
}


def body(family: str, lights: Float) -> LitBody:
    return LitBody(Body(frame_of(BOX), FAMILIES[family], np.array(SHAPES[family])), lights)


def aligned(bodies: list[LitBody], costs: Costs) -> Alignment | None:
    """Of one picture."""
    return all_aligned([Start(bodies, sight_of(costs.region), costs)])[0]


def smooth_outlines(lit: LitBody, region: Region) -> list[Float]:
    """As `outlines` draws them, but round where they are round."""
    proxy = lit.body.proxy
    points = proxy.surface(256, 129)[0] if proxy.spheroids_marker[:, 4].any() else proxy.points_marker(720)
    cast = [
        (points - points[:, 2:] * light[:3] / light[2]) / (1 - points[:, 2:] * light[3] / light[2])
        for light in lit.lights
    ]
    hulls = [outline(region.view.camera, region.view.T_cam_marker, each) for each in (points, *cast)]
    return [hull for hull in hulls if hull is not None]


def moved_outward(points: Float, outward: Float, hull_px: Float) -> Float:
    """(n,) how far along their normals the places are from another convex outline."""
    edges = np.roll(hull_px, -1, axis=0) - hull_px
    normals = edges[:, ::-1] * (1, -1)
    normals *= np.sign(((hull_px - hull_px.mean(axis=0)) * normals).sum(axis=1))[:, None]
    facing = outward @ normals.T
    offset = ((hull_px - points[:, None]) * normals).sum(axis=2)
    reached = np.divide(offset, facing, out=np.full_like(offset, np.inf), where=facing > 1e-6 * np.abs(facing).max())
    return np.asarray(reached.min(axis=1))


def measured_slopes(lit: LitBody, region: Region, places: OutlinePoints, step: float = 2e-3) -> Float:
    """(2 l + q, n) by central differences of the outlines that are drawn."""
    columns = []
    for unit in np.eye(lit.layout.split + len(lit.body.shape)):
        ahead, behind = (
            np.concatenate(list(map(moved_outward, places.points, places.normals, smooth_outlines(there, region))))
            for there in (lit.moved(step * unit), lit.moved(-step * unit))
        )
        columns.append((ahead - behind) / (2 * step))
    return np.array(columns)


# Slopes


@pytest.mark.parametrize("lights", LIGHTS.values(), ids=LIGHTS)
@pytest.mark.parametrize("family", SHAPES)
def test_slopes_are_those_of_the_outlines(family: str, lights: Float) -> None:
    region = painted_region(BOX).region
    here = body(family, lights)
    places = evenly_spaced(smooth_outlines(here, region))
    (slopes,), measured = (
        derivatives_by_theta([here], [sight_of(region)], places),
        measured_slopes(here, region, places),
    )
    assert slopes.shape == (here.layout.split + len(here.body.shape), (1 + len(lights)) * POINTS_PER_OUTLINE)
    error = np.abs(slopes - measured)
    # A place next to a corner, or where a straight edge goes over into a round one, moves as neither of them does.
    assert np.quantile(error.max(axis=0), 0.98) < 0.03 * np.abs(measured).max()
    assert np.quantile(error.max(axis=0), 0.7) < 0.01 * np.abs(measured).max()


# Bodies in painted pictures


def light_error_deg(found: LitBody, here: PaintedRegion) -> float:
    return math.degrees(angle_between(found.to_lights_marker[0], here.scene.to_light))


# Displacement, place and shape of a body of this height, spoilt by a few pixels.
SPOILT = {"shadow longer": (0, 0.15), "shadow aside": (1, -0.15), "moved": (2, 0.08), "moved away": (3, -0.08)}


@pytest.mark.parametrize("spoilt", SPOILT.values(), ids=SPOILT)
@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", ["plain", "striped"])
def test_a_body_that_is_displaced_comes_back(ground: str, caster: Caster, spoilt: tuple[int, float]) -> None:
    here = painted_region(caster, ground=ground)
    truth, costs = body_of(here, caster), costs_of(here)
    step = np.zeros(2 + len(truth.body.shape))
    step[spoilt[0]] = spoilt[1]
    displaced = truth.moved(step)
    found = aligned([displaced], costs)
    assert found is not None
    assert light_error_deg(found.placed.lit, here) < 1
    assert found.misfit_px < 0.5
    assert min(found.clear_body, found.clear_shadow) > 0.9
    start = predicted(displaced.body.proxy, displaced.lights, here.region.view)
    assert found.placed.cost < costs.of(start)
    for mask, was, true in (
        (found.placed.predicted.body, start.body, here.body),
        (found.placed.predicted.shadow, start.shadow, here.shadow),
    ):
        assert overlap(mask, true) > max(overlap(was, true) - 0.02, 0.9)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_the_family_that_suits_the_picture_is_chosen(caster: Caster) -> None:
    here = painted_region(caster)
    bodies = [body_of(here, replace(caster, shape=shape)) for shape in ("box", "cylinder")]
    for several in (bodies, bodies[::-1]):
        found = aligned(several, costs_of(here))
        assert found is not None
        assert found.placed.lit.body.family.name == body_of(here, caster).body.family.name


def test_of_bodies_that_look_the_same_the_simpler_one_is_chosen() -> None:
    here = painted_region(CYLINDER)
    plain = body_of(here, CYLINDER)
    x, y, height, below, above = plain.body.shape
    shape = np.array([x, y, height, below, below, above, 0.0])
    vase = replace(plain, body=replace(plain.body, family=FAMILIES["vase"], shape=shape))
    found = aligned([vase, plain], costs_of(here))
    assert found is not None
    assert found.placed.lit.body.family.name == "frustum"


@settings(max_examples=40)
@given(st.integers(0, 2**31), st.floats(1e-3, 30.0))
def test_from_anywhere_the_cost_never_rises_and_no_number_is_none(seed: int, scale: float) -> None:
    here = painted_region(BOX)
    truth, costs = body_of(here, BOX), costs_of(here)
    there = truth.moved(scale * np.random.default_rng(seed).normal(size=2 + len(truth.body.shape)).clip(-3, 3))
    found = aligned([there], costs)
    if found is None:
        return
    assert found.placed.cost <= costs.of(predicted(there.body.proxy, there.lights, here.region.view)) + 1e-3
    assert np.isfinite(found.normal).all()
    assert np.isfinite([found.misfit_px, found.placed.cost]).all()
    assert np.isfinite(light_parameters(found.placed.lit.lights)).all()
    assert 0 <= found.clear_body <= 1
    assert 0 <= found.clear_shadow <= 1
    assert np.linalg.eigvalsh(found.normal).min() > -1e-6 * np.abs(found.normal).max()


def test_what_is_not_in_view_is_no_alignment() -> None:
    here = painted_region(BOX)
    truth, costs = body_of(here, BOX), costs_of(here)
    elsewhere = replace(truth.body.frame, origin_marker=np.array([0.0, -50.0]))
    behind = replace(truth, body=replace(truth.body, frame=elsewhere))
    endless = replace(truth, lights=np.array([[1e12, 0.0, 1.0, 0.0]]))
    for body in (behind, endless):
        assert aligned([body], costs) is None


def test_the_sharper_the_shadow_the_more_is_known_of_the_light() -> None:
    known = []
    for penumbra_px in (0.0, 2.0, 4.0):
        here = painted_region(BOX, penumbra_px=penumbra_px)
        found = aligned([body_of(here, BOX)], costs_of(here))
        assert found is not None
        known.append(np.linalg.eigvalsh(information_on_lights(found.normal, ParameterLayout(1))))
    assert (np.diff(known, axis=0) < 0).all()


@pytest.mark.parametrize("elevation_deg", [8.0, 10.0])
def test_of_a_shadow_whose_tip_is_out_of_the_picture_the_length_is_not_known(elevation_deg: float) -> None:
    """The sides of a box's shadow are parallel, and go on in the same lines however long they are."""
    here = painted_region(BOX, azimuth_deg=110.0, elevation_deg=elevation_deg)
    found = aligned([body_of(here, BOX)], costs_of(here))
    assert found is not None
    along = light_parameters(found.placed.lit.lights)[0] / np.linalg.norm(light_parameters(found.placed.lit.lights)[0])
    across = along[::-1] * (-1, 1)
    known = information_on_lights(found.normal, ParameterLayout(1))
    assert along @ known @ along < 1e-3 * (across @ known @ across)


@pytest.mark.parametrize(("elevation_deg", "least", "most"), [(60.0, 0.95, 1.0), (35.0, 0.95, 1.0), (8.0, 0.0, 0.05)])
def test_the_end_of_a_shadow_is_in_view_where_it_lies_in_the_picture(
    elevation_deg: float, least: float, most: float
) -> None:
    here = painted_region(BOX, elevation_deg=elevation_deg)
    found = aligned([body_of(here, BOX)], costs_of(here))
    assert found is not None
    (share,) = found.ends_in_view
    assert least <= share <= most


@pytest.mark.parametrize("elevation_deg", [50.0, 60.0])
def test_an_end_that_the_object_hides_is_in_view_all_the_same(elevation_deg: float) -> None:
    """The light comes from before the camera: were the shadow longer, it would come out from behind the object."""
    here = painted_region(CYLINDER, azimuth_deg=250.0, elevation_deg=elevation_deg)
    found = aligned([body_of(here, CYLINDER)], costs_of(here))
    assert found is not None
    assert found.ends_in_view == pytest.approx((1.0,), abs=0.05)


def test_two_lights_shadows_come_back_to_their_own_places() -> None:
    here = painted_region(BOX)
    lights = here.scene.to_light, direction(170.0, 55.0)
    truth = body_of(here, BOX, *lights)
    costs = costs_of_labels(here.region, predicted(truth.body.proxy, truth.lights, here.region.view))
    displaced = truth.moved(np.array([0.1, -0.1, -0.1, 0.1, 0.03, -0.03, 0, 0, 0, 0]))
    found = aligned([displaced], costs)
    assert found is not None
    for towards, light in zip(found.placed.lit.to_lights_marker, lights, strict=True):
        assert math.degrees(angle_between(towards, light)) < 2
    assert found.placed.cost < costs.of(predicted(displaced.body.proxy, displaced.lights, here.region.view))


def test_a_lamps_shadow_comes_back_to_its_place() -> None:
    here = painted_region(BOX)
    truth = replace(body_of(here, BOX), lights=LAMP[None])
    costs = costs_of_labels(here.region, predicted(truth.body.proxy, truth.lights, here.region.view))
    displaced = truth.moved(np.array([0.1, -0.1, 0.03, -0.03, 0, 0, 0, 0]))
    found = aligned([displaced], costs)
    assert found is not None
    assert found.ends_in_view == pytest.approx((1.0,), abs=0.05)
    (x, y, z, w), (was_x, was_y, *_) = found.placed.lit.lights[0], displaced.lights[0] / displaced.lights[0, 3]
    assert z / w == pytest.approx(LAMP[2])
    assert math.hypot(x / w - LAMP[0], y / w - LAMP[1]) < 0.3 * math.hypot(was_x - LAMP[0], was_y - LAMP[1])


def costs_of_labels(region: Region, seen: Predicted, wrong: float = 20.0) -> Costs:
    """Each pixel costs nothing as what it is, and much as anything else."""

    def cost(*own: Mask) -> Float32:
        return np.asarray(np.where(np.logical_or.reduce(own), 0, wrong), np.float32)

    if not seen.parts:
        lit, shaded = cost(~seen.whole), cost(seen.shadow)
        return Costs(
            region, Materials((np.array([-1.0, 0, 0]),), lit, shaded, shaded, np.zeros_like(lit)), cost(seen.body)
        )
    one, other = seen.parts
    layers = cost(one & ~other), cost(other & ~one), cost(one & other)
    shift = np.array([-1.0, 0, 0])
    shaded = np.minimum.reduce(layers)
    materials = Materials((shift,) * 3, cost(~seen.whole), shaded, shaded, np.zeros_like(shaded), layers)
    return Costs(region, materials, cost(seen.body))


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (3, 3)])
def test_tiny_regions_break_nothing(size: Size) -> None:
    here = painted_region(BOX)
    window = slice(60, 60 + size[1]), slice(60, 60 + size[0])
    region = Region(
        here.region.view.cut(window), here.region.colours[window], here.region.unlit[window], window, size[::-1]
    )
    lit, shaded, contact, share = (
        each[window]
        for each in (here.materials.lit, here.materials.shaded, here.materials.contact, here.materials.light_lost)
    )
    costs = Costs(region, Materials((here.true_shift,), lit, shaded, contact, share), costs_of(here).as_object[window])
    found = aligned([body_of(here, BOX)], costs)
    assert found is None or np.isfinite(found.normal).all()

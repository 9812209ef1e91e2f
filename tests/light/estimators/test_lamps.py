"""Lamps in painted photos: stated where they are near enough, and where they are; suns and far lamps are directions."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.commands.flags.option_groups import LIGHTS
from ashe_live.commands.flags.parser import build_parser
from ashe_live.commands.flags.setup import light_preset
from ashe_live.core.arrays import Float
from ashe_live.core.light import Light, LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED, FAST, ProxyPreset
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.lamps.kinds import KINDS, LAMP, SUN
from tests.light.painted_scenes import BOX, CYLINDER, SHADOW_RATIO, Caster, paint
from tests.light.synthetic_masks import camera_towards, direction

CASTERS = {"box": BOX, "cylinder": CYLINDER}
# Azimuth and elevation in degrees, and distance in metres; the caster and the ground.
NEAR = [
    (200.0, 50.0, 0.5, "box", "plain"),
    (200.0, 50.0, 0.5, "cylinder", "bricks"),
    (110.0, 40.0, 0.8, "box", "bricks"),
    (330.0, 35.0, 1.2, "cylinder", "bricks"),
]
EXTREME = {
    "above the object": (0.12, 0.0, 0.3),
    "above the marker": (0.0, 0.0, 0.45),
    "at 8 cm": (0.0, 0.0, 0.08),
    "at 20 m": (0.02, 0.03, 20.0),
    "grazing": (0.4, 0.1, 0.1),
    "behind the camera": (0.08, -1.0, 0.8),
    "below the object's top": (0.3, 0.0, 0.05),
}
# Of these alone an estimate says that it is a direction, or nothing, where nobody says that the light is a lamp.
MAYBE_NO_LAMP = ("at 8 cm", "at 20 m", "behind the camera")


def at(azimuth_deg: float, elevation_deg: float, distance_m: float) -> Float:
    return distance_m * direction(azimuth_deg, elevation_deg)


def estimated(lamp_m: Float, caster: Caster = BOX, ground: str = "plain", light: str = BALANCED.light) -> LightEstimate:
    scene = paint(caster, ground=ground, lamp_m=lamp_m)
    return ProxyEstimator(replace(BALANCED, light=light)).estimate(scene.tracked)


def stated(estimate: LightEstimate) -> Light:
    assert estimate.light is not None, estimate.reason
    return estimate.light


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg", "distance_m", "caster", "ground"), NEAR)
def test_a_lamp_is_stated_where_it_is(
    azimuth_deg: float, elevation_deg: float, distance_m: float, caster: str, ground: str
) -> None:
    lamp_m = at(azimuth_deg, elevation_deg, distance_m)
    light = stated(estimated(lamp_m, CASTERS[caster], ground))
    assert light.kind == "lamp"
    assert light.lamp_covariance is not None
    assert math.degrees(angle_between(light.to_light_marker, lamp_m)) < 2.6
    assert abs(light.inverse_distance * distance_m - 1) < 0.2
    assert abs(light.inverse_distance - 1 / distance_m) < 2 * math.sqrt(light.lamp_covariance[2, 2])
    # The ground's own slow darkening, and the shadow's blur, are in what was measured of it.
    assert light.intensity_rgb_ratio is not None
    np.testing.assert_allclose(light.intensity_rgb_ratio, (1 - SHADOW_RATIO) / SHADOW_RATIO, rtol=0.35)


@pytest.mark.parametrize(("caster", "distance_m"), [(BOX, 20.0), (CYLINDER, 1000.0)])
def test_what_is_far_away_is_a_direction(caster: Caster, distance_m: float) -> None:
    light = stated(estimated(at(200.0, 40.0, distance_m), caster))
    assert light.kind == "directional"
    assert light.lamp_covariance is None
    assert light.radius_m is None
    assert math.degrees(angle_between(light.to_light_marker, direction(200.0, 40.0))) < 1.0


def test_what_a_light_is_taken_for_can_be_chosen() -> None:
    lamp_m = at(200.0, 50.0, 0.5)
    as_sun, as_lamp = (stated(estimated(lamp_m, light=kind)) for kind in (SUN, LAMP))
    assert as_sun.kind == "directional"
    assert as_lamp.kind == "lamp"
    # A direction is right at the object, where it was measured: its tip is nearer to the lamp than the marker is.
    at_object = lamp_m - (*BOX.at, BOX.height_m)
    assert math.degrees(angle_between(as_sun.to_light_marker, at_object)) < 4
    assert math.degrees(angle_between(as_sun.to_light_marker, lamp_m)) > 6


@pytest.mark.parametrize(
    ("name", "preset"),
    [
        *(pytest.param(name, BALANCED, id=name) for name in EXTREME),
        *(pytest.param(name, replace(FAST, light=LAMP), id=f"{name}, taken for a lamp") for name in MAYBE_NO_LAMP),
    ],
)
def test_extreme_lamps_end_in_an_answer_or_a_reason(name: str, preset: ProxyPreset) -> None:
    place = np.array(EXTREME[name])
    # Small where it is asked what is stated of a lamp at all, and not what the default preset finds.
    size = (640, 480) if preset is BALANCED else (320, 240)
    estimate = ProxyEstimator(preset).estimate(paint(BOX, lamp_m=place, size=size).tracked)
    if estimate.light is None:
        assert estimate.reason
        return
    light = estimate.light
    assert light.confidence is not None
    assert light.covariance_rad2 is not None
    assert (np.linalg.eigvalsh(light.covariance_rad2) > 0).all()
    error = math.degrees(angle_between(light.to_light_marker, place))
    assert error < 20 or light.confidence < 0.75


def test_what_a_command_or_a_program_asks_for_reaches_the_estimator() -> None:
    options = build_parser().parse_args(["estimate", "a.jpg", "--light", "sun"])
    assert light_preset(options) == replace(BALANCED, light=SUN)
    assert {
        choice: light_preset(build_parser().parse_args(["demo", "--light", choice])).light for choice in LIGHTS
    } == {kind: kind for kind in KINDS}


def test_two_objects_determine_the_distance() -> None:
    """Better than one does: the fall of light alone leaves it uncertain by what cameras do to contrast."""
    lamp_m, other = at(200.0, 50.0, 0.6), replace(CYLINDER, at=(-0.06, 0.14))
    alone, both = (
        stated(ProxyEstimator().estimate(paint(*casters, lamp_m=lamp_m).tracked)) for casters in ((BOX,), (BOX, other))
    )
    assert both.kind == "lamp"
    assert both.lamp_covariance is not None
    assert alone.lamp_covariance is not None
    assert abs(both.inverse_distance * 0.6 - 1) < 0.1
    assert both.lamp_covariance[2, 2] < alone.lamp_covariance[2, 2]


def estimated_in_views(lamp_m: Float, ground: str = "plain") -> LightEstimate:
    frames = [
        paint(CYLINDER, ground=ground, lamp_m=lamp_m, T_cam_marker=camera_towards((0.08, 0.0), 0.55, 45.0, heading))
        for heading in (90.0, 70.0, 110.0)
    ]
    first, *others = (
        replace(each.tracked, frame=replace(each.tracked.frame, index=i)) for i, each in enumerate(frames)
    )
    estimate = ProxyEstimator().estimate(first, others)
    assert len(estimate.views) == 3
    return estimate


@pytest.mark.parametrize(("distance_m", "ground"), [(0.5, "bricks"), (1.0, "plain")])
def test_several_views_of_a_lamp_determine_its_place_by_the_shadows_parallax(distance_m: float, ground: str) -> None:
    lamp_m = at(200.0, 50.0, distance_m)
    light = stated(estimated_in_views(lamp_m, ground))
    assert light.kind == "lamp"
    assert math.degrees(angle_between(light.to_light_marker, lamp_m)) < 1.0
    assert abs(light.inverse_distance * distance_m - 1) < 0.08


def test_several_views_of_what_is_far_away_give_no_lamp() -> None:
    light = stated(estimated_in_views(at(200.0, 40.0, 20.0), "bricks"))
    assert light.kind == "directional"
    assert math.degrees(angle_between(light.to_light_marker, direction(200.0, 40.0))) < 1.0

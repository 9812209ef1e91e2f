"""The bodies of painted scenes as a fit describes them, and explanations that say the truth."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.alignment import Alignment, Start, aligned
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.shape.body import Body, BodyFrame, LitBody
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.sight import Sight
from tests.light.painted_regions import PaintedRegion
from tests.light.painted_scenes import BOX, Caster

BOX_YAW_RAD = math.radians(70 - 45)


def frame_of(caster: Caster) -> BodyFrame:
    """In units of its height."""
    return BodyFrame(np.array(caster.at), caster.height_m)


def sight_of(region: Region) -> Sight:
    """About the middle of the region."""
    return Sight(region.view.camera, region.view.T_cam_marker, np.array(region.view.size) / 2)


def body_of(here: PaintedRegion, caster: Caster, *to_lights: Float) -> LitBody:
    """The caster in the painted light, or in others."""
    lights = at_infinity(np.array(to_lights or [here.scene.to_light]))
    half = 0.5 * caster.width_m / caster.height_m
    if caster.shape == "box":
        family, shape = "box", [0.0, 0.0, BOX_YAW_RAD, math.log(half), math.log(half), 0.0]
    else:
        family, shape = "frustum", [0.0, 0.0, 0.0, half, half]
    return LitBody(Body(frame_of(caster), FAMILIES[family], np.array(shape)), lights)


def costs_of(here: PaintedRegion) -> Costs:
    return Costs(here.region, here.materials, object_cost(here.region, here.body))


def alignment_of(here: PaintedRegion, caster: Caster = BOX, **changed: Any) -> Alignment:
    """Of the true body; with what is changed of it."""
    (found,) = aligned([Start([body_of(here, caster)], sight_of(here.region), costs_of(here))])
    assert found is not None
    return replace(found, **changed)


def explanation_of(here: PaintedRegion, caster: Caster = BOX, **changed: Any) -> Explanation:
    """The painted truth, with what is changed of it."""
    explanation = Explanation(
        here.region,
        here.materials,
        Split(here.body, here.shadow),
        alignment_of(here, caster),
        (FittedLight(at_infinity(here.scene.to_light), np.eye(2) * 1e-4),),
        costs_of(here).as_object,
    )
    return replace(explanation, **changed)

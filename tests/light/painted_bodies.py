"""The bodies of painted scenes as a fit describes them, and explanations that say the truth."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.alignment import Alignment, aligned
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.shape.body import Body
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.first_guess import FirstGuess
from tests.light.painted_regions import PaintedRegion
from tests.light.painted_scenes import BOX, Caster

BOX_YAW_RAD = math.radians(70 - 45)


def framed(region: Region, caster: Caster, slants: Float) -> FirstGuess:
    """A guess's frame at the caster's place, in units of its height."""
    half = np.array(region.view.size) / 2
    P = np.array([[1, 0, -half[0]], [0, 1, -half[1]], [0, 0, 1]]) @ region.view.camera.K @ region.view.T_cam_marker[:3]
    unit_m = caster.height_m
    M = np.diag([unit_m, unit_m, unit_m, 1.0])
    M[:2, 3] = caster.at
    return FirstGuess(P @ M, np.array(caster.at), unit_m, 0.5 * caster.width_m / unit_m, 1.0, slants)


def slant_of(to_light: Float) -> Float:
    return np.asarray(to_light[:2] / to_light[2])


def body_of(here: PaintedRegion, caster: Caster, *to_lights: Float) -> Body:
    """The caster in the painted light, or in others."""
    slants = np.array([slant_of(to_light) for to_light in to_lights or (here.scene.to_light,)])
    half = 0.5 * caster.width_m / caster.height_m
    if caster.shape == "box":
        family, shape = "box", [0.0, 0.0, BOX_YAW_RAD, math.log(half), math.log(half), 0.0]
    else:
        family, shape = "frustum", [0.0, 0.0, 0.0, half, half]
    return Body(framed(here.region, caster, slants), FAMILIES[family], slants, np.array(shape))


def costs_of(here: PaintedRegion) -> Costs:
    return Costs(here.region, here.materials, object_cost(here.region, here.body))


def alignment_of(here: PaintedRegion, caster: Caster = BOX, **changed: Any) -> Alignment:
    """Of the true body; with what is changed of it."""
    (found,) = aligned([([body_of(here, caster)], costs_of(here))])
    assert found is not None
    return replace(found, **changed)


def explanation_of(here: PaintedRegion, caster: Caster = BOX, **changed: Any) -> Explanation:
    """The painted truth, with what is changed of it."""
    explanation = Explanation(
        here.region,
        here.materials,
        Split(here.body, here.shadow),
        alignment_of(here, caster),
        (FittedLight(here.scene.to_light, np.eye(2) * 1e-4),),
        costs_of(here).own,
    )
    return replace(explanation, **changed)

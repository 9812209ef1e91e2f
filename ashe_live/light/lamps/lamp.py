"""From an explanation's directions to lamps: where a light is near enough for its distance to be told, it is stated.

The light that an explanation was aligned with is at infinity, and right at the object. The nearness that all sources
ask for together moves the answer to the marker's centre; borders are then aligned again with that nearness, as the
shadow of a lamp is not that of a sun.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import Light
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.explanation.explain import lamp_borders, realigned
from ashe_live.light.explanation.judge import probability_of_good
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.lamps.fall_off import FallOff
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.lamps.place import Place, place_by_borders
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.directions import FittedLight, direction_by_displacement
from ashe_live.light.shape.layout import light_parameters, nearness_of
from ashe_live.light.shape.light_points import cast_on_ground
from ashe_live.light.shape.predicted import predicted

BESIDE_PX = 4  # of the coarse picture: ground nearer than this to an object or a shadow is not lit as the rest
LEAST_SIGMAS = 3.0  # standard errors by which the nearness of a lamp must differ from 0
WORTH_ALIGNING = 2.0  # standard errors from which on borders are aligned as a lamp's
NEAREST = 20.0  # 1/m, nearness of a lamp 5 cm above the plane: a nearer one is taken to be there
STARTS = (0.0, 0.3, 0.7, 1.2, 2.0, 3.5, 6.0, 10.0)  # 1/m
ROUNDS, SETTLED = 12, 1e-3
# Limits of one step: of the nearness in 1/m, and as a fraction of it; of the displacement over the distance per height.
LARGEST_STEP, LARGEST_SHARE, LARGEST_SHIFT = 0.4, 0.3, 0.5
ALIGNMENTS = 2
# Sigma of the nearness of lamps (1/m), and the probability of a lamp before a picture is seen: both count only where
# the evidence leaves it open, in how far a direction may be off at the marker.
LAMPS_NEARNESS, LAMPS_SHARE = 1.5, 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """An explanation with its lights as stated, and where its first light would be as a lamp."""

    explanation: Explanation
    lights: tuple[Light, ...]
    place: Place


def stated(
    explanation: Explanation,
    lights_of: Callable[[Explanation], tuple[Light, ...]],
    ratios: Sequence[Float],
    ground: LitGround,
    view: View,
    unlit: Mask,
    kind: str,
    of_views: int = 1,
) -> Answer:
    """The lights of an explanation; its first one as a lamp where that is told, the others always as suns.

    lights_of: those of an explanation as directions, with covariances and confidence. ratios: (3,) each light's shadow
    ratio, linear RGB. view: the one that `ground` was fitted to, and with `unlit` (h, w) does not explain. kind: one of
    KINDS. of_views: how many views' borders the explanation was aligned with; of several, it stays as it is.
    """
    lights = lights_of(explanation)
    seen = predicted(explanation.proxy, explanation.alignment.placed.lit.lights, view).whole
    fall_off = FallOff.of(view, ground, ~grown(unlit | seen, BESIDE_PX))
    place = _placed(explanation, lights, ratios, fall_off)
    if kind == SUN:
        return Answer(explanation, lights, place)
    now, at = explanation, place
    for _ in range(ALIGNMENTS if of_views == 1 else 0):
        if not _is_near(at, WORTH_ALIGNING if kind == AUTO else 0.0):
            break
        again = realigned(now, 0, float(min(at.mean[2], NEAREST)))
        if again is None:
            break
        now = again
        at = _placed(now, lights_of(now), ratios, fall_off)
    if _is_near(at, LEAST_SIGMAS if kind == AUTO else 0.0):
        first, *others = lights_of(now)
        return Answer(now, (_lamp(first, at, ratios[0], _shadow_middle(now)), *others), at)
    first, *others = lights
    return Answer(explanation, (_with_doubt(first, explanation, place), *others), place)


def with_size(light: Light, angular_size_rad: float | None) -> Light:
    """The light with its angular diameter as seen from the marker's centre, and a lamp with its radius."""
    if angular_size_rad is None or light.inverse_distance == 0:
        return replace(light, angular_size_rad=angular_size_rad)
    radius_m = math.sin(angular_size_rad / 2) / light.inverse_distance
    return replace(light, angular_size_rad=angular_size_rad, radius_m=radius_m)


def _is_near(place: Place, sigmas: float) -> bool:
    return bool(place.mean[2] > max(sigmas * place.nearness_sigma, 0.0))


def _shadow_middle(explanation: Explanation) -> Float:
    """(2,) the middle of the first light's shadow on the plane, where the shadow ratio was measured."""
    lit = explanation.alignment.placed.lit
    middle = np.array([[*lit.body.frame.origin_marker, 0.5 * explanation.proxy.points_marker()[:, 2].max()]])
    cast = cast_on_ground(middle, lit.lights[0])
    return np.asarray((middle if cast is None else cast)[0, :2])


def _placed(
    explanation: Explanation, lights: Sequence[Light], ratios: Sequence[Float], fall_off: FallOff | None
) -> Place:
    """Where the first light is, by the borders and by the fall of light."""
    fitted, covariance = explanation.lights[0], lights[0].covariance_rad2
    assert covariance is not None
    by_borders = place_by_borders(FittedLight(fitted.light, covariance), lamp_borders(explanation)[0])
    if fall_off is None:
        return by_borders
    others = np.array([_parameters(each.light) for each in explanation.lights[1:]]).reshape(-1, 3)
    shares = [float(np.clip(1 - ratio.mean(), 0.02, 0.98)) for ratio in ratios[: len(lights)]]
    excess = max(sum(shares) / 0.98, 1.0)
    shares = [share / excess for share in shares]
    return _with_fall_off(by_borders, fall_off, others, shares, _shadow_middle(explanation))


def _with_fall_off(
    by_borders: Place, fall_off: FallOff, others: Float, shares: Sequence[float], reference: Float
) -> Place:
    """The borders' place moved to where the fall of light pulls it, by Gauss-Newton steps of limited length."""
    line = by_borders.covariance[:, 2] / by_borders.covariance[2, 2]  # the likeliest place for each nearness

    def cost_at(nearness: float) -> float:
        offset = nearness - by_borders.mean[2]
        there = np.vstack([by_borders.mean + line * offset, others])
        return fall_off.pull(there, shares, reference).cost + float(offset**2 / by_borders.covariance[2, 2])

    start = min(STARTS, key=cost_at)
    at = by_borders.mean + line * (start - by_borders.mean[2])
    information = by_borders.information
    for number in range(ROUNDS):
        pull = fall_off.pull(np.vstack([at, others]), shares, reference)
        information = pull.information + by_borders.information
        step = np.linalg.solve(information, pull.gradient + by_borders.information @ (by_borders.mean - at))
        reach = max(LARGEST_STEP, LARGEST_SHARE * abs(at[2])) / max(abs(step[2]), 1e-9)
        wide = LARGEST_SHIFT * math.hypot(1, *at[:2]) / max(math.hypot(*step[:2]), 1e-9)
        at = at + min(1.0, reach, wide) * step * (1.0 if 2 * number < ROUNDS else 0.5)
        at[2] = np.clip(at[2], -NEAREST, NEAREST)
        if np.abs(step).max() < SETTLED:
            break
    return Place(at, information)


def _parameters(light: Float) -> Float:
    """(3,) displacement and nearness of a light (4,)."""
    return np.append(light_parameters(light), nearness_of(light))


def _lamp(light: Light, place: Place, ratio: Float, reference: Float) -> Light:
    """The direction `light` restated as a lamp; ratio: (3,) the shadow ratio, measured at `reference` (2,)."""
    covariance = place.lamp_covariance
    of_direction = covariance[:2, :2]
    x, y, z, inverse_distance = place.light
    aside = place.mean[:2] - place.mean[2] * reference
    brighter = ((1 + aside @ aside) / (1 + place.mean[:2] @ place.mean[:2])) ** 1.5  # at the centre than there
    intensity = brighter * (1 - ratio) / np.maximum(ratio, 1e-3)
    return replace(
        light,
        to_light_marker=np.array([x, y, z]),
        covariance_rad2=of_direction,
        sigma_rad=radius_of_68_percent(of_direction),
        confidence=_confidence(light, of_direction),
        inverse_distance=float(inverse_distance),
        lamp_covariance=covariance,
        intensity_rgb_ratio=np.maximum(intensity, 0.0),
    )


def _with_doubt(light: Light, explanation: Explanation, place: Place) -> Light:
    """The direction with the error that it has at the marker if it is a lamp, as far as it may be one."""
    assert light.covariance_rad2 is not None
    nearness, variance = float(place.mean[2]), place.nearness_sigma**2
    total = variance + LAMPS_NEARNESS**2
    mean = nearness * LAMPS_NEARNESS**2 / total
    left = variance * LAMPS_NEARNESS**2 / total
    likelihood_ratio = math.sqrt(variance / total) * math.exp(min(0.5 * mean**2 / left, 50.0))
    likelihood_ratio *= 1 + math.erf(mean / math.sqrt(2 * left))  # lamps are nearer than infinity, not farther
    odds = likelihood_ratio * LAMPS_SHARE / (1 - LAMPS_SHARE)
    expected = odds / (1 + odds) * (mean**2 + left)
    moved = (
        direction_by_displacement(light_parameters(explanation.lights[0].light))
        @ lamp_borders(explanation)[0].by_nearness
    )
    covariance = light.covariance_rad2 + expected * np.outer(moved, moved)
    sigma_rad, confidence = radius_of_68_percent(covariance), _confidence(light, covariance)
    return replace(light, covariance_rad2=covariance, sigma_rad=sigma_rad, confidence=confidence)


def _confidence(light: Light, covariance_rad2: Float) -> float | None:
    """The light's confidence, lowered by what a wider covariance leaves of directions within 10 degrees."""
    if light.confidence is None or light.covariance_rad2 is None:
        return None
    before, after = (probability_of_good(each) for each in (light.covariance_rad2, covariance_rad2))
    return light.confidence * min(after / before, 1.0)

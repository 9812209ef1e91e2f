"""From an explanation's directions to lamps: the distance of a light is stated where it is near enough for that.

The light that an explanation was aligned with is at infinity, and right at the object. The nearness that all sources
ask for together moves the answer to the marker's centre; borders are then aligned again with that nearness, as the
shadow of a lamp is not that of a sun.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.light import Light
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.explain import NearFit
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, Judge
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.glint import Glint
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.lamps.companions import companions
from ashe_live.light.lamps.doubt import with_doubt
from ashe_live.light.lamps.fall.fall_off import fall_beside
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.lamps.kinds import AUTO, LAMP, SUN
from ashe_live.light.lamps.mixture import PlaceMixture
from ashe_live.light.lamps.near_fits import fitted_near
from ashe_live.light.lamps.one_sun import by_all_objects, place_of_sun
from ashe_live.light.lamps.place import Place, places_by_glints
from ashe_live.light.lamps.sources import (
    NEAREST,
    PlaceEvidence,
    SeenObject,
    deviance_of_sun,
    place_by_all,
    place_by_the_rest,
    place_seen_from_a_sun,
    shadow_middle,
)
from ashe_live.light.pixels.view import View

SURE_DEVIANCE = 60.0  # of a sun, from which on there is a lamp even without a slope of the ground's light: one overhead
LEAST_SIGMAS = 3.0  # standard errors by which the nearness of a lamp must differ from 0, seen from a sun
STATED_SIGMAS = 2.0  # the same once a sun is excluded: the nearness is then stated with a standard error of its own
# The same where there is one object alone: then it rests on the fall of light, whose errors by uneven ground have wider
# tails than a normal distribution, and there is no independent evidence against these.
ALONE_SIGMAS = 4.0
# Deviance of a sun, from which on the ground excludes it: 269 suns have 19 at most (docs/accuracy/lamps.md).
# Where no lamp fits the object and its shadow either, they are something else.
EXCLUDED_DEVIANCE = 100.0
WORTH_ALIGNING = 1.5  # standard errors from which on borders are aligned as a lamp's
WORTH_LOOKING = 1.0  # standard errors from which on other objects are looked for
OPEN_NEARNESS_SIGMA = 0.5  # 1/m, standard error of the nearness above which a sun is not certain either
ALIGNMENTS = 2  # of the objects as in a lamp's light, each with the nearness that follows from the one before


@dataclass(frozen=True, slots=True, eq=False)
class StatedExplanation:
    """An explanation with its lights as stated."""

    explanation: Explanation
    lights: tuple[Light, ...]


@dataclass(frozen=True, eq=False)
class PictureContext:
    """What a picture shows beside the explanation that is stated."""

    tracked: TrackedFrame
    view: View  # of it, which `ground` was fitted to
    ground: LitGround
    unlit: Mask  # (h, w) of `view`: what the lit ground does not explain
    fine_views: Sequence[View]  # all views of the scene at full resolution, that of `tracked` first
    judged: Sequence[tuple[Explanation, float]]  # the explanations that lost to the stated one, with their log odds
    # Fits other objects, which takes time: called only where a sun is not certain. With their log odds, too.
    find_others: Callable[[], Sequence[tuple[Explanation, float]]]
    fit: NearFit  # of one view
    glints: Sequence[Glint]  # mirror images of lights in the ground: one in each view that shows one
    judge: Judge  # that says how sure directions are

    @cached_property
    def sharpener(self) -> Sharpener:
        """Made on demand, as only lamps need it."""
        return Sharpener.of(self.fine_views)

    def seen_object(self, explanation: Explanation, probability: float) -> SeenObject:
        """The object of an explanation that is right with some probability."""
        overdispersion = self.judge.calibration.overdispersion
        return SeenObject(explanation, probability, self.covariance_rad2(explanation, probability), overdispersion)

    def covariance_rad2(self, explanation: Explanation, probability: float) -> Float:
        """(2, 2) of an explanation's first light, if it is right with some probability."""
        covariance = self.lights_of(explanation, probability)[0].covariance_rad2
        assert covariance is not None
        return covariance

    def lights_of(self, explanation: Explanation, probability: float) -> tuple[Light, ...]:
        """Those of an explanation that is right with some probability, as directions."""
        return self.judge.lights_of(explanation, probability, self.tracked)


def stated(
    explanation: Explanation, confidence: float, ratios: Sequence[Float], scene: PictureContext, kind: str
) -> StatedExplanation:
    """The lights of an explanation; its first one as a lamp where it is known to be one, the others always as suns.

    The first has no confidence where the light on the ground is no sun's and no lamp is found.

    ratios: (3,) each light's shadow ratio, linear RGB. kind: one of KINDS.
    """
    first = scene.seen_object(explanation, confidence)
    if kind == SUN:
        return StatedExplanation(explanation, _as_suns(first, scene))
    fall_off = fall_beside(explanation.lit, scene.view, scene.ground, scene.unlit)
    seen = PlaceEvidence([first], ratios, fall_off, places_by_glints(scene.glints, first.place))
    place, from_sun = place_by_all(seen), place_seen_from_a_sun(seen)
    if kind == LAMP or _may_be_near(place):
        others = companions(first, place, scene.find_others(), scene.covariance_rad2, scene.view)
        if others:
            seen = replace(seen, objects=[first, *others])
            place = place_by_all(seen)
            from_sun = max(from_sun, place_seen_from_a_sun(seen), key=attrgetter("standard_errors"))
    if kind == LAMP or explanation.lights[0].is_lamp or _is_lamp(seen, place, from_sun, scene):
        as_lamp = _stated_as_lamp(seen, place, kind, scene)
        if as_lamp is not None:
            return as_lamp
    return _stated_as_sun(seen, place, from_sun, scene)


def _stated_as_lamp(seen: PlaceEvidence, place: Place, kind: str, scene: PictureContext) -> StatedExplanation | None:
    """The first light as a lamp; None where it is not near enough once the objects are fitted as in a lamp's light."""
    worth, needed = (WORTH_ALIGNING, STATED_SIGMAS) if kind == AUTO else (0.0, 0.0)
    as_lamps, at = _fitted_as_lamps(seen, place, worth, scene)
    if not _is_near(at, needed):
        return None
    believed = _believed(as_lamps, scene)
    if not believed.mean.mean[2] > 0:
        return None
    alone, *others = scene.lights_of(as_lamps.first, seen.objects[0].probability)
    lamp = _lamp(alone, believed, seen.ratios[0], shadow_middle(as_lamps.first))
    return StatedExplanation(as_lamps.first, (lamp, *others))


def _stated_as_sun(seen: PlaceEvidence, place: Place, from_sun: Place, scene: PictureContext) -> StatedExplanation:
    """The first light as a sun, as unsure as there is evidence of a lamp."""
    alone, *others = _as_suns(seen.objects[0], scene)
    # Evidence of the outlines for a lamp is in the place by their borders already.
    deviance, by_outlines = deviance_of_sun(seen, place), min(seen.first.sun_by_outlines, 0.0)
    unsure = with_doubt(alone, place, from_sun, deviance, by_outlines)
    if deviance + by_outlines > EXCLUDED_DEVIANCE:
        unsure = replace(unsure, confidence=0.0)
    return StatedExplanation(seen.first, (unsure, *others))


def _as_suns(first: SeenObject, scene: PictureContext) -> tuple[Light, ...]:
    """The lights at infinity that `first` shows: the only one by all objects that stand in it, two as they are."""
    lights = scene.lights_of(first.explanation, first.probability)
    if len(lights) > 1:
        return lights
    alone = first.as_sun
    sun = replace(lights[0], to_light_marker=alone.to_light_marker, covariance_rad2=alone.covariance_rad2)
    others = companions(first, place_of_sun(alone), scene.judged, scene.covariance_rad2, scene.view)
    suns = [each.as_sun for each in (first, *others)]
    shared_rad2 = partial(scene.judge.shared_rad2, tracked=scene.tracked)
    return (by_all_objects(sun, suns, shared_rad2) if others else sun,)


def _is_lamp(seen: PlaceEvidence, place: Place, from_sun: Place, scene: PictureContext) -> bool:
    """Whether the light is surely no sun, and the hypotheses of a lamp and of a sun do not contradict that."""
    if not _is_surely_no_sun(seen, place, from_sun):
        return False
    evidence = LampHypotheses(seen.fall_off, scene.ground).evidence(seen.first, scene.fit, scene.sharpener)
    # Another object is independent evidence; that of one object alone is used up.
    return evidence.is_lamp if len(seen.objects) == 1 else evidence.lamp is None or evidence.deviance > 0


def _is_surely_no_sun(seen: PlaceEvidence, place: Place, from_sun: Place) -> bool:
    """By the slope of the light's nearness, seen from a sun, and by a sun's deviance."""
    deviance = deviance_of_sun(seen, place)
    needed = ALONE_SIGMAS if len(seen.objects) == 1 else LEAST_SIGMAS
    return deviance >= SURE_DEVIANCE or (from_sun.standard_errors > needed and deviance > needed**2)


def _fitted_as_lamps(
    seen: PlaceEvidence, place: Place, worth_sigmas: float, scene: PictureContext
) -> tuple[PlaceEvidence, Place]:
    """The objects fitted again with the lamp's nearness held, and its place by them, as long as that is worth it."""
    sharpener = scene.sharpener
    for _ in range(ALIGNMENTS):
        if not _is_near(place, worth_sigmas):
            break
        nearness = float(min(place.mean[2], NEAREST))
        # What was free to find its nearness is where it belongs.
        again = [
            one if one.nearness is not None else fitted_near(one, nearness, scene.fit, sharpener)
            for one in (each.explanation for each in seen.objects)
        ]
        if again[0] is None:
            break
        pairs = zip(again, seen.objects, strict=True)
        objects = [scene.seen_object(one, each.probability) for one, each in pairs if one is not None]
        seen = replace(seen, objects=objects)
        place = place_by_all(seen)
    return seen, place


def _believed(seen: PlaceEvidence, scene: PictureContext) -> PlaceMixture:
    """Where the lamp is: by all, if the first object and its shadow are what they were taken for, else by the rest."""
    first = seen.objects[0]
    certain = replace(first, covariance_rad2=scene.covariance_rad2(first.explanation, 1.0))
    if_right = place_by_all(replace(seen, objects=[certain, *seen.objects[1:]]))
    places = [if_right, place_by_the_rest(seen, if_right)]
    return PlaceMixture.of(places, np.array([first.probability, 1 - first.probability]))


def _may_be_near(place: Place) -> bool:
    """Whether a sun is not certain: there is evidence of a lamp, or hardly any evidence on the nearness."""
    return _is_near(place, WORTH_LOOKING) or place.nearness_sigma > OPEN_NEARNESS_SIGMA


def _is_near(place: Place, sigmas: float) -> bool:
    return place.mean[2] > 0 and place.standard_errors > sigmas


def _lamp(light: Light, believed: PlaceMixture, ratio: Float, reference: Float) -> Light:
    """The direction `light` restated as a lamp; ratio: (3,) the shadow ratio, measured at `reference` (2,)."""
    place = believed.mean
    covariance = place.lamp_covariance
    x, y, z, inverse_distance = place.light
    aside = place.mean[:2] - place.mean[2] * reference
    brighter = ((1 + aside @ aside) / (1 + place.mean[:2] @ place.mean[:2])) ** 1.5  # at the centre than there
    intensity = brighter * (1 - ratio) / np.maximum(ratio, 1e-3)
    return replace(
        light,
        to_light_marker=np.array([x, y, z]),
        covariance_rad2=covariance[:2, :2],
        sigma_rad=min(believed.errors.radius(0.68), math.pi),
        confidence=believed.errors.within(GOOD_RAD),
        inverse_distance=float(inverse_distance),
        lamp_covariance=covariance,
        intensity_rgb_ratio=np.maximum(intensity, 0.0),
    )

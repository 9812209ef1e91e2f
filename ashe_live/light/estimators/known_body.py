"""The light from a body that is known beforehand, as the paper cube: only lights are fitted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float, without
from ashe_live.core.light import Illumination, Light, LightEstimate, StageClock
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.judgement.judge import good_by_pose
from ashe_live.light.explanation.judgement.uncertainty import Calibration
from ashe_live.light.explanation.no_answer import (
    LEAST_GOOD_BY_POSE,
    NO_SHADOW,
    ROUGH_POSE,
    TOO_LITTLE_GROUND,
    fault_of_exposure,
)
from ashe_live.light.known_body.found_light import SOFT_RAD, FoundLight, darkenings_rgb, images_beside, masks_of
from ashe_live.light.known_body.lights import Found, lights_of
from ashe_live.light.known_body.outline.folded import beside_folds
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.sides.ambient import open_sky_rgb, sky_slope_rgb
from ashe_live.light.lamps.place import Place
from ashe_live.light.pixels.view import View

IN_SHADE = "the cube stands in another thing's shadow: move it into the light"
BLOCKED = (
    "the cube's shadow falls on other things, or what darkens the table is no shadow of it: clear the table around it"
)
# Least confidence of a light that is stated: below it, as many are wrong as right in painted pictures.
LEAST_CONFIDENCE = 0.4
# The same of a light none of whose edges is seen: the sides that it brightens may be brightened by a leaning sky.
LEAST_HIDDEN = 0.5
# Of an answer that may be wrong; an error of the folded paper is among the systematic ones.
CALIBRATION = Calibration(overdispersion=1.0, doubt_rad=np.radians(10.0).item(), doubt_power=1.0)
# The table beside the cube over the open table, below which something else keeps the light away.
SHADED = 0.6
DARKEST = 1e-3  # least share of the table's light that is left in a shadow


@dataclass(frozen=True, slots=True, eq=False)
class BodyEstimate:
    """What frames of a known body say of its lights."""

    estimate: LightEstimate
    view: View  # of the first frame
    used: list[TrackedFrame]  # of the others, those that the estimate rests on as well


def estimate_by_body(
    tracked: TrackedFrame, others: Sequence[TrackedFrame], body: Proxy, width_px: int, name: str, clock: StageClock
) -> BodyEstimate:
    """The lights that cast the shadows of `body` (marker frame, as it is known in `tracked`, which must have a marker).

    others: further frames of the scene with a marker on that body, which hides other parts of its shadows there; one
    with too little of the table that `tracked` shows is left out. width_px: of the frames at the resolution that is
    used. name: of the estimator.
    """
    view = View.of(tracked, width_px)
    beside = [(View.of(each, width_px), each.pose.pose_shape_errors) for each in others]
    seen = Seen.of(view, body, tracked.pose.pose_shape_errors, beside)
    clock.end("segment")
    used = [] if seen is None else [each for each, (its, _) in zip(others, beside, strict=True) if seen.shows(its)]
    index, *more = (each.frame.index for each in (tracked, *used))
    answered = partial(LightEstimate, name, index, views=(index, *more))

    def none(reason: str) -> BodyEstimate:
        reason = fault_of_exposure(view) or reason
        return BodyEstimate(answered(Illumination(), reason, timing_ms=clock.timing_ms()), view, used)

    if seen is None:
        return none(TOO_LITTLE_GROUND)
    found = lights_of(seen)
    clock.end("fit")
    likely = _likely(found.lights)
    if not likely:
        return none(_why_none(seen, found))
    if len(likely) == 1:
        dark = darkenings_rgb(found.seen, likely, SOFT_RAD)
    else:  # of one light's shadow the other's takes the middle
        dark = found.dark_rgb if len(likely) == len(found.lights) else darkenings_rgb(found.seen, likely)
    illumination = _illumination(found.seen, likely, dark, tracked)
    if all(good_by_pose(each.to_light_marker, tracked) < LEAST_GOOD_BY_POSE for each in illumination.lights):
        return none(ROUGH_POSE)
    body_mask, shadow_mask = masks_of(seen, likely)
    clock.end("judge")
    estimate = answered(illumination, object_mask=body_mask, shadow_mask=shadow_mask, timing_ms=clock.timing_ms())
    return BodyEstimate(estimate, view, used)


def _likely(found: Sequence[FoundLight]) -> list[FoundLight]:
    """The lights to be stated.

    A light that surely exists is stated beside others for its share of the light, even if its direction is uncertain.
    """
    least = [LEAST_HIDDEN if each.fit is None else LEAST_CONFIDENCE for each in found]
    is_likely = [max(each.confidence, each.around) >= one for each, one in zip(found, least, strict=True)]
    if not any(is_likely):
        return []
    exist = [(each.exists or 0.0) >= LEAST_CONFIDENCE for each in found]
    return [each for each, *kept in zip(found, is_likely, exist, strict=True) if any(kept)]


def _illumination(seen: Seen, found: Sequence[FoundLight], dark: Float, tracked: TrackedFrame) -> Illumination:
    """The lights with their uncertainty, and the sky: how much of the table's light it gives, and how it leans.

    dark: (l, 3) part of the table's light that each light gives, R, G, B.
    """
    stated = [_sun_beside_folds(seen, each, without(found, [each])) for each in found]
    lights = [_light_of(each, taken, tracked) for each, taken in zip(stated, dark, strict=True)]
    sky = open_sky_rgb(seen, found, dark)
    slope = sky_slope_rgb(seen, found, dark, sky)
    return Illumination(
        tuple(lights),
        ambient_rgb_ratio=sky,
        ground_rgb=seen.lit_rgb,
        real_object=seen.body,
        sky_slope_rgb=slope if slope.any() else None,
    )


def _sun_beside_folds(seen: Seen, found: FoundLight, others: Sequence[FoundLight]) -> FoundLight:
    """The light by its shadow's edges as the body may be off; for lamps, and what may be one, that was done before."""
    fit = found.fit
    if fit is None or found.is_lamp or found.may_be_lamp or fit.light[3] != 0:
        return found
    adjusted = beside_folds(fit, images_beside(seen, others), found.darkening, with_nearness=False)
    if adjusted is None:
        return found
    light, covariance = adjusted
    covariance = covariance + found.covariance[:2, :2] - fit.covariance[:2, :2]
    return replace(found, light=light, covariance=covariance, has_folds=True)


def _light_of(found: FoundLight, taken: Float, tracked: TrackedFrame) -> Light:
    """The light as stated; taken: (3,) part of the table's light that it gives, R, G, B."""
    by_edges = found.fitted
    covariance = CALIBRATION.covariance(by_edges, found.confidence, tracked, found.has_folds)
    left = np.clip(1 - taken, DARKEST, 1.0)
    light = Light(
        by_edges.to_light_marker,
        covariance_rad2=covariance,
        sigma_rad=radius_of_68_percent(covariance),
        confidence=found.confidence * good_by_pose(by_edges.to_light_marker, tracked),
        shadow_rgb_ratio=left,
    )
    if found.is_lamp:
        place = Place(found.light[[0, 1, 3]], np.asarray(np.linalg.inv(found.covariance), dtype=np.float64))
        lamp_covariance = place.lamp_covariance
        lamp_covariance[:2, :2] = covariance
        light = replace(
            light,
            inverse_distance=float(place.light[3]),
            lamp_covariance=lamp_covariance,
            intensity_rgb_ratio=(1 - left) / left,
        )
    return light.with_angular_size(found.size_rad or None)


def _why_none(seen: Seen, found: Found) -> str:
    if seen.beside_body < SHADED:
        return IN_SHADE
    return BLOCKED if found.is_dark_elsewhere else NO_SHADOW

"""Interpolates between illuminations, so that a new estimate does not make the virtual light jump."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.core.types import Illumination, Light, MarkerPose
from ashe_live.light.live.moved_marker import moved_illumination
from ashe_live.render.lights.lighting import angular_size, ground_ratio

EASED_OVER_S = 0.3
# A light farther than this from every former one is not reached by moving one: the old one fades out, the new one in.
SAME_LIGHT_COSINE = math.cos(math.radians(60))


class LightEasing:
    """Interpolates from what was shown when the target changed to the new target."""

    def __init__(self) -> None:
        self._target = self._shown = self._from = Illumination()
        self._begun_s = -math.inf

    def at(self, target: Illumination, now_s: float) -> Illumination:
        """The light to show at `now_s`; from the end on `target` itself, so that the renderer sees no more changes."""
        if target is not self._target:
            self._target, self._from, self._begun_s = target, self._shown, now_s
        share = (now_s - self._begun_s) / EASED_OVER_S
        self._shown = target if share >= 1 else _between(self._from, target, max(0.0, share))
        return self._shown

    def jump(self, target: Illumination) -> Illumination:
        """Shows `target` at once."""
        self._target = self._shown = target
        self._begun_s = -math.inf
        return target

    def move(self, T_new_old: Float, marker: MarkerPose) -> None:
        """What is shown goes on in another frame of the marker, as `moved_illumination`."""
        self._target = self._shown = moved_illumination(self._shown, T_new_old, marker)
        self._begun_s = -math.inf


def _between(start: Illumination, end: Illumination, share: float) -> Illumination:
    """`start` at share 0, `end` at share 1, by a smoothstep."""
    eased = share * share * (3 - 2 * share)
    lights = tuple(_lights_between(start.lights, end.lights, eased))
    ambient_of_start, ambient_of_end = _ambient(start), _ambient(end)
    ambient = None
    if ambient_of_start is not None and ambient_of_end is not None:
        ambient = (1 - eased) * ambient_of_start + eased * ambient_of_end
    slope = (1 - eased) * _slope(start) + eased * _slope(end)
    return replace(end, lights=lights, ambient_rgb_ratio=ambient, sky_slope_rgb=slope if slope.any() else None)


def _ambient(illumination: Illumination) -> Float | None:
    """(3,) ambient ratio: 1 without lights, as the sky then gives all light; None where it was not measured."""
    return illumination.ambient_rgb_ratio if illumination.lights else np.ones(3)


def _slope(illumination: Illumination) -> Float:
    """(2, 3) the sky's lean; 0 without lights, as the lean of a sky alone is not known."""
    slope = illumination.sky_slope_rgb
    return np.zeros((2, 3)) if slope is None or not illumination.lights else slope


def _lights_between(start: tuple[Light, ...], end: tuple[Light, ...], share: float) -> Iterator[Light]:
    left = list(start)
    for light in end:
        cosines = [float(other.to_light_marker @ light.to_light_marker) for other in left]
        if max(cosines, default=-1.0) < SAME_LIGHT_COSINE:
            yield _dimmed(light, share)
            continue
        near = left.pop(cosines.index(max(cosines)))
        direction = normalised((1 - share) * near.to_light_marker + share * light.to_light_marker)
        yield replace(
            light,
            to_light_marker=direction,
            # A sun's is 0: on its way to a lamp it comes nearer.
            inverse_distance=_mix(near.inverse_distance, light.inverse_distance, share),
            angular_size_rad=_mix(angular_size(near), angular_size(light), share),
            radius_m=None,
            shadow_rgb_ratio=(1 - share) * ground_ratio(near) + share * ground_ratio(light),
            intensity_rgb_ratio=None,
        )
    for light in left:
        yield _dimmed(light, 1 - share)


def _dimmed(light: Light, share: float) -> Light:
    """The light at `share` of its strength."""
    return replace(light, shadow_rgb_ratio=1 - share * (1 - ground_ratio(light)), intensity_rgb_ratio=None)


def _mix(start: float, end: float, share: float) -> float:
    return (1 - share) * start + share * end

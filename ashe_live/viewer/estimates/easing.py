"""Interpolates between illuminations, so that a new estimate does not make the virtual light jump."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import normalised
from ashe_live.core.types import MarkerPose
from ashe_live.light.live.moved_marker import moved_illumination
from ashe_live.render.lights.lighting import angular_size, lighting_of

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
        self.jump(moved_illumination(self._shown, T_new_old, marker))


def _between(start: Illumination, end: Illumination, share: float) -> Illumination:
    """`start` at share 0, `end` at share 1, by a smoothstep."""
    eased = share * share * (3 - 2 * share)
    (of_start, sky_of_start), (of_end, sky_of_end) = _as_drawn(start), _as_drawn(end)
    lights = tuple(_lights_between(of_start, of_end, eased))
    ambient = (1 - eased) * sky_of_start + eased * sky_of_end
    slope = (1 - eased) * _slope(start) + eased * _slope(end)
    return replace(end.relit(lights, ambient), sky_slope_rgb=slope if slope.any() else None)


def _as_drawn(illumination: Illumination) -> tuple[list[tuple[Light, Float]], Float]:
    """Each light with the share (3,) of level ground's light that it is drawn with, and the sky's share (3,).

    What was measured may leave some open, and contradict itself.
    """
    lighting = lighting_of(illumination.lights, illumination.ambient_rgb_ratio)
    drawn = iter(lighting.lights)
    shares = [
        np.zeros(3) if light.to_light_marker[2] <= 0 or (each := next(drawn, None)) is None else each.ground_share
        for light in illumination.lights
    ]
    return list(zip(illumination.lights, map(np.array, shares), strict=True)), np.array(lighting.sky)


def _slope(illumination: Illumination) -> Float:
    """(2, 3) the sky's lean; 0 without lights, as the lean of a sky alone is not known."""
    slope = illumination.sky_slope_rgb
    return np.zeros((2, 3)) if slope is None or not illumination.lights else slope


def _lights_between(start: list[tuple[Light, Float]], end: list[tuple[Light, Float]], share: float) -> Iterator[Light]:
    left = list(start)
    for light, of_ground in end:
        cosines = [float(other.to_light_marker @ light.to_light_marker) for other, _ in left]
        if max(cosines, default=-1.0) < SAME_LIGHT_COSINE:
            yield light.with_ground_share(share * of_ground)
            continue
        near, by_near = left.pop(cosines.index(max(cosines)))
        direction = normalised((1 - share) * near.to_light_marker + share * light.to_light_marker)
        moved = replace(
            light,
            to_light_marker=direction,
            # A sun's is 0: on its way to a lamp it comes nearer.
            inverse_distance=_mix(near.inverse_distance, light.inverse_distance, share),
            angular_size_rad=_mix(angular_size(near), angular_size(light), share),
            radius_m=None,
        )
        yield moved.with_ground_share((1 - share) * by_near + share * of_ground)
    for light, of_ground in left:
        yield light.with_ground_share((1 - share) * of_ground)


def _mix(start: float, end: float, share: float) -> float:
    return (1 - share) * start + share * end

"""Irradiances of the sky, suns and lamps for shading, from the measured ratios of the real shadows."""

import math
from dataclasses import dataclass, field

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light

RGB = tuple[float, float, float]

MAX_LIGHTS = 4
# Assumed ratio of shadowed over lit ground if none was measured: about the share of a clear sky at noon.
ASSUMED_SHADOW_RATIO = 0.4
SUN_ANGULAR_SIZE_RAD = math.radians(0.53)
# Nearer to a lamp than this share of its distance from the marker's centre, light grows no further (as in lights.glsl).
LEAST_LAMP_DISTANCE = 0.01
LAMP_RADIUS_M = 0.03  # of a household bulb (A60), for a lamp whose size was not measured
# Below this sine of the elevation a light's irradiance is no longer raised to match its share on level ground.
MIN_BALANCED_SINE = 0.2
LEAST_REST = 0.5  # least ambient light, as a share of the product of the shadows' ratios
# The albedo of ground whose colour is not known, and the largest that is accepted.
GROUND_ALBEDO = 0.35
MAX_ALBEDO = 0.9


@dataclass(frozen=True, slots=True, eq=False)
class ShadingLight:
    """A light as shading wants it: a sun, or a lamp near by. Units as in Lighting, at the marker's centre.

    In the terms of glTF's KHR_lights_punctual a sun is a directional light, a lamp a point light, whose light falls by
    the square of the distance in metres: its intensity in candela, where our unit is a lux, is its irradiance here over
    the square of `inverse_distance`.
    """

    to_light: Float  # (3,) unit, marker frame, from the marker's centre, above the horizon
    ground_share: RGB  # share of the light on level ground, which its shadow takes away
    irradiance: RGB  # on a surface that faces it
    angular_size_rad: float  # diameter, seen from the marker's centre
    inverse_distance: float = 0.0  # 1/m, one over the distance from the marker's centre; 0 for a sun

    @property
    def homogeneous(self) -> Float:
        """(4,) the light as a point, marker frame, metres; w = 0 for a sun."""
        return np.array([*self.to_light, self.inverse_distance])

    @property
    def tan_half_size(self) -> float:
        """The light's radius over its distance from the marker's centre."""
        return math.tan(self.angular_size_rad / 2)

    def towards(self, points: Float) -> Float:
        """(n, 3) vectors from points (n, 3) to the light, over its distance from the marker's centre."""
        return np.asarray(self.to_light - self.inverse_distance * points)

    def ground_falloff(self, ground: Float, height_m: float = 0.0) -> Float:
        """(n,) its light on level ground at points (n, 2) over that at the marker's centre: h / d^3, by Lambert.

        `height_m`: of the ground above the marker's plane, as of what lies on a body.
        """
        towards = self.towards(np.column_stack([ground, np.full(len(ground), height_m)]))
        above = np.maximum(towards[:, 2] / self.to_light[2], 0.0)
        return np.asarray(above * np.maximum(np.linalg.norm(towards, axis=1), LEAST_LAMP_DISTANCE) ** -3)


@dataclass(frozen=True, slots=True, eq=False)
class Lighting:
    """Irradiances over pi, in units in which fully lit level ground receives 1 at the marker's centre.

    White ground then has radiance 1 there, and under suns everywhere.
    """

    lights: tuple[ShadingLight, ...]  # strongest first, MAX_LIGHTS at most
    sky: RGB  # on level ground; with the lights' shares it makes 1 at the marker's centre
    bounce: RGB  # from the ground at the marker's centre, on a surface that faces it
    # (2, 3) what surfaces that face x and y get of the sky beyond what an even one gives them.
    sky_slope: Float = field(default_factory=lambda: np.zeros((2, 3)))

    @property
    def has_lamps(self) -> bool:
        return any(light.inverse_distance > 0 for light in self.lights)

    @property
    def constants(self) -> dict[str, int]:
        """The macros of a shader that includes lights.glsl."""
        return {"lights": len(self.lights), "lamps": int(self.has_lamps)}

    @property
    def light_points(self) -> Float:
        """(n, 4) the lights as homogeneous points, marker frame, metres."""
        return np.array([light.homogeneous for light in self.lights])

    def level_at(self, ground: Float, height_m: float = 0.0) -> Float:
        """(n, 3) the light on level ground at points (n, 2), which nothing shades, over that at the marker's centre.

        `height_m`: as of `ShadingLight.ground_falloff`.
        """
        falloff = np.array([light.ground_falloff(ground, height_m) for light in self.lights]).reshape(
            len(self.lights), len(ground)
        )
        return np.asarray(1 + (falloff - 1).T @ self.ground_shares.reshape(-1, 3))

    @property
    def irradiances(self) -> Float:
        """(n, 3) irradiances of the lights, on surfaces that face them."""
        return np.array([light.irradiance for light in self.lights])

    @property
    def ground_shares(self) -> Float:
        """(n, 3) shares of the lights in the light on level ground."""
        return np.array([light.ground_share for light in self.lights])


def lighting_of(
    lights: tuple[Light, ...],
    ambient_rgb_ratio: Float | None = None,
    ground_albedo: Float | None = None,
    sky_slope_rgb: Float | None = None,
) -> Lighting:
    """Sky and lights from the shadows' ratios: one whose shadow has the ratio r gives 1 - r of level ground's light.

    Where ratios and ambient (3,) contradict each other, the ambient is kept and the lights share the rest. The ambient
    was measured where the shadow lies; a lamp's share that was measured at the marker's centre takes precedence over
    it. Lights below the horizon give nothing; without any light the sky gives all: no light is invented. From below,
    surfaces get the light of the ground in its own colour (3,). The sky's slope (2, 3) is limited such that no surface
    gets negative light.
    """
    albedo = np.full(3, GROUND_ALBEDO) if ground_albedo is None else np.clip(ground_albedo, 0.0, MAX_ALBEDO)
    lights = tuple(light for light in lights if light.to_light_marker[2] > 0)[:MAX_LIGHTS]
    if not lights:
        return Lighting((), (1.0, 1.0, 1.0), _rgb(albedo), _slope_within(sky_slope_rgb, np.ones(3)))
    shares = np.array([1 - ground_ratio(light, len(lights)) for light in lights])
    if any(light.intensity_rgb_ratio is not None for light in lights):
        ambient_rgb_ratio = None
    total = shares.sum(axis=0)
    # Shares that sum to more than 1 were measured wrongly; the product of the shadows' ratios bounds what is left.
    rest = np.maximum(1 - total, LEAST_REST * (1 - shares).prod(axis=0))
    sky = np.clip(rest if ambient_rgb_ratio is None else ambient_rgb_ratio, 0.0, 1.0)
    sky = np.where(total > 0, sky, 1.0)  # of a colour in which no light has a share there is nothing to share
    shares *= np.divide(1 - sky, total, out=np.zeros(3), where=total > 0)
    sines = np.array([light.to_light_marker[2] for light in lights])
    across = shares / np.maximum(sines, MIN_BALANCED_SINE)[:, None]
    level = sky + sines @ across
    shading = tuple(
        ShadingLight(light.to_light_marker, _rgb(share), _rgb(irradiance), angular_size(light), light.inverse_distance)
        for light, share, irradiance in zip(lights, shares, across, strict=True)
    )
    return Lighting(shading, _rgb(sky), _rgb(albedo * level), _slope_within(sky_slope_rgb, sky))


def _slope_within(slope: Float | None, sky: Float) -> Float:
    """(2, 3) the slope, limited such that no wall gets negative light from the sky (3,)."""
    if slope is None:
        return np.zeros((2, 3))
    steepest = np.maximum(np.linalg.norm(slope, axis=0), 1e-9)
    return np.asarray(slope * np.minimum(1.0, 0.5 * sky / steepest))


def ground_ratio(light: Light, count: int = 1) -> Float:
    """(3,) as `Light.ground_rgb_ratio`, within [0, 1]; a plausible one of `count` lights where it was not measured."""
    measured = light.ground_rgb_ratio
    if measured is None:
        return np.full(3, 1 - (1 - ASSUMED_SHADOW_RATIO) / count)
    return np.clip(measured, 0.0, 1.0)


def measured_ratio(light: Light) -> Float | None:
    """(3,) ground in the light's shadow over lit ground, as the video shows it; None if it was not measured.

    Where the shadow itself was not measured, that of a lamp's intensity, which holds at the marker's centre.
    """
    if light.shadow_rgb_ratio is None and light.intensity_rgb_ratio is None:
        return None
    return ground_ratio(light) if light.shadow_rgb_ratio is None else light.shadow_rgb_ratio


def angular_size(light: Light) -> float:
    """The light's angular diameter seen from the marker's centre; a plausible one where it was not measured."""
    is_by_radius = light.radius_m is not None or light.angular_size_rad is None
    if light.inverse_distance > 0 and is_by_radius:
        radius_m = LAMP_RADIUS_M if light.radius_m is None else light.radius_m
        return 2 * math.atan(radius_m * light.inverse_distance)
    return light.angular_size_rad or SUN_ANGULAR_SIZE_RAD


def _rgb(values: Float) -> RGB:
    red, green, blue = (float(value) for value in values)
    return red, green, blue

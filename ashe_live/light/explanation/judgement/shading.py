"""Shading: whether the object is shaded as the fitted body would be in the light that its shadow implies."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Float32, Mask, fixed_point, median
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre, project
from ashe_live.light.ground.regions import Region
from ashe_live.light.pixels.areas import shrunk
from ashe_live.light.shape.light_points import relative_irradiance, towards

AROUND, UPWARDS = 16, 9  # facets of the body's surface
BOUNCE = 0.3  # fraction of the light on the ground that it reflects
DARKEST = 0.02  # linear light of a facet, below which differences are not seen
LOWEST_Z = 0.1  # of a light's direction, by which its irradiance on level ground is divided
FARTHEST_PX = 1e5  # of a facet from the picture's corner
LEAST_PX = 30  # of the object without its rim, whose shading is compared
SPREAD_OF_NOISE = 0.03  # added to both spreads: smaller differences in log brightness are noise
# Prior on the amplitudes of the sky's shading and of the light's, means and standard deviations: both would be 1 if the
# object were matt, of one colour, and exactly of the body's shape.
PRIOR_MEAN, PRIOR_SIGMA = np.array([1.0, 0.5]), np.array([0.7, 0.5])
LEAST_NOISE = 0.05  # standard deviation of what shading leaves unexplained, log brightness
PIXELS_PER_SAMPLE_OF_OBJECT = 40  # pixels over their effective sample size: an object's colours come in patches


@dataclass(frozen=True, slots=True)
class Shading:
    """Whether an object is lit by a light, or by the sky alone; both numbers are 0 where too little of it is seen."""

    contrast: float  # log ratio of the spread of brightness left unexplained by the sky alone to that by sky and light
    sunlit: float  # amplitude of the light's shading in sigmas; negative if the object is lit from elsewhere


UNKNOWN = Shading(0.0, 0.0)


def shading_of(
    region: Region, body: Mask, proxy: Proxy, lights: Sequence[Float], shadow_ratios: Sequence[float]
) -> Shading:
    """Compares the object's pixels `body` (h, w) with a Lambertian `proxy` in these lights and under the sky.

    lights: (4,) homogeneous points, marker frame. shadow_ratios: shadow ratio of the ground's brightness for each of
    them, beside the object, from which its strength follows: a light whose shadow halves the ground's brightness must
    shade the object as strongly, whereas a flat dark patch beside an object implies a light that the shading does not
    show.
    """
    lit, under_sky = _irradiances(region, proxy, lights, shadow_ratios)
    core = shrunk(body, 1) & region.is_ground & (lit > 0)
    if np.count_nonzero(core) <= LEAST_PX:
        return UNKNOWN
    brightness = region.colours[..., 0][core].astype(np.float64)
    by_light, by_sky = (np.log(picture[core] + DARKEST, dtype=np.float64) for picture in (lit, under_sky))
    contrast = math.log(
        (_spread(brightness - by_sky) + SPREAD_OF_NOISE) / (_spread(brightness - by_light) + SPREAD_OF_NOISE)
    )
    return Shading(contrast, _sunlit(brightness, by_sky, by_light - by_sky))


def _sunlit(brightness: Float, by_sky: Float, by_light: Float) -> float:
    """The least-squares amplitude of `by_light` in `brightness` over its deviation, scaled down where the prior
    dominates.
    """
    parts = np.column_stack([values - values.mean() for values in (by_sky, by_light)])
    shown = brightness - brightness.mean()
    noise = max(float(np.std(shown - parts @ PRIOR_MEAN)), LEAST_NOISE)
    weight = 1 / (PIXELS_PER_SAMPLE_OF_OBJECT * noise**2)
    information = weight * (parts.T @ parts) + np.diag(PRIOR_SIGMA**-2.0)
    amplitude = np.linalg.solve(information, weight * (parts.T @ shown) + PRIOR_MEAN / PRIOR_SIGMA**2)[1]
    variance = float(np.linalg.inv(information)[1, 1])
    return float(amplitude / math.sqrt(variance) * (1 - variance / PRIOR_SIGMA[1] ** 2))


def _spread(values: Float) -> float:
    """Mean absolute deviation from the median, which few outliers hardly change."""
    return float(np.abs(values - median(values)).mean())


def _irradiances(
    region: Region, proxy: Proxy, lights: Sequence[Float], shadow_ratios: Sequence[float]
) -> tuple[Float32, Float32]:
    """(h, w) each: irradiance of the body's surface in the lights, and under the sky alone, in units of that of
    the lit ground at the body's foot.

    Both are 0 outside of the body.
    """
    view = region.view
    points, triangles = proxy.surface(AROUND, UPWARDS)
    first, second, third = points[triangles.T]
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    eye = camera_centre(view.T_cam_marker)
    pixels = project(view.camera, view.T_cam_marker, points)[triangles]
    in_view = np.isfinite(pixels).all(axis=(1, 2)) & (np.abs(np.nan_to_num(pixels)).max(axis=(1, 2)) < FARTHEST_PX)
    front = (lengths > 1e-9 * lengths.max()) & (((eye - first) * normals).sum(axis=1) > 0) & in_view
    normals = normals[front] / lengths[front, None]
    up = normals[:, 2]
    from_sky, bounced = (1 + up) / 2, BOUNCE * (1 - up) / 2
    irradiance = max(1 - sum(1 - ratio for ratio in shadow_ratios), 0.0) * from_sky + bounced
    foot, centres = proxy.foot_marker, points[triangles[front]].mean(axis=1)
    for light, ratio in zip(lights, shadow_ratios, strict=True):
        to_light = towards(light, foot)
        irradiance += (1 - ratio) / max(to_light[2], LOWEST_Z) * relative_irradiance(light, centres, normals, foot)
    corners = fixed_point(pixels[front])
    # Facets share the pixels of a common edge: the brighter one gets them, however the marker is rotated.
    order = np.argsort(irradiance)
    facet = np.zeros(view.is_ground.shape, np.int32)
    for number, index in enumerate(order, start=1):
        cv2.fillConvexPoly(facet, corners[index], number, shift=FRACTION_BITS)
    lit, under_sky = (np.append(0.0, each[order]).astype(np.float32) for each in (irradiance, from_sky + bounced))
    return lit[facet], under_sky[facet]

"""The lit ground's slowly varying shading: how its colours change over the picture, whatever they are.

A quadratic in the image's coordinates follows vignetting, a wall near by, and what a lamp far away does. Near below a
lamp the light falls by a factor of ten within a metre, which no quadratic follows: there its fall is one function more.
So is what glossy ground mirrors of a sun.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Float32
from ashe_live.core.transforms import camera_centre, image_from_plane
from ashe_live.light.ground.gloss import Gloss, mirrored
from ashe_live.light.pixels.view import View, Window

LEAST_LIGHT = 1e-3  # of that at the reference, so that the log is finite
# Ridges on the coefficients, for each pixel: on the linear, the quadratic and the fall's, as the trend must not follow
# clusters of colours; and on all alike, once these are known.
TREND_RIDGE, FIELD_RIDGE = 2e-5 * np.array([0.0, 1, 1, 3, 3, 3, 1]), 5e-4
OUTLIER = 0.15  # difference of log colour from its cluster's centre at which a pixel's weight is halved
LEAST_SCALE = 0.01  # added to the scale of the residuals, log colour
TREND_ROUNDS = 6  # of reweighting
HORIZON = 1e-9  # of a homogeneous coordinate: a pixel that is nearer to the horizon sees no ground


@dataclass(frozen=True, slots=True, eq=False)
class LightFall:
    """How a light is distributed over the plane by its distance and the ground's gloss, in a picture at any scale."""

    plane_from_picture: Float  # (3, 3) to metres on the plane, from coordinates that are -1 and 1 at the borders
    light: Float  # (3,) its displacement at the marker's centre, and its nearness w / z (1/m)
    share: float  # of all light on the plane at the reference that is this light's
    reference: Float  # (2,) metres on the plane
    eye: Float  # (3,) the camera's centre, metres, marker frame
    gloss: Gloss | None  # of the ground

    @staticmethod
    def of(view: View, light: Float, share: float, reference: Float, gloss: Gloss | None = None) -> "LightFall":
        """In a view, of a light (3,) that has this share of all light at the reference (2,), as the fields say."""
        width, height = view.size
        to_picture = np.array([[2 / width, 0, 1 / width - 1], [0, 2 / height, 1 / height - 1], [0, 0, 1]])
        plane = np.linalg.inv(to_picture @ image_from_plane(view.camera, view.T_cam_marker))
        return LightFall(np.asarray(plane), light, share, reference, camera_centre(view.T_cam_marker), gloss)

    def log_light(self, u: Float32, v: Float32) -> Float32:
        """(n,) log of all light over that at the reference, at picture coordinates (n,) each."""
        x, y, w = self.plane_from_picture @ np.stack([u, v, np.ones_like(u)]).astype(np.float64)
        w = np.where(np.abs(w) < HORIZON, HORIZON, w)
        places, light = np.column_stack([x / w, y / w]), self.light[None]
        relative = irradiances(places, light)[:, 0] / irradiances(self.reference[None], light)[0, 0]
        if self.gloss is not None:
            relative = relative * (1 + mirrored(places, self.eye, light, self.gloss)[:, 0])
        return np.asarray(np.log(np.maximum(1 - self.share + self.share * relative, LEAST_LIGHT)), dtype=np.float32)


def irradiances(places: Float, lamps: Float) -> Float:
    """(p, n) irradiance by each of n lamps (n, 3) at places (p, 2), but for a factor: (1 + |s - p w / z|^2)^(-3/2)."""
    x, y, nearness = lamps.T
    by_place = np.array([1 + x**2 + y**2, -2 * x * nearness, -2 * y * nearness, nearness**2])
    # |s - p w / z|^2 is a quadratic in the place, so that all of them are one product of (p, 4) and (4, n).
    squared = np.column_stack([np.ones(len(places)), places, (places**2).sum(axis=1)]) @ by_place
    return np.asarray(1 / (squared * np.sqrt(squared)))  # a third of the time of a power of -1.5


def log_irradiance(
    places: Float,
    parameters: Float,
    shares: Sequence[float],
    reference: Float,
    mirrored_share: tuple[Float, Float] | None = None,
) -> tuple[Float, Float]:
    """(n,) log of all light at places (n, 2) over that at `reference` (2,); (n, 3) its slopes by the first light.

    parameters: (l, 3) displacement and nearness of each light. shares: of all light at the reference. What is no
    light's share is the same everywhere. mirrored_share: (n, l) what the ground mirrors of each light, over what it
    scatters, and (n, 3) its slopes by the first light.
    """
    total = np.full(len(places), 1.0 - sum(shares))
    slopes = np.zeros((len(places), 3))
    for i, (light, share) in enumerate(zip(parameters, shares, strict=True)):
        here, by_light = _log_fall(places, light)
        there, by_light_there = _log_fall(reference[None], light)
        part = share * np.exp(here - there)
        slope = by_light - by_light_there
        if mirrored_share is not None:
            seen, by_first = mirrored_share
            glossy = 1 + seen[:, i]
            part = part * glossy
            slope = slope + by_first / glossy[:, None]
        total += part
        if i == 0:
            slopes = part[:, None] * slope
    total = np.maximum(total, LEAST_LIGHT)
    return np.log(total), slopes / total[:, None]


def _log_fall(places: Float, light: Float) -> tuple[Float, Float]:
    """(n,) log of (1 + |s - p w / z|^2)^(-3/2) at places (n, 2), and (n, 3) its slopes by s and w / z (3,)."""
    aside = light[:2] - light[2] * places
    squared = 1 + (aside**2).sum(axis=1)
    by_displacement = -3 * aside / squared[:, None]
    return -1.5 * np.log(squared), np.column_stack([by_displacement, -(by_displacement * places).sum(axis=1)])


def slow_bases(shape: tuple[int, ...], fall: LightFall | None, window: Window = (slice(None), slice(None))) -> Float32:
    """(h * w, b) functions of a window of a picture (h, w): a quadratic in u, v in [-1, 1] without a constant, b = 5,
    and the fall of light where it is given, b = 6.
    """
    rows, columns = (np.arange(size, dtype=np.float32)[part] + 0.5 for size, part in zip(shape, window, strict=True))
    v, u = np.meshgrid(rows, columns, indexing="ij")
    u, v = 2 * u / shape[1] - 1, 2 * v / shape[0] - 1
    functions = [u, v, u * u, u * v, v * v]
    if fall is not None:
        functions.append(fall.log_light(u.ravel(), v.ravel()).reshape(u.shape))
    return np.stack(functions, axis=2).reshape(-1, len(functions))


def robust_trend(values: Float32, slow: Float32) -> Float32:
    """(b, 3) slow field of colours (n, 3) with basis functions `slow` (n, b), by iteratively reweighted least squares.

    Cauchy's weights against outliers. The constant is fitted too, but not returned.
    """
    design = np.column_stack([np.ones(len(slow), np.float32), slow]).astype(np.float64)
    columns = values.T.astype(np.float64)
    ridge = len(slow) * np.diag(TREND_RIDGE[: design.shape[1]])
    weights = np.ones(len(slow))
    for _ in range(TREND_ROUNDS):
        weighted = design * weights[:, None]
        coefficients = np.linalg.solve(weighted.T @ design + ridge, (columns @ weighted).T)
        residuals = columns - coefficients.T @ design.T
        scale = SIGMA_OVER_MAD * np.median(np.abs(residuals), axis=1, keepdims=True) + LEAST_SCALE
        weights = 1 / (1 + ((residuals / (2 * scale)) ** 2).sum(axis=0))
    return np.asarray(coefficients[1:], dtype=np.float32)


def field_beside(rest: Float32, slow: Float32, before: Float32) -> Float32:
    """(b, 3) the slow field refitted to the colours' differences from their clusters' centres (n, 3).

    before: (b, 3) the last field, whose residuals give the weights against outliers.
    """
    weights = 1 / (1 + (((rest - slow @ before) / OUTLIER) ** 2).sum(axis=1))
    weighted = slow * weights[:, None]
    ridge = FIELD_RIDGE * len(slow) * np.eye(slow.shape[1], dtype=np.float32)
    return np.asarray(np.linalg.solve(weighted.T @ slow + ridge, weighted.T @ rest), dtype=np.float32)

"""The fit: from masks of an object and its shadows to lights, their covariance, and a body that explains both.

Families of bodies are tried one after the other, each searched for its best member together with the lights; the one
that explains the outlines best for its number of parameters is believed as far as it explains them, and the tangents
that need no body decide the rest (docs/maths.md).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Mask, frozen_floats, set_frozen
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised, tangent_basis
from ashe_live.light.contours import AnyMask
from ashe_live.light.first_guess import FirstGuess, guess_scene
from ashe_live.light.proxies import FAMILIES
from ashe_live.light.search import Solution, search
from ashe_live.light.silhouettes import Outlines, observe_outlines
from ashe_live.light.tangents import sharpened_slants

# Errors in neighbouring directions go together: this many of them tell what one independent measurement would.
CORRELATED = 4.0
# What a squared edge error and a squared misfit (the body is not quite of the family) weigh in the variance of an
# outline; measured so that 68 and 95 % of the errors on rendered scenes, with true and spoilt masks, lie within theirs.
EDGE_WEIGHT, MISFIT_WEIGHT = 4.0, 20.0
# A misfit beyond this share of the object's size says that the family is a wrong one.
WRONG_FAMILY_SHARE = 0.015
# Cauchy's scale: errors beyond this share of the object's size are outliers (a handle, a hole in a mask).
OUTLIER_SHARE, OUTLIER_PX = 0.03, (0.75, 4.0)
ENOUGH_SHARE = 0.005  # of the object's size: small objects look alike, and need all families
HEMISPHERE_RAD = 0.7  # how far a light may be from where it is found, if the outlines tell nothing
HOPELESS = 3.0  # a search whose cost remains above this multiple of the best is given up


@dataclass(frozen=True, slots=True)
class FitPreset:
    """How much work the fit spends."""

    directions: int  # in which outlines are compared
    families: tuple[str, ...]  # tried in this order, each after the one that it grows from
    stretches: tuple[float, ...]  # of the first guess's shadow length, to start from
    iterations: int
    kept: int  # starts that go on after the first iterations
    enough: float  # no further family is tried once one misses by less, in sigmas of the edges


FAST = FitPreset(32, ("frustum", "box", "sphere", "vase"), (1.0,), 8, 1, 1.5)
BALANCED = FitPreset(40, ("frustum", "box", "sphere", "vase", "mug", "pylon", "wagon", "ell"), (1.0,), 10, 1, 1.25)
ACCURATE = FitPreset(72, tuple(FAMILIES), (0.6, 1.0, 1.6), 30, 3, 0.0)


@dataclass(frozen=True, slots=True)
class FittedLight:
    """A direction towards a light, and how well the outlines determine it."""

    to_light_marker: Float  # (3,) unit
    covariance_rad2: Float  # (2, 2) on the tangent basis: larger azimuth, larger elevation

    def __post_init__(self) -> None:
        set_frozen(
            self,
            to_light_marker=frozen_floats(normalised(self.to_light_marker), (3,), "to_light_marker"),
            covariance_rad2=frozen_floats(self.covariance_rad2, (2, 2), "covariance_rad2"),
        )


@dataclass(frozen=True, slots=True)
class Fit:
    """Lights, the body that casts their shadows, and how well it does."""

    lights: tuple[FittedLight, ...]  # one for each shadow mask, in their order
    proxy: Proxy
    residual_px: float  # root mean square by which the proxy and its shadows miss the outlines, outliers forgiven
    object_px: float  # square root of the object's area, to compare the residual with
    residual_px_by_family: Mapping[str, float]  # of every family tried


@dataclass(frozen=True, slots=True)
class FitFailure:
    """Why these masks tell no direction."""

    reason: str  # for a person


def fit_light(
    body: AnyMask,
    shadows: Sequence[AnyMask],
    camera: Camera,
    T_cam_marker: Float,
    unreliable: Mask | None = None,
    edge_sigma_px: float = 0.5,
    preset: FitPreset = BALANCED,
    either: Mask | None = None,
    near: Float | None = None,
) -> Fit | FitFailure:
    """The lights that cast `shadows`, one mask each, off the one object `body`, which stands on the marker plane.

    Masks: (h, w) of the camera's size, bool, or float probabilities whose 0.5 level is the outline; of undistorted
    pixels. `unreliable`: (h, w) pixels of which nothing is known (the marker's print, other objects). `edge_sigma_px`:
    how far the masks' edges typically are from the truth; 0.2 for perfect masks. `either`: (h, w) pixels outside the
    masks that belong to the object or to a shadow. `near`: (l, 2) displacements s to start from as well.
    Raises ValueError when shapes differ or there is no shadow mask.
    """
    shape = camera.size[::-1]
    masks = [mask for mask in (body, *shadows, unreliable, either) if mask is not None]
    if not shadows or any(mask.shape != shape for mask in masks):
        raise ValueError(f"a fit needs an object and shadows of shape {shape}, not {[mask.shape for mask in masks]}")
    outlines = observe_outlines(body, shadows, unreliable, preset.directions, edge_sigma_px, either)
    if isinstance(outlines, str):
        return FitFailure(outlines)
    guess = guess_scene(camera, T_cam_marker, outlines)
    if isinstance(guess, str):
        return FitFailure(guess)
    slants = [guess.slants * stretch for stretch in preset.stretches] + ([] if near is None else [near])
    solutions = _try_families(outlines, guess, slants, edge_sigma_px, preset)
    return _believed(outlines, guess, solutions, edge_sigma_px)


def _try_families(
    outlines: Outlines, guess: FirstGuess, slants: list[Float], edge_sigma_px: float, preset: FitPreset
) -> dict[str, Solution]:
    outlier_px = min(max(OUTLIER_SHARE * outlines.size_px, OUTLIER_PX[0]), OUTLIER_PX[1])
    enough_px = min(preset.enough * edge_sigma_px, ENOUGH_SHARE * outlines.size_px)
    cylinder = np.array([0.0, 0.0, math.log(guess.height), guess.radius, guess.radius])
    solutions: dict[str, Solution] = {}
    for name in preset.families:
        family = FAMILIES[name]
        least = min((solution.mean_square for solution in solutions.values()), default=math.inf)
        # A small ball also looks much like a cup: all families that grow from the first guess are tried in any case.
        if family.grows_from and math.sqrt(least) < enough_px:
            break
        if family.grows_from is None:
            shapes = family.starts(cylinder)
            origins = slants
        else:
            parent = solutions[family.grows_from]
            shapes = family.starts(parent.shape)
            origins = [parent.slants]
        starts = np.array([[*slant.ravel(), *shape] for slant in origins for shape in shapes])
        hopeless = HOPELESS * min((solution.cost for solution in solutions.values()), default=math.inf)
        solutions[name] = search(
            guess.P, outlines, family, starts, outlier_px, preset.iterations, preset.kept, hopeless
        )
    return solutions


def _believed(outlines: Outlines, guess: FirstGuess, solutions: Mapping[str, Solution], edge_sigma_px: float) -> Fit:
    """The best solution as a fit: sharpened by tangents, in the marker frame."""
    name = min(solutions, key=lambda name: _information_criterion(solutions[name], edge_sigma_px))
    best = solutions[name]
    parameters = best.slants.size + best.shape.size
    misfit = best.mean_square * best.count / max(best.count - parameters, 0.25 * best.count)
    wrong = misfit / (WRONG_FAMILY_SHARE * outlines.size_px) ** 2
    variance = EDGE_WEIGHT * edge_sigma_px**2 + MISFIT_WEIGHT * misfit * (1 + wrong)

    information = best.information / variance
    for i, slant in enumerate(best.slants):
        own, slope = np.s_[2 * i : 2 * i + 2], _direction_by_slant(slant)
        information[own, own] += slope.T @ slope / HEMISPHERE_RAD**2
    spheroids = best.family.parts(best.shape[None])[0][0]
    spheroids[:, 3:] = np.abs(spheroids[:, 3:])  # a radius enters squared, so that its sign means nothing
    trusted = spheroids if wrong < 1 else None
    slants, covariance = sharpened_slants(guess.P, outlines, best.slants, information, edge_sigma_px, trusted)
    lights = []
    for i, slant in enumerate(slants):
        own, slope = np.s_[2 * i : 2 * i + 2], _direction_by_slant(slant)
        spread = slope @ covariance[own, own] @ slope.T
        lights.append(FittedLight(np.array([*slant, 1.0]), 0.5 * (spread + spread.T)))
    spheroids *= guess.unit_m
    spheroids[:, :2] += guess.origin_marker
    residuals = {family: math.sqrt(solution.mean_square) for family, solution in solutions.items()}
    return Fit(tuple(lights), Proxy(name, spheroids), residuals[name], outlines.size_px, residuals)


def _direction_by_slant(slant: Float) -> Float:
    """(2, 2) derivative of the direction (s, 1) / |(s, 1)|, on its tangent basis, by s."""
    towards = np.array([*slant, 1.0])
    return np.asarray(tangent_basis(towards)[:, :2] / np.linalg.norm(towards))


def _information_criterion(solution: Solution, edge_sigma_px: float) -> float:
    """Bayes's: how badly the outlines are explained, and by how many numbers; the least is the best."""
    parameters = solution.slants.size + solution.shape.size
    measurements = max(solution.count / CORRELATED, parameters + 1.0)
    error = solution.mean_square + edge_sigma_px**2
    return measurements * math.log(error) + parameters * math.log(measurements)

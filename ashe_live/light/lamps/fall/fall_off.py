"""How the light falls off over the lit ground, by which a lamp differs from a sun, and a near lamp from a far one.

A lamp at (X, Y, Z) lights a point p of the plane by Z / |X - p|^3, which is (1 + |s - p w / z|^2)^(-3/2) in the
light's parameters but for a factor; a sun lights all of it alike. A glossy ground mirrors either on top of that. What
else makes the ground uneven (relief, a wall near by, the camera's tone mapping) has a larger variance than what is
fitted along (docs/maths, "The fall of light").
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from ashe_live.core.arrays import Float, Mask, once_for_each
from ashe_live.core.transforms import camera_centre
from ashe_live.light.ground.gloss import Gloss, mirrored, mirrored_and_slopes
from ashe_live.light.ground.lit_ground import LitGround, as_taken
from ashe_live.light.ground.slow_shading import LEAST_LIGHT, irradiances, log_irradiance
from ashe_live.light.lamps.fall.lit_samples import CONTRAST, LitSamples, clear_of
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.predicted import predicted_of

# Sigmas of what a picture in a hundred shows and no lamp causes, beside what all show (`lit_samples`): sheen towards
# the light, bumps of a rough ground in low light, a shadow's soft rim, tone mapping that differs from place to place.
WORST_GRADIENT, WORST_CURVATURE, WORST_CONTRAST = 0.25, 0.4, 0.3
WORST = np.array([WORST_GRADIENT] * 2 + [WORST_CURVATURE] * 3 + [WORST_CONTRAST])
LEAST_CONTRAST, MOST_CONTRAST = 0.3, 3.0  # limits of the camera's contrast beside that of sRGB, which is fitted along
BLOCK = 60_000  # samples times lights that are tried at once: what is computed then fits into the processor's cache


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """The log likelihood of a light by the fall of light, linearised about some parameters."""

    gradient: Float  # (3,) information times the offset of displacement and nearness
    information: Float  # (3, 3) on these, positive semi-definite
    cost: float  # twice the negative log likelihood of the light, without what worst unevenness may explain
    worst_cost: float  # the same, with all that it may explain


@dataclass(frozen=True, slots=True, eq=False)
class FallOff:
    """The lit ground's brightness, as the light of any sun or lamp may be compared with it."""

    samples: LitSamples
    eye: Float  # (3,) the camera's centre, metres, marker frame
    gloss: Gloss | None = None  # of the ground: what it mirrors of a light may be part of that light, or not

    @staticmethod
    def of(view: View, ground: LitGround, free: Mask) -> "FallOff | None":
        """Of the lit ground in `free` (h, w), away from objects and shadows; None where too little of it is seen.

        view: the one that `ground` was fitted to.
        """
        if view.taken is not None and ground.taken is None:
            return None
        view, ground = as_taken(view, ground)
        samples = LitSamples.of(view, ground, free)
        gloss = None if ground.fall is None else ground.fall.gloss
        return None if samples is None else FallOff(samples, camera_centre(view.T_cam_marker), gloss)

    def every(self, step: int) -> "FallOff":
        """With every `step`-th sample: for a first look at many lights."""
        return replace(self, samples=self.samples.every(step))

    def pull(self, parameters: Float, shares: Sequence[float], reference: Float) -> Pull:
        """The pull on the first of l lights whose displacements and nearness are `parameters` (l, 3).

        shares: each light's share of all light on the plane at `reference` (2,), by its shadow there.
        """
        lit = partial(log_irradiance, self.samples.places, parameters, shares, reference)
        places, gloss = self.samples.places, self.gloss
        with_gloss = [] if gloss is None else [lit(mirrored_and_slopes(places, self.eye, parameters, gloss))]
        return min((self._pull(*each) for each in (lit(), *with_gloss)), key=attrgetter("worst_cost"))

    def _pull(self, log_light: Float, slopes: Float) -> Pull:
        """As `pull`, by the log of all light (n,) and its slopes (n, 3)."""
        residual = self.samples.brightness - log_light
        gram = self.samples.gram(np.column_stack([slopes, self.samples.uneven, log_light, residual]))
        tone, rest = -2, -1  # columns of the log of all light, which a contrast multiplies, and of the residual
        # The contrast's offset from 1, fitted with its prior, then eliminated.
        stiff = gram[tone, tone] + 1 / CONTRAST**2
        contrast = float(np.clip(1 + gram[tone, rest] / stiff, LEAST_CONTRAST, MOST_CONTRAST))
        gram = gram - np.outer(gram[:, tone], gram[tone]) / stiff
        gradient, information = contrast * gram[:3, rest], contrast**2 * gram[:3, :3]
        through = contrast * gram[:3, 3 : 3 + len(WORST)] * WORST
        # The covariance of the gradient: noise, and the worst unevenness (a "sandwich", after Huber, 1967).
        spread = information + through @ through.T
        spread += (1e-9 * np.trace(spread) + 1e-12) * np.eye(3)
        trusted = information @ np.linalg.inv(spread)
        robust = trusted @ information
        uneven = slice(3, 3 + len(WORST))
        stiffness = gram[uneven, uneven] + np.diag(1 / WORST**2)
        explained = float(gram[uneven, rest] @ np.linalg.solve(stiffness, gram[uneven, rest]))
        cost = float(gram[rest, rest])
        return Pull(trusted @ gradient, np.asarray(0.5 * (robust + robust.T)), cost, cost - explained)

    def worst_costs(self, parameters: Float, share: float | Float, reference: Float) -> Float:
        """(n,) `Pull.worst_cost` of n single lights with parameters (n, 3), each of a share (n,), or all of one."""
        shares = np.broadcast_to(share, len(parameters))
        known = _Known.of(self.samples)
        size = max(BLOCK // len(known.values), 1)
        blocks = (slice(i, i + size) for i in range(0, len(parameters), size))
        return np.concatenate([self._worst_costs(parameters[i], shares[i], reference, known) for i in blocks])

    def _worst_costs(self, parameters: Float, shares: Float, reference: Float, known: "_Known") -> Float:
        """As `worst_costs`, of a block of lights."""
        relative = irradiances(self.samples.places, parameters) / irradiances(reference[None], parameters)
        if self.gloss is not None:
            glossy = 1 + mirrored(self.samples.places, self.eye, parameters, self.gloss)
            relative, shares = np.hstack([relative, relative * glossy]), np.append(shares, shares)
        lights = np.log(np.maximum(1 - shares + shares * relative, LEAST_LIGHT))
        weighted, explained = self.samples.weighted(lights)
        by_light = known.values.T @ weighted - known.explained.T @ explained
        square = (lights * weighted).sum(axis=0) - (explained**2).sum(axis=0)
        uneven, bright = slice(0, 5), 5  # columns of `known.values`
        with_brightness = by_light[bright]
        # As in `pull`: inner products of unevenness and contrast with one another, and with what the light leaves.
        products = np.empty((lights.shape[1], 6, 7))
        products[:, :5, :5] = known.among[uneven, uneven]
        products[:, :5, 5] = products[:, 5, :5] = by_light[uneven].T
        products[:, 5, 5] = square
        products[:, :5, 6] = known.among[uneven, bright] - by_light[uneven].T
        products[:, 5, 6] = with_brightness - square
        cost = known.among[bright, bright] - 2 * with_brightness + square
        stiff = square + 1 / CONTRAST**2
        cost -= products[:, 5, 6] ** 2 / stiff
        products = products - products[:, :, 5:6] * products[:, 5:6] / stiff[:, None, None]
        stiffness = products[:, :, :6] + np.diag(1 / WORST**2)
        cost -= (products[:, :, 6:] * np.linalg.solve(stiffness, products[:, :, 6:])).sum(axis=(1, 2))
        return np.asarray(cost.reshape(-1, len(parameters)).min(axis=0))


@once_for_each
def fall_beside(lit: LitBody, view: View, ground: LitGround, unlit: Mask) -> FallOff | None:
    """That over the lit ground away from a body with its shadows, and from what else of the view is `unlit` (h, w).

    As `FallOff.of`.
    """
    return FallOff.of(view, ground, clear_of(unlit | predicted_of(lit, view).whole))


class _Known(NamedTuple):
    """What all lights are compared with: the unevenness of n samples and their brightness."""

    values: Float  # (n, 6) unevenness in five columns, then brightness
    among: Float  # (6, 6) their inner products
    explained: Float  # (c, 6) as what can be fitted along

    @staticmethod
    @once_for_each
    def of(samples: LitSamples) -> "_Known":
        values = np.column_stack([samples.uneven, samples.brightness])
        return _Known(values, samples.gram(values), samples.weighted(values)[1])

"""How far to believe a fit: which explanation is best, how likely it is right, and when not to answer."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.types import DirectionalLight
from ashe_live.light.associate import Split
from ashe_live.light.fit import Fit

# Below this, an answer is more likely a wrong one.
LEAST_CONFIDENCE = 0.3
GOOD_RAD = math.radians(10)
# A sample of a round normal distribution is beyond r times its 68 % radius with probability exp(RAYLEIGH_68 r^2).
RAYLEIGH_68 = math.log(1 - 0.68)
# That an explanation is right is the logistic function of this offset and these weights on `evidence`; fitted by
# maximum likelihood with a ridge to every explanation of the rendered scenes, right and wrong ones (docs/accuracy.md).
OFFSET = -8.17
WEIGHTS = np.array([-2.53, -3.43, -8.05, -0.19, -0.1])


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """An explanation of the picture and the light that follows from it."""

    split: Split
    fit: Fit
    rank: int  # among the explanations, which come in the order of their shifts' votes


def evidence(candidate: Candidate) -> Float:
    """(5,) what speaks for and against an explanation; WEIGHTS says how much.

    The outlines' error over the object's size; the share of the shadow's border at which it meets the object; how far
    the shadow's colour is from daylight's; its rank in votes; a shadow larger than its object.
    """
    body, shadow, fit = candidate.split.object_mask, candidate.split.shadow_mask, candidate.fit
    _, red_blue, green = candidate.split.shift
    return np.array(
        [
            math.log(max(fit.residual_px, 0.05) / max(fit.object_px, 1.0)),
            _border_share(shadow, body),
            abs(green + 0.25 * red_blue),
            min(candidate.rank, 3),
            max(math.log(int(shadow.sum()) / max(int(body.sum()), 1)), 0.0),
        ]
    )


def confidence_in(candidate: Candidate) -> float:
    """P(angular error < 10 degrees): that the explanation is the right one, times that its direction is that good."""
    is_right = 1 / (1 + np.exp(-np.clip(OFFSET + WEIGHTS @ evidence(candidate), -50, 50)))
    radius = _radius_of_68_percent(candidate.fit.lights[0].covariance_rad2)
    return float(is_right * -np.expm1(RAYLEIGH_68 * (GOOD_RAD / max(radius, 1e-9)) ** 2))


def judged(candidate: Candidate) -> DirectionalLight | str:
    """The light with what is known about it, or the reason not to answer."""
    confidence = confidence_in(candidate)
    if confidence < LEAST_CONFIDENCE:
        return "what stands out from the ground does not fit an object and its shadow in one directional light"
    fitted = candidate.fit.lights[0]
    return DirectionalLight(
        fitted.to_light_marker, fitted.covariance_rad2, _radius_of_68_percent(fitted.covariance_rad2), confidence
    )


def _radius_of_68_percent(covariance_rad2: Float) -> float:
    """Radius of the circle that holds a 2D normal distribution's sample with probability 0.68.

    Between 0.99 of the larger deviation (a line) and 1.51 of it (a circle); in between, and at both ends, right to 1 %.
    """
    smaller, larger = np.maximum(np.linalg.eigvalsh(covariance_rad2), 0.0)
    return math.sqrt(0.985 * larger + 1.326 * smaller)


def _border_share(mask: Mask, other: Mask) -> float:
    """Share of the pixels just outside `mask` that lie in `other`."""
    border = cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & ~mask
    return int((border & other).sum()) / max(int(border.sum()), 1)

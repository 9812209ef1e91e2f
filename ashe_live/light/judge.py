"""How far to believe a fit: which explanation is best, how likely it is right, and when not to answer."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.types import DirectionalLight
from ashe_live.light.associate import Split
from ashe_live.light.fit import Fit

# Below this, an answer is more likely a wrong one.
LEAST_CONFIDENCE = 0.3
# P(error < 10 degrees) is the logistic function of this offset and these weights on `evidence`; fitted by maximum
# likelihood with a ridge to every explanation of the rendered scenes, right and wrong ones (docs/accuracy.md).
OFFSET = -4.85
WEIGHTS = np.array([-1.91, -4.22, -6.71, -0.31, -0.38, -0.62])


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """An explanation of the picture and the light that follows from it."""

    split: Split
    fit: Fit
    rank: int  # of the shadow's shift, by votes


def evidence(candidate: Candidate) -> Float:
    """(6,) what speaks for and against an explanation; WEIGHTS says how much.

    The outlines' error over the object's size; the share of the shadow's border at which it meets the object; how far
    the shadow's colour is from daylight's; its rank in votes; the direction's own uncertainty; a shadow larger than its
    object.
    """
    body, shadow, fit = candidate.split.object_mask, candidate.split.shadow_mask, candidate.fit
    largest = float(np.linalg.eigvalsh(fit.lights[0].covariance_rad2).max())
    _, red_blue, green = candidate.split.shift
    return np.array(
        [
            math.log(max(fit.residual_px, 0.05) / max(fit.object_px, 1.0)),
            _border_share(shadow, body),
            abs(green + 0.25 * red_blue),
            min(candidate.rank, 3),
            max(math.log(math.degrees(math.sqrt(largest)) + 1e-9), 0.0),
            max(math.log(int(shadow.sum()) / max(int(body.sum()), 1)), 0.0),
        ]
    )


def confidence_in(candidate: Candidate) -> float:
    """P(angular error < 10 degrees)."""
    return float(1 / (1 + np.exp(-np.clip(OFFSET + WEIGHTS @ evidence(candidate), -50, 50))))


def best_candidate(candidates: Sequence[Candidate]) -> Candidate | None:
    return max(candidates, key=confidence_in, default=None)


def judged(candidate: Candidate, confidence: float) -> DirectionalLight | str:
    """The light with what is known about it, or the reason not to answer."""
    if confidence < LEAST_CONFIDENCE:
        return "what stands out from the ground does not fit an object and its shadow in one directional light"
    fitted = candidate.fit.lights[0]
    return DirectionalLight(
        fitted.to_light_marker, fitted.covariance_rad2, _radius_of_68_percent(fitted.covariance_rad2), confidence
    )


def _radius_of_68_percent(covariance_rad2: Float) -> float:
    """Radius of the circle that holds a 2D normal distribution's sample with probability 0.68.

    Between 0.99 of the larger deviation (a line) and 1.51 of it (a circle); interpolated in the ratio of variances,
    which is right to 2 %.
    """
    smaller, larger = np.linalg.eigvalsh(covariance_rad2)
    ratio = max(float(smaller), 0.0) / max(float(larger), 1e-30)
    return math.sqrt(max(float(larger), 0.0)) * (0.994 + 0.516 * ratio)


def _border_share(mask: Mask, other: Mask) -> float:
    """Share of the pixels just outside `mask` that lie in `other`."""
    border = cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & ~mask
    return int((border & other).sum()) / max(int(border.sum()), 1)

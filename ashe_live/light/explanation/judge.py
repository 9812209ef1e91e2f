"""The confidence in an explanation: which one is likeliest, how likely it is right, and when not to answer."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import DirectionalLight, TrackedFrame
from ashe_live.light.explanation.evidence import Explanation, appearance, evidence
from ashe_live.light.explanation.uncertainty import covariance_of_direction, covariance_of_doubt, covariance_of_outlines
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import Materials
from ashe_live.light.shape.predicted import Predicted

# Below this confidence no answer is given: fewer than two in five such answers would be right. (The calibration weighs
# wrong explanations 1.5 times, so that a stated confidence of 0.4 is a true probability of one half.)
LEAST_CONFIDENCE = 0.3
GOOD_RAD = math.radians(10)
# A sample of an isotropic 2D normal distribution lies beyond r times its 68 % radius with probability
# exp(RAYLEIGH_68 r^2): the radius has a Rayleigh distribution.
RAYLEIGH_68 = math.log(1 - 0.68)
# Logistic regression of an explanation's being right on its `evidence`: fitted by maximum likelihood with a ridge
# penalty to all explanations of the rendered scenes, right and wrong ones (docs/accuracy.md).
OFFSET = -8.75
WEIGHTS = np.array([-0.79, 2.93, 2.7, -1.27, 2.29, 0.69, -3.38, -6.98, 0.19, 0.4, -0.74, -0.43, 1.19, -3.89, 0.3])
# Logistic regression, on `appearance` alone, of whether the right light will follow from a split.
SPLIT_WEIGHTS = np.array([-3.65, -6.41, -0.26, -1.39, 0.96, -0.58, 1.51, -4.47, 0.3])
# Logistic regression of the best explanation's being right on the three numbers of `contest`.
CONTEST_OFFSET = -0.35
CONTEST_WEIGHTS = np.array([1.02, 0.87, 0.58])


def split_score(region: Region, materials: Materials, split: Split) -> float:
    """Score of a split before any fit, weighted by SPLIT_WEIGHTS: the larger, the likelier the right light follows."""
    doubtful = split.shadow_mask if split.undecided is None else split.shadow_mask | split.undecided
    return float(SPLIT_WEIGHTS @ appearance(region, materials, Predicted(split.object_mask, doubtful)))


def log_odds(explanation: Explanation) -> float:
    """Log odds of the probability that the explanation is right and its direction within GOOD_RAD of the truth."""
    is_right = 1 / (1 + math.exp(-_score(explanation)))
    radius = max(radius_of_68_percent(covariance_of_outlines(light.covariance_rad2)) for light in explanation.lights)
    is_good = -math.expm1(RAYLEIGH_68 * (GOOD_RAD / max(radius, 1e-9)) ** 2)
    probability = min(max(is_right * is_good, 1e-6), 1 - 1e-6)
    return math.log(probability / (1 - probability))


def likeliest(explanations: Sequence[Explanation]) -> Explanation:
    """The explanation most likely to be right, even if it hardly constrains the light's direction."""
    return max(explanations, key=_score)


def best_of(explanations: Sequence[Explanation]) -> tuple[Explanation, float]:
    """The likeliest explanation, and the probability that its angular error is below GOOD_RAD, given all the others."""
    odds = np.array([log_odds(explanation) for explanation in explanations])
    directions = np.array([explanation.lights[0].to_light_marker for explanation in explanations])
    best = int(odds.argmax())
    score = CONTEST_OFFSET + CONTEST_WEIGHTS @ contest(odds, directions)
    return explanations[best], 1 / (1 + math.exp(-float(np.clip(score, -50, 50))))


def contest(log_odds: Float, directions: Float) -> Float:
    """(3,) features of the best of n explanations: its log odds; the log of its share of the odds of all directions,
    each represented by its best explanation; the log of the share of all explanations' odds within GOOD_RAD of it.

    log_odds: (n,). directions: (n, 3) unit vectors.
    """
    odds = np.exp(np.clip(log_odds, -20, 20))
    nearby = directions @ directions.T > math.cos(GOOD_RAD)
    rivals, left = 0.0, np.ones(len(odds), np.bool_)
    for index in np.argsort(-odds, kind="stable"):
        if left[index]:
            rivals += odds[index]
            left &= ~nearby[index]
    best = int(odds.argmax())
    return np.array([log_odds[best], math.log(odds[best] / rivals), math.log(odds[nearby[best]].sum() / odds.sum())])


def lights_of(explanation: Explanation, confidence: float, tracked: TrackedFrame) -> list[DirectionalLight]:
    """The lights of an explanation with covariance, sigma and confidence, the strongest first as in its shifts."""
    lights = []
    for fitted in explanation.lights:
        covariance = covariance_of_direction(
            fitted.covariance_rad2, fitted.to_light_marker, tracked
        ) + covariance_of_doubt(confidence)
        sigma_rad = radius_of_68_percent(covariance)
        lights.append(DirectionalLight(fitted.to_light_marker, covariance, sigma_rad, confidence))
    return lights


def _score(explanation: Explanation) -> float:
    """Log odds that the explanation is right, clipped to [-50, 50]."""
    return float(np.clip(OFFSET + WEIGHTS @ evidence(explanation), -50, 50))

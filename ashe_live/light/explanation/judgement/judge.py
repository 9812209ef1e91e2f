"""The judge: which explanation is the likeliest, how probable it is given all that were tried, and when to refuse.

A conditional logit with an outside option (McFadden, "Conditional logit analysis of qualitative choice behavior",
1974): one of the explanations tried, or "none of them", is right, with odds that are the product of one factor for
each feature. Every further explanation takes a share of the total probability, so that a longer search gives a surer
answer only if it finds a better one. docs/maths, "Confidence", has the equations.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np

from ashe_live.core.arrays import Float, Mask, once_for_each
from ashe_live.core.light import Light
from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import NO_CONTEXT, Context, context_features
from ashe_live.light.explanation.judgement.evidence import appearance, evidence
from ashe_live.light.explanation.judgement.judge_tables import Average, Tables, read_tables
from ashe_live.light.explanation.judgement.uncertainty import Calibration, covariance_of_outlines, covariance_of_pose
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import Materials
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.predicted import Predicted

GOOD_RAD = math.radians(10)
# A sample of an isotropic 2D normal distribution lies beyond r times its 68 % radius with probability
# exp(RAYLEIGH_68 r^2): the radius has a Rayleigh distribution.
RAYLEIGH_68 = math.log(1 - 0.68)
LEAST_GOOD = 1e-6  # probability of a good direction, so that its logarithm is finite
LEAST_PROBABILITY = 1e-9  # so that log odds are finite
SETTLED = 0.7  # probability of a direction above which the search ends
# Log odds are clipped here, far beyond any effect, so that their exponentials do not overflow.
MOST_LOG_ODDS = 50.0


@dataclass(frozen=True, slots=True, eq=False)
class Judge:
    """Judges by tables that were fitted to scenes with known lights (`ashe-live bench fit-judge`)."""

    tables: Tables

    @property
    def least_confidence(self) -> float:
        """The confidence below which no answer is given, by the risk-coverage curve (docs/accuracy/one_picture.md)."""
        return self.tables.least_confidence

    @property
    def calibration(self) -> Calibration:
        return self.tables.calibration

    def of_known_body(self) -> "Judge":
        """The judge of explanations by a body whose shape and size are given."""
        return replace(self, tables=replace(self.tables, explanation=self.tables.known_body_score))

    def split_score(self, region: Region, materials: Materials, split: Split) -> float:
        """Log odds, before any fit, that the right light follows from a split; larger is likelier."""
        return self.tables.split.log_odds(split_features(region, materials, split))

    def log_odds(self, explanation: Explanation, context: Context = NO_CONTEXT) -> float:
        """Log odds that the explanation is right, its direction within GOOD_RAD, rather than none of those tried."""
        return self.log_odds_of(explanation_features(explanation, context))

    def log_odds_of(self, features: Mapping[str, float]) -> float:
        """As `log_odds`, of an explanation with these features."""
        return float(np.clip(self.tables.explanation.log_odds(features), -MOST_LOG_ODDS, MOST_LOG_ODDS))

    def average(self, looks: int) -> Average:
        """How the probabilities of `looks` looks at a picture are combined into a confidence."""
        return self.tables.averages.get(looks) or Average((1 / looks,) * looks)

    def probability_if_right(self, explanation: Explanation) -> float:
        """Probability that the first light is within GOOD_RAD of the truth, provided that the outlines are those of the
        object and its shadow. It is below 1 as outlines may leave open how high the light is.
        """
        by_outlines = self._calibration_of(explanation).of_outlines(explanation.lights[0])
        return good_if_right(by_outlines, self.tables.good_if_open)

    def lights_of(self, explanation: Explanation, confidence: float, tracked: TrackedFrame) -> tuple[Light, ...]:
        """The lights of an explanation with covariance, sigma and confidence, the strongest first.

        confidence: that of the explanation. A light's is less where the marker's pose leaves its direction open.
        """
        calibration = self._calibration_of(explanation)
        lights = []
        for fitted in explanation.lights:
            covariance = calibration.covariance(fitted, confidence, tracked)
            sure = confidence * good_by_pose(fitted.to_light_marker, tracked)
            lights.append(Light(fitted.to_light_marker, covariance, radius_of_68_percent(covariance), sure))
        return tuple(lights)

    def shared_rad2(self, to_light_marker: Float, tracked: TrackedFrame) -> Float:
        """(2, 2) rad^2 on the tangent basis of a direction (3,): what all objects of a frame show it off by alike."""
        exact = FittedLight(np.append(to_light_marker, 0.0), np.zeros((2, 2)))
        return self.calibration.covariance(exact, 1.0, tracked)

    def _calibration_of(self, explanation: Explanation) -> Calibration:
        # A hull's light is a posterior mean over all that pixels and tangents allow, so that its covariance is kept as
        # it is.
        return self.calibration if explanation.hull is None else replace(self.calibration, overdispersion=1.0)


def recalibrated(probability: float, average: Average) -> float:
    """The confidence that corresponds to an average `probability` over the looks (Platt, 1999).

    It is needed because an average of agreeing forecasts is less sure than it should be (Ranjan and Gneiting, 2010).
    """
    return 1 / (1 + math.exp(-average.offset - average.slope * logit(probability)))


def logit(probability: float) -> float:
    """The log odds of a probability, finite for 0 and 1 too."""
    inside = min(max(probability, LEAST_PROBABILITY), 1 - LEAST_PROBABILITY)
    return math.log(inside / (1 - inside))


def probabilities_of(log_odds: Sequence[float]) -> Float:
    """(n,) probability that each explanation is the right one; the rest of 1 is that of "none of them"."""
    odds = np.exp(log_odds)
    return np.asarray(odds / (1 + odds.sum()))


def best_direction(probabilities: Float, to_lights_marker: Iterable[Float]) -> tuple[int, float]:
    """The index of the likeliest explanation, and the probability that its light is within GOOD_RAD of the truth.

    As `likeliest_direction`, of whose explanations it is the likeliest, whatever the numbers of lights.
    """
    group, share = likeliest_direction(probabilities, to_lights_marker)
    return int(np.where(group, probabilities, -1.0).argmax()), share


def likeliest_direction(
    probabilities: Float, to_lights_marker: Iterable[Float], counts: Sequence[int] | None = None
) -> tuple[Mask, float]:
    """(n,) which explanations have the likeliest direction, and the probability that it is right to GOOD_RAD.

    The probabilities of explanations with lights within GOOD_RAD of each other are added up. The answer comes from the
    likeliest such group: its explanations with the number of lights that has most of the group's probability.
    probabilities: (n,). to_lights_marker: n unit vectors (3,). counts: n numbers of lights; None where all are equal.
    """
    directions = np.array(list(to_lights_marker))
    nearby = directions @ directions.T > math.cos(GOOD_RAD)
    around = nearby @ probabilities
    group = nearby[int(around.argmax())]
    if counts is not None:
        shares = np.bincount(counts, group * probabilities)
        group = group & (np.asarray(counts) == shares.argmax())
    return group, float(min(around.max(), 1.0))


def is_settled(log_odds: Sequence[float], to_lights_marker: Sequence[Float]) -> bool:
    """Whether n explanations leave no doubt about the direction; to_lights_marker: n unit vectors (3,)."""
    return bool(log_odds) and best_direction(probabilities_of(log_odds), to_lights_marker)[1] > SETTLED


def split_features(region: Region, materials: Materials, split: Split) -> Mapping[str, float]:
    """The features of a split before any fit: those of `appearance`, where doubtful pixels count as shadow."""
    doubtful = split.shadow_mask if split.undecided is None else split.shadow_mask | split.undecided
    return appearance(region, materials, Predicted(split.object_mask, doubtful))


def explanation_features(explanation: Explanation, context: Context = NO_CONTEXT) -> Mapping[str, float]:
    """The features of an explanation: its `evidence`, how well it constrains the direction, and its context's."""
    return {**_own_features(explanation), **context_features(explanation, context)}


@once_for_each
def _own_features(explanation: Explanation) -> Mapping[str, float]:
    """Those that do not depend on the context."""
    is_good = min(probability_of_good(covariance_of_outlines(light.covariance_rad2)) for light in explanation.lights)
    return {**evidence(explanation), "constrained": math.log(max(is_good, LEAST_GOOD))}


def probability_of_good(covariance_rad2: Float) -> float:
    """Probability that a direction of this covariance (2, 2) is within GOOD_RAD of the truth."""
    return -math.expm1(RAYLEIGH_68 * (GOOD_RAD / max(radius_of_68_percent(covariance_rad2), 1e-9)) ** 2)


def good_by_pose(to_light_marker: Float, tracked: TrackedFrame) -> float:
    """Probability that the marker's pose puts a direction (3,) no farther off than GOOD_RAD."""
    return probability_of_good(covariance_of_pose(to_light_marker, tracked))


def good_if_right(covariance_rad2: Float, good_if_open: float) -> float:
    """As `probability_of_good`, plus the share `good_if_open` of the rest, which turns out good all the same."""
    determined = probability_of_good(covariance_rad2)
    return determined + (1 - determined) * good_if_open


@cache
def fitted_judge() -> Judge:
    """The judge with the tables that are shipped with the package."""
    return Judge(read_tables(files(__package__).joinpath("judge.json").read_text(encoding="utf-8")))

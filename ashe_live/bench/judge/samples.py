"""What the judge is fitted to: the explanations that the estimator tries on pictures with known lights."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between, tangent_basis
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.explanation.judge import GOOD_RAD, explanation_features, split_features


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """One explanation (or one split) that was tried, and whether it is right."""

    features: Mapping[str, float]
    rightness: int  # 0: wrong; 1: its first light is within GOOD_RAD of a true one; 2: so are all, and none is missing
    to_light_marker: Float  # (3,) unit
    error_rad: float  # of its first light to the nearest true one; pi where there is none
    error_by_axis: Float  # (2,) rad, that error on the light's tangent basis
    covariance_rad2: Float  # (2, 2) rad^2, by the outlines alone


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """All explanations of one picture by one preset."""

    preset: str
    case: str
    tags: Mapping[str, str]  # the families that the picture belongs to, by kind
    lights: int  # true ones
    judged: Sequence[Candidate]
    splits: Sequence[Candidate]


def sample_of(case: Case, preset: str, estimator: ProxyEstimator) -> Sample:
    """Runs the estimator on a picture whose lights are known, and compares all its explanations with them."""
    _, trace = estimator.traced(case.tracked())
    truths = case.to_lights_marker
    assert truths is not None
    judged = [_candidate(each, explanation_features(each), truths) for each in trace.judged]
    splits = [_candidate(each, split_features(each.region, each.materials, each.split), truths) for each in trace.rough]
    return Sample(preset, f"{case.folder}/{case.id}", case.tags, len(truths), judged, splits)


def _candidate(explanation: Explanation, features: Mapping[str, float], truths: Float) -> Candidate:
    lights = [light.to_light_marker for light in explanation.lights]
    nearest = [min((angle_between(light, truth) for truth in truths), default=np.pi) for light in lights]
    first, by_axis = lights[0], np.zeros(2)
    if len(truths):
        truth = min(truths, key=lambda each: angle_between(first, each))
        along = tangent_basis(first) @ truth
        by_axis = along * (nearest[0] / max(float(np.linalg.norm(along)), 1e-12))
    is_right = nearest[0] < GOOD_RAD
    is_whole = max(nearest) < GOOD_RAD and len(lights) == len(truths)
    rightness = int(is_right) + int(is_right and is_whole)
    covariance = explanation.lights[0].covariance_rad2
    return Candidate(features, rightness, first, nearest[0], by_axis, covariance)

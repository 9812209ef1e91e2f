"""What the judge is fitted to: the explanations that the estimator tries on pictures with known lights."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track

from ashe_live.bench.cases import Case
from ashe_live.bench.metrics import tangent_offset
from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.steps import ProxySteps
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.company import Company
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, explanation_features, split_features

Picture = TypeVar("Picture")


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """One explanation (or one split) that was tried, and whether it is right."""

    features: Mapping[str, float]
    rightness: int  # 0: wrong; 1: its first light is within GOOD_RAD of a true one; 2: so are all, and none is missing
    to_light_marker: Float  # (3,) unit
    error_rad: float  # of its first light to the nearest true one; pi where there is none
    error_by_axis: Float  # (2,) rad, that error on the light's tangent basis
    covariance_rad2: Float  # (2, 2) rad^2, by the outlines alone
    lights: int = 1  # number of lights that it states
    unseen_end: float = 0.0  # share of the elevation's variance by a shadow's end out of view


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """All explanations of one picture by one look at it."""

    case: str
    tags: Mapping[str, str]  # the families that the picture belongs to, by kind
    lights: int  # number of true lights
    judged: Sequence[Candidate]
    splits: Sequence[Candidate]


def in_processes(
    looked: Callable[[Picture], dict[ProxySteps, Sample]],
    pictures: Sequence[Picture],
    jobs: int,
    console: Console,
    what: str,
) -> list[dict[ProxySteps, Sample]]:
    """What `looked`, which must be picklable, returns for each picture, by `jobs` processes; shows `what` meanwhile."""
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        return list(track(pool.map(looked, pictures), what, len(pictures), console=console, transient=True))


def of_one_view(steps: ProxySteps) -> ProxySteps:
    """The steps without their settings for several views, so that presets which treat one view alike are equal."""
    return replace(steps, views=1, companions=0, joint=1)


def sample_of(case: Case, estimator: ProxyEstimator) -> Sample:
    """Looks at a picture whose lights are known, from the tracker's own pose, and compares all explanations with them.

    estimator: with steps for a single look.
    """
    _, trace = estimator.traced(case.followed())
    truths = case.to_lights_marker
    assert truths is not None
    company = Company(trace.judged, trace.glint, trace.sheet_shadow)
    judged = [_candidate(each, explanation_features(each, company), truths) for each in trace.judged]
    splits = [_candidate(each, split_features(each.region, each.materials, each.split), truths) for each in trace.rough]
    return Sample(f"{case.folder}/{case.id}", case.tags, len(truths), judged, splits)


def _candidate(explanation: Explanation, features: Mapping[str, float], truths: Float) -> Candidate:
    lights = [light.to_light_marker for light in explanation.lights]
    nearest = [min((angle_between(light, truth) for truth in truths), default=np.pi) for light in lights]
    first, by_axis = lights[0], np.zeros(2)
    if len(truths):
        by_axis = tangent_offset(first, min(truths, key=lambda each: angle_between(first, each)))
    is_right = nearest[0] < GOOD_RAD
    is_whole = max(nearest) < GOOD_RAD and len(lights) == len(truths)
    rightness = int(is_right) + int(is_right and is_whole)
    fitted = explanation.lights[0]
    return Candidate(
        features,
        rightness,
        first,
        nearest[0],
        by_axis,
        fitted.covariance_rad2,
        len(lights),
        fitted.unseen_end,
    )

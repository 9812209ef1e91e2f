"""What the judge is fitted to: the explanations that the estimator tries on pictures with known lights."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from multiprocessing import get_context
from typing import TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track

from ashe_live.bench.cases import Case
from ashe_live.bench.metrics import tangent_offset
from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import Context
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, Judge, explanation_features, split_features
from ashe_live.light.explanation.judgement.judge_tables import read_tables
from ashe_live.light.explanation.light_covariance import averaged
from ashe_live.light.shape.directions import FittedLight
from ashe_live.quality import LIGHT_PRESETS

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
    truths: Float  # (l, 3) unit, towards the true lights
    judged: Sequence[Candidate]
    splits: Sequence[Candidate]

    @property
    def lights(self) -> int:
        """The number of true lights."""
        return len(self.truths)


def in_processes(
    looked: Callable[[Picture], dict[ProxyPreset, Sample]],
    pictures: Sequence[Picture],
    jobs: int,
    console: Console,
    what: str,
) -> list[dict[ProxyPreset, Sample]]:
    """What `looked`, which must be picklable, returns for each picture, by `jobs` processes; shows `what` meanwhile."""
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        return list(track(pool.map(looked, pictures), what, len(pictures), console=console, transient=True))


def of_one_view(preset: ProxyPreset) -> ProxyPreset:
    """The preset without its settings for several views, so that presets which treat one view alike are equal."""
    return replace(preset, views=1, companions=0, joint=1)


LOOKS = tuple(dict.fromkeys(of_one_view(look) for preset in LIGHT_PRESETS.values() for look in preset.looks))


def by_every_look(
    cases: Sequence[Case], judge: Judge, jobs: int, console: Console, what: str, tried: int | None = None
) -> list[dict[ProxyPreset, Sample]]:
    """The pictures by every look of the presets; with `tried` splits fitted instead of each look's own number."""
    looked = partial(_looked_at, json.dumps(judge.tables.as_json()), tried)
    return in_processes(looked, cases, jobs, console, what)


def _looked_at(tables: str, tried: int | None, case: Case) -> dict[ProxyPreset, Sample]:
    """A picture by every look, in a process of its own."""
    return {preset: sample_of(case, estimator) for preset, estimator in _estimators(tables, tried).items()}


@cache
def _estimators(tables: str, tried: int | None) -> Mapping[ProxyPreset, ProxyEstimator]:
    """One for each look, with a judge by the text of its tables."""
    judge = Judge(read_tables(tables))
    return {preset: ProxyEstimator(replace(preset, tried=tried or preset.tried), judge) for preset in LOOKS}


def sample_of(case: Case, estimator: ProxyEstimator) -> Sample:
    """Looks at a picture whose lights are known, from the tracker's own pose, and compares all explanations with them.

    estimator: by the preset of a single look.
    """
    _, trace = estimator.traced(case.followed())
    truths = case.to_lights_marker
    assert truths is not None
    context = Context(trace.judged, trace.glint, trace.sheet_shadow)
    judged = [_candidate(each, explanation_features(each, context), truths) for each in trace.judged]
    splits = [_candidate(each, split_features(each.region, each.materials, each.split), truths) for each in trace.rough]
    return Sample(f"{case.folder}/{case.id}", case.tags, truths, judged, splits)


def _candidate(explanation: Explanation, features: Mapping[str, float], truths: Float) -> Candidate:
    lights = [light.to_light_marker for light in explanation.lights]
    nearest = [min((angle_between(light, truth) for truth in truths), default=np.pi) for light in lights]
    is_right = nearest[0] < GOOD_RAD
    is_whole = max(nearest) < GOOD_RAD and len(lights) == len(truths)
    rightness = int(is_right) + int(is_right and is_whole)
    fitted = explanation.lights[0]
    return Candidate(
        features,
        rightness,
        fitted.to_light_marker,
        *_errors(fitted.to_light_marker, truths),
        fitted.covariance_rad2,
        len(lights),
        fitted.unseen_end,
    )


def with_mean_light(best: Candidate, alike: Sequence[tuple[Candidate, float]], truths: Float) -> Candidate:
    """A candidate with its light where the estimator states it: at the mean of all single lights of its direction.

    alike: these with their probabilities, `best` first.
    """
    if best.lights > 1:
        return best
    directions, probabilities = zip(*((each.to_light_marker, one) for each, one in alike), strict=True)
    light = FittedLight(np.append(best.to_light_marker, 0.0), best.covariance_rad2)
    mean = averaged(light, np.array(directions), np.array(probabilities)).to_light_marker
    error_rad, error_by_axis = _errors(mean, truths)
    return replace(best, to_light_marker=mean, error_rad=error_rad, error_by_axis=error_by_axis)


def _errors(to_light_marker: Float, truths: Float) -> tuple[float, Float]:
    """How far a direction is from the nearest true one: rad, and (2,) rad on its tangent basis; pi and 0 for none."""
    if not len(truths):
        return math.pi, np.zeros(2)
    nearest = min(truths, key=lambda each: angle_between(to_light_marker, each))
    return angle_between(to_light_marker, nearest), tangent_offset(to_light_marker, nearest)

"""The estimators' results on single cases, and their summaries."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.bench.light.lamps import LampFigures, lamp_figures
from ashe_live.bench.metrics import (
    BAD_CONFIDENCE,
    BAD_DEG,
    angular_error_deg,
    brier_score,
    largest,
    mean,
    median,
    percentile,
    share,
    squared_sigmas,
)
from ashe_live.core.contract import light_json
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import ELLIPSE_95
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import Estimator

GOOD_DEG = 5.0
CONFIDENT_DEG = 10.0  # a confidence is the probability of an error below this, `judge.GOOD_RAD`
ALL_LIT, ALL = "all lit", "all"


@dataclass(frozen=True, slots=True)
class CaseResult:
    """The result of one preset on one case; angles in degrees, None where there is nothing to measure."""

    preset: str
    folder: str
    case: str
    category: str
    caster: str | None
    true_lights: int
    lights: tuple[Mapping[str, object], ...]  # in the format of the contract
    reason: str | None
    error_deg: float | None  # of the strongest light answered, to the nearest true light
    sigma_deg: float | None
    squared_sigmas: float | None  # squared Mahalanobis distance of the error under the stated covariance
    confidence: float | None
    object_iou: float | None
    shadow_iou: float | None
    true_labels_deg: float | None  # error of the run from true labels
    wall_ms: Mapping[str, float]  # by stage, with "total"
    cpu_ms: float  # of all threads, of all stages
    lamp: LampFigures | None  # of a case with one light, sun or lamp

    @property
    def is_lit(self) -> bool:
        return self.true_lights > 0

    @property
    def is_answered(self) -> bool:
        return len(self.lights) > 0

    @property
    def is_good(self) -> bool:
        """Whether an answer is one that its confidence is the probability of."""
        return self.error_deg is not None and self.error_deg < CONFIDENT_DEG

    @property
    def is_bad(self) -> bool:
        """Whether a wrong answer, or any answer where there is no light, was given with high confidence."""
        is_wrong = self.is_answered and (self.error_deg is None or self.error_deg > BAD_DEG)
        return is_wrong and self.confidence is not None and self.confidence > BAD_CONFIDENCE


def timed_estimate(
    estimator: Estimator, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()
) -> tuple[LightEstimate, float]:
    """The estimate of a frame, with other views of its scene; and the processor's time for it, of all threads, ms."""
    started_s = time.process_time()
    estimate = estimator.estimate(tracked, others)
    return estimate, 1e3 * (time.process_time() - started_s)


def case_result(
    preset: str,
    case: Case,
    estimate: LightEstimate,
    cpu_ms: float,
    overlaps: tuple[float | None, float | None] = (None, None),
    true_labels_deg: float | None = None,
) -> CaseResult:
    """Compares `estimate` with the truth of `case`. Raises ValueError when that is not known."""
    truths = case.to_lights_marker
    if truths is None:
        raise ValueError(f"nobody knows the light of {case.id}")
    light = estimate.light
    error = off = None
    if light is not None and len(truths):
        nearest = min(truths, key=lambda truth: angular_error_deg(light.to_light_marker, truth))
        error = angular_error_deg(light.to_light_marker, nearest)
        if light.covariance_rad2 is not None:
            off = squared_sigmas(light.to_light_marker, light.covariance_rad2, nearest)
    object_iou, shadow_iou = overlaps
    return CaseResult(
        preset=preset,
        folder=case.folder,
        case=case.id,
        category=case.category,
        caster=case.caster,
        true_lights=len(truths),
        lights=tuple(light_json(light) for light in estimate.lights),
        reason=estimate.reason,
        error_deg=error,
        sigma_deg=None if light is None or light.sigma_rad is None else float(np.degrees(light.sigma_rad)),
        squared_sigmas=off,
        confidence=None if light is None else light.confidence,
        object_iou=object_iou,
        shadow_iou=shadow_iou,
        true_labels_deg=true_labels_deg,
        wall_ms=dict(estimate.timing_ms),
        cpu_ms=cpu_ms,
        lamp=lamp_figures(light, case),
    )


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of a group of cases; None where no case contributes. Errors are those of the answered lit cases."""

    attempted: int
    abstained: int
    mean_deg: float | None
    median_deg: float | None
    p90_deg: float | None
    max_deg: float | None
    good_share: float | None  # fraction of the lit cases answered with an error below GOOD_DEG
    right_count_share: float | None  # fraction of all cases with the right number of lights
    within_1_sigma: float | None
    within_2_sigma: float | None
    within_ellipse_95: float | None
    brier: float | None
    bad_share: float | None  # fraction of all cases with CaseResult.is_bad
    object_iou: float | None  # medians
    shadow_iou: float | None
    true_labels_mean_deg: float | None
    true_labels_median_deg: float | None
    true_labels_max_deg: float | None
    median_ms: float | None
    p95_ms: float | None
    median_cpu_ms: float | None
    p95_cpu_ms: float | None


def summarise(results: Sequence[CaseResult]) -> Summary:
    """The statistics of a group of cases."""
    lit = [result for result in results if result.is_lit]
    errors = [result.error_deg for result in lit]
    sigmas = [(r.error_deg, r.sigma_deg) for r in lit if r.error_deg is not None and r.sigma_deg is not None]
    ellipses = [result.squared_sigmas for result in lit if result.squared_sigmas is not None]
    sure = [(result.confidence, result.is_good) for result in results if result.confidence is not None]
    true_labels = [result.true_labels_deg for result in lit]
    wall_ms, cpu_ms = [result.wall_ms["total"] for result in results], [result.cpu_ms for result in results]
    return Summary(
        attempted=len(results),
        abstained=sum(not result.is_answered for result in results),
        mean_deg=mean(errors),
        median_deg=median(errors),
        p90_deg=percentile(errors, 90),
        max_deg=largest(errors),
        good_share=share([error is not None and error < GOOD_DEG for error in errors]),
        right_count_share=share([len(result.lights) == result.true_lights for result in results]),
        within_1_sigma=share([error <= sigma for error, sigma in sigmas]),
        within_2_sigma=share([error <= 2 * sigma for error, sigma in sigmas]),
        within_ellipse_95=share([squared <= ELLIPSE_95 for squared in ellipses]),
        brier=brier_score([confidence for confidence, _ in sure], [is_good for _, is_good in sure]),
        bad_share=share([result.is_bad for result in results]),
        object_iou=median(result.object_iou for result in results),
        shadow_iou=median(result.shadow_iou for result in results),
        true_labels_mean_deg=mean(true_labels),
        true_labels_median_deg=median(true_labels),
        true_labels_max_deg=largest(true_labels),
        median_ms=median(wall_ms),
        p95_ms=percentile(wall_ms, 95),
        median_cpu_ms=median(cpu_ms),
        p95_cpu_ms=percentile(cpu_ms, 95),
    )


def grouped(results: Sequence[CaseResult]) -> dict[str, list[CaseResult]]:
    """The results by category, in order of first appearance; then those that are lit, and all."""
    groups: dict[str, list[CaseResult]] = {}
    for result in results:
        groups.setdefault(result.category, []).append(result)
    pools = {ALL_LIT: [result for result in results if result.is_lit], ALL: list(results)}
    return {**groups, **{name: pool for name, pool in pools.items() if pool}}


def stage_times(results: Sequence[CaseResult]) -> dict[str, dict[str, float]]:
    """Median and 95th percentile of the wall time by stage, in milliseconds, over the cases that reached the stage."""
    stages = dict.fromkeys(stage for result in results for stage in result.wall_ms)
    times = {stage: [result.wall_ms[stage] for result in results if stage in result.wall_ms] for stage in stages}
    return {stage: {"p50": float(np.median(ms)), "p95": float(np.percentile(ms, 95))} for stage, ms in times.items()}

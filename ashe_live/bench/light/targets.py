"""The estimator's targets, figure by figure, and which stage is responsible for a miss."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from ashe_live.bench.light.clips import ClipResult
from ashe_live.bench.light.results import ALL, ALL_LIT, UPRIGHT, Summary

DEG, SHARE, MS = "°", "share", "ms"

Bounds = Mapping[str, tuple[float, float]]  # by preset: the least and the most


@dataclass(frozen=True, slots=True)
class Target:
    """The bounds of one figure of one group of cases."""

    group: str
    figure: str
    unit: str
    value: Callable[[Summary], float | None]
    bounds: Bounds
    on_true_labels: Callable[[Summary], float | None] | None = None  # the same figure from true labels


@dataclass(frozen=True, slots=True)
class Verdict:
    """A target with the figure measured for one preset."""

    preset: str
    group: str
    figure: str
    unit: str
    value: float | None
    least: float
    most: float
    on_true_labels: float | None = None

    @property
    def is_met(self) -> bool:
        return self.value is not None and self.least <= self.value <= self.most

    @property
    def missed_by(self) -> str | None:
        """The stage responsible for a miss: geometry, if the run from true labels misses too, else segmentation."""
        if self.is_met or self.on_true_labels is None:
            return None
        return "segmentation" if self.on_true_labels <= self.most else "geometry"


def _most(balanced: float, accurate: float) -> Bounds:
    return {"balanced": (0.0, balanced), "accurate": (0.0, accurate)}


def _least(balanced: float, accurate: float) -> Bounds:
    return {"balanced": (balanced, 1.0), "accurate": (accurate, 1.0)}


def _mean(group: str, balanced: float, accurate: float) -> Target:
    return Target(group, "mean", DEG, lambda s: s.mean_deg, _most(balanced, accurate), lambda s: s.true_labels_mean_deg)


def _median(group: str, balanced: float, accurate: float) -> Target:
    return Target(
        group, "median", DEG, lambda s: s.median_deg, _most(balanced, accurate), lambda s: s.true_labels_median_deg
    )


def _answered(summary: Summary) -> float:
    return 1 - summary.abstained / summary.attempted


TARGETS = (
    _mean("paper", 1.5, 1.0),
    _mean(UPRIGHT, 2.0, 1.2),
    _median("clean", 3.0, 2.0),
    _mean("clean", 5.0, 4.0),
    *(_median(group, 3.0, 2.0) for group in ("texture", "soft", "dark")),
    *(_median(group, 4.0, 3.0) for group in ("low", "high")),
    *(_median(group, 5.0, 4.0) for group in ("clutter", "partial")),
    Target("two", "right count", SHARE, lambda s: s.right_count_share, _least(0.8, 0.8)),
    Target("two", "worse of the two, median", DEG, lambda s: s.worst_median_deg, _most(6.0, 5.0)),
    Target("diffuse", "answered none", SHARE, lambda s: s.abstained / s.attempted, _least(8 / 9, 8 / 9)),
    Target(ALL_LIT, "answered", SHARE, _answered, _least(0.9, 0.95)),
    Target(ALL, "wrong with confidence", SHARE, lambda s: s.bad_share, _most(0.02, 0.01)),
    Target(ALL, "within 1 σ", SHARE, lambda s: s.within_1_sigma, {"balanced": (0.6, 0.76), "accurate": (0.6, 0.76)}),
    Target(ALL, "within the 95 % ellipse", SHARE, lambda s: s.within_ellipse_95, _least(0.9, 0.9)),
    Target("photo", "max", DEG, lambda s: s.max_deg, _most(3.0, 2.5)),
    Target(ALL, "time, median", MS, lambda s: s.median_ms, {"fast": (0.0, 15.0), **_most(60.0, 250.0)}),
)
CLIP_RMS_DEG = _most(3.0, 2.0)


def verdicts(preset: str, summaries: Mapping[str, Summary], clips: Sequence[ClipResult]) -> list[Verdict]:
    """The targets of `preset` with their figures from `summaries` (by group); groups without cases are left out."""
    found = []
    for target in TARGETS:
        summary = summaries.get(target.group)
        if summary is not None and preset in target.bounds:
            alone = None if target.on_true_labels is None else target.on_true_labels(summary)
            least, most = target.bounds[preset]
            value = target.value(summary)
            found.append(Verdict(preset, target.group, target.figure, target.unit, value, least, most, alone))
    if preset in CLIP_RMS_DEG:
        least, most = CLIP_RMS_DEG[preset]
        for clip in clips:
            figure = f"RMS about the {clip.about}"
            found.append(Verdict(preset, clip.clip, figure, DEG, clip.rms_deg, least, most))
    return found

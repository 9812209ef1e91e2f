"""`ashe-live bench fit-seconds`: how clear a second light's shadow has to be, by pictures whose lights are known."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import cases_of
from ashe_live.bench.second_lights.tried import FAINTEST, MeasuredLight, MeasuredPicture, measured_picture
from ashe_live.bench.tables import figures_table, percent
from ashe_live.core.contract import Json
from ashe_live.errors import UserError
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.searches.second_light import LEAST_CLARITY
from ashe_live.light.explanation.searches.shadow_search import LEAST_SIGNAL_TO_NOISE

# The thresholds that are compared.
CLARITIES = [round(each, 2) for each in np.arange(0.0, 0.81, 0.04)]
RATIOS = [float(each) for each in np.arange(FAINTEST, 61.0, 4.0)]

Measure = Callable[[MeasuredLight], float]


class Rates(NamedTuple):
    """Shares of pictures with a right first light."""

    right: float  # of those with two lights: the other one is among the accepted ones
    wrong: float  # of those with one light: another one is accepted

    @property
    def youden(self) -> float:
        """Youden's index ("Index for rating diagnostic tests", 1950): 0 by chance, 1 without an error."""
        return self.right - self.wrong


@dataclass(frozen=True, slots=True)
class SecondLightsBench(Bench):
    """The shares of right and wrong second lights beside right first ones, by both thresholds that they have to pass.

    Each threshold is varied where the other one is as in use. Fitted is the one with the largest Youden index, by which
    pictures with two lights count as much as those with one, however many there are of each.
    """

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every `every`th

    def parts(self) -> Iterator[Json]:
        judge, cases = fitted_judge(), cases_of(self.scenes, self.limit, self.every)
        looked_at = track(cases, "pictures", console=self.console, transient=True)
        found = {f"{case.folder}/{case.id}": measured_picture(case, BALANCED, judge) for case in looked_at}
        pictures = {key: picture for key, picture in found.items() if picture is not None}
        several = list(pictures.values())
        if {picture.lights for picture in several} != {1, 2}:
            raise UserError(
                f"a first light is right in {len(several)} of {len(cases)} pictures, and not in some with one light "
                "and in some with two",
                "give a set with both, such as training",
            )
        strong = _kept(several, attrgetter("signal_to_noise"), LEAST_SIGNAL_TO_NOISE)
        clear = _kept(several, attrgetter("clarity"), LEAST_CLARITY)
        yield {
            "least_clarity": self._fitted("LEAST_CLARITY", strong, attrgetter("clarity"), CLARITIES, LEAST_CLARITY),
            "least_signal_to_noise": self._fitted(
                "LEAST_SIGNAL_TO_NOISE", clear, attrgetter("signal_to_noise"), RATIOS, LEAST_SIGNAL_TO_NOISE
            ),
            "pictures": {key: asdict(picture) for key, picture in pictures.items()},
        }

    def _fitted(
        self,
        name: str,
        several: Sequence[MeasuredPicture],
        measure: Measure,
        thresholds: Sequence[float],
        in_use: float,
    ) -> float:
        """The fitted threshold of `measure`, printed with the rates by each."""
        counts = [sum(picture.lights == lights for picture in several) for lights in (2, 1)]
        table = figures_table(
            f"{counts[0]} pictures with two lights, {counts[1]} with one", name, "right", "wrong", "J"
        )
        for threshold in sorted({*thresholds, in_use}):
            rates = rates_by(several, measure, threshold)
            table.add_row(f"{threshold:g}", percent(rates.right), percent(rates.wrong), f"{rates.youden:.3f}")
        self.console.print(table)
        fitted = fitted_to(several, measure, thresholds)
        self.console.print(f"{name} {fitted:g}, in use {in_use:g}")
        return fitted


def rates_by(several: Sequence[MeasuredPicture], measure: Measure, threshold: float) -> Rates:
    """The rates where lights are accepted whose `measure` is at least the threshold; pictures of both kinds."""
    kept = _kept(several, measure, threshold)
    right = [any(light.is_right for light in picture.tried) for picture in kept if picture.lights == 2]
    wrong = [len(picture.tried) > 0 for picture in kept if picture.lights == 1]
    return Rates(float(np.mean(right)), float(np.mean(wrong)))


def fitted_to(several: Sequence[MeasuredPicture], measure: Measure, thresholds: Sequence[float]) -> float:
    """The threshold with the largest Youden index, the highest of equal ones."""
    return max(reversed(thresholds), key=lambda threshold: rates_by(several, measure, threshold).youden)


def _kept(several: Sequence[MeasuredPicture], measure: Measure, threshold: float) -> list[MeasuredPicture]:
    """The pictures with those of the lights whose `measure` is at least the threshold."""
    return [
        MeasuredPicture(picture.lights, [light for light in picture.tried if measure(light) >= threshold])
        for picture in several
    ]

"""`ashe-live bench fit-judge --casters`: how the judge's log odds count where the object's shape and size are given.

Its tables are fitted to bodies of any shape. A given one has fewer free parameters, so that the same agreement with the
picture says more for it; and less agreement says less against it, as it cannot adapt to what spoils an outline. Two
numbers, an offset and a slope of the log odds, are fitted to pictures of known casters, those without a light included.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.bench.cases import Case, read_cases
from ashe_live.bench.judge.fit import FitBench
from ashe_live.bench.judge.samples import Sample, in_processes, of_one_view, sample_of
from ashe_live.bench.judge.tables import risk_table
from ashe_live.bench.judge.validation import Pictures, judged, scores_by_others
from ashe_live.bench.light.known_casters import caster_specs
from ashe_live.core.caster import parsed_caster
from ashe_live.core.contract import Json
from ashe_live.errors import UserError
from ashe_live.light.estimators.preset import BALANCED, ProxyPreset
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.judgement.judge import Judge, fitted_judge
from ashe_live.light.explanation.judgement.judge_tables import UNCHANGED, OfKnownBody, Score, read_tables

LOOK = of_one_view(BALANCED)
LEAST_LIKELIHOOD = 1e-12  # of a picture: no single one rules a pair of numbers out
OFFSETS, SLOPES = np.arange(-1.0, 3.01, 0.1), np.arange(0.5, 2.01, 0.1)  # that are tried; the likeliest pair is taken


@dataclass(frozen=True, slots=True)
class KnownBodiesBench(FitBench):
    """Fits the two numbers to pictures of known casters: every `every`th of those among the first `limit`."""

    def parts(self) -> Iterator[Json]:
        tables = fitted_judge().tables
        free = replace(tables, of_known_body=UNCHANGED)
        pictures = self._pictures(replace(fitted_judge(), tables=free))
        fit = partial(fitted_to, free.known_body_score)
        answers = [
            judged(score, [picture[LOOK]], tables.averages[1])
            for picture, score in zip(pictures, scores_by_others(pictures, lambda some: fit(some)[0]), strict=True)
        ]
        before = [judged(free.known_body_score, [picture[LOOK]], tables.averages[1]) for picture in pictures]
        _, found = fit(pictures)
        self.console.print(f"offset {found.offset:+.1f}, slope {found.slope:.1f} by {len(pictures)} pictures")
        self.console.print(risk_table("known casters", {"as any object": before, "by other families": answers}))
        for name, several in (("as any object", before), ("by other families", answers)):
            given = [each for each in several if each.confidence >= tables.least_confidence]
            lit = [each for each in several if each.sample.lights]
            shares = (
                len([each for each in given if each.sample.lights]) / max(len(lit), 1),
                sum(each.is_bad for each in several) / len(several),
                sum(not each.sample.lights for each in given) / max(len(several) - len(lit), 1),
            )
            words = zip(("answered", "sure and wrong", "answered without a light"), shares, strict=True)
            self.console.print(f"{name}: " + ", ".join(f"{word} {share:.1%}" for word, share in words))
        yield {
            "scenes": self.names,
            "pictures": len(pictures),
            "tables": replace(tables, of_known_body=found).as_json(),
        }

    def _pictures(self, judge: Judge) -> Pictures:
        """Every picture of a known caster by one look, as it is judged where nothing was fitted to known bodies."""
        known = [
            (case, specs[case.id])
            for folder, specs in ((folder, caster_specs(folder)) for folder in self.scenes)
            for case in read_cases(folder)[: self.limit]
            if case.id in specs and case.to_lights_marker is not None
        ]
        if not known:
            raise UserError(
                "there is no box, cylinder or sphere with a known light in these sets", "give a training set of scenes"
            )
        looked = partial(_looked_at, json.dumps(judge.tables.as_json()))
        return in_processes(looked, known[:: self.every], self.jobs, self.console, "known casters")


def _looked_at(tables: str, picture: tuple[Case, str]) -> dict[ProxyPreset, Sample]:
    """A picture and its caster, by a judge with these tables, in a process of its own."""
    case, spec = picture
    estimator = ProxyEstimator(LOOK.assuming(caster=parsed_caster(spec)), Judge(read_tables(tables)))
    return {LOOK: sample_of(case, estimator)}


def fitted_to(free: Score, pictures: Pictures) -> tuple[Score, OfKnownBody]:
    """The score of known bodies that makes it likeliest which of the pictures' explanations are right, or none."""
    samples = [sample for picture in pictures for sample in picture.values() if sample.judged]
    if not samples:
        return UNCHANGED.applied(free), UNCHANGED
    log_odds = np.array([free.log_odds(each.features) for sample in samples for each in sample.judged])
    is_right = np.array([each.rightness > 0 for sample in samples for each in sample.judged])
    begins = np.cumsum([0, *(len(sample.judged) for sample in samples[:-1])])  # of each picture's explanations
    none_is_right = ~np.logical_or.reduceat(is_right, begins)

    def log_likelihood(found: OfKnownBody) -> float:
        odds = np.exp(found.offset + found.slope * log_odds)
        of_right = np.add.reduceat(odds * is_right, begins) + none_is_right
        probabilities = of_right / (1 + np.add.reduceat(odds, begins))
        return float(np.log(np.maximum(probabilities, LEAST_LIKELIHOOD)).sum())

    tried = [OfKnownBody(round(float(a), 1), round(float(b), 1)) for a in OFFSETS for b in SLOPES]
    best = max(tried, key=log_likelihood)
    return best.applied(free), best

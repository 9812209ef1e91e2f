"""The tables of the judge: what each feature contributes to the log odds, as `ashe-live bench fit-judge` fits them."""

import json
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from ashe_live.light.explanation.judgement.uncertainty import Calibration


@dataclass(frozen=True, slots=True)
class Curve:
    """A feature's contribution to the log odds: monotone and piecewise linear in it, constant beyond both ends."""

    at: tuple[float, ...]  # values of the feature, rising
    log_odds: tuple[float, ...]  # the contributions there

    def __post_init__(self) -> None:
        steps = np.diff(self.log_odds)
        if len(self.at) != len(self.log_odds) or len(self.at) < 2 or (np.diff(self.at) <= 0).any():
            raise ValueError(f"a curve needs as many rising values as contributions, not {self.at}, {self.log_odds}")
        if not ((steps >= 0).all() or (steps <= 0).all()):
            raise ValueError(f"a curve rises or falls, not both: {self.log_odds}")

    def __call__(self, value: float) -> float:
        # As np.interp, whose call costs ten times as much as what it does for one value.
        end = bisect_right(self.at, value)
        if end in (0, len(self.at)):
            return self.log_odds[max(end - 1, 0)]
        share = (value - self.at[end - 1]) / (self.at[end] - self.at[end - 1])
        return self.log_odds[end - 1] + share * (self.log_odds[end] - self.log_odds[end - 1])


@dataclass(frozen=True, slots=True, eq=False)
class Score:
    """Log odds as a constant and a sum of curves, one for each feature."""

    constant: float
    curves: Mapping[str, Curve]

    def log_odds(self, features: Mapping[str, float]) -> float:
        """The log odds for these features. Raises KeyError if a feature that has a curve is missing."""
        return self.constant + sum(curve(features[name]) for name, curve in self.curves.items())


@dataclass(frozen=True, slots=True)
class Average:
    """How the probabilities of several looks at a picture become a confidence."""

    weights: tuple[float, ...]  # of each look's probabilities
    offset: float = 0.0  # log odds of being right are offset + slope times those of the average
    slope: float = 1.0


@dataclass(frozen=True, slots=True)
class OfKnownBody:
    """How log odds count where the body's shape and size are given, as `bench fit-judge --casters` fits it."""

    offset: float
    slope: float

    def applied(self, score: Score) -> Score:
        """The score by which explanations of known bodies are judged, from one of any bodies."""
        curves = {
            name: curve if name in INDEPENDENT else Curve(curve.at, tuple(self.slope * each for each in curve.log_odds))
            for name, curve in score.curves.items()
        }
        return Score(self.offset + self.slope * score.constant, MappingProxyType(curves))


UNCHANGED = OfKnownBody(0.0, 1.0)
# Features that count against a body whose shape is guessed, and say nothing about one that is given.
GIVEN = ("flat",)
# Features that do not depend on the body, and count as they do for any.
INDEPENDENT = ("sheet",)


@dataclass(frozen=True, slots=True, eq=False)
class Tables:
    """All that is fitted of the judge, and what it was fitted to."""

    split: Score
    explanation: Score
    averages: Mapping[int, Average]  # by the number of looks
    least_confidence: float
    calibration: Calibration
    origin: Mapping[str, Any]  # sets, seeds, counts, date, scores
    # Probability that a direction is good which outlines, although the right ones, leave open.
    good_if_open: float = 0.0
    of_known_body: OfKnownBody = UNCHANGED

    @property
    def known_body_score(self) -> Score:
        """The score of explanations by a body whose shape and size are given."""
        curves = {name: curve for name, curve in self.explanation.curves.items() if name not in GIVEN}
        return self.of_known_body.applied(Score(self.explanation.constant, MappingProxyType(curves)))

    def as_json(self) -> dict[str, Any]:
        return {
            "origin": dict(self.origin),
            "averages": {str(looks): asdict(average) for looks, average in self.averages.items()},
            "least_confidence": self.least_confidence,
            "good_if_open": self.good_if_open,
            "calibration": {name: getattr(self.calibration, name) for name in Calibration.__slots__},
            "known_body": asdict(self.of_known_body),
            "split": _score_json(self.split),
            "explanation": _score_json(self.explanation),
        }


def read_tables(text: str) -> Tables:
    """The tables from the text that `Tables.as_json` was written as; raises ValueError or KeyError for another."""
    content = json.loads(text)
    return Tables(
        split=_score(content["split"]),
        explanation=_score(content["explanation"]),
        averages=MappingProxyType({int(looks): _average(each) for looks, each in content["averages"].items()}),
        least_confidence=float(content["least_confidence"]),
        calibration=Calibration(**content["calibration"]),
        origin=MappingProxyType(content["origin"]),
        good_if_open=float(content["good_if_open"]),
        of_known_body=OfKnownBody(**content.get("known_body", asdict(UNCHANGED))),
    )


def _average(content: Mapping[str, Any]) -> Average:
    return Average(tuple(map(float, content["weights"])), float(content["offset"]), float(content["slope"]))


def _score(content: Mapping[str, Any]) -> Score:
    curves = {name: Curve(tuple(each["at"]), tuple(each["log_odds"])) for name, each in content["curves"].items()}
    return Score(float(content["constant"]), MappingProxyType(curves))


def _score_json(score: Score) -> dict[str, Any]:
    curves = {name: {"at": curve.at, "log_odds": curve.log_odds} for name, curve in score.curves.items()}
    return {"constant": score.constant, "curves": curves}

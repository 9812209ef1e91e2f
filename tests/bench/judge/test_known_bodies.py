"""How log odds count for known bodies: fitted to which explanations are right, and applied to the judge's own."""

import json
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench.bench import RESULTS
from ashe_live.bench.cases import read_cases
from ashe_live.bench.judge.known_bodies import LOOK, KnownBodiesBench, fitted_to
from ashe_live.bench.judge.samples import Candidate, Sample
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.judgement.judge_tables import Curve, OfKnownBody, Score, read_tables

FREE = Score(0.0, {"clear shadow": Curve((-4.0, 4.0), (-4.0, 4.0))})


def candidate(log_odds: float, is_right: bool) -> Candidate:
    return Candidate({"clear shadow": log_odds}, int(is_right), np.array([0.0, 0.0, 1.0]), 0.0, np.zeros(2), np.eye(2))


@pytest.mark.parametrize("truth", [OfKnownBody(1.0, 1.5), OfKnownBody(-0.5, 0.8)])
def test_offset_and_slope_are_those_by_which_explanations_are_right(truth: OfKnownBody) -> None:
    rng = np.random.default_rng(3)
    pictures = []
    for number, odds in enumerate(rng.uniform(-3, 3, 3000)):
        is_right = rng.random() < 1 / (1 + np.exp(-truth.offset - truth.slope * odds))
        pictures.append({LOOK: Sample(str(number), {}, np.array([[0.0, 0.0, 1.0]]), [candidate(odds, is_right)], [])})
    score, found = fitted_to(FREE, pictures)
    assert abs(found.offset - truth.offset) < 0.3
    assert abs(found.slope - truth.slope) < 0.3
    assert score.log_odds({"clear shadow": 2.0}) == pytest.approx(found.offset + 2 * found.slope)


def test_flatness_that_was_given_is_no_evidence() -> None:
    tables = fitted_judge().tables
    features = {name: curve.at[0] for name, curve in tables.explanation.curves.items()}
    flat = {**features, "flat": 3.0}
    assert tables.explanation.log_odds(flat) < tables.explanation.log_odds(features)
    of_known = fitted_judge().of_known_body().tables.explanation
    assert of_known.log_odds({**flat}) == of_known.log_odds(features)


def test_both_numbers_are_kept_with_the_tables() -> None:
    tables = fitted_judge().tables
    assert read_tables(json.dumps(tables.as_json())).of_known_body == tables.of_known_body


def test_pictures_of_known_casters_are_looked_at_as_far_as_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenes, limit = resource("assets", "scenes"), 3
    known = {case.id: "cylinder:0.03x0.08" for case in read_cases(scenes)[1:]}  # the first one's is none
    monkeypatch.setattr("ashe_live.bench.judge.known_bodies.caster_specs", lambda _: known)
    KnownBodiesBench([scenes], limit=limit, jobs=1).run(tmp_path / "out")
    record = json.loads((tmp_path / "out" / RESULTS).read_text(encoding="utf-8"))
    assert record["pictures"] == limit - 1


def test_sets_without_a_known_caster_get_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ashe_live.bench.judge.known_bodies.caster_specs", lambda _: {})
    with pytest.raises(UserError, match="no box, cylinder or sphere"):
        KnownBodiesBench([resource("assets", "scenes")]).run()

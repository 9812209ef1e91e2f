"""The bench of light estimators."""

import json

import cv2
import numpy as np
import pytest

from ashe_live.bench.light import ALL_LIT, CaseResult, run_light_bench, summaries
from ashe_live.errors import UserError


@pytest.fixture
def plain_scenes(tmp_path):
    """Two pictures of nothing, one of which has a light: neither can be answered."""
    cv2.imwrite(str(tmp_path / "plain.png"), np.full((48, 64, 3), 128, np.uint8))
    base = {
        "image": "plain.png",
        "size": [64, 48],
        "K": [[60, 0, 31.5], [0, 60, 23.5], [0, 0, 1]],
        "dist": [0, 0, 0, 0, 0],
        "R": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        "t": [0, 0, 1],
        "marker": {"side_m": 0.2, "corners_px": [[25.5, 17.5], [37.5, 17.5], [37.5, 29.5], [25.5, 29.5]]},
    }
    lit = {"id": "lit", "category": "clean", "lights": [{"dir_to_light": [0, 0.6, 0.8]}]}
    unlit = {"id": "unlit", "category": "diffuse", "lights": []}
    (tmp_path / "ground_truth.json").write_text(json.dumps({"scenes": [base | lit, base | unlit]}))
    return tmp_path


def test_an_abstention_is_counted_and_written(plain_scenes, tmp_path, capsys):
    out = tmp_path / "new" / "results.json"
    run_light_bench([plain_scenes], out, ["paper"])
    content = json.loads(out.read_text())
    assert content["schema"] == 1
    assert content["summaries"]["paper"][ALL_LIT]["attempted"] == 1
    assert content["summaries"]["paper"]["diffuse"]["abstained"] == 1
    assert [case["error_deg"] for case in content["cases"]] == [None, None]
    assert all(case["reason"] for case in content["cases"])
    assert "lit" in capsys.readouterr().out


def test_the_limit_holds_for_every_folder(plain_scenes):
    results = run_light_bench([plain_scenes, plain_scenes], None, ["paper"], limit=1)
    assert [result.case for result in results] == ["lit", "lit"]


def test_an_unknown_estimator_is_refused_before_anything_runs(plain_scenes):
    with pytest.raises(UserError, match="paper"):
        run_light_bench([plain_scenes], None, ["no such"])


def test_an_answer_where_there_is_no_light_is_no_small_error():
    answered = CaseResult("paper", "a", "diffuse", False, (0.0, 0.0, 1.0), None, None, 5.0)
    right = CaseResult("paper", "b", "clean", True, (0.0, 0.0, 1.0), 2.0, None, 5.0)
    other_folder = CaseResult("paper", "c", "diffuse", False, None, None, "no shadow", 5.0)
    found = summaries([answered, right, other_folder])
    assert (found["diffuse"].attempted, found["diffuse"].abstained) == (2, 1)
    assert found["diffuse"].mean_deg is None
    assert (found[ALL_LIT].attempted, found[ALL_LIT].mean_deg) == (1, 2.0)

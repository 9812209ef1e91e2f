"""The bench of light estimators, run on pictures of nothing: that it runs and what it writes."""

import json

import cv2
import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.bench.light.bench import LightBench, thinned
from ashe_live.bench.light.results import ALL_LIT
from ashe_live.errors import UserError
from tests.bench.scene_files import scene, written


@pytest.fixture
def plain_scenes(tmp_path):
    """Two pictures of nothing, one of which has a light: neither can be answered."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    cv2.imwrite(str(folder / "plain.png"), np.full((48, 64, 3), 128, np.uint8))
    lit = scene(id="lit", image="plain.png", category="clean")
    unlit = scene(id="unlit", image="plain.png", category="diffuse", lights=[])
    return written(folder, {"scenes": [lit, unlit]})


def test_abstentions_are_counted_and_written_by_preset(plain_scenes, tmp_path, capsys):
    out = tmp_path / "new"
    record = LightBench([plain_scenes], presets=("fast", "accurate")).run(out)
    assert json.loads((out / "results.json").read_text()) == json.loads(json.dumps(record))
    assert list(record["presets"]) == ["fast", "accurate"]
    for preset in record["presets"].values():
        assert preset["summaries"][ALL_LIT]["attempted"] == preset["summaries"][ALL_LIT]["abstained"] == 1
        assert preset["summaries"]["diffuse"]["right_count_share"] == 1
        assert preset["stages_ms"]["total"]["p50"] > 0
    assert [case["error_deg"] for case in record["cases"]] == [None] * 4
    assert all(case["reason"] and not case["lights"] for case in record["cases"])
    assert record["machine"]["cpus"] >= 1
    assert record["versions"]["opencv"]
    assert "diffuse" in capsys.readouterr().out


def test_several_folders_are_one_set_and_the_limit_holds_for_each(plain_scenes):
    folders = [plain_scenes, plain_scenes]
    assert len(LightBench(folders).cases()) == 4
    assert [case.id for case in LightBench(folders, limit=1).cases()] == ["lit", "lit"]


def test_a_thinned_set_keeps_every_category(plain_scenes):
    cases = read_cases(plain_scenes) * 5
    assert [case.id for case in thinned(cases, 3)] == ["lit", "unlit"] * 2


def test_an_unknown_estimator_is_refused_before_anything_runs(plain_scenes):
    with pytest.raises(UserError, match="paper"):
        LightBench([plain_scenes], "no such").run()


def test_the_trade_is_drawn_beside_the_results(plain_scenes, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib", reason="only needed for plots")
    monkeypatch.setattr("ashe_live.bench.light.trade.VARIATIONS", ())
    bench = LightBench([plain_scenes], presets=("fast", "accurate"), sweeps=True)
    record = bench.run(tmp_path)
    assert [(point["name"], point["is_preset"]) for point in record["trade"]] == [("fast", True), ("accurate", True)]
    assert {path.name for path in tmp_path.iterdir() if path.is_file()} == {"results.json", "trade.svg", "trade.png"}
    (tmp_path / "results.json").unlink()
    with pytest.raises(UserError, match=r"trade\.svg"):
        bench.run(tmp_path)


def test_without_a_light_in_any_picture_there_is_no_trade_to_draw(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib", reason="only needed for plots")
    monkeypatch.setattr("ashe_live.bench.light.trade.VARIATIONS", ())
    cv2.imwrite(str(tmp_path / "plain.png"), np.full((48, 64, 3), 128, np.uint8))
    written(tmp_path, {"scenes": [scene(id="unlit", image="plain.png", category="diffuse", lights=[])]})
    out = tmp_path / "out"
    record = LightBench([tmp_path], presets=("fast",), sweeps=True).run(out)
    assert record["presets"]["fast"]["summaries"]["diffuse"]["right_count_share"] == 1
    assert [path.name for path in out.iterdir()] == ["results.json"]

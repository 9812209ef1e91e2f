"""REPORT.json: the contract, and a file whole or not at all."""

import json

import jsonschema
import pytest

from ashe_live.errors import UserError
from ashe_live.viewer.output.report import Report, frame_time_percentiles
from tests.checkout import CHECKOUT

SCHEMA = json.loads((CHECKOUT / "docs" / "contract.schema.json").read_text())


@pytest.fixture
def report(fakes) -> Report:
    report = Report("llvmpipe", "4.5 Mesa", "fast")
    report.add_frame(fakes.tracked(0, has_marker=False), 10.0)
    report.add_frame(fakes.tracked(1), 20.0)
    report.add_frame(fakes.tracked(2), 30.0)
    report.add_estimate(fakes.estimate(1))
    report.add_estimate(fakes.estimate(2, with_light=False))
    return report


def test_it_keeps_the_contract(report):
    jsonschema.validate(report.to_json(), SCHEMA)


def test_an_empty_one_keeps_the_contract_too():
    content = Report("llvmpipe", "4.5 Mesa", "fast").to_json()
    jsonschema.validate(content, SCHEMA)
    assert content["summary"]["fps"] is None


def test_it_sums_up(report):
    summary = report.to_json()["summary"]
    assert (summary["frames"], summary["found"]) == (3, 2)
    assert summary["camera"]["source"] == "flag"
    assert summary["fps"] == pytest.approx(50.0)
    assert summary["frame_ms"]["idle"]["p50"] == 20.0
    assert summary["frame_ms"]["estimating"] is None


def test_percentiles_are_ordered():
    percentiles = frame_time_percentiles([float(ms) for ms in range(101)])
    assert percentiles == {"p50": 50.0, "p95": 95.0, "p99": 99.0}
    assert frame_time_percentiles([]) is None


def test_it_writes_what_it_says(report, tmp_path):
    report.write(tmp_path / "report.json")
    assert json.loads((tmp_path / "report.json").read_text()) == report.to_json()
    assert [path.name for path in tmp_path.iterdir()] == ["report.json"]


def test_what_has_appeared_under_its_name_stays_unless_it_may_be_replaced(report, tmp_path):
    path = tmp_path / "report.json"
    path.write_text("precious")
    assert report.write(path) == tmp_path / "report-2.json"
    assert path.read_text() == "precious"
    assert report.write(path, overwrite=True) == path
    assert json.loads(path.read_text()) == report.to_json()


def test_where_it_cannot_write_it_says_so(report, tmp_path):
    with pytest.raises(UserError, match="there is no folder"):
        report.write(tmp_path / "missing" / "report.json")
    assert list(tmp_path.iterdir()) == []

"""The sweep of the estimator's numbers."""

import dataclasses

import cv2
import numpy as np
import pytest
from rich.console import Console

from ashe_live.bench.cases import Case
from ashe_live.bench.light.trade import MEDIAN_ERROR, MISSED, VARIATIONS, Variation, print_trade, replaced, sweep
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import rigid
from ashe_live.core.types import MarkerPose
from ashe_live.light.estimators.preset import BALANCED, ProxyPreset
from ashe_live.quality import LIGHT_PRESETS


class Guess:
    """Always overhead, in a set time."""

    name = "guess"

    def estimate(self, tracked, others=()):  # noqa: ARG002
        return LightEstimate(
            self.name, tracked.frame.index, Illumination((Light((0, 0, 1)),)), timing_ms={"total": 7.0}
        )


@pytest.fixture
def cases(tmp_path):
    """A blank picture, under a light that is 45 degrees from the zenith, under none, and under an unknown one."""
    path = tmp_path / "blank.png"
    cv2.imwrite(str(path), np.full((48, 64, 3), 128, np.uint8))
    camera = Camera.from_hfov((64, 48), 60)
    pose = MarkerPose(rigid(np.diag((1.0, -1.0, -1.0)), (0, 0, 1)), np.zeros((4, 2)), 0.1, 0.0, None)
    truths = (np.array([[0.0, 1.0, 1.0]]), np.empty((0, 3)), None)
    return [Case("a", "set", "clean", None, path, camera, pose, truth, {}) for truth in truths]


def test_a_path_leads_into_the_records_within():
    changed = replaced(BALANCED, "ground.palette_colours", 7)
    assert changed.ground.palette_colours == 7
    assert replaced(changed, "ground.palette_colours", BALANCED.ground.palette_colours) == BALANCED
    with pytest.raises((TypeError, AttributeError)):
        replaced(BALANCED, "ground.no_such", 1)


def test_every_variation_is_a_setting_and_every_series_passes_through_balanced():
    series = {}
    for variation in VARIATIONS:
        series.setdefault(variation.series, []).append(variation.preset())
    for name, settings in series.items():
        assert BALANCED in settings, name
        assert all(settings.count(setting) == 1 for setting in settings), name


def test_every_number_that_the_presets_differ_in_is_varied():
    varied = {path.partition(".")[0] for variation in VARIATIONS for path in variation.changes}
    fields = [field.name for field in dataclasses.fields(ProxyPreset)]
    assert varied >= {name for name in fields if len({getattr(preset, name) for preset in LIGHT_PRESETS.values()}) > 1}


def test_an_abstention_is_worse_than_any_answer(cases, monkeypatch):
    monkeypatch.setattr("ashe_live.bench.light.trade.VARIATIONS", (Variation("size", "same", {}),))
    same, guess = sweep(cases, [], {"guess": Guess()}, Console(quiet=True))
    assert (same.is_preset, guess.is_preset) == (False, True)
    assert same.errors == {MEDIAN_ERROR: 90.0, MISSED: 100.0}
    assert guess.errors == pytest.approx({MEDIAN_ERROR: 45.0, MISSED: 100.0})
    assert guess.cost == 7.0


def test_the_table_marks_the_front(cases, capsys, monkeypatch):
    monkeypatch.setattr("ashe_live.bench.light.trade.VARIATIONS", ())
    print_trade(Console(width=100), sweep(cases, [], {"guess": Guess()}, Console(quiet=True)))
    assert "45.0°*" in capsys.readouterr().out

"""The concentration is that of the azimuths about where sheets' shadows come from, and 0 where these tell nothing."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.bench.judge import sheets
from ashe_live.bench.judge.sheets import SeenSheet, SheetsBench, fitted_to
from ashe_live.light.ground.sheet_shadow import OTHERS, SheetShadow
from tests.bench.printed import Printed


def seen(concentration: float, clear: float, count: int = 400) -> list[SeenSheet]:
    """Sheets with shadows of lights whose azimuths spread so much about where these come from, or of something else."""
    rng = np.random.default_rng(5)
    made = []
    for azimuth in rng.uniform(-np.pi, np.pi, count):
        is_own = rng.uniform() > OTHERS
        about = azimuth + rng.vonmises(0.0, concentration * clear if is_own else 0.0)
        away = -0.03 * np.array([np.cos(about), np.sin(about)])
        to_light = np.array([np.cos(azimuth), np.sin(azimuth), 1.0]) / np.sqrt(2)
        made.append(SeenSheet("", SheetShadow(away, clear), to_light))
    return made


@pytest.mark.parametrize(("truth", "clear"), [(2.0, 0.9), (5.0, 0.4)])
def test_the_concentration_is_that_of_the_azimuths(truth: float, clear: float) -> None:
    several = seen(truth, clear)
    found = fitted_to(several)
    assert found == pytest.approx(truth, rel=0.2)
    assert np.mean([each.gain(found) for each in several]) > 0.05


def test_shadows_from_anywhere_are_no_evidence() -> None:
    several = [*seen(0.0, 0.8), SeenSheet("", None, np.array([1.0, 0.0, 0.0]))]
    assert fitted_to(several) <= 0.25
    assert several[-1].gain(3.0) == 0.0


def test_a_shadow_within_45_degrees_counts_as_right() -> None:
    from_right = SheetShadow(np.array([-0.03, 0.0]), 0.9)
    for azimuth_deg, is_right in ((40, True), (50, False), (180, False)):
        a = np.radians(azimuth_deg)
        assert SeenSheet("", from_right, np.array([np.cos(a), np.sin(a), 0.0])).is_within_45 == is_right


def test_each_ground_is_judged_by_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shadows come from the light on wood, and from opposite to it on stone: the one misleads the other."""
    right, wrong = (SheetShadow(np.array([x, 0.0]), clear) for x, clear in ((-0.03, 0.9), (0.03, 0.4)))
    to_light = np.array([1.0, 0.0, 1.0]) / np.sqrt(2)
    grounds = {"wood": (right, right, None), "stone": (wrong,)}
    seen = [SeenSheet(ground, shadow, to_light) for ground, shadows in grounds.items() for shadow in shadows]
    lights = (np.eye(3)[:1], np.eye(3)[:1], np.eye(3)[:1], np.eye(3)[:1], np.eye(3)[:2], np.empty((0, 3)), None)
    cases = [SimpleNamespace(number=number, to_lights_marker=each) for number, each in enumerate(lights)]
    monkeypatch.setattr(sheets, "cases_of", lambda *given: cases if given == ([Path("a")], 9, 2) else [])
    monkeypatch.setattr(sheets, "seen_sheet", lambda case: seen[case.number])
    console = Printed()
    record = SheetsBench([Path("a")], limit=9, every=2, console=console).run()
    assert (record["pictures"], record["concentration"]) == (4, fitted_to(seen))
    assert record["gain"] == pytest.approx(np.mean([each.gain(fitted_to(seen)) for each in seen]))
    # By stone alone shadows tell nothing, and by wood they come from the light.
    assert record["left_out"]["wood"] == 0
    assert record["left_out"]["stone"] == pytest.approx(seen[-1].gain(8.0))
    (rows,) = console.tables
    assert rows["wood",] == {"pictures": "3", "clear": "2", "of these within 45°": "2", "gain, nats": "+0.000"}
    assert [*rows["stone",].values()][:3] == ["1", "0", "0"]

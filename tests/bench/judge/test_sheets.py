"""The concentration is that of the azimuths about where sheets' shadows come from, and 0 where these tell nothing."""

import numpy as np
import pytest

from ashe_live.bench.judge.sheets import SeenSheet, fitted_to
from ashe_live.light.ground.sheet_shadow import OTHERS, SheetShadow


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

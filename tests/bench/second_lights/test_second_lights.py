"""`ashe-live bench fit-seconds`: which second lights count as right, and the threshold that tells them from others."""

from dataclasses import replace
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench import cases
from ashe_live.bench.cases import Case
from ashe_live.bench.second_lights.bench import SecondLightsBench, fitted_to, rates_by
from ashe_live.bench.second_lights.tried import MeasuredLight, MeasuredPicture, measured_picture
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.judgement.judge import fitted_judge
from tests.bench.painted_case import painted_case
from tests.light.painted_scenes import CYLINDER, OtherLight, paint

STRONG = OtherLight(80.0, 45.0, (0.12, 0.2, 0.3))


def tried_in(case: Case) -> list[MeasuredLight]:
    measured = measured_picture(case, BALANCED, fitted_judge())
    assert measured is not None
    assert case.to_lights_marker is not None
    assert measured.lights == len(case.to_lights_marker)
    return list(measured.tried)


def test_a_second_light_is_right_where_it_and_the_first_are_the_true_ones(tmp_path: Path) -> None:
    scene = paint(CYLINDER, other=STRONG)
    case = painted_case(tmp_path, scene, np.array([scene.to_light, STRONG.to_light]))
    assert any(each.is_right and each.clarity > 0.5 and each.signal_to_noise > 20 for each in tried_in(case))
    # Of the same picture, were the second light elsewhere, or none.
    for truths in ([scene.to_light, [0.0, 0.0, 1.0]], [scene.to_light]):
        other = tried_in(replace(case, to_lights_marker=np.array(truths)))
        assert other
        assert not any(each.is_right for each in other)


def test_where_no_first_light_is_right_nothing_is_measured(tmp_path: Path) -> None:
    scene = paint(CYLINDER)
    for truths in (np.zeros((0, 3)), -scene.to_light[None], np.array([scene.to_light] * 3)):
        assert measured_picture(painted_case(tmp_path, scene, truths), BALANCED, fitted_judge()) is None


def pictures(right: list[float], wrong: list[float]) -> list[MeasuredPicture]:
    """With a right second light each, of some clarity, and with a wrong one."""
    two = [MeasuredPicture(2, [MeasuredLight(30.0, clarity, True)]) for clarity in right]
    one = [MeasuredPicture(1, [MeasuredLight(30.0, clarity, False)]) for clarity in wrong]
    return [*two, *one, MeasuredPicture(2, [])]


def test_the_fitted_threshold_is_where_wrong_ones_become_as_dense_as_right_ones() -> None:
    rng = np.random.default_rng(5)
    right, wrong = rng.uniform(0.3, 1.0, 300).tolist(), rng.uniform(0.0, 0.5, 300).tolist()
    clarity, thresholds = attrgetter("clarity"), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    # Densities 1 / 0.7 and 1 / 0.5: where there are both, a wrong one is likelier.
    assert fitted_to(pictures(right, wrong), clarity, thresholds) == 0.5
    # However many pictures there are of either kind.
    assert fitted_to(pictures(right * 9, wrong), clarity, thresholds) == 0.5
    assert fitted_to(pictures([each for each in right if each < 0.5], wrong), clarity, thresholds) == 0.3
    rates = rates_by(pictures(right, wrong), clarity, 0.5)
    assert rates.wrong == 0.0
    assert rates.youden == rates.right == pytest.approx(sum(each >= 0.5 for each in right) / 301)


def test_the_bench_prints_both_thresholds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = paint(CYLINDER, other=STRONG)
    two = painted_case(tmp_path, scene, np.array([scene.to_light, STRONG.to_light]))
    several = [two, replace(two, id="one", to_lights_marker=scene.to_light[None])]
    monkeypatch.setattr(cases, "read_cases", lambda _: several)
    record = SecondLightsBench([tmp_path]).run()
    assert record["pictures"].keys() == {"scenes/painted", "scenes/one"}
    printed = capsys.readouterr().out
    assert "1 pictures with two lights, 1 with one" in printed
    assert f"LEAST_CLARITY {record['least_clarity']:g}, in use" in printed
    assert f"LEAST_SIGNAL_TO_NOISE {record['least_signal_to_noise']:g}, in use" in printed


def test_a_set_without_second_lights_gets_a_line() -> None:
    with pytest.raises(UserError, match="a first light is right in 1 of 1 pictures, and not in some with"):
        SecondLightsBench([resource("assets", "scenes")], limit=1).run()

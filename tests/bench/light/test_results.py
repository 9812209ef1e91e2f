"""What many answers come to."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench.cases import Case
from ashe_live.bench.light import results
from ashe_live.bench.light.results import (
    ALL,
    ALL_LIT,
    CONFIDENT_DEG,
    case_result,
    grouped,
    stage_times,
    summarise,
    timed_estimate,
)
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import direction_from_angles, rigid
from ashe_live.core.types import MarkerPose
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from tests.bench.fake_clock import FakeClock

SUN = direction_from_angles(0.5, 0.7)
LAMP = direction_from_angles(2.5, 0.9)
POSE = MarkerPose(rigid(np.diag((1.0, -1.0, -1.0)), (0, 0, 1)), np.zeros((4, 2)), 0.1, 0.0, None)


def case(category="clean", lights=(SUN,)):
    truths = np.array(lights, dtype=float).reshape(-1, 3)
    return Case("a", "set", category, "box", Path("a.png"), Camera.from_hfov((64, 48), 60), POSE, truths, {})


def off_by(degrees, from_=SUN, sigma_deg=3.0, confidence=0.9):
    """An answer that many degrees above the truth, as sure as stated, equally in both ways."""
    azimuth, elevation = math.atan2(from_[1], from_[0]), math.asin(from_[2])
    sigma = math.radians(sigma_deg)
    return Light(
        direction_from_angles(azimuth, elevation + math.radians(degrees)),
        np.eye(2) * (sigma / 1.51) ** 2,
        sigma,
        confidence,
    )


def answered(of, *lights, ms=10.0, true_labels_deg=None):
    reason = None if lights else "no shadow"
    estimate = LightEstimate("e", 0, Illumination(lights), reason, timing_ms={"fit": ms / 2, "total": ms})
    return case_result("balanced", of, estimate, 2 * ms, (0.5, 0.25), true_labels_deg)


def test_errors_are_those_of_the_answers_and_shares_are_of_all():
    summary = summarise([answered(case(), off_by(error)) for error in (1, 3, 20)] + [answered(case())])
    assert (summary.attempted, summary.abstained) == (4, 1)
    assert summary.mean_deg == pytest.approx(8)
    assert summary.median_deg == pytest.approx(3)
    assert summary.max_deg == pytest.approx(20)
    assert summary.good_share == 0.5
    assert summary.right_count_share == 0.75
    assert summary.within_1_sigma == pytest.approx(2 / 3)
    assert summary.within_2_sigma == pytest.approx(2 / 3)
    assert summary.within_ellipse_95 == pytest.approx(2 / 3)
    assert summary.bad_share == 0.25
    assert summary.brier == pytest.approx((0.01 + 0.01 + 0.81) / 3)
    assert (summary.object_iou, summary.shadow_iou) == (0.5, 0.25)
    assert (summary.median_ms, summary.median_cpu_ms) == (10, 20)


def test_figures_are_means_medians_and_percentiles_as_they_are_named():
    """Of 0, 1, 4, ... 100, the mean is 35, the median 25, and nine tenths are within 81."""
    summary = summarise(
        [
            replace(
                answered(case(), off_by(0)),
                error_deg=square,
                true_labels_deg=2 * square,
                object_iou=square / 100,
                shadow_iou=square / 200,
                wall_ms={"total": square},
                cpu_ms=3 * square,
            )
            for square in (float(number**2) for number in range(11))
        ]
    )
    assert (summary.mean_deg, summary.median_deg, summary.p90_deg, summary.max_deg) == (35, 25, 81, 100)
    assert (summary.true_labels_mean_deg, summary.true_labels_median_deg, summary.true_labels_max_deg) == (70, 50, 200)
    assert (summary.object_iou, summary.shadow_iou) == (0.25, 0.125)
    assert (summary.median_ms, summary.p95_ms) == (25, 90.5)
    assert (summary.median_cpu_ms, summary.p95_cpu_ms) == (75, 271.5)


def test_answers_lie_within_their_sigmas_and_their_ellipse_where_they_state_any():
    def beside(sigmas, squared):
        return replace(answered(case(), off_by(0)), error_deg=sigmas, sigma_deg=1.0, squared_sigmas=squared)

    unstated = replace(answered(case(), off_by(9)), sigma_deg=None, squared_sigmas=None)
    summary = summarise([*(beside(*each) for each in ((0.9, 5.9), (1.1, 5.9), (1.9, 6.1), (2.1, 6.1))), unstated])
    assert (summary.within_1_sigma, summary.within_2_sigma) == (0.25, 0.75)
    assert summary.within_ellipse_95 == 0.5  # of two degrees of freedom: 5.99


def test_answers_are_good_below_5_degrees_right_below_10_and_wrong_beyond_15_where_they_are_sure():
    below, above = (summarise([answered(case(), off_by(limit + by)) for limit in (5, 10)]) for by in (-0.1, 0.1))
    assert (below.good_share, above.good_share) == (0.5, 0)
    assert [answered(case(), off_by(degrees)).is_good for degrees in (9.9, 10.1)] == [True, False]
    assert math.radians(CONFIDENT_DEG) == pytest.approx(GOOD_RAD)
    sureness = {
        (degrees, sure): answered(case(), off_by(degrees, confidence=sure)).is_bad
        for degrees in (14.9, 15.1)
        for sure in (0.49, 0.51)
    }
    assert [each for each, is_bad in sureness.items() if is_bad] == [(15.1, 0.51)]


def test_an_estimate_is_timed_by_the_processor(monkeypatch):
    clock, tracked, others = FakeClock(), object(), (object(),)
    clock.install(monkeypatch, results.__name__)

    class Busy:
        def estimate(self, *given):
            clock.work(30)  # half of it on the processor
            return given

    assert timed_estimate(Busy(), tracked, others) == ((tracked, others), pytest.approx(15))


def test_of_nothing_there_is_nothing():
    summary = summarise([])
    assert summary.mean_deg is summary.good_share is summary.brier is summary.median_ms is None


def test_an_answer_where_there_is_no_light_is_no_small_error():
    right, wrong = answered(case("diffuse", ())), answered(case("diffuse", ()), off_by(0))
    summary = summarise([right, wrong])
    assert (summary.abstained, summary.mean_deg, summary.good_share) == (1, None, None)
    assert summary.right_count_share == 0.5
    assert summary.bad_share == 0.5
    assert summary.brier == pytest.approx(0.81)


def test_the_first_of_two_lights_may_be_either_of_the_true_ones():
    two = case("two", (SUN, LAMP))
    both = answered(two, off_by(2, LAMP), off_by(4, SUN))
    assert both.error_deg == pytest.approx(2)
    one = answered(two, off_by(1, LAMP))
    assert one.error_deg == pytest.approx(1)
    summary = summarise([both, one])
    assert summary.right_count_share == 0.5


def test_a_light_too_many_is_a_wrong_count():
    result = answered(case(), off_by(1), off_by(0, LAMP))
    assert result.error_deg == pytest.approx(1)
    assert summarise([result]).right_count_share == 0


def test_what_nobody_knows_cannot_be_compared():
    with pytest.raises(ValueError, match="knows"):
        answered(replace(case(), to_lights_marker=None), off_by(1))


def test_the_groups_are_the_categories_and_the_pools():
    found = [answered(each) for each in (case("soft"), case("clean"), case("clean"), case("diffuse", ()))]
    groups = grouped(found)
    assert list(groups) == ["soft", "clean", "diffuse", ALL_LIT, ALL]
    assert groups["clean"] == found[1:3]
    assert len(groups[ALL_LIT]) == 3
    assert len(groups[ALL]) == 4
    assert list(grouped([answered(case("diffuse", ()))])) == ["diffuse", ALL]


def test_stages_are_timed_over_the_cases_that_reach_them():
    early = answered(case(), ms=100.0)
    early = replace(early, wall_ms={"total": 100.0})
    times = stage_times([early, answered(case(), ms=10.0)])
    assert times["fit"]["p50"] == 5
    assert times["total"]["p50"] == 55
    assert times["total"]["p95"] == pytest.approx(95.5)

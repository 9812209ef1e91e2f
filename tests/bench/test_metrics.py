"""The statistics of angular errors."""

import pytest

from ashe_live.bench.metrics import angular_error_deg, summarise


def test_the_error_is_the_angle_whatever_the_lengths():
    assert angular_error_deg((1, 0, 0), (0, 2, 0)) == pytest.approx(90)
    assert angular_error_deg((0, 0, 3), (0, 0, 1)) == 0
    assert angular_error_deg((1, 0, 0), (-1, 0, 0)) == pytest.approx(180)


def test_a_summary_counts_the_good_among_the_attempted():
    summary = summarise([1.0, 3.0, 20.0], attempted=4, abstained=1, times_ms=[10, 20, 30, 40])
    assert (summary.attempted, summary.abstained) == (4, 1)
    assert summary.mean_deg == pytest.approx(8)
    assert summary.median_deg == 3
    assert summary.max_deg == 20
    assert summary.median_deg <= summary.p90_deg <= summary.max_deg
    assert summary.good_share == pytest.approx(0.5)
    assert summary.median_ms == 25


def test_without_errors_there_are_no_statistics():
    summary = summarise([], attempted=2, abstained=2, times_ms=[])
    assert summary.mean_deg is None
    assert summary.good_share is None
    assert summary.median_ms is None

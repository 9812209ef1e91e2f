"""What is learned from: how right an explanation is, and each picture's samples in its place."""

from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from ashe_live.bench.judge import samples
from ashe_live.bench.judge.samples import Candidate, in_processes, sample_of, with_mean_light
from ashe_live.core.transforms import direction_from_angles

A, B, C = (direction_from_angles(np.radians(azimuth), np.radians(50)) for azimuth in (0, 120, 240))
NEAR_A = direction_from_angles(0.0, np.radians(59))  # within 10 degrees, from where on an answer is no good
BEYOND_A = direction_from_angles(0.0, np.radians(61))


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_is_found_has_the_order_of_the_pictures_whichever_takes_longest(jobs: int) -> None:
    pictures = [range(3_000_000), range(5), range(3), range(4)]
    assert in_processes(sum, pictures, jobs, Console(quiet=True), "sums") == [sum(each) for each in pictures]


@pytest.mark.parametrize(
    ("truths", "lights", "rightness", "error_deg"),
    [
        ([A], [A], 2, 0),
        ([A], [NEAR_A], 2, 9),
        ([A], [BEYOND_A], 0, 11),
        ([A], [A, B], 1, 0),
        ([A, B], [B], 1, 0),
        ([A, B], [B, NEAR_A], 2, 0),
        ([A, B], [NEAR_A, C], 1, 9),
        ([A, B], [BEYOND_A, B], 0, 11),
        ([A, B], [A, B, B], 1, 0),
        ([], [A], 0, 180),
    ],
)
def test_right_is_what_begins_with_a_true_light_and_whole_what_has_them_all_and_no_other(
    monkeypatch: pytest.MonkeyPatch, truths, lights, rightness: int, error_deg: float
) -> None:
    fitted = [SimpleNamespace(to_light_marker=light, covariance_rad2=np.eye(2), unseen_end=0.3) for light in lights]
    trace = SimpleNamespace(judged=[SimpleNamespace(lights=fitted)], rough=[], glint=None, sheet_shadow=None)
    monkeypatch.setattr(samples, "explanation_features", lambda *_: {"edge": 2.0})
    case = SimpleNamespace(
        folder="set", id="a", tags={}, to_lights_marker=np.array(truths).reshape(-1, 3), followed=lambda: "frame"
    )
    sample = sample_of(case, SimpleNamespace(traced=lambda _: (None, trace)))
    (found,) = sample.judged
    assert (found.rightness, found.lights, found.unseen_end, found.features) == (
        rightness,
        len(lights),
        0.3,
        {"edge": 2},
    )
    assert found.error_rad == pytest.approx(np.radians(error_deg))
    assert sample.lights == len(truths)
    by_axis = np.linalg.norm(found.error_by_axis)
    assert by_axis == pytest.approx(found.error_rad if truths else 0.0)


def test_the_mean_of_like_lights_is_compared_with_the_true_one_that_is_nearest() -> None:
    def candidate(elevation_deg: float, lights: int = 1) -> Candidate:
        light = direction_from_angles(0.0, np.radians(elevation_deg))
        return Candidate({}, 2, light, 9.0, np.zeros(2), 1e-4 * np.eye(2), lights)

    best, other = candidate(48.0), candidate(56.0)
    found = with_mean_light(best, [(best, 0.75), (other, 0.25)], np.array([B, A]))
    assert found.to_light_marker == pytest.approx(A, abs=1e-3)
    assert found.error_rad == pytest.approx(0.0, abs=1e-3)
    # From the answer to the truth: upwards, on the basis of azimuth and elevation.
    low = with_mean_light(best, [(best, 1.0)], np.array([B, A]))
    assert low.error_by_axis == pytest.approx((0.0, np.radians(2.0)), abs=1e-6)
    two = candidate(48.0, lights=2)
    assert with_mean_light(two, [(two, 0.75), (other, 0.25)], np.array([A])) is two

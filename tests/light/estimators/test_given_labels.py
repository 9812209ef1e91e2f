"""What follows from true labels: near the truth, whatever the labelling would have made of the picture."""

import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.bench.light.truth import error_on_true_labels_deg
from ashe_live.light.estimators.given_labels import directions_from_labels
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from tests.shared_data import shared_folder
from tests.shipped_scenes import CASES, LIT


@pytest.mark.parametrize("name", LIT)
def test_true_labels_lead_to_the_true_light(name: str) -> None:
    error = error_on_true_labels_deg(CASES[name], CASES[name].tracked(), BALANCED)
    assert error is not None
    assert error < 4


def test_lights_come_in_the_order_of_their_shadows() -> None:
    case = CASES["two_cylinder"]
    assert case.to_lights_marker is not None
    body, shadows = case.mask("object"), [case.mask("shadow"), case.mask("shadow2")]
    assert body is not None
    for order in (1, -1):
        found = directions_from_labels(case.tracked(), body, shadows[::order], BALANCED)
        assert found is not None
        assert all(
            one @ true > np.cos(np.radians(5)) for one, true in zip(found, case.to_lights_marker[::order], strict=True)
        )


def test_without_a_shadow_there_is_no_light() -> None:
    case = CASES["diffuse_cylinder"]
    body = case.mask("object")
    assert body is not None
    assert directions_from_labels(case.tracked(), body, [np.zeros_like(body)], BALANCED) is None


def test_labels_off_the_ground_lead_to_no_light() -> None:
    case = CASES["diffuse_cylinder"]
    tracked = case.tracked()
    nowhere = np.zeros(tracked.frame.image_bgr.shape[:2], np.bool_)
    off_ground = ~grown(View.of(tracked, tracked.frame.size[0]).is_ground, 3)  # within the marker's sheet
    assert off_ground.any()
    for body in (nowhere, off_ground):
        assert directions_from_labels(tracked, body, [nowhere], BALANCED) is None


def test_the_papers_scenes() -> None:
    cases = read_cases(shared_folder("paper_scenes"))
    errors = [error_on_true_labels_deg(case, case.tracked(), BALANCED) for case in cases]
    assert None not in errors
    assert np.mean(errors) < 1

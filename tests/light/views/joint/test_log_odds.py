"""What several views say for an explanation."""

import dataclasses

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.explanation.judgement.context import NO_CONTEXT, Context
from ashe_live.light.explanation.judgement.judge import best_direction, fitted_judge, probabilities_of
from ashe_live.light.ground.sheet_shadow import SheetShadow
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import plane_homography
from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.joint.log_odds import joint_log_odds, joint_support, no_less_sure
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX
from tests.light.painted_views import explained_in_two_views
from tests.light.synthetic_masks import direction

HERE, NEARBY, ELSEWHERE = direction(200, 40), direction(203, 41), direction(80, 50)


def share(directions: list[np.ndarray], log_odds: list[float]) -> float:
    return best_direction(probabilities_of(log_odds), directions)[1]


def test_a_direction_that_all_views_confirm_is_as_likely_as_by_the_first() -> None:
    directions, alone = [HERE, NEARBY, ELSEWHERE], [NEARBY, ELSEWHERE]
    raised = no_less_sure(directions, [0.5, -1.0, -0.5], alone, [3.0, -2.0])
    assert share(directions, raised) == pytest.approx(share(alone, [3.0, -2.0]))
    # What explains the same direction keeps its share of it, and what explains another its odds against none.
    assert raised[0] - raised[1] == pytest.approx(1.5)
    assert raised[2] == -0.5


def test_views_that_are_surer_than_the_first_stay_so() -> None:
    assert no_less_sure([HERE, ELSEWHERE], [4.0, -1.0], [HERE], [1.0]) == [4.0, -1.0]


def test_views_that_contradict_the_first_are_right() -> None:
    assert no_less_sure([HERE], [0.5], [ELSEWHERE], [5.0]) == [0.5]


def test_the_surest_view_leaves_odds_finite() -> None:
    assert np.isfinite(no_less_sure([HERE], [-50.0], [HERE], [50.0])).all()


@pytest.mark.parametrize(("all_views", "first"), [([], [1.0]), ([1.0], [])])
def test_without_explanations_nothing_changes(all_views: list[float], first: list[float]) -> None:
    assert no_less_sure([HERE] * len(all_views), all_views, [HERE] * len(first), first) == all_views


def test_what_shears_in_a_shadow_is_not_made_up_for_by_the_ground_around_it() -> None:
    scene = painted_region(BOX)
    rows = np.arange(len(scene.shadow))[:, None]
    on_plane = np.where(scene.shadow, 1.0, np.where(scene.body, -1.0, 0.0)).astype(np.float32)
    clear = dataclasses.replace(scene.region, on_plane=on_plane)
    # A quarter of the shadow's pixels, at one of its ends, stand up: its sum stays that of ground on the plane.
    end = scene.shadow & (rows < np.quantile(np.nonzero(scene.shadow)[0], 0.25))
    standing = dataclasses.replace(clear, on_plane=np.where(end, -2.0, on_plane).astype(np.float32))
    assert standing.on_plane[scene.shadow].sum() > 0
    for_clear, for_standing = (joint_support(each, scene.body, scene.shadow) for each in (clear, standing))
    assert for_clear == pytest.approx(1.0)
    assert for_standing == pytest.approx(0.0)


def test_what_another_object_hides_in_one_view_does_not_shear_in_the_other() -> None:
    found = explained_in_two_views()
    here, there = found.each
    shadow = here.predicted.shadow
    end = shadow & (np.arange(len(shadow))[:, None] < np.quantile(np.nonzero(shadow)[0], 0.3))
    H = plane_homography(here.region.view, there.region.view)
    end_there = cv2.warpPerspective(end.astype(np.uint8), H, there.region.view.size, flags=cv2.INTER_NEAREST) > 0
    beside = grown(end_there, 12) & ~grown(there.predicted.whole, 2)

    def log_odds(standing: Mask) -> float:
        """By two views, one of which shows the shadow's end to shear, the other something that stands."""
        several = [
            dataclasses.replace(
                each, region=dataclasses.replace(each.region, on_plane=np.where(each.predicted.body | mask, -2, 1.0))
            )
            for each, mask in ((here, end), (there, standing))
        ]
        return joint_log_odds(JointExplanation(several[0], tuple(several), here), fitted_judge(), NO_CONTEXT)

    in_its_place, reaching_over = log_odds(end_there), log_odds(grown(end_there, 3) | beside)
    assert reaching_over > in_its_place + 0.5


def test_what_else_a_picture_shows_counts_with_several_views_too() -> None:
    found = explained_in_two_views()
    towards = found.joint.lights[0].to_light_marker[:2]
    confirmed, contradicted = (
        joint_log_odds(found, fitted_judge(), Context(sheet=SheetShadow(0.05 * away, 0.8)))
        for away in (-towards, towards)
    )
    assert contradicted + 0.5 < joint_log_odds(found, fitted_judge(), NO_CONTEXT) < confirmed - 0.5


def test_one_view_alone_supports_nothing() -> None:
    scene = painted_region(BOX)
    assert joint_support(scene.region, scene.body, scene.shadow) == 0

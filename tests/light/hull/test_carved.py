"""What silhouettes and a shadow leave of voxels."""

import numpy as np

from ashe_live.light.hull.carved import Box, carved
from ashe_live.light.hull.labelled import MOST_COST
from tests.light.hull.labelled_views import ODD, TO_LIGHT_DEG, headings, views_of
from tests.light.synthetic_masks import direction

TO_LIGHT = direction(*TO_LIGHT_DEG)
POINTS = np.concatenate(ODD)
HULL = carved(views_of(ODD, TO_LIGHT, headings(60, 5)), Box.around(POINTS, 0.3))


def inside_the_body(points: np.ndarray, margin_m: float) -> np.ndarray:
    """Those well within one of the boxes: on the inner side of the planes of all its faces."""
    within = np.zeros(len(points), np.bool_)
    for part in ODD:
        base, height = part[:4], part[4, 2] - part[0, 2]
        x, y = (part[1] - part[0])[:2], (part[3] - part[0])[:2]
        away = points[:, :2] - base[:, :2].mean(axis=0)
        along, across = np.abs(away @ x) / np.linalg.norm(x), np.abs(away @ y) / np.linalg.norm(y)
        level = np.abs(points[:, 2] - base[0, 2] - height / 2)
        halves = np.linalg.norm(x) / 2, np.linalg.norm(y) / 2, height / 2
        within |= (along < halves[0] - margin_m) & (across < halves[1] - margin_m) & (level < halves[2] - margin_m)
    return within


def test_the_body_survives_and_most_of_the_rest_does_not() -> None:
    truth = inside_the_body(HULL.box.centres(), 0.0)
    surely = np.flatnonzero(inside_the_body(HULL.box.centres(), HULL.box.voxel_m))
    kept = HULL.flat[HULL.in_light(TO_LIGHT).kept]
    assert np.isin(surely, kept).mean() > 0.99
    assert len(kept) < 0.35 * len(truth)


def test_the_true_light_explains_every_view_and_others_do_not() -> None:
    truth = HULL.in_light(TO_LIGHT)
    unlit = sum(np.count_nonzero(view.as_lit) for view in HULL.views)
    assert truth.cost / MOST_COST < 0.2 * unlit
    for azimuth, elevation in ((180, 40), (220, 40), (200, 60), (200, 27)):
        assert HULL.in_light(direction(azimuth, elevation)).cost > 1.3 * truth.cost


def test_a_shadow_beyond_all_that_is_seen_explains_nothing() -> None:
    flat = HULL.in_light(direction(200, 1.0))
    assert np.isfinite(flat.cost)
    assert flat.cost > HULL.in_light(TO_LIGHT).cost

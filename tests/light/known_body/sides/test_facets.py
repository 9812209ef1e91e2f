"""The light of a folded cube's sides, by Lambert's law of a painted one."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.sides.facets import OVER_SIGMA, Facets, facets_of
from ashe_live.light.known_body.table import linear_picture
from ashe_live.light.pixels.view import View
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, Folds, frame_of, looking, sun

DIRECT, SKY = 0.6, 0.3  # of level ground


def cube_in_view(scene: CubeScene) -> tuple[View, Proxy]:
    """Where the tracker finds it."""
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    assert tracked.marker is not None
    assert tracked.marker.body is not None
    return View.of(tracked, 640), tracked.marker.body


def seen_facets(scene: CubeScene) -> Facets:
    view, body = cube_in_view(scene)
    return facets_of(view, body, linear_picture(view))


@pytest.mark.parametrize(("azimuth_deg", "seed"), [(25, 0), (40, 1), (25, 2), (40, 3), (25, 4), (40, 5)])
def test_a_dark_side_is_not_taken_for_its_bright_neighbour(azimuth_deg: float, seed: int) -> None:
    """By hand no cube is folded so that no face reaches into another's outline."""
    folds = Folds.drawn(np.random.default_rng(seed), EDGE_M)
    # Both sides in view face away from the sun, and a black table sends them nothing: an even sky's half is left.
    light = sun(180 + azimuth_deg, 50, on_table=DIRECT)
    scene = CubeScene(
        CAMERA,
        looking(0.4, 55, azimuth_deg),
        [light],
        sky_rgb=np.full(3, SKY),
        folds=folds,
        table_rgb=np.full(3, 0.02),
        exposure=0.7,
        seed=seed,
    )
    facets = seen_facets(scene)
    level = facets.normals[:, 2] > 0.99
    relative = facets.light_rgb.mean(axis=1) / facets.light_rgb[level].mean()
    direct = float(light.irradiance_rgb.mean() * light.point[2])
    assert np.count_nonzero(~level) == 2
    assert relative[~level] == pytest.approx(np.full(2, 0.5 * SKY / (SKY + direct)), abs=0.04)


def half_lit(exposure: float) -> CubeScene:
    """A cube with one of the two sides in view in the sun."""
    light = sun(240, 50, on_table=DIRECT)
    return CubeScene(CAMERA, looking(0.4, 45, 30), [light], sky_rgb=np.full(3, SKY), exposure=exposure)


def relative_light(exposure: float) -> tuple[Float, bool, float]:
    """(2,) of a cube's two sides in view over its top's; whether that is overexposed; and how well it is told."""
    facets = seen_facets(half_lit(exposure))
    level = facets.normals[:, 2] > 0.99
    relative = facets.light_rgb[~level].mean(axis=1) / facets.light_rgb[level].mean()
    return relative, bool(facets.is_clipped[level].all()), facets.level_sigma


@pytest.mark.parametrize("exposure", [1.7, 2.0])
def test_an_overexposed_top_is_measured_by_its_ink(exposure: float) -> None:
    truth, is_clipped, sigma = relative_light(0.8)
    assert not is_clipped
    assert sigma == 0
    relative, is_clipped, sigma = relative_light(exposure)
    assert is_clipped
    as_shown = truth * exposure * 0.78  # over a top no brighter than the picture shows, of paper
    assert (np.abs(np.log(relative / truth)) < np.abs(np.log(as_shown / truth))).all()
    assert np.abs(np.log(relative / truth)).max() < 2 * sigma
    assert 0.1 < sigma < 0.4


def test_black_ink_bounds_an_overexposed_top_from_below_and_no_more() -> None:
    """As of cameras whose tones sink into black."""
    view, body = cube_in_view(half_lit(2.0))
    crushed = view.image_bgr.copy()
    crushed[crushed < 100] = 0
    facets = facets_of(view, body, linear_picture(replace(view, image_bgr=crushed)))
    level = facets.normals[:, 2] > 0.99
    assert facets.is_clipped[level].all()
    assert facets.light_rgb[level].mean() > 1
    _, _, by_ink = relative_light(2.0)
    assert by_ink < facets.level_sigma < OVER_SIGMA

"""Where a picture of a known body is looked at for the edges of shadows that are not known yet."""

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.painted_scene import hull_of
from ashe_live.bench.cube.painter import cast_on_table, projected
from ashe_live.core.arrays import Float
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.pixels.view import View
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, frame_of, looking, sun

LIGHT = sun(140, 40, on_table=0.6)
SCENE = CubeScene(CAMERA, looking(0.45, 50, 30), [LIGHT], seed=3)
PIXELS = np.stack(np.meshgrid(np.arange(0, 640, 2), np.arange(0, 480, 2)), axis=-1).reshape(-1, 2)


@pytest.fixture(scope="module")
def seen() -> Seen:
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED).track(frame_of(SCENE))
    body = tracked.pose.body
    assert body is not None
    found = Seen.of(View.of(tracked, 640), body)
    assert found is not None
    return found


def inside_px(points: Float) -> Float:
    """(n,) how far each of PIXELS lies within the hull of points, cube frame, as it is seen; negative beyond it."""
    hull = cv2.convexHull(projected(CAMERA, SCENE.T_cam_cube, points).astype(np.float32))
    return np.array([cv2.pointPolygonTest(hull, (float(x), float(y)), True) for x, y in PIXELS])


def test_the_body_and_the_edges_of_known_shadows_are_left_out_and_nothing_else(seen: Seen) -> None:
    photo, rims = seen.photos[0], seen.templates.rims
    everywhere, away = (
        photo.beside(rims, lights)[1][PIXELS[:, 1], PIXELS[:, 0]] for lights in (np.empty((0, 4)), LIGHT.point[None])
    )
    of_body, of_shadow = inside_px(hull_of(SCENE)), inside_px(cast_on_table(hull_of(SCENE), LIGHT.point))
    assert not everywhere[of_body > -1].any()
    assert everywhere[(of_body < -8) & (np.abs(of_shadow) < 2)].mean() > 0.9
    assert not away[np.abs(of_shadow) < 1.5].any()
    apart = np.abs(of_shadow) > 8
    assert np.array_equal(away[apart], everywhere[apart])


def test_a_light_that_casts_no_shadow_into_the_picture_hides_nothing(seen: Seen) -> None:
    photo, rims = seen.photos[0], seen.templates.rims
    below = np.array([[0.3, 0.2, -1.0, 0.0]])
    assert np.array_equal(photo.beside(rims, below)[1], photo.beside(rims, np.empty((0, 4)))[1])

"""A paper cube is covered, with its shadow, by ground like that around it; painted tables tell what is below."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre, direction_from_angles, project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.quality import FAST
from ashe_live.render.cover.cover_maker import NEARER
from ashe_live.render.cover.hidden_by_body import TURNED_RAD, half_of_square, hidden_and_shaded
from ashe_live.render.scene import Scene
from ashe_live.tracking.cube.faces import CORNERS
from ashe_live.viewer.display import cut_out
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, looking, painted, sun

BODY = Proxy("box", np.column_stack([EDGE_M * CORNERS, np.zeros((8, 2))]))
SUN_DEG = (200, 35)
LIT_BY = Illumination(
    (Light(direction_from_angles(*np.radians(SUN_DEG)), shadow_rgb_ratio=np.full(3, 0.3)),), real_object=BODY
)


def seen(T: Float) -> TrackedFrame:
    picture = painted(CubeScene(CAMERA, T, [sun(*SUN_DEG)]))
    base = EDGE_M / 2 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)], float)
    marker = MarkerPose(T, project(CAMERA, T, base), EDGE_M, 0.0, None, body=BODY)
    return TrackedFrame(Frame(picture, 0, 0.0), CAMERA, marker)


def bare(T: Float) -> Image:
    """The same table, on which stands what is too small to be seen."""
    return painted(CubeScene(CAMERA, T, [sun(*SUN_DEG)], edge_m=1e-4))


def differences(one: Image, other: Image) -> Float:
    """(h, w) CIE 1976 colour difference of what is alike after a blur: grain may lie elsewhere."""
    labs = [
        cv2.cvtColor(cv2.GaussianBlur(np.float32(each) / 255, (0, 0), 2), cv2.COLOR_BGR2LAB) for each in (one, other)
    ]
    return np.asarray(np.linalg.norm(labs[0] - labs[1], axis=2), dtype=np.float64)


def cube_and_shadow(tracked: TrackedFrame, table: Image) -> Mask:
    """(h, w) where the picture is not that of the bare table."""
    return np.asarray(differences(tracked.frame.image_bgr, table) > 8)


def far_away(stage):
    """Low, and beside all that is covered: a model must stand somewhere for anything to be drawn."""
    return stage.placed(box((0.004, 0.004, 0.002)).moved(1.0, np.array((-0.14, 0.14, 0.0))))


@pytest.mark.parametrize("turned_rad", [0.0, 0.8 * TURNED_RAD])
def test_cube_and_shadow_are_covered_also_while_the_camera_moves(make_renderer, stage, turned_rad: float) -> None:
    renderer = make_renderer(FAST.render, CAMERA.size)
    for azimuth_deg in (30.0, 30.0 + np.degrees(turned_rad)):
        T = looking(0.45, 45, azimuth_deg)
        tracked, table = seen(T), bare(T)
        renderer.render(Scene(tracked, far_away(stage), LIT_BY, covers_marker=True))
    there = cube_and_shadow(tracked, table)
    assert there.mean() > 0.02
    off = differences(renderer.read_bgr(), table)
    assert off[there].mean() < 3
    assert np.percentile(off[there], 99) < 8
    assert differences(tracked.frame.image_bgr, table)[there].mean() > 20


@pytest.mark.parametrize("tilt_deg", [5, 20, 40])
@pytest.mark.parametrize("distance_m", [0.25, 0.8])
def test_the_cover_reaches_as_far_as_the_cube_hides_ground_wherever_the_camera_turns(
    tilt_deg: float, distance_m: float
) -> None:
    """The higher the camera, the farther its azimuth goes around for the same turn."""
    T = looking(distance_m, tilt_deg, 30)
    marker = MarkerPose(T, np.zeros((4, 2)), EDGE_M, 0.0, None, body=BODY)
    half_m = half_of_square(marker, BODY, LIT_BY)
    _, covered = hidden_and_shaded(marker, BODY, LIT_BY, half_m, size := 300)
    away_m = float(np.linalg.norm(camera_centre(T)))
    towards = camera_centre(T) / away_m
    aside = np.cross(towards, (0, 0, 1)) / np.linalg.norm(np.cross(towards, (0, 0, 1)))
    for way in np.radians(np.arange(0, 360, 15)):
        turned = np.cos(way) * aside + np.sin(way) * np.cross(aside, towards)
        direction = np.cos(TURNED_RAD) * towards + np.sin(TURNED_RAD) * turned
        for eye in (away_m * direction, away_m / NEARER * direction):
            rays = EDGE_M * CORNERS - eye
            hidden = eye - rays * (eye[2] / rays[:, 2])[:, None]
            column, row = ((hidden[:, :2] * (1, -1) / half_m + 1) * size / 2).astype(int).T
            assert covered[row, column].all()


def test_what_is_covered_is_no_real_object() -> None:
    tracked = seen(looking(0.45, 45, 30))
    assert Scene(tracked, None, LIT_BY).real_object(has_cover=False) is BODY
    assert Scene(tracked, None, LIT_BY, covers_marker=True).real_object(has_cover=True) is None
    assert tracked.marker is not None
    flat = replace(tracked, marker=replace(tracked.marker, body=None))
    assert Scene(flat, None, LIT_BY, covers_marker=True).real_object(has_cover=True) is BODY


def test_until_it_is_covered_it_is_a_real_object_with_the_models_shadow_on_it(make_renderer, stage) -> None:
    renderer, tracked = make_renderer(FAST.render, CAMERA.size), seen(looking(0.45, 45, 30))
    # Towards the sun, so that its shadow falls onto the cube, whose upright sides take it.
    to_sun = direction_from_angles(*np.radians(SUN_DEG))
    aside = Placement(shift_m=tuple(1.3 * EDGE_M * to_sun[:2] / np.hypot(*to_sun[:2])))
    model = stage.placed(box((0.9 * EDGE_M,) * 3))
    pictures = []
    for covers in (False, True, True):
        scene = Scene(tracked, model, LIT_BY, placement=aside, covers_marker=covers)
        renderer.render(scene, waits=len(pictures) != 1)  # as a window does, while another thread makes the cover
        pictures.append(renderer.read_bgr())
    uncovered, being_covered, covered = pictures
    np.testing.assert_array_equal(being_covered, uncovered)
    assert (covered != uncovered).any(axis=2).mean() > 0.02


def test_a_model_alone_is_cut_out_whole_in_the_place_of_the_covered_cube(make_renderer, stage) -> None:
    """Though the cover, which would hide the model's shadow once it is put over that, is left out."""
    renderer, tracked = make_renderer(FAST.render, CAMERA.size), seen(looking(0.45, 45, 30))
    model = stage.placed(box((0.3 * EDGE_M,) * 3))
    inside = []
    for lit_by in (LIT_BY, replace(LIT_BY, real_object=None)):
        renderer.render(cut_out(Scene(tracked, model, lit_by, covers_marker=True, casts_shadow=False)))
        # Within its rim, which is as transparent as its brightness allows.
        inside.append(cv2.erode(np.uint8(renderer.read_bgra()[..., 3] == 255), np.ones((5, 5))))
    assert inside[1].sum() > 300
    np.testing.assert_array_equal(*inside)


def test_where_no_ground_is_seen_nothing_is_covered(make_renderer, stage) -> None:
    tracked = seen(looking(0.45, 45, 30))
    rows = slice(200, 280)  # nothing but the cube
    K = tracked.camera.K.copy()
    K[:2, 2] -= 280, 200
    near = replace(
        tracked,
        frame=replace(tracked.frame, image_bgr=np.ascontiguousarray(tracked.frame.image_bgr[rows, 280:360])),
        camera=replace(tracked.camera, size=(80, 80), K=K),
    )
    renderer = make_renderer(FAST.render, (80, 80))
    renderer.render(Scene(near, far_away(stage), LIT_BY, covers_marker=True))
    np.testing.assert_array_equal(renderer.read_bgr(), near.frame.image_bgr)

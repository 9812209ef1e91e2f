"""The paper's segmentation, step by step."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.core.camera import Camera
from ashe_live.light.paper import masks
from ashe_live.light.paper.geometry import cube_corners
from tests.light.painted_scenes import overlap


def disc(shape, centre, radius):
    rows, columns = np.indices(shape)
    return (rows - centre[1]) ** 2 + (columns - centre[0]) ** 2 <= radius**2


@given(st.tuples(st.integers(20, 5000), st.integers(20, 5000)))
def test_the_working_size_fits_and_keeps_the_aspect_ratio(size):
    width, height = masks.working_size(size, (640, 480))
    assert width <= 640
    assert height <= 480
    assert width == 640 or height == 480
    if min(width, height) >= 16:
        Camera.from_hfov(size, 60).resized((width, height))


def test_the_darkest_clusters_are_the_shadow(scene):
    image = scene.tracked.frame.image_bgr
    ink = (image < 40).all(axis=2)
    dark = masks.darkest_clusters(image, masks.lab_clusters(image), ~ink)
    assert overlap(dark, scene.shadow) > 0.97


@pytest.mark.parametrize("level", [0, 90, 255])
def test_a_picture_of_one_colour_has_no_shadow(level):
    image = np.full((60, 80, 3), level, np.uint8)
    assert not masks.darkest_clusters(image, masks.lab_clusters(image), np.ones((60, 80), bool)).any()


def test_clusters_do_not_depend_on_what_was_drawn_before(scene):
    image = scene.tracked.frame.image_bgr
    first = masks.lab_clusters(image)
    cv2.setRNGSeed(99)
    np.testing.assert_array_equal(masks.lab_clusters(image), first)


def test_grabcut_takes_what_stands_out_of_the_ground(paint_scene):
    small = paint_scene(size=(160, 120))
    foreground = masks.grabcut_foreground(small.tracked.frame.image_bgr, iterations=3)
    assert np.count_nonzero(foreground & small.box) / np.count_nonzero(small.box) > 0.95
    assert np.count_nonzero(foreground) < 0.4 * foreground.size


@given(st.floats(1, 500), st.floats(1, 500), st.floats(1, 1e5), st.floats(1, 1e5))
def test_the_score_prefers_the_near_and_the_large(d1, d2, a1, a2):
    near, far = sorted((d1, d2))
    small, large = sorted((a1, a2))
    assert masks.association_score(near, large, 100) <= masks.association_score(far, large, 100)
    assert masks.association_score(near, large, 100) <= masks.association_score(near, small, 100)


def test_the_score_stays_finite_at_any_distance():
    assert np.isfinite(masks.association_score(1e6, 1e3, 1.0))


def test_the_near_and_large_shadow_is_the_objects_own():
    shape = (200, 300)
    thing, near, speck, far = (
        disc(shape, c, r) for c, r in [((60, 80), 20), ((110, 80), 15), ((85, 110), 1), ((250, 80), 15)]
    )
    found = masks.shadow_of(thing, near | speck | far, smallest_px=20)
    np.testing.assert_array_equal(found, near)
    assert masks.shadow_of(thing, speck, smallest_px=20) is None


def test_the_object_is_the_largest_region_that_is_neither_shadow_nor_virtual():
    shape = (200, 300)
    thing, cube, shadow = disc(shape, (60, 80), 20), disc(shape, (200, 80), 50), disc(shape, (100, 150), 30)
    foreground = thing | cube | shadow | disc(shape, (280, 190), 5)
    np.testing.assert_array_equal(masks.largest_object(foreground, shadow, cube, 20), thing)
    assert masks.largest_object(shadow | cube, shadow, cube, 20) is None


def test_the_virtual_mask_has_its_hulls_area(scene):
    camera, pose = scene.tracked.camera, scene.tracked.marker
    hull = masks.hull_of_points(camera, pose.T_cam_marker, cube_corners(pose.side_m))
    area = cv2.contourArea(hull.astype(np.float32))
    # Drawn polygons own their outline: half its length more.
    outline = cv2.arcLength(hull.astype(np.float32), True)
    assert area <= masks.filled(hull, camera.size).sum() <= area + outline


def test_a_cube_behind_the_camera_has_no_hull(pose_above):
    camera = Camera.from_hfov((640, 480), 60)
    assert masks.hull_of_points(camera, pose_above((0.0, -0.03, 0.05)), cube_corners(0.08)) is None


def test_a_hull_far_outside_is_not_in_the_picture():
    assert not masks.filled(np.array([[1e9, 1e9], [2e9, 1e9], [1e9, 2e9]]), (64, 48)).any()


def test_the_centre_of_mass_of_a_disc_is_its_centre():
    np.testing.assert_allclose(masks.centre_of_mass(disc((100, 100), (40, 60), 20)), (40, 60))

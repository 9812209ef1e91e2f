"""Reading pictures with a known light."""

import json

import cv2
import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.core.transforms import angle_between
from ashe_live.errors import UserError
from tests.bench.scene_files import scene, written
from tests.shared_data import shared_folder
from tests.shipped_scenes import CASES


def test_a_scene_with_only_what_every_folder_has(tmp_path):
    cv2.imwrite(str(tmp_path / "one.png"), np.zeros((48, 64, 3), np.uint8))
    (case,) = read_cases(written(tmp_path, {"scenes": [scene()]}))
    assert case.marker.reprojection_rms_px == pytest.approx(0, abs=1e-9)
    np.testing.assert_array_equal(case.to_lights_marker, [[0, 0.6, 0.8]])
    assert case.mask_paths == {}
    tracked = case.tracked(4)
    assert tracked.frame.index == 4
    assert tracked.marker is case.marker


def test_no_lights_means_none_and_not_unknown(tmp_path):
    (case,) = read_cases(written(tmp_path, {"scenes": [scene(lights=[], masks={"object": "o.png"})]}))
    assert case.to_lights_marker.shape == (0, 3)
    assert case.mask_paths == {"object": tmp_path / "o.png"}


def test_a_photo_without_a_known_sun_is_unknown(tmp_path):
    photo = {"size": [640, 480], "f_px": 500, "corners_px": [[300, 200], [340, 200], [340, 240], [300, 240]]}
    known = photo | {"to_light_marker": [0, 0, 1]}
    content = {"marker": {"side_units": 1.0}, "photos": {"a.jpg": photo, "b.jpg": known}}
    unknown, case = read_cases(written(tmp_path, content))
    assert unknown.to_lights_marker is None
    np.testing.assert_array_equal(case.to_lights_marker, [[0, 0, 1]])
    assert case.marker.T_cam_marker[2, 3] == pytest.approx(12.5, rel=1e-3)


@pytest.mark.parametrize("content", [{"scenes": [{"id": 1}]}, [], {"scenes": [scene(K=[[1]])]}, {"photos": {"a": 1}}])
def test_what_is_no_ground_truth_is_said_to_be_none(tmp_path, content):
    with pytest.raises(UserError, match=r"ground_truth\.json"):
        read_cases(written(tmp_path, content))


def test_an_empty_folder_is_said_to_be_one(tmp_path):
    with pytest.raises(UserError, match="there is no file"):
        read_cases(tmp_path)


def test_a_missing_picture_is_named(tmp_path):
    (case,) = read_cases(written(tmp_path, {"scenes": [scene()]}))
    with pytest.raises(UserError, match=r"one\.png"):
        case.tracked()


@pytest.mark.parametrize("folder", ["paper_scenes", "scenes", "real"])
def test_the_shared_sets_explain_their_corners(folder):
    cases = read_cases(shared_folder(folder))
    truth = json.loads((shared_folder(folder) / "ground_truth.json").read_text(encoding="utf-8"))
    assert len(cases) == len(truth.get("scenes", truth.get("photos")))
    for case in cases:
        assert case.image_path.exists()
        assert all(path.exists() for path in case.mask_paths.values())
        # Stated poses explain stated corners to their rounding; corners of photos were clicked on curled paper.
        assert case.marker.reprojection_rms_px < (3.0 if folder == "real" else 0.01)


@pytest.mark.parametrize("name", CASES)
def test_the_shipped_scenes_explain_their_corners_and_have_their_masks(name):
    case = CASES[name]
    assert case.marker.reprojection_rms_px < 0.01
    masks = [case.mask(mask) for mask in case.mask_paths]
    assert masks
    assert all(mask.shape == case.camera.size[::-1] and mask.any() for mask in masks)


def test_two_photos_of_one_cup_see_the_sun_from_the_same_side():
    cases = {case.image_path.name: case for case in read_cases(shared_folder("real"))}
    suns = [cases[name].to_lights_marker[0] for name in ("real_2_3.jpeg", "img_extobj_5.jpeg")]
    assert np.degrees(angle_between(*suns)) < 3


def test_a_scene_without_lights_is_dark_only_if_it_says_so(tmp_path):
    told = {key: value for key, value in scene().items() if key not in ("lights", "dist")}
    (unknown,) = read_cases(written(tmp_path, {"scenes": [told]}))
    assert unknown.to_lights_marker is None
    (dark,) = read_cases(written(tmp_path, {"scenes": [told | {"directional": False}]}))
    assert dark.to_lights_marker.shape == (0, 3)


def test_corners_that_are_not_stated_are_projected(tmp_path):
    stated = scene()
    (case,) = read_cases(written(tmp_path, {"scenes": [stated | {"marker": {"side_m": 0.2}}]}))
    np.testing.assert_allclose(case.marker.corners_px, stated["marker"]["corners_px"])


def test_the_strongest_light_comes_first(tmp_path):
    lights = [{"dir_to_light": [1, 0, 0], "relative_strength": 0.4}, {"dir_to_light": [0, 0, 1]}]
    (case,) = read_cases(written(tmp_path, {"scenes": [scene(lights=lights)]}))
    np.testing.assert_array_equal(case.to_lights_marker, [[0, 0, 1], [1, 0, 0]])


def test_masks_are_read_by_name(tmp_path):
    cv2.imwrite(str(tmp_path / "o.png"), np.array([[0, 255]], np.uint8))
    (case,) = read_cases(written(tmp_path, {"scenes": [scene(masks={"object": "o.png", "shadow": "gone.png"})]}))
    np.testing.assert_array_equal(case.mask("object"), [[False, True]])
    assert case.mask("clutter") is None
    with pytest.raises(UserError, match=r"gone\.png"):
        case.mask("shadow")


def test_a_lamp_has_a_place(tmp_path):
    lamp = {"dir_to_light": [0, 0.6, 0.8], "lamp": {"position_m": [0, 0.3, 0.4]}, "relative_strength": 0.9}
    sun = {"dir_to_light": [0, 0, 1], "relative_strength": 0.5}
    several = [scene(lights=[sun, lamp], caster={"type": "box", "base_xy_m": [0.1, 0.2]}), scene(lights=[sun])]
    near, far = read_cases(written(tmp_path, {"scenes": several}))
    np.testing.assert_array_equal(near.lamp_m, [0, 0.3, 0.4])
    np.testing.assert_array_equal(near.foot_m, [0.1, 0.2])
    assert (far.lamp_m, far.foot_m) == (None, None)

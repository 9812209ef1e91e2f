"""Whose an error is: masks beside the true ones, and what the estimator makes of those."""

import dataclasses

import cv2
import numpy as np
import pytest

from ashe_live.bench.cases import Case
from ashe_live.bench.light.truth import error_on_true_labels_deg, mask_overlaps
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.types import MarkerPose
from ashe_live.light.estimators.preset import BALANCED
from tests.light.synthetic_masks import box, camera_towards, direction, render

LIGHT = direction(200.0, 40.0)
VIEW = camera_towards((0.08, 0.0), 0.5, 35.0)


@pytest.fixture
def scene():
    return render(box(0.1, 0.02, (0.06, 0.04, 0.08), 25.0), [LIGHT], VIEW)


@pytest.fixture
def case(scene, tmp_path):
    masks = {"object": scene.body, "shadow": scene.shadows[0]}
    paths = {name: tmp_path / f"{name}.png" for name in masks}
    for name, mask in masks.items():
        cv2.imwrite(str(paths[name]), (np.asarray(mask) > 0.5).astype(np.uint8) * 255)
    picture = np.full((*scene.body.shape, 3), 150.0)
    picture[scene.shadows[0]] = 70
    picture[scene.body] = (40, 80, 190)
    picture += np.random.default_rng(0).normal(0, 2, picture.shape)
    cv2.imwrite(str(tmp_path / "a.png"), np.clip(picture, 0, 255).astype(np.uint8))
    pose = MarkerPose(scene.T_cam_marker, np.zeros((4, 2)), 0.08, 0.0, None)
    return Case("a", "set", "clean", "box", tmp_path / "a.png", scene.camera, pose, LIGHT[None], paths)


def halved(mask):
    height, width = mask.shape
    return cv2.resize((np.asarray(mask) > 0.5).astype(np.uint8), (width // 2, height // 2)).astype(bool)


def test_masks_of_another_size_are_compared_all_the_same(scene, case):
    body, shadow = halved(scene.body), halved(scene.shadows[0])
    right = mask_overlaps(LightEstimate("e", 0, Illumination(), "-", body, shadow), case)
    exchanged = mask_overlaps(LightEstimate("e", 0, Illumination(), "-", shadow, body), case)
    assert min(right) > 0.9
    assert max(exchanged) < 0.1
    assert mask_overlaps(LightEstimate("e", 0, Illumination(), "-"), case) == (None, None)
    unknown = dataclasses.replace(case, mask_paths={})
    assert mask_overlaps(LightEstimate("e", 0, Illumination(), "-", body, shadow), unknown) == (None, None)


@pytest.mark.parametrize("width", [213, 333, 431])
def test_true_labels_of_another_size_lie_where_the_true_ones_do(scene, case, tmp_path, width):
    height, whole = scene.body.shape
    size = width, round(height * width / whole)
    masks = [np.asarray(mask, np.float32) for mask in (scene.body, scene.shadows[0])]
    found = [cv2.resize(mask, size, interpolation=cv2.INTER_AREA) > 0.5 for mask in masks]
    estimate = LightEstimate("e", 0, Illumination(), "-", *found)
    paths = {name: tmp_path / f"moved_{name}.png" for name in case.mask_paths}
    for by in (-1, 1):
        for path, mask in zip(paths.values(), masks, strict=True):
            cv2.imwrite(str(path), np.roll(mask > 0.5, (by, by), axis=(0, 1)).astype(np.uint8) * 255)
        moved = mask_overlaps(estimate, dataclasses.replace(case, mask_paths=paths))
        assert np.subtract(mask_overlaps(estimate, case), moved).min() > 0


def test_true_labels_leave_only_the_geometrys_error(case):
    assert error_on_true_labels_deg(case, case.tracked(), BALANCED) < 1.0


def test_a_light_elsewhere_is_as_wrong_as_it_is_far(case):
    other = dataclasses.replace(case, to_lights_marker=direction(200.0, 60.0)[None])
    assert error_on_true_labels_deg(other, case.tracked(), BALANCED) == pytest.approx(20, abs=1)


def test_of_two_lights_the_error_is_that_of_the_strongest(case, monkeypatch):
    found = [direction(200.0, 47.0), direction(110.0, 50.0)]
    monkeypatch.setattr("ashe_live.bench.light.truth.directions_from_labels", lambda *_: found)
    both = dataclasses.replace(case, to_lights_marker=np.array([LIGHT, found[1]]))
    assert error_on_true_labels_deg(both, case.tracked(), BALANCED) == pytest.approx(7)


def test_without_masks_or_light_there_is_no_such_error(case):
    for name in case.mask_paths:
        alone = dataclasses.replace(case, mask_paths={name: case.mask_paths[name]})
        assert error_on_true_labels_deg(alone, case.tracked(), BALANCED) is None
    for lights in (np.empty((0, 3)), None):
        dark = dataclasses.replace(case, to_lights_marker=lights)
        assert error_on_true_labels_deg(dark, case.tracked(), BALANCED) is None


def test_shadows_of_other_objects_are_not_the_main_ones(scene, case, tmp_path):
    """Of two lights, each with a mask of all shadows and one of the object's own."""
    own = np.asarray(scene.shadows[0]) > 0.5
    paths = dict(case.mask_paths)
    for name in ("shadow", "shadow2", "shadow_caster", "shadow2_caster"):
        paths[name] = tmp_path / f"{name}.png"
        mask = own if name.endswith("_caster") else own | np.roll(own, 30, axis=1)
        cv2.imwrite(str(paths[name]), mask.astype(np.uint8) * 255)
    beside = dataclasses.replace(case, mask_paths=paths)
    found = LightEstimate("e", 0, Illumination(), "-", np.asarray(scene.body) > 0.5, own)
    assert mask_overlaps(found, beside)[1] == 1

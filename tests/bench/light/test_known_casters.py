"""The scenes' own boxes, cylinders and spheres, from the generator's specifications or from bounding boxes."""

import json
import math

import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.bench.light.bench import LightBench
from ashe_live.bench.light.known_casters import caster_specs, with_known_casters
from ashe_live.core.caster import parsed_caster
from ashe_live.errors import UserError
from tests.bench.scene_files import scene, written
from tests.light.synthetic_masks import box

SPECIFIED = {
    "carton": ({"size_m": [0.06, 0.04, 0.1], "bevel_m": 0.003}, "box:0.06x0.04x0.1"),
    "book": ({"size_m": [0.15, 0.1, 0.02], "standing": False}, "box:0.15x0.1x0.02"),
    "tin": ({"above_m": 0.03, "height_m": 0.1}, "cylinder:0.03x0.1"),
    "ball": ({"radius_m": 0.025, "flatten": 1.0}, "sphere:0.025"),
    "cup": ({"above_m": 0.03}, None),
}


@pytest.mark.parametrize("family", SPECIFIED)
def test_a_specified_object_is_what_a_person_would_measure(tmp_path, family):
    params, spec = SPECIFIED[family]
    other = {"family": "tin", "params": {"above_m": 0.01, "height_m": 0.02}, "role": "clutter"}
    caster = {"family": family, "params": params, "role": "caster"}
    content = {"scenes": [{"objects": [other, caster], "pictures": [{"id": "a_0"}, {"id": "a_1"}]}]}
    (tmp_path / "specifications.json").write_text(json.dumps(content))
    found = caster_specs(tmp_path)
    if spec is None:
        assert found == {}
    else:
        assert {id_: parsed_caster(each) for id_, each in found.items()} == dict.fromkeys(
            ("a_0", "a_1"), parsed_caster(spec)
        )


def test_a_standing_book_is_as_high_as_it_is_long_across_its_back(tmp_path):
    caster = {"family": "book", "params": {"size_m": [0.15, 0.1, 0.02], "standing": True}, "role": "caster"}
    content = {"scenes": [{"objects": [caster], "pictures": [{"id": "a"}]}]}
    (tmp_path / "specifications.json").write_text(json.dumps(content))
    assert parsed_caster(caster_specs(tmp_path)["a"]).height_m == pytest.approx(0.1)


@pytest.mark.parametrize("yaw_deg", [0.0, 20.0, 70.0, 110.0, 200.0, 44.0])
def test_a_box_follows_from_its_bounds_unless_it_stands_half_way_between_two_sides(tmp_path, yaw_deg):
    (corners,) = box(0.1, 0.2, (0.06, 0.04, 0.1), yaw_deg)
    caster = {
        "type": "box",
        "yaw_deg": yaw_deg,
        "bbox_min_m": corners.min(axis=0).tolist(),
        "bbox_max_m": corners.max(axis=0).tolist(),
    }
    (tmp_path / "ground_truth.json").write_text(json.dumps({"scenes": [{"id": "a", "caster": caster}, {"id": "b"}]}))
    found = caster_specs(tmp_path)
    if yaw_deg == 44.0:
        assert found == {}
        return
    extent = np.ptp(np.array(parsed_caster(found["a"]).spheroids)[:, :3], axis=0)
    np.testing.assert_allclose(extent, (0.06, 0.04, 0.1), atol=2e-5)


def test_folders_of_one_name_each_have_their_casters(tmp_path):
    bounds = {"yaw_deg": 0.0, "bbox_min_m": [-0.03, -0.03, 0.0], "bbox_max_m": [0.03, 0.03, 0.06]}
    folders = [tmp_path / part / "sealed" for part in ("first", "second")]
    for folder in folders:
        folder.mkdir(parents=True)
        written(folder, {"scenes": [scene(id=folder.parent.name, caster={"type": "sphere"} | bounds)]})
    cases = [case for folder in folders for case in read_cases(folder)]
    assert [case.id for case, _ in with_known_casters(cases, folders)] == ["first", "second"]


def test_a_folder_without_scenes_is_said(tmp_path):
    with pytest.raises(UserError):
        caster_specs(tmp_path)


def test_the_bench_tries_them_only_where_it_can(tmp_path):
    with pytest.raises(UserError, match="no use of known casters"):
        LightBench([tmp_path], "paper", casters=True).run()


def test_bounds_of_balls_and_tins(tmp_path):
    bounds = {"yaw_deg": 30.0, "bbox_min_m": [-0.03, -0.03, 0.0], "bbox_max_m": [0.03, 0.03, 0.06]}
    scenes = [{"id": kind, "caster": {"type": kind, **bounds}} for kind in ("cylinder", "sphere", "mug")]
    (tmp_path / "ground_truth.json").write_text(json.dumps({"scenes": scenes}))
    found = {id_: parsed_caster(spec) for id_, spec in caster_specs(tmp_path).items()}
    assert set(found) == {"cylinder", "sphere"}
    assert math.isclose(found["cylinder"].radius_m, 0.03)
    assert math.isclose(found["sphere"].radius_m, 0.03)

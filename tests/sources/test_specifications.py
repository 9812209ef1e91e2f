"""Scenes as drawn: the same from the same seed, of the families and within the ranges that are named, and usable."""

import json
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scenes.drawing import cubes, families
from scenes.drawing.families import HELD_OUT
from scenes.drawing.layout import LIGHTS, MARGIN_PX
from scenes.drawing.motion import FRAMES
from scenes.geometry.poses import cast, direction, projected, share_in_frame, square
from scenes.geometry.shapes import FAMILIES, built, placed_points
from scenes.specify import SETS, main, onto_marker, specification

COUNT = 60


@pytest.fixture(scope="module")
def training() -> list[dict[str, Any]]:
    return [specification("training", index) for index in range(COUNT)]


@pytest.fixture(scope="module")
def sealed() -> list[dict[str, Any]]:
    return [specification("sealed", index) for index in range(COUNT)]


def pictures(scenes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [picture for scene in scenes for picture in scene["pictures"]]


def object_families(scenes: list[dict[str, Any]]) -> set[str]:
    return {each["family"] for scene in scenes for each in scene["objects"] if each["role"] != "outside"}


def test_single_scenes_of_a_set_are_those_of_the_whole(
    training: list[dict[str, Any]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["specify", "--set", "training", "--scenes", "9", "4", "--out", str(tmp_path)])
    main()
    drawn = json.loads((tmp_path / "specifications.json").read_text())["scenes"]
    assert drawn == json.loads(json.dumps([training[9], training[4]]))


def test_a_scene_depends_on_its_set_and_index_alone(training: list[dict[str, Any]]) -> None:
    again = specification("training", 7)
    assert json.dumps(again) == json.dumps(training[7])
    assert json.dumps(specification("development", 7)) != json.dumps(again)


def test_a_specification_survives_json(training: list[dict[str, Any]]) -> None:
    assert json.loads(json.dumps(training[3])) == training[3]


def test_sets_have_seeds_of_their_own() -> None:
    assert len({each.seed for each in SETS.values()}) == len(SETS)


@pytest.mark.parametrize("name", [name for name, each in SETS.items() if not each.sealed])
def test_held_out_families_are_drawn_only_for_sealed_sets(name: str) -> None:
    scenes = [specification(name, index) for index in range(10)]
    assert not object_families(scenes) & set(HELD_OUT["object"])
    assert not {scene["ground"]["family"] for scene in scenes} & set(HELD_OUT["ground"])


def test_most_sealed_scenes_show_what_the_other_sets_lack(sealed: list[dict[str, Any]]) -> None:
    assert object_families(sealed) >= set(HELD_OUT["object"])
    assert {scene["ground"]["family"] for scene in sealed} >= set(HELD_OUT["ground"])
    unseen = [
        scene["ground"]["family"] in HELD_OUT["ground"] or bool(object_families([scene]) & set(HELD_OUT["object"]))
        for scene in sealed
    ]
    assert np.mean(unseen) > 0.7


def test_held_out_families_can_be_drawn_nowhere_else() -> None:
    assert not set(families.OBJECTS) & set(HELD_OUT["object"])
    assert not set(families.GROUNDS) & set(HELD_OUT["ground"])


def test_every_category_and_most_families_come_up(training: list[dict[str, Any]]) -> None:
    more = training + [specification("training", index) for index in range(COUNT, 2 * COUNT)]
    drawn = [picture["category"] for picture in pictures(more)]
    wanted = ("clean", "texture", "clutter", "soft", "low", "high", "two", "diffuse", "dark", "partial", "misleading")
    assert set(drawn) == set(wanted)
    assert 0.07 < drawn.count("misleading") / len(drawn) < 0.17
    assert {scene["ground"]["family"] for scene in more} == set(families.GROUNDS)
    assert len(object_families(more)) > 0.8 * len(families.OBJECTS)
    cameras = [picture["camera"]["family"] for picture in pictures(more)]
    assert set(cameras) == set(families.CAMERAS)
    assert 0.5 < np.mean([camera.startswith("phone") for camera in cameras]) < 0.7


def test_numbers_lie_within_the_named_ranges(training: list[dict[str, Any]]) -> None:
    for scene in training:
        assert 40 <= scene["camera"]["hfov_deg"] <= 80
        assert 15 <= scene["camera"]["pitch_deg"] <= 80
        assert 0.2 < np.linalg.norm(scene["camera"]["t"]) < 1.0
        assert len(scene["lights"]) == LIGHTS
        for light in scene["lights"]:
            low, high = {"low": (8, 20), "high": (75, 89)}.get(light["kind"], (20, 75))
            assert low <= light["elevation_deg"] <= high
            assert (light["angular_diameter_deg"] >= 3) == (light["kind"] == "soft")


def test_marker_and_object_are_in_the_picture_and_apart(training: list[dict[str, Any]]) -> None:
    for scene in training:
        paper = square(scene["marker"]["paper_side_m"])
        assert share_in_frame(scene["camera"], paper, scene["size"], MARGIN_PX) == 1
        for each in scene["objects"]:
            if each["role"] == "caster" and scene["partial_kind"] != "object_out":
                points = placed_points(each, scene["ground"]["z_m"])
                assert share_in_frame(scene["camera"], points, scene["size"]) == 1
                assert np.linalg.norm(points[:, :2], axis=1).min() > scene["marker"]["side_m"] / 2


def test_the_answer_is_the_lights_that_shine_but_for_misleading_pictures(
    training: list[dict[str, Any]],
) -> None:
    for scene in training:
        for picture in scene["pictures"]:
            shining = picture["lights"] + picture["unseen_lights"]
            assert len(picture["gains"]) == len(shining)
            assert len(shining) == {"two": 2, "diffuse": 0}.get(picture["category"], len(shining))
            if picture["category"] == "misleading":
                assert not picture["lights"]
                assert scene["patches"] or any(each["role"] == "outside" for each in scene["objects"])


def test_nothing_in_view_throws_a_shadow_where_no_light_is_to_be_answered() -> None:
    beside_a_shadow_from_outside = [specification("training", index) for index in (176, 270, 274)]
    for scene in beside_a_shadow_from_outside:
        assert scene["without_object"]
        assert [each["role"] for each in scene["objects"]] == ["outside"]


def test_cells_of_a_marker_are_those_that_opencv_draws(training: list[dict[str, Any]]) -> None:
    for scene in training[:10]:
        sheet = scene["marker"]
        cells = np.kron(np.array(sheet["cells"], np.uint8) * 255, np.ones((12, 12), np.uint8))
        picture = cv2.copyMakeBorder(cells, 24, 24, 24, 24, cv2.BORDER_CONSTANT, value=255)
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, sheet["dictionary"]))
        ids = cv2.aruco.ArucoDetector(dictionary).detectMarkers(picture)[1]
        assert ids is not None
        assert np.ravel(ids).tolist() == [sheet["id"]]


@pytest.mark.parametrize("family", [*families.OBJECTS, *HELD_OUT["object"]])
def test_objects_stand_on_the_ground_and_have_triangles_with_an_area(family: str) -> None:
    for seed in range(4):
        parts = built(family, families.object_params(np.random.default_rng(seed), family))
        points = np.concatenate([part.points for part in parts])
        assert points[:, 2].min() == pytest.approx(0, abs=2e-3)
        assert 0.01 < points[:, 2].max() < 0.3
        for part in parts:
            a, b, c = (part.points[part.faces[:, k]] for k in range(3))
            assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() > 0


def test_every_family_of_objects_is_either_drawn_or_held_out_or_outside() -> None:
    assert set(FAMILIES) == {*families.OBJECTS, *HELD_OUT["object"], "slab", "foliage", "person", cubes.FAMILY}


def test_shadows_of_points_by_sun_and_lamp() -> None:
    point = np.array([[0.1, -0.05, 0.08]])
    sun = {"azimuth_deg": 30.0, "elevation_deg": 40.0}
    fallen = cast(point, sun, -0.002)
    assert fallen[0, 2] == pytest.approx(-0.002)
    away = point[0] - fallen[0]
    np.testing.assert_allclose(away / np.linalg.norm(away), direction(30, 40), atol=1e-12)
    lamp = {"position_m": [0.4, 0.3, 0.5]}
    fallen = cast(point, lamp, 0.0)
    # The lamp, the point and its shadow lie on one line.
    assert np.linalg.norm(np.cross(point[0] - lamp["position_m"], fallen[0] - lamp["position_m"])) < 1e-12
    assert fallen[0, 2] == pytest.approx(0)


def test_poses_are_opencvs() -> None:
    scene = specification("training", 1)
    camera = scene["camera"]
    pixels, _ = cv2.projectPoints(
        square(0.07), cv2.Rodrigues(np.array(camera["R"]))[0], np.array(camera["t"]), np.array(camera["K"]), None
    )
    np.testing.assert_allclose(projected(camera, square(0.07))[0], pixels.reshape(-1, 2), atol=1e-4)
    assert np.linalg.det(camera["R"]) == pytest.approx(1, abs=1e-6)


def test_lamps_stand_above_all_objects_and_near_by() -> None:
    for index in range(12):
        scene = specification("near_training", index)
        assert 1 <= sum(each["role"] != "outside" for each in scene["objects"]) <= 3
        lamps = [light for light in scene["lights"] if light["kind"] == "lamp"]
        assert len(lamps) == LIGHTS - 1
        for lamp in lamps:
            assert 0.2 <= np.linalg.norm(lamp["position_m"]) <= 3.001
            assert 0.005 <= lamp["radius_m"] <= 0.06
            assert lamp["position_m"][2] > max(each.get("height_m", 0) for each in scene["objects"])
            assert share_in_frame(scene["camera"], [lamp["position_m"]], scene["size"]) == 0


def test_takes_turn_by_their_span_and_keep_the_marker_in_view() -> None:
    spans = []
    for index in range(5):
        scene = specification("takes_training", index)
        assert len(scene["frames"]) == FRAMES
        spans.append(scene["span_deg"])
        for pose in scene["frames"]:
            np.testing.assert_allclose(np.array(pose["R"]) @ np.array(pose["R"]).T, np.eye(3), atol=1e-7)
            corners = square(scene["marker"]["side_m"])
            assert share_in_frame(scene["camera"] | pose, corners, scene["size"]) == 1
    np.testing.assert_allclose(spans, [3, 6, 12, 25, 40], rtol=0.5)
    assert np.all(np.diff(spans) > 0)


def test_fewer_frames_of_a_take_span_as_much(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []
    for given in ([], ["--frames", "4"]):
        arguments = ["specify", "--set", "takes_training", "--scenes", "3", *given, "--out", str(tmp_path)]
        monkeypatch.setattr(sys, "argv", arguments)
        main()
        drawn.append(json.loads((tmp_path / "specifications.json").read_text())["scenes"][0])
    whole, fewer = drawn
    numbers = [whole["frames"].index(frame) for frame in fewer["frames"]]
    assert numbers[0] == 0
    assert numbers[-1] == FRAMES - 1
    gaps = np.diff(numbers)
    assert len(gaps) == 3
    assert gaps.max() - gaps.min() <= 1
    assert {**whole, "frames": None} == {**fewer, "frames": None}


@pytest.mark.parametrize("asked", [("takes_training", "1"), ("takes_training", "13"), ("training", "4")])
def test_frames_are_a_takes_and_at_least_two(
    asked: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name, frames = asked
    monkeypatch.setattr(
        sys, "argv", ["specify", "--set", name, "--scenes", "3", "--frames", frames, "--out", str(tmp_path / "set")]
    )
    with pytest.raises(SystemExit):
        main()
    assert not (tmp_path / "set").exists()


def test_onto_the_marker_falls_the_shadow_of_the_objects_top(training: list[dict[str, Any]]) -> None:
    shaded = [scene for each in training if (scene := onto_marker(each)) is not None]
    assert len(shaded) > 3
    for scene in shaded:
        (caster,), light = scene["objects"], scene["lights"][0]
        to_light = direction(light["azimuth_deg"], light["elevation_deg"])
        top = np.array([*caster["xy_m"], caster["height_m"]])
        end = top - to_light * (top[2] / to_light[2])
        assert np.abs(end[:2]).max() < scene["marker"]["side_m"] / 2
        assert [picture["lights"] for picture in scene["pictures"]] == [[0]]


def test_a_light_that_was_moved_onto_the_marker_is_neither_low_nor_high() -> None:
    high = specification("training", 44)
    scene = onto_marker(high)
    assert scene is not None
    assert (high["lights"][0]["kind"], high["pictures"][0]["category"]) == ("high", "high")
    assert 20 < scene["lights"][0]["elevation_deg"] < 75
    assert (scene["lights"][0]["kind"], scene["pictures"][0]["category"]) == ("plain", scene["base"])


def test_a_lamp_is_not_moved_onto_the_marker() -> None:
    assert all(onto_marker(specification("near_training", index)) is None for index in range(8))

"""Every kind of record that leaves the program validates against the published schema."""

import dataclasses
import json
import math

import jsonschema
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.contract import (
    FileRecord,
    Json,
    estimated_light_json,
    light_by_hand_json,
    light_json,
    marker_json,
    snapshot_json,
)
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from tests.checkout import CHECKOUT

SCHEMA = json.loads((CHECKOUT / "docs" / "contract.schema.json").read_text(encoding="utf-8"))
POSE = MarkerPose(np.eye(4), np.zeros((4, 2)), 0.08, 0.2, None)
CAMERA = Camera.from_hfov((640, 480), 60, "assumed")
BARE = Light(np.array([0.3, -0.2, 1]))
FULL = Light(np.array([0.3, -0.2, 1]), np.eye(2) * 1e-4, 0.015, 0.9, 0.009, np.array([0.2, 0.3, 0.4]))
TIMING = {"detect": 1.0, "segment": 2.0, "associate": 3.0, "fit": 4.0, "judge": 5.0, "total": 15.0}


def estimate(*lights: Light) -> LightEstimate:
    return LightEstimate("paper", 3, Illumination(lights), None if lights else "no shadow found")


CONE = Proxy("frustum", np.array([[0.1, 0.0, 0.0, 0.03, 0.0], [0.1, 0.0, 0.08, 0.0, 0.0]]))
SKY_SLOPE = np.array([[0.1, 0.1, 0.2], [0.0, -0.1, 0.0]])
WHOLE = LightEstimate(
    "proxy",
    3,
    Illumination((FULL,), np.array([0.2, 0.3, 0.4]), np.array([0.6, 0.5, 0.4]), CONE, sky_slope_rgb=SKY_SLOPE),
)

VIEWS = dataclasses.replace(WHOLE, views=(3, 9, 14), span_rad=0.4)
PLACES = ("a.jpg", 0), ("b.mp4", 4), ("b.mp4", 9)

RECORDS = {
    "views": FileRecord("a.mp4", "fast", "proxy", None, 3, CAMERA, POSE, VIEWS, TIMING),
    "together": FileRecord("a.jpg", "fast", "proxy", None, 0, CAMERA, POSE, VIEWS, TIMING, (), PLACES),
    "answered": FileRecord("a.jpg", "fast", "paper", None, 0, CAMERA, POSE, estimate(BARE), TIMING),
    "two lights": FileRecord("a.jpg", "fast", "paper", None, 0, CAMERA, POSE, estimate(FULL, BARE), TIMING),
    "all measured": FileRecord("a.jpg", "fast", "proxy", None, 0, CAMERA, POSE, WHOLE, TIMING),
    "no light": FileRecord("a.mp4", "auto", "paper", None, 7, CAMERA, POSE, estimate(), TIMING),
    "no marker": FileRecord("a.mp4", "auto", "paper", None, 7, CAMERA, None, None, {"detect": 1.0, "total": 1.0}),
    "bad file": FileRecord("a.mp4", "balanced", "paper", "there is no file a.mp4: check the name"),
}


@pytest.mark.parametrize("kind", RECORDS)
def test_a_record_is_one_line_that_validates(kind: str) -> None:
    line = RECORDS[kind].to_line()
    assert "\n" not in line
    jsonschema.validate(json.loads(line), SCHEMA)


@pytest.mark.parametrize("pose", [POSE, None])
@pytest.mark.parametrize(
    "light",
    [
        estimated_light_json(WHOLE),
        estimated_light_json(VIEWS),
        estimated_light_json(estimate()),
        light_by_hand_json(Illumination((BARE,)), 3),
        None,
    ],
)
def test_what_a_snapshot_carries_validates(pose: MarkerPose | None, light: Json | None) -> None:
    tracked = TrackedFrame(Frame(np.zeros((480, 640, 3), np.uint8), 9, 0.3), CAMERA, pose)
    models = [("mug", np.eye(4)), ("tree", 2 * np.eye(4)), ("cube", None)]
    record = json.loads(json.dumps(snapshot_json(tracked, models, light), allow_nan=False))
    jsonschema.validate(record, SCHEMA)
    assert record["frame"] == 9
    assert [other["model"] for other in record["others"]] == ["tree", "cube"]
    assert (record["estimate"] is None) is (light is None)
    assert light is None or record["estimate"]["frame"] == 3


def test_the_numbers_of_a_light_are_its_own_in_the_units_that_are_named() -> None:
    lamp = Light(
        (0.0, 1.0, 1.0),
        np.diag([1e-4, 4e-4]),
        sigma_rad=0.015,
        confidence=0.9,
        angular_size_rad=0.06,
        shadow_rgb_ratio=(0.2, 0.3, 0.4),
        inverse_distance=2.0,
        lamp_covariance=np.diag([1e-4, 4e-4, 0.01]),
        radius_m=0.015,
        intensity_rgb_ratio=(3.0, 2.0, 1.0),
    )
    half = math.sqrt(0.5)
    expected = {
        "kind": "lamp",
        "to_light_marker": pytest.approx([0, half, half]),
        "azimuth_deg": pytest.approx(90),
        "elevation_deg": pytest.approx(45),
        "sigma_deg": pytest.approx(math.degrees(0.015)),
        "covariance_rad2": [[1e-4, 0], [0, 4e-4]],
        "confidence": 0.9,
        "angular_size_deg": pytest.approx(math.degrees(0.06)),
        "shadow_rgb_ratio": [0.2, 0.3, 0.4],
        "position_marker_m": pytest.approx([0, half / 2, half / 2]),
        "lamp_covariance": [[1e-4, 0, 0], [0, 4e-4, 0], [0, 0, 0.01]],
        "radius_m": 0.015,
        "intensity_rgb_ratio": [3.0, 2.0, 1.0],
        "reason": None,
    }
    assert light_json(lamp) == expected
    assert light_json(None, "no shadow") == {**dict.fromkeys(expected), "kind": "none", "reason": "no shadow"}


def test_what_was_found_of_the_marker_is_null_where_it_was_not() -> None:
    corners = np.array([(1.0, 2.0), (3.0, 2.0), (3.0, 4.0), (1.0, 4.0)])
    found = marker_json(MarkerPose(np.eye(4), corners, 0.08, 0.2, None))
    assert found == {
        "found": True,
        "T_cam_marker": np.eye(4).tolist(),
        "corners_px": corners.tolist(),
        "reprojection_rms_px": 0.2,
        "bridged": False,
    }
    assert marker_json(None) == {**dict.fromkeys(found), "found": False}


def test_a_file_that_cannot_be_used_has_an_error_and_nothing_else() -> None:
    record = RECORDS["bad file"].to_json()
    said = "there is no file a.mp4: check the name"
    assert (record["error"], record["light"]["reason"], record["light"]["kind"]) == (said, said, "none")
    assert record["frame"] is record["marker"] is record["camera"] is record["timing_ms"] is None
    without_marker = RECORDS["no marker"].to_json()
    assert without_marker["marker"]["found"] is False
    assert without_marker["light"]["reason"] == "no marker found"


def test_views_are_frames_of_one_file_or_of_several_and_null_where_there_is_one() -> None:
    span_deg = pytest.approx(math.degrees(0.4))
    assert RECORDS["views"].to_json()["views"] == {"frames": [3, 9, 14], "files": None, "span_deg": span_deg}
    together = {"frames": [0, 4, 9], "files": ["a.jpg", "b.mp4", "b.mp4"], "span_deg": span_deg}
    assert RECORDS["together"].to_json()["views"] == together
    assert estimated_light_json(VIEWS)["views"]["frames"] == [3, 9, 14]
    assert RECORDS["all measured"].to_json()["views"] is None


def test_the_strongest_light_comes_first_and_stands_alone() -> None:
    record = RECORDS["two lights"].to_json()
    assert len(record["lights"]) == 2
    assert record["light"] == record["lights"][0]
    assert record["light"]["sigma_deg"] == pytest.approx(np.degrees(0.015))


def test_the_schema_refuses_an_answer_without_a_direction() -> None:
    record = RECORDS["answered"].to_json()
    record["light"]["to_light_marker"] = None
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(record, SCHEMA)


def test_the_body_and_what_light_falls_on_stand_beside_the_lights() -> None:
    record = RECORDS["all measured"].to_json()
    assert record["caster"] == {"family": "frustum", "spheroids_marker": CONE.spheroids_marker.tolist()}
    assert record["ambient_rgb_ratio"] == [0.2, 0.3, 0.4]
    assert record["ground_rgb"] == [0.6, 0.5, 0.4]
    assert record["sky_slope_rgb"] == SKY_SLOPE.tolist()


@pytest.mark.parametrize("kind", ["answered", "no light", "no marker", "bad file"])
def test_what_was_not_measured_is_null_and_not_missing(kind: str) -> None:
    record = RECORDS[kind].to_json()
    assert record["caster"] is record["ambient_rgb_ratio"] is record["ground_rgb"] is record["sky_slope_rgb"] is None


@pytest.mark.parametrize("field", ["caster", "ambient_rgb_ratio", "ground_rgb", "sky_slope_rgb"])
def test_the_schema_misses_a_field_that_is_left_out(field: str) -> None:
    record = RECORDS["all measured"].to_json()
    del record[field]
    with pytest.raises(jsonschema.ValidationError, match=field):
        jsonschema.validate(record, {"$ref": "#/$defs/estimate", "$defs": SCHEMA["$defs"]})


@pytest.mark.parametrize("spheroids", [[], [[0.1, 0, 0, 0.03]], [[0.1, 0, 0, -0.03, 0]]])
def test_the_schema_refuses_a_caster_without_a_body(spheroids: list[list[float]]) -> None:
    record = RECORDS["all measured"].to_json()
    record["caster"]["spheroids_marker"] = spheroids
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(record, SCHEMA)

"""Radiance painted by hand instead of path-traced: what is developed from it is read and found as the truth says."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes.compare import compare
from scenes.develop import develop
from scenes.geometry.index import CASTER, GROUND, ROLES, SHEET
from scenes.geometry.poses import direction, projected, square
from scenes.geometry.shapes import FAMILIES, placed_points
from scenes.photo.masks import mask_of_triangles
from scenes.specify import SETS, specification

from ashe_live.bench.cases import read_cases


def faces_of(spec: dict[str, Any]) -> NDArray[np.int64]:
    parts = FAMILIES[spec["family"]](spec["params"])
    offsets = np.cumsum([0, *(len(part.points) for part in parts)])
    return np.concatenate([part.faces + offset for part, offset in zip(parts, offsets, strict=False)])


def painted(spec: dict[str, Any], pose: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Radiance of one frame: a grey ground, the sheet where its true pose puts it, dark objects, no shadows."""
    camera, size, sheet = spec["camera"] | pose, spec["size"], spec["marker"]
    cells = np.kron(np.array(sheet["cells"], np.float32), np.ones((20, 20), np.float32))
    print_px = len(cells)
    grey = sheet["ink"] + (sheet["paper"] - sheet["ink"]) * cells
    margin = round(print_px * (sheet["paper_side_m"] / sheet["side_m"] - 1) / 2)
    grey = cv2.copyMakeBorder(grey, margin, margin, margin, margin, cv2.BORDER_CONSTANT, value=sheet["paper"])
    edges = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)]) * len(grey) - 0.5
    outline = np.float32(projected(camera, square(sheet["side_m"] * len(grey) / print_px))[0])
    to_picture = cv2.getPerspectiveTransform(edges, outline)
    fine = np.diag([4.0, 4.0, 1.0]) + np.array([(0, 0, 1.5), (0, 0, 1.5), (0, 0, 0)])
    at = tuple(4 * v for v in size)
    albedo = np.full(at[::-1], 0.35, np.float32)
    cv2.warpPerspective(grey, fine @ to_picture, at, albedo, cv2.INTER_LINEAR, cv2.BORDER_TRANSPARENT)
    albedo = cv2.resize(albedo, size, interpolation=cv2.INTER_AREA)
    index = np.full(size[::-1], GROUND, np.uint8)
    index[mask_of_triangles(camera, size, square(sheet["paper_side_m"]), np.array([(0, 1, 2), (0, 2, 3)]))] = SHEET
    raw: dict[str, NDArray[Any]] = {}
    for number, each in enumerate(spec["objects"]):
        points, faces = placed_points(each, spec["ground"]["z_m"]).astype(np.float32), faces_of(each)
        raw |= {f"points{number}": points, f"faces{number}": faces}
        covered = mask_of_triangles(camera, size, points, faces)
        index[covered], albedo[covered] = ROLES[each["role"]], 0.08
    light = (albedo / np.pi)[..., None].repeat(3, 2).astype(np.float16)
    lights = {f"light{number}": light * np.float16(each["strength"]) for number, each in enumerate(spec["lights"])}
    return raw | lights | {"ambient": light, "index": index}


def stored(folder: Path, set_name: str, specs: list[dict[str, Any]]) -> Path:
    (folder / "radiance").mkdir(parents=True)
    content = {"format": 1, "set": set_name, "seed": SETS[set_name].seed, "scenes": specs}
    (folder / "specifications.json").write_text(json.dumps(content))
    for spec in specs:
        shots = [painted(spec, pose) for pose in spec.get("frames", [{}])]
        moving = ("ambient", "index", "light0", "light1", "light2")
        raw = (
            shots[0] if "frames" not in spec else shots[0] | {k: np.stack([shot[k] for shot in shots]) for k in moving}
        )
        np.savez(folder / "radiance" / f"{spec['id']}.npz", **raw)
    return folder


def flat(spec: dict[str, Any]) -> dict[str, Any]:
    """With a marker that lies on the ground as a plane, printed black, and a camera that sees it clearly."""
    calm = {"ink": 0.03, "paper": 0.8, "curl_m": 0.0, "card_m": 0.0002}
    clear = {"blur_px": 0.5, "motion_px": 0.0, "glare": 0.0, "jpeg_quality": 92}
    spec["marker"] |= calm
    spec["ground"]["z_m"] = -0.0002
    for picture in spec["pictures"]:
        picture["camera"] |= clear
    return spec


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = stored(
        tmp_path_factory.mktemp("set") / "set", "development", [flat(specification("development", k)) for k in (0, 2)]
    )
    assert develop(made) == 0
    return made


def test_what_is_developed_is_read_as_cases_with_the_lights_that_were_specified(folder: Path) -> None:
    specs = json.loads((folder / "specifications.json").read_text())["scenes"]
    pictures = {picture["id"]: (spec, picture) for spec in specs for picture in spec["pictures"]}
    cases = read_cases(folder)
    assert len(cases) >= 0.8 * len(pictures)
    for case in cases:
        spec, picture = pictures[case.id]
        assert case.category == picture["category"]
        lights = [
            direction(spec["lights"][k]["azimuth_deg"], spec["lights"][k]["elevation_deg"]) for k in picture["lights"]
        ]
        assert case.to_lights_marker is not None
        assert len(case.to_lights_marker) == len(lights)
        for light in lights:
            assert (case.to_lights_marker @ light).max() == pytest.approx(1, abs=1e-7)
        image = case.tracked().frame.image_bgr
        assert image.shape[1::-1] == tuple(spec["size"])
        seen = case.mask("object")
        assert seen is not None
        assert seen.any() == any(each["role"] == "caster" for each in spec["objects"])
        assert (case.mask("shadow") is None) == (not picture["lights"])


def test_the_tracker_finds_the_marker_where_the_truth_says(folder: Path) -> None:
    entries = json.loads((folder / "ground_truth.json").read_text())["scenes"]
    for entry in entries:
        found = entry["marker"]["detection"]
        assert found["corner_rms_px"] < 0.6, entry["id"]
        assert found["pnp_rotation_error_deg"] < 2.0, entry["id"]
    assert np.median([entry["marker"]["detection"]["corner_rms_px"] for entry in entries]) < 0.25


def test_developing_goes_on_where_it_stopped_and_gives_the_same_again(folder: Path, tmp_path: Path) -> None:
    specs = json.loads((folder / "specifications.json").read_text())["scenes"]
    again = stored(tmp_path / "again", "development", specs)
    last = again / "radiance" / f"{specs[-1]['id']}.npz"
    aside = last.rename(tmp_path / "aside.npz")
    assert develop(again) == 1
    first = {path: path.stat().st_mtime_ns for path in again.glob("*.jpg")}
    aside.rename(last)
    assert develop(again) == 0
    assert first.items() <= {path: path.stat().st_mtime_ns for path in again.glob("*.jpg")}.items()
    count, differing = compare(folder, again)
    assert count == len(read_cases(folder))
    assert not differing


def test_takes_become_clips_with_a_pose_a_frame(tmp_path: Path) -> None:
    spec = flat(specification("takes_training", 0))
    spec["pictures"], spec["frames"] = spec["pictures"][:1], spec["frames"][::3]
    made = stored(tmp_path / "takes", "takes_training", [spec])
    assert develop(made) == 0
    (take,) = json.loads((made / "ground_truth.json").read_text())["takes"]
    capture = cv2.VideoCapture(str(made / take["video"]))
    count = 0
    while capture.read()[0]:
        count += 1
    assert count == len(take["frames"]) == len(spec["frames"])
    assert take["fps"] == spec["fps"]
    assert np.mean([frame["marker_detected"] for frame in take["frames"]]) > 0.8
    assert CASTER in painted(spec, spec["frames"][0])["index"]

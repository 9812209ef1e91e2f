"""What cameras' tones make of a cube's sides, on photos painted with tones that are known."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scenes import tones
from scenes.specify import specification

from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, looking, painted, sun

BRIGHTEST = 0.8  # linear light of the photo's white: nothing is clipped
BENT = {"phone": 0.2, "plain": 0.0, "webcam": -0.15}  # exponents beyond 1, by camera
SCENES = {"a": (sun(200, 40, 0.6), looking(0.4, 50, 20)), "b": (sun(60, 55, 0.4), looking(0.45, 60, 160))}


@pytest.fixture
def photos(tmp_path: Path) -> Path:
    """A set in which each scene was photographed by each camera: brightness to the power of 1 and its exponent."""
    (tmp_path / "radiance").mkdir()
    surroundings = specification("training", 0)["surroundings"]
    specs, entries = [], []
    for name, (light, T) in SCENES.items():
        scene = CubeScene(CAMERA, T, [light], noise=0.0, exposure=BRIGHTEST)
        linear = linear_from_srgb(painted(scene)[..., ::-1] / 255)
        np.savez(tmp_path / "radiance" / f"{name}.npz", ambient=linear.astype(np.float16))
        pictures = [{"id": f"{name}_{camera}", "lights": [], "unseen_lights": [], "gains": []} for camera in BENT]
        specs.append({"id": name, "surroundings": surroundings, "lights": [], "pictures": pictures})
        for camera, exponent in BENT.items():
            shown = 255 * srgb_from_linear(BRIGHTEST * (linear / BRIGHTEST).clip(0, 1) ** (1 + exponent))
            cv2.imwrite(str(tmp_path / f"{name}_{camera}.png"), np.round(shown[..., ::-1]).astype(np.uint8))
            entries.append(entry(f"{name}_{camera}", name, camera, T, light.point))
    (tmp_path / "specifications.json").write_text(json.dumps({"scenes": specs}))
    (tmp_path / "ground_truth.json").write_text(json.dumps({"scenes": entries}))
    return tmp_path


def entry(name: str, render: str, camera: str, T_cam_cube: Any, point: Any) -> dict[str, Any]:
    return {
        "id": name,
        "image": f"{name}.png",
        "size": list(CAMERA.size),
        "K": CAMERA.K.tolist(),
        "R": T_cam_cube[:3, :3].tolist(),
        "t": T_cam_cube[:3, 3].tolist(),
        "marker": {"dictionary": "cube", "side_m": EDGE_M},
        "lights": [{"dir_to_light": point[:3].tolist(), "irradiance_ground": [0.5, 0.5, 0.5]}],
        "ambient": {"irradiance_ground": [0.3, 0.3, 0.3], "on_ball": np.zeros((9, 3)).tolist()},
        "ground": {"albedo": [0.4, 0.4, 0.4]},
        "photo": {"family": camera, "gains": [1.0, 1.0, 1.0]},
        "tags": {"render": render},
    }


def test_the_exponent_of_each_camera_is_measured(
    photos: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["tones", str(photos)])
    tones.main()
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    off = {words[0].removesuffix(":"): float(words[-2]) for words in lines}
    sides = {words[0].removesuffix(":"): int(words[1]) for words in lines}
    assert {camera: off[camera] for camera in BENT} == pytest.approx({k: abs(v) for k, v in BENT.items()}, abs=0.03)
    assert sides["all"] == sum(sides[camera] for camera in BENT)
    assert min(sides.values()) >= 2
    assert off["all"] == pytest.approx(np.sqrt(np.mean(np.square(list(BENT.values())))), abs=0.03)

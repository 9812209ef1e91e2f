"""Path-traced pictures of cubes: read with their truth from what the generator of scenes writes."""

import json
import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.ambient import NORMALS
from ashe_live.bench.cube.pictures import painted_pictures, traced_picture, traced_pictures
from ashe_live.bench.cube.scenes import AROUND_DEG, SETS, before
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import directions_on_spiral
from ashe_live.core.transforms import camera_centre
from ashe_live.errors import UserError

SKY = (0.2, 0.4, 0.8)
EVEN = [[0.5 * c for c in SKY], [0.0] * 3, [0.0] * 3, [0.5 * c for c in SKY], *([[0.0] * 3] * 5)]  # (1 + n_z) / 2

FROM_ABOVE = {"size": [640, 480], "K": [[500.0, 0, 320], [0, 500.0, 240], [0, 0, 1]], "t": [0.0, 0.0, 0.4],
              "R": np.diag([1.0, -1.0, -1.0]).tolist()}  # fmt: skip


def entry(**more: object) -> dict[str, object]:
    lamp = {"dir_to_light": [0.0, 0.6, 0.8], "irradiance_ground": [0.8, 0.6, 0.2],
            "lamp": {"position_m": [0.0, 0.3, 0.4], "radius_m": 0.01}}  # fmt: skip
    return {
        "id": "one", "category": "lamp", "image": "one.png", "size": [8, 6], "K": np.eye(3).tolist(),
        "R": np.eye(3).tolist(), "t": [0.0, 0.0, 0.4], "marker": {"dictionary": "cube", "side_m": 0.06},
        "lights": [lamp], "ambient": {"irradiance_ground": list(SKY), "on_ball": EVEN},
        "ground": {"albedo": [0.3, 0.2, 0.1]},
    } | more  # fmt: skip


def folder_of(path: Path, *entries: dict[str, object]) -> Path:
    cv2.imwrite(str(path / "one.png"), np.zeros((6, 8, 3), np.uint8))
    (path / "ground_truth.json").write_text(json.dumps({"scenes": entries}))
    return path


def test_truth_is_in_units_of_all_light_on_level_ground(tmp_path: Path) -> None:
    (found,) = traced_pictures([folder_of(tmp_path, entry())])["lamp"]
    picture = traced_picture(found)
    assert picture.lights.tolist() == [[0.0, 0.3, 0.4, 1.0]]
    up = directions_on_spiral(NORMALS)[:, 2]
    level = np.add(SKY, (0.8, 0.6, 0.2))
    assert picture.sky_on_ball == pytest.approx((1 + up[:, None]) / 2 * np.array(SKY) / level, abs=1e-9)
    assert math.isclose(picture.T_cam_cube[2, 3], 0.4)


def test_a_sun_is_at_infinity_and_behind_the_camera_casts_no_shadow_that_it_sees(tmp_path: Path) -> None:
    for high, is_seen in ((0.8, True), (0.02, True), (1.0, False)):
        to_light = [0.0, math.sqrt(1 - high**2), high]
        light = {"dir_to_light": to_light, "irradiance_ground": [1.0] * 3}
        (found,) = traced_pictures([folder_of(tmp_path, entry(lights=[light], **FROM_ABOVE))])["lamp"]
        picture = traced_picture(found)
        assert picture.lights == pytest.approx(np.array([[*to_light, 0.0]]))
        assert picture.shows_shadows == is_seen


def test_a_picture_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, entry())
    (tmp_path / "one.png").write_bytes(b"no picture")
    with pytest.raises(UserError, match=r"cannot read the picture one\.png: is it there"):
        traced_picture(traced_pictures([folder])["lamp"][0])


@pytest.mark.parametrize(("place", "is_seen"), [((0.0, 0.3, 0.4), True), ((0.0, 0.0, 0.5), False)])
def test_a_cube_hides_its_shadow_from_a_camera_beside_the_lamp(
    tmp_path: Path, place: tuple[float, ...], is_seen: bool
) -> None:
    """Whatever else casts shadows in the picture."""
    lamp = {"dir_to_light": [0.0, 0.0, 1.0], "irradiance_ground": [1.0] * 3, "lamp": {"position_m": list(place)}}
    seen = {"object_px": 9000, "shadow_px": 9000}
    folder = folder_of(tmp_path, entry(lights=[lamp], visibility=seen, **FROM_ABOVE))
    (found,) = traced_pictures([folder])["lamp"]
    assert traced_picture(found).shows_shadows == is_seen


def test_pictures_without_a_cube_are_another_bench_s(tmp_path: Path) -> None:
    flat = entry(marker={"dictionary": "DICT_4X4_50", "id": 0, "side_m": 0.08})
    with pytest.raises(UserError, match="no pictures of a paper cube"):
        traced_pictures([folder_of(tmp_path, flat)])


@pytest.mark.parametrize("missing", ["category", "ambient", "lights", "K"])
def test_a_picture_whose_truth_is_not_whole_is_named(tmp_path: Path, missing: str) -> None:
    folder = folder_of(tmp_path, {key: value for key, value in entry().items() if key != missing})
    with pytest.raises(UserError, match=missing):
        traced_picture(traced_pictures([folder])["lamp"][0])


def test_a_camera_comes_around_the_cube_to_where_it_takes_the_picture() -> None:
    followed = next(one for one in SETS if one.followed)
    (scene,) = followed.scenes(1)
    eyes = np.array([camera_centre(each.T_cam_cube) for each in before(scene)])
    end = camera_centre(scene.T_cam_cube)
    assert np.hypot(eyes[:, 0], eyes[:, 1]) == pytest.approx(math.hypot(*end[:2]))
    assert eyes[:, 2] == pytest.approx(end[2])
    ways = np.linalg.norm(np.diff([*eyes, end], axis=0), axis=1)
    assert ways == pytest.approx(ways[0])
    assert ways.sum() == pytest.approx(math.radians(AROUND_DEG) * math.hypot(*end[:2]), rel=1e-2)


def test_a_followed_cube_is_shown_by_its_frames_before_it() -> None:
    one = next(painted_pictures(replace(SETS[0], followed=True), 1, 0))
    alone = next(painted_pictures(SETS[0], 1, 0))
    assert np.array_equal(one.image, alone.image)
    first = next(iter(one.before))
    assert first.shape == one.image.shape
    assert not np.array_equal(first, one.image)
    assert not list(alone.before)


def take_of(path: Path, frames: int = 3) -> Path:
    """A folder with a take of a cube, whose clip has so many frames."""
    poses = [{"frame": number, "R": np.eye(3).tolist(), "t": [0.1 * number, 0.0, 0.4]} for number in range(3)]
    with Recorder(path / "take.mp4", (64, 48), 6) as recorder:
        for number in range(frames):
            recorder.write(np.full((48, 64, 3), 80 * number, np.uint8), number / 6)
    take = entry(video="take.mp4", frames=poses, fps=6, size=[64, 48])
    del take["image"]
    (path / "ground_truth.json").write_text(json.dumps({"takes": [take]}))
    return path


def test_a_take_comes_alone_and_with_its_frames_as_further_views(tmp_path: Path) -> None:
    found = traced_pictures([take_of(tmp_path)])
    assert set(found) == {"lamp", "lamp, views"}
    ((alone,), (together,)) = found["lamp"], found["lamp, views"]
    for about, is_together in ((alone, False), (together, True)):
        picture = traced_picture(about)
        assert picture.together == is_together
        assert picture.T_cam_cube[0, 3] == pytest.approx(0.2)  # that of the last frame
        levels = [float(image.mean()) for image in (*picture.before, picture.image)]
        assert levels == pytest.approx([0, 80, 160], abs=4)
        assert picture.fps == 6


def test_a_take_whose_clip_is_cut_off_is_named(tmp_path: Path) -> None:
    folder = take_of(tmp_path, frames=2)
    with pytest.raises(UserError, match=r"take\.mp4 has 2 frames"):
        traced_picture(traced_pictures([folder])["lamp"][0])

"""The programming interface: docs/api.md runs as written; what it promises is kept; importing it is cheap."""

import dataclasses
import gc
import inspect
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import numpy as np
import PIL.ExifTags
import PIL.Image
import pytest

import ashe_live as al
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, direction_from_angles
from ashe_live.models.placement import PlacedModel
from ashe_live.render.beside import first_places
from ashe_live.render.occlusion.contact import ContactPatch
from tests.checkout import CHECKOUT
from tests.conftest import box_corners
from tests.painted_cubes import CAMERA as CUBE_CAMERA
from tests.painted_cubes import EDGE_M, CubeScene, looking, painted, sun
from tests.shipped_scenes import CASES
from tests.thin_rod import unevenness, write_rod

PAGE = CHECKOUT / "docs" / "api.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def photo_folder(shoot_film, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, np.ndarray]:
    """With the files that the page names, and the true direction of the light."""
    folder = tmp_path_factory.mktemp("api")
    film = shoot_film(folder, (640, 480), 4)
    shutil.move(film.path, folder / "table.mp4")
    with al.open_source(folder / "table.mp4") as clip:
        al.write_png(folder / "table.png", clip.read().image_bgr)
    return folder, film.to_light_marker


@pytest.fixture(scope="module")
def ran(photo_folder) -> dict:
    """The variables that the page's examples leave behind."""
    folder, _ = photo_folder
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        names: dict = {}
        for example in EXAMPLES:
            exec(compile(example, str(PAGE), "exec"), names)
    return names


def test_the_first_example_is_ten_lines():
    assert len(EXAMPLES) >= 5
    assert len(EXAMPLES[0].splitlines()) <= 10


def test_the_pages_examples_find_the_marker_and_the_light(ran, photo_folder):
    _, to_light = photo_folder
    assert ran["T_cam_marker"].shape == (4, 4)
    assert np.degrees(np.arccos(ran["estimate"].light.to_light_marker @ to_light)) < 10
    assert len(ran["pictures"]) == 4


def test_the_model_stands_on_the_marker_and_nowhere_far_from_it(ran, photo_folder):
    folder, _ = photo_folder
    before, after = cv2.imread(str(folder / "table.png")), cv2.imread(str(folder / "with_mug.png"))
    changed = np.abs(after.astype(int) - before).max(axis=2) > 30
    corners = ran["corners"]
    assert changed[int(corners[:, 1].mean()), int(corners[:, 0].mean())]
    assert not changed[:, -20:].any()


def test_a_picture_without_a_marker_is_answered_with_a_reason_and_drawn_as_it_is():
    grey = np.full((96, 128, 3), 140, np.uint8)
    camera = al.Camera.from_hfov((128, 96), 60)
    estimate = al.estimate_light(grey, camera)
    assert estimate.light is None
    assert estimate.reason == "no marker found"
    with al.Renderer((128, 96)) as renderer:
        np.testing.assert_array_equal(
            renderer.render(al.Tracker(camera).track(grey), "cube", estimate.illumination), grey
        )


def test_a_photos_camera_is_that_of_its_exif_data_or_the_assumed_one(tmp_path):
    picture, exif = PIL.Image.new("RGB", (720, 480)), PIL.Image.Exif()
    exif.get_ifd(PIL.ExifTags.IFD.Exif)[PIL.ExifTags.Base.FocalLengthIn35mmFilm] = 28
    picture.save(tmp_path / "stated.jpg", exif=exif)
    picture.save(tmp_path / "silent.jpg")
    stated, silent = (al.camera_of_photo(tmp_path / name) for name in ("stated.jpg", "silent.jpg"))
    assert (stated.size, stated.source, silent.source) == ((720, 480), "exif", "assumed")
    assert stated.K[0, 0] == pytest.approx(28 / 36 * 720)  # 36 mm are as broad as the picture
    np.testing.assert_array_equal(silent.K, al.Camera.assumed((720, 480)).K)
    with pytest.raises(al.UserError):
        al.camera_of_photo(tmp_path / "none.jpg")


def test_a_marker_that_nobody_knows_is_named_as_the_tracker_takes_it(ran):
    assert al.markers_in_view(GREY) == ()
    (named,) = al.markers_in_view(ran["image"])
    assert al.Tracker(ran["camera"], named).track(ran["image"]).marker is not None


@pytest.mark.parametrize("caster", [None, "cylinder:0.03x0.1"])
def test_an_estimator_answers_alike_in_another_process(ran, caster):
    here = al.make_estimator("proxy", "fast", "sun", caster)
    there = pickle.loads(pickle.dumps(here))
    one, other = (estimator.estimate(ran["first"]) for estimator in (here, there))
    assert (there.name, one.reason) == (here.name, other.reason)
    np.testing.assert_array_equal(one.object_mask, other.object_mask)
    assert [light.to_light_marker.tolist() for light in one.lights] == [
        light.to_light_marker.tolist() for light in other.lights
    ]


def test_a_pose_of_ones_own_has_the_corners_that_the_tracker_finds(ran):
    posed, tracked = ran["posed"], ran["tracked"]
    np.testing.assert_allclose(posed.marker.corners_px, tracked.marker.corners_px, atol=1.0)


def posed_by(tracked: al.TrackedFrame, T_cam_marker: np.ndarray) -> al.TrackedFrame:
    """The frame with a pose of one's own, and the corners where that has them, as the page's program does."""
    T, camera, marker = T_cam_marker, tracked.camera, tracked.marker
    square = square_corners(marker.side_m)
    pixels, _ = cv2.projectPoints(square, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)
    return dataclasses.replace(tracked, marker=al.MarkerPose(T, pixels.reshape(4, 2), marker.side_m, 0.0, None))


def test_a_pose_that_has_the_marker_elsewhere_than_its_corners_is_refused():
    """By the inverse of the pose, as it is easily handed in, lights were up to 66 degrees off, and up to 0.83 sure."""
    tracked, estimator = CASES["clean_box"].tracked(), al.make_estimator("proxy", "fast")
    T, corners = tracked.marker.T_cam_marker, tracked.marker.corners_px
    for wrong in (
        dataclasses.replace(tracked.marker, T_cam_marker=np.linalg.inv(T)),
        dataclasses.replace(tracked.marker, corners_px=corners[[1, 0, 3, 2]]),  # mirrored
        dataclasses.replace(tracked.marker, side_m=tracked.marker.side_m / 10),
        dataclasses.replace(tracked.marker, corners_px=np.zeros((4, 2))),
    ):
        contradicted = dataclasses.replace(tracked, marker=wrong)
        with pytest.raises(ValueError, match="tracked has a marker whose corners_px are"):
            estimator.estimate(contradicted)
        with pytest.raises(ValueError, match="each of others has a marker"):
            estimator.estimate(tracked, [contradicted])


def test_a_pose_from_below_the_plane_shows_no_light_and_says_why():
    """As one whose z points into the table, or that of a camera in the marker's centre, which raised in other words."""
    tracked, estimator = CASES["clean_box"].tracked(), al.make_estimator("proxy", "fast")
    T = tracked.marker.T_cam_marker
    into_the_table = posed_by(tracked, T @ np.diag([1.0, -1.0, -1.0, 1.0]))
    for scale in (0.0, 1e-300):
        centred = T.copy()
        centred[:3, 3] *= scale
        in_the_centre = dataclasses.replace(tracked.marker, T_cam_marker=centred, corners_px=np.zeros((4, 2)))
        for wrong in (into_the_table, dataclasses.replace(tracked, marker=in_the_centre)):
            estimate = estimator.estimate(wrong)
            assert estimate.light is None
            assert "the camera is not above its plane" in estimate.reason
    assert estimator.estimate(tracked, [into_the_table]).views == (tracked.frame.index,)


@pytest.mark.parametrize("name", ["clean_cup", "two_cylinder"])
def test_a_frame_of_ones_own_may_begin_anywhere_on_the_table(name):
    """Also beside the picture, or behind the camera, where the corners are no pixels."""
    tracked, estimator = CASES[name].tracked(), al.make_estimator("proxy", "fast")
    for shift in ((1.5, 0.0), (0.0, -2.0)):
        elsewhere = np.eye(4)
        elsewhere[:2, 3] = shift
        estimate = estimator.estimate(posed_by(tracked, tracked.marker.T_cam_marker @ elsewhere))
        off = angle_between(estimate.light.to_light_marker, CASES[name].to_lights_marker[0])
        assert off < np.radians(2)


def cubes_from(*azimuths_deg: float) -> list[al.TrackedFrame]:
    """A painted cube in the sun, seen from several sides."""
    tracker, seen = al.Tracker(CUBE_CAMERA, "cube"), []
    for azimuth_deg in azimuths_deg:
        tracker.reset()
        seen.append(tracker.track(painted(CubeScene(CUBE_CAMERA, looking(0.4, 50, azimuth_deg), (sun(120, 50),)))))
    return seen


def test_beside_the_paper_cube_a_model_is_seen_and_stays_where_it_is():
    """It stood within the cube, which hid it."""
    lit_by = al.Illumination((al.Light(direction_from_angles(np.radians(120), np.radians(50))),))
    first, second = cubes_from(20, 60)
    with al.Renderer(first.frame.size) as renderer:

        def alone(tracked: al.TrackedFrame, model) -> np.ndarray:
            return renderer.render(tracked, model, lit_by, is_cut_out=True)

        seen = [alone(tracked, "mug") for tracked in (first, second)]
        x, y = first_places(first, lit_by.light).on_marker(0, EDGE_M).shift_m
        assert np.hypot(x, y) > 1.2 * EDGE_M
        for tracked, picture in zip((first, second), seen, strict=True):
            np.testing.assert_array_equal(picture, alone(tracked, ("mug", al.Placement(shift_m=(x, y)))))
            assert (picture[..., 3] == 255).sum() > 500


def test_the_marker_is_covered_on_request_and_by_the_ground_of_its_own_video():
    light = al.Illumination((al.Light((1.0, 0.0, 1.0)),))
    bricks, cone = CASES["texture_bricks"].tracked(), CASES["clean_cone"].tracked()
    sheet = np.zeros(cone.frame.image_bgr.shape[:2], np.uint8)
    cv2.fillConvexPoly(sheet, cone.marker.corners_px.round().astype(np.int32), 1)
    tiny = ("mug", al.Placement(scale=0.1))
    with al.Renderer(cone.frame.size) as renderer, al.Renderer(cone.frame.size) as fresh:
        shown = [renderer.render(cone, tiny, light, hides_marker=hides) for hides in (False, True)]
        dark = [picture[sheet > 0].max(axis=1) < 60 for picture in shown]
        assert dark[0].mean() > 0.3
        assert dark[1].mean() < 0.05
        renderer.render(bricks, tiny, light, hides_marker=True)
        np.testing.assert_array_equal(
            renderer.render(cone, tiny, light, hides_marker=True), fresh.render(cone, tiny, light, hides_marker=True)
        )


def test_what_is_thinner_than_a_pixel_is_whole_without_a_window(tmp_path):
    """As on a GPU; `fast` has one sample a pixel."""
    cone, rod = CASES["clean_cone"].tracked(), write_rod(tmp_path / "rod.obj")
    uneven = {}
    for quality in ("fast", "balanced"):
        with al.Renderer(cone.frame.size, quality) as renderer:
            uneven[quality] = unevenness(renderer.render(cone, str(rod), is_cut_out=True, up="z")[..., 3])
    assert uneven["balanced"] < 0.3 < uneven["fast"]


def test_a_lamp_in_the_markers_plane_is_drawn_as_one_that_lights_no_ground(ran):
    """Of one hardly above it, the shadow's matrix was singular."""
    with al.Renderer((320, 240), "fast") as renderer:
        low, level = (
            renderer.render(ran["tracked"], "mug", al.Illumination((al.Light((1, 0, z), inverse_distance=2.0),)))
            for z in (1e-300, 0.0)
        )
    np.testing.assert_array_equal(low, level)


def test_two_renderers_do_not_disturb_each_other():
    camera = al.Camera.from_hfov((64, 48), 60)
    dark, bright = (al.Tracker(camera).track(np.full((48, 64, 3), value, np.uint8)) for value in (20, 220))
    with al.Renderer((64, 48)) as first, al.Renderer((64, 48)) as second:
        for _ in range(2):
            assert first.render(dark, "cube").mean() == pytest.approx(20)
            assert second.render(bright, "cube").mean() == pytest.approx(220)


def test_several_models_stand_side_by_side_and_one_where_it_is_put(ran):
    """Each as the window has it: what is drawn of the two is what is drawn of either, where only that one stands."""
    tracked = ran["tracked"]
    side_m = tracked.marker.side_m
    beside = al.Placement(shift_m=(1.25 * side_m, 0.0))
    with al.Renderer(tracked.frame.size) as renderer:
        covers = [
            renderer.render(tracked, model, is_cut_out=True)[..., 3] == 255
            for model in ("mug", ("tree", beside), ["mug", "tree"], [("tree", beside), ("mug", al.Placement())])
        ]
    mug, tree, both, in_other_order = covers
    assert np.count_nonzero(mug & ~tree) > 100
    assert np.count_nonzero(tree & ~mug) > 100
    assert np.mean(both == (mug | tree)) > 0.999
    assert np.mean(in_other_order == both) > 0.999


@pytest.mark.parametrize("size_m", [(0.05, 0.03, 0.09), (0.11, 0.06, 0.02), (0.03, 0.08, 0.05)])
def test_a_file_in_metres_is_drawn_in_its_true_size_as_the_page_says(ran, tmp_path, size_m):
    tracked, camera = ran["tracked"], ran["camera"]
    width, depth, height = size_m
    base = [(x * width / 2, y * depth / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    corners = np.array([(x, y, z) for z in (0.0, height) for x, y in base])
    faces = ("4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8")
    file = tmp_path / "box.obj"
    file.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {face}\n" for face in faces))
    names = {"al": al, "width_m": width, "depth_m": depth, "height_m": height}
    (line,) = re.findall(r"^true_size = .*$", "\n".join(EXAMPLES), re.MULTILINE)
    exec(line, names)
    with al.Renderer(tracked.frame.size) as renderer:
        drawn = renderer.render(tracked, (file, names["true_size"]), is_cut_out=True, up="z")
    T = tracked.marker.T_cam_marker
    pixels, _ = cv2.projectPoints(corners, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)
    expected = np.zeros(drawn.shape[:2], np.uint8)
    cv2.fillConvexPoly(expected, cv2.convexHull(pixels.reshape(-1, 2).round().astype(np.int32)), 1)
    is_model = drawn[..., 3] == 255
    overlap = (is_model & (expected > 0)).sum() / (is_model | (expected > 0)).sum()
    assert overlap > 0.9  # a size off by a tenth gives 0.8


def test_models_are_named_in_a_tuple_as_in_a_list(ran):
    """As `model_names` has them."""
    assert isinstance(al.model_names(), tuple)
    with al.Renderer((320, 240), "fast") as renderer:
        for names in (("mug", "tree"), ("mug", "tree", "cube")):
            in_list = renderer.render(ran["tracked"], list(names))
            np.testing.assert_array_equal(renderer.render(ran["tracked"], names), in_list)


def test_a_file_is_named_by_a_path_as_by_text(ran, tmp_path):
    file = tmp_path / "tile.obj"
    file.write_text("v 0 0 0\nv 0.06 0 0\nv 0.06 0 0.04\nv 0 0.03 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n")
    tracked, moved = ran["tracked"], al.Placement(scale=0.5)
    with al.Renderer((320, 240), "fast") as renderer:
        for by_path, by_text in (
            (file, str(file)),
            ((file, moved), (str(file), moved)),
            (["cube", file], ["cube", str(file)]),
        ):
            drawn = renderer.render(tracked, by_path, is_cut_out=True)
            assert drawn[..., 3].any()
            np.testing.assert_array_equal(drawn, renderer.render(tracked, by_text, is_cut_out=True))
    known = [al.make_estimator("proxy", "fast", caster=caster).estimate(tracked) for caster in (file, str(file))]
    assert known[0].reason == known[1].reason
    with pytest.raises(al.UserError, match="no file"):
        al.make_estimator(caster=tmp_path / "none.obj")


def test_a_models_file_is_read_anew_where_it_has_changed_and_drawn_on_where_it_is_gone(ran, tmp_path):
    tracked, file, other = ran["tracked"], tmp_path / "tile.obj", tmp_path / "other.obj"
    flat, upright = (
        f"v 0 0 0\nv 0.06 0 0\nv 0.06 {z} 0.04\nv 0 0.03 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n"
        for z in ("0.0", "0.09")
    )
    with al.Renderer((320, 240), "fast") as renderer:
        file.write_text(flat)
        before = renderer.render(tracked, file)
        for path in (file, other):
            path.write_text(upright)
        changed = renderer.render(tracked, file)
        assert np.any(changed != before)
        np.testing.assert_array_equal(changed, renderer.render(tracked, other))
        file.write_text("")  # another program has begun to write it anew
        with pytest.warns(al.ModelWarning, match="read before"):
            np.testing.assert_array_equal(changed, renderer.render(tracked, file))
        np.testing.assert_array_equal(changed, renderer.render(tracked, file))  # and is not read again as it is
        file.write_text(flat)
        np.testing.assert_array_equal(before, renderer.render(tracked, file))
        file.write_text(upright)
        renderer.render(tracked, file)
        file.unlink()
        np.testing.assert_array_equal(changed, renderer.render(tracked, file))


def test_a_renderer_that_draws_ever_other_models_keeps_the_last_ones(ran, monkeypatch):
    """As a server does, on markers of any size: they were kept for good, a megabyte for each size of each model."""
    monkeypatch.setattr("ashe_live.renderer.MOST_KEPT", 2)
    tracked = ran["tracked"]
    with al.Renderer((64, 48), "fast") as renderer:
        before = live_models()
        for number in range(6):
            marker = dataclasses.replace(tracked.marker, side_m=0.08 + 0.001 * number)
            renderer.render(dataclasses.replace(tracked, marker=marker), "cube")
        assert live_models() - before <= 2


def live_models() -> int:
    gc.collect()
    return sum(isinstance(thing, PlacedModel) for thing in gc.get_objects())


def test_the_first_model_stands_on_the_side_that_is_asked_for(ran, tmp_path):
    """A slab in a file with y up, and the same in one with z up."""
    corners = [(x, y, z) for x in (0, 4) for y in (0, 3) for z in (0, 1)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    y_up, z_up = tmp_path / "y.obj", tmp_path / "z.obj"
    for file, points in ((y_up, corners), (z_up, [(x, -z, y) for x, y, z in corners])):
        file.write_text("".join([f"v {x} {y} {z}\n" for x, y, z in points] + [f"f {face}\n" for face in faces]))
    tracked = ran["tracked"]
    with al.Renderer((320, 240), "fast") as renderer:
        upright, guessed = (renderer.render(tracked, y_up, is_cut_out=True, up=up) for up in ("y", None))
        assert np.count_nonzero(guessed != upright) > 300, "a slab that stands is told from one that lies"
        np.testing.assert_array_equal(renderer.render(tracked, z_up, is_cut_out=True, up="z"), upright)
        second = renderer.render(tracked, ["cube", y_up], up="y")
        np.testing.assert_array_equal(renderer.render(tracked, ["cube", y_up]), second)


def test_what_is_cut_out_is_nothing_where_nothing_is_drawn_and_can_be_saved(ran, tmp_path):
    tracked = ran["tracked"]
    with al.Renderer(tracked.frame.size) as renderer:
        cut_out = renderer.render(tracked, "mug", is_cut_out=True)
    assert cut_out.shape[2] == 4
    assert not cut_out[:, -20:].any()
    assert (cut_out[..., 3] == 255).sum() > 100
    al.write_png(tmp_path / "mug.png", cut_out)
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "mug.png"), cv2.IMREAD_UNCHANGED), cut_out)


CAMERA = al.Camera.from_hfov((64, 48), 60)
GREY = np.full((48, 64, 3), 140, np.uint8)
TRACKED = al.Tracker(CAMERA).track(GREY)

# What the arguments must not be.
NO_PATHS = (None, 7, b"a.png", "a\0b", ["a.png"])
NO_NAMES = (None, 7, b"a", "a\0b", ["a"])
NO_QUALITIES = (*NO_NAMES, "best", "")
NO_PICTURES = (None, "a", GREY[:, :, 0], GREY.astype(float), GREY[:0], GREY.tolist())
NO_SIZES = (None, 7, "64x48", (64,), (0, 48), (64, -1), (64.5, 48), (True, 48), (10**9, 48), (64, float("nan")))
NO_LENGTHS = (None, "a", 0, -1, float("nan"), float("inf"), 1e300, True, [1])
NO_ANGLES = (None, "a", 0, 180, -5, float("nan"), 1e300)
NO_DIRECTIONS = (None, "abc", (0, 0, 0), (1, 2), (1, 2, float("nan")), (1, 2, float("inf")), {})
A_LIGHT = al.Light((0, 0, 1))
WRONG = {
    ("path", "read_photo"): (al.read_photo, NO_PATHS),
    ("path", "open_source"): (al.open_source, NO_PATHS),
    ("path", "camera_of_photo"): (al.camera_of_photo, NO_PATHS),
    ("path", "read_camera_file"): (al.read_camera_file, NO_PATHS),
    ("path", "write_png"): (lambda value: al.write_png(value, GREY), NO_PATHS),
    ("image_bgr", "write_png"): (lambda value: al.write_png("never-written.png", value), NO_PICTURES),
    ("image_bgr", "estimate_light"): (lambda value: al.estimate_light(value, CAMERA), NO_PICTURES),
    ("image_bgr", "track"): (lambda value: al.Tracker(CAMERA).track(value), NO_PICTURES),
    ("time_s", "track"): (lambda value: al.Tracker(CAMERA).track(GREY, value), ("a", float("nan"), 1e300, True)),
    ("camera", "Tracker"): (al.Tracker, (None, 60, "a", np.eye(3))),
    ("camera", "estimate_light"): (lambda value: al.estimate_light(GREY, value), (None, 60, "a")),
    ("marker", "Tracker"): (lambda value: al.Tracker(CAMERA, value), NO_NAMES),
    ("side_m", "Tracker"): (
        lambda value: al.Tracker(CAMERA, side_m=value),
        [one for one in NO_LENGTHS if one is not None],
    ),
    ("quality", "Tracker"): (lambda value: al.Tracker(CAMERA, quality=value), NO_QUALITIES),
    ("quality", "make_estimator"): (lambda value: al.make_estimator("proxy", value), NO_QUALITIES),
    ("light", "make_estimator"): (lambda value: al.make_estimator("proxy", light=value), NO_QUALITIES),
    ("empty_bgr", "estimate_light"): (
        lambda value: al.estimate_light(GREY, CAMERA, empty_bgr=value),
        [one for one in NO_PICTURES if one is not None] + [GREY[:40]],
    ),
    ("light", "estimate_light"): (lambda value: al.estimate_light(GREY, CAMERA, light=value), NO_QUALITIES),
    ("caster", "make_estimator"): (
        lambda value: al.make_estimator(caster=value),
        [one for one in NO_NAMES if one is not None],
    ),
    ("name", "make_estimator"): (al.make_estimator, NO_NAMES),
    ("estimator", "estimate_light"): (
        lambda value: al.estimate_light(GREY, CAMERA, estimator=value),
        (*NO_NAMES, al.make_estimator()),
    ),
    ("tracked", "estimate"): (lambda value: al.make_estimator().estimate(value), (None, "a", GREY)),
    ("quality", "Renderer"): (lambda value: al.Renderer((64, 48), value), NO_QUALITIES),
    ("size", "Renderer"): (al.Renderer, (*NO_SIZES, (16384, 16384))),
    ("size", "from_hfov"): (lambda value: al.Camera.from_hfov(value, 60), NO_SIZES),
    ("hfov_deg", "from_hfov"): (lambda value: al.Camera.from_hfov((64, 48), value), NO_ANGLES),
    ("focal_px", "from_focal"): (lambda value: al.Camera.from_focal((64, 48), value), NO_LENGTHS),
    ("K", "Camera"): (
        lambda value: al.Camera((64, 48), value, np.zeros(5), "file"),
        (None, "a", np.eye(2), -np.eye(3), CAMERA.K.T, CAMERA.K + np.eye(3, k=1), CAMERA.K + np.eye(3, k=-1)),
    ),
    ("dist", "Camera"): (
        lambda value: al.Camera((64, 48), CAMERA.K, value, "file"),
        (None, "a", [1, 2], [1e300] * 5, np.zeros((2, 5))),
    ),
    ("to_light_marker", "Light"): (al.Light, NO_DIRECTIONS),
    ("confidence", "Light"): (
        lambda value: al.Light((0, 0, 1), confidence=value),
        ("a", -1, 2, float("nan")),
    ),
    ("lights", "Illumination"): (al.Illumination, (None, "a", (1,), [A_LIGHT])),
    ("image_bgr", "markers_in_view"): (al.markers_in_view, (None, GREY.astype(float), GREY[..., 0])),
    ("ground_rgb", "Illumination"): (lambda value: al.Illumination(ground_rgb=value), ("abc", (1, 2), {})),
    ("tracked", "as_seen_in"): (al.Illumination().as_seen_in, ("a", np.eye(4))),
    ("camera", "TrackedFrame"): (lambda value: al.TrackedFrame(TRACKED.frame, value, None), (None, 60)),
    ("scale", "Placement"): (al.Placement, (None, "a", 0, -1, float("nan"), 1e300, True)),
    ("turn_rad", "Placement"): (lambda value: al.Placement(turn_rad=value), (None, "a", float("nan"), True)),
    ("shift_m", "Placement"): (
        lambda value: al.Placement(shift_m=value),
        (None, 1.0, "ab", (1.0,), (0.0, float("nan")), (0.0, "a")),
    ),
    ("marker", "TrackedFrame"): (lambda value: al.TrackedFrame(TRACKED.frame, CAMERA, value), ("a", np.eye(4))),
}


@pytest.mark.parametrize(("argument", "function"), WRONG)
def test_wrong_use_names_the_argument(argument, function, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, values = WRONG[argument, function]
    for value in values:
        with pytest.raises((TypeError, ValueError), match=rf"\b{argument}\b"):
            call(value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("argument", "values"),
    [
        ("tracked", (None, "a", GREY)),
        ("model", (None, 7, "a\0b", [], (), ["cube"] * 10, ["cube", 7], ("cube", None), [("cube", "mug")])),
        ("illumination", ("a", A_LIGHT)),
        ("time_s", ("a", float("nan"))),
        ("up", ("a", "", "Z", 1)),
    ],
)
def test_wrong_use_of_a_renderer_names_the_argument(argument, values):
    right = {"tracked": TRACKED, "model": "cube"}
    with al.Renderer((64, 48)) as renderer:
        for value in values:
            with pytest.raises((TypeError, ValueError), match=rf"\b{argument}\b"):
                renderer.render(**{**right, argument: value})
        assert renderer.render(**right).shape == (48, 64, 3), "nothing of it is left"


def test_a_model_that_is_not_there_is_named_before_any_marker_is_seen():
    assert TRACKED.marker is None
    with al.Renderer((64, 48)) as renderer:
        no_name = "no model 'mgu'"
        for name, said in (("mgu", no_name), ("mug.obj", "no file mug.obj"), (["cube", "mgu"], no_name)):
            with pytest.raises(al.UserError, match=said):
                renderer.render(TRACKED, name)


def test_a_picture_that_is_interrupted_does_not_spoil_the_next(ran, monkeypatch):
    """As by Ctrl-C, or by a notebook's button, while a model is prepared for being drawn."""
    tracked, add = ran["tracked"], ContactPatch.add

    def interrupted(patch: ContactPatch, *arguments: object) -> object:
        signal.raise_signal(signal.SIGINT)
        return add(patch, *arguments)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # not ignored, as in a shell's background job
    try:
        with al.Renderer((320, 240), "fast") as renderer, al.Renderer((320, 240), "fast") as fresh:
            with monkeypatch.context() as patched:
                patched.setattr(ContactPatch, "add", interrupted)
                with pytest.raises(KeyboardInterrupt):
                    renderer.render(tracked, "mug")
            np.testing.assert_array_equal(renderer.render(tracked, "mug"), fresh.render(tracked, "mug"))
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_renderer_is_for_its_own_thread_and_process_and_until_it_is_released():
    renderer = al.Renderer((64, 48))
    with ThreadPoolExecutor(1) as others, pytest.raises(ValueError, match="thread"):
        others.submit(renderer.render, TRACKED, "cube").result()
    child = os.fork()
    if child == 0:
        try:
            renderer.render(TRACKED, "cube")
        except ValueError:
            os._exit(0)
        finally:
            os._exit(1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert renderer.render(TRACKED, "cube").shape == (48, 64, 3)
    for _ in range(2):
        renderer.release()
    with pytest.raises(ValueError, match="released"):
        renderer.render(TRACKED, "cube")


def test_a_renderer_that_is_never_released_is_a_resource_warning():
    renderers = [al.Renderer((64, 48))]
    with pytest.warns(ResourceWarning, match="never released"):
        renderers.clear()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        with pytest.raises(ValueError, match="quality"):
            al.Renderer((64, 48), "no such")
        al.Renderer((64, 48)).release()
    assert not [each for each in warned if "never released" in str(each.message)]


def test_a_process_that_is_forked_from_one_with_a_renderer_refuses_to_make_another():
    """It would wait for ever for threads of the driver that are in the other process."""
    with al.Renderer((64, 48)):
        child = os.fork()
        if child == 0:
            signal.alarm(20)  # which ends it where it hangs
            try:
                al.Renderer((64, 48))
            except ValueError as error:
                os._exit(0 if "spawn" in str(error) else 2)
            finally:
                os._exit(1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


FAILED_BEFORE_A_FORK = """
import os

import moderngl

import ashe_live as al


def fails(*arguments, **named):
    raise ValueError("no display")


make, moderngl.create_context = moderngl.create_context, fails
try:
    al.Renderer((64, 48))
except al.UserError as error:
    assert "no display" in error.message
moderngl.create_context = make
child = os.fork()
if child == 0:
    al.Renderer((64, 48)).release()
    os._exit(0)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
"""


def test_a_process_in_which_no_renderer_could_be_made_does_not_count_as_one_with_a_renderer():
    """Its child was told that it had been forked from one that used OpenGL."""
    subprocess.run([sys.executable, "-c", FAILED_BEFORE_A_FORK], check=True, timeout=120, cwd=CHECKOUT)


def test_what_a_person_can_mend_is_a_user_error():
    camera, grey = CAMERA, GREY
    with pytest.raises(al.UserError):
        al.estimate_light(grey, camera, marker="qr:7")
    with pytest.raises(al.UserError):
        al.estimate_light(grey, al.Camera.from_hfov((100, 20), 60))
    with pytest.raises(al.UserError):
        al.estimate_light(grey, camera, caster="tin")


def test_every_name_is_there_and_no_other():
    for name in al.__all__:
        assert getattr(al, name).__name__ == name
    assert set(dir(al)) == {*al.__all__, "__version__"}
    with pytest.raises(AttributeError, match="no attribute 'learn'"):
        al.learn  # noqa: B018


@pytest.mark.parametrize("name", al.__all__)
def test_help_tells_what_every_field_and_member_is(name):
    kind = getattr(al, name)
    said = inspect.getdoc(kind)
    if dataclasses.is_dataclass(kind):
        told = ",".join(re.findall(r"^([\w, ]+): ", said, re.MULTILINE)).replace(" ", "").split(",")
        assert {field.name for field in dataclasses.fields(kind)} <= {*told}
    if isinstance(kind, type):
        fields = getattr(kind, "__slots__", ())
        members = {name: member for name, member in vars(kind).items() if name[0] != "_" and name not in fields}
        assert [name for name, member in members.items() if not inspect.getdoc(member)] == []


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import ashe_live", {"cv2", "numpy", "moderngl", "glfw", "av", "trimesh", "PIL"}),
        ("import ashe_live; ashe_live.estimate_light, ashe_live.Tracker, ashe_live.Renderer", {"moderngl", "glfw"}),
    ],
)
def test_importing_loads_nothing_that_is_not_asked_for(code, absent):
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
        cwd=PAGE.parents[1],
    )
    loaded = set(done.stdout.split())
    assert "ashe_live" in loaded
    assert not loaded & absent


def test_several_pictures_of_one_scene_have_one_answer_for_the_first_with_a_marker(picture_of_box):
    camera = al.Camera.from_hfov((640, 480), 55)
    empty = np.full((480, 640, 3), 140, np.uint8)
    pictures = [picture_of_box(azimuth) for azimuth in (-100, -90)]
    alone = al.estimate_light(pictures[0], camera, quality="fast")
    together = al.estimate_light([empty, *pictures], camera, quality="fast")
    assert alone.views == (0,)
    assert together.frame_index == together.views[0] == 1
    assert set(together.views) <= {1, 2}
    assert al.estimate_light([empty], camera).reason == "no marker found"
    with pytest.raises(ValueError, match="no picture"):
        al.estimate_light([], camera)


def test_of_several_pictures_one_of_another_scene_is_neither_answered_for_nor_used(picture_of_box):
    camera = al.Camera.from_hfov((640, 480), 55)
    odd = picture_of_box(-100, 20.0)
    estimate = al.estimate_light(
        [odd, *(picture_of_box(azimuth) for azimuth in (-95, -90, -85))], camera, quality="fast"
    )
    assert estimate.frame_index == 1
    assert set(estimate.views) <= {1, 2, 3}
    truth = direction_from_angles(np.radians(200.0), np.radians(42))
    assert np.degrees(angle_between(estimate.light.to_light_marker, truth)) < 5


def test_each_picture_of_several_is_looked_at_by_itself_and_those_of_a_tracker_until_it_is_reset(picture_of_box):
    """Where the marker is covered in a picture of another view, it is not followed there from the picture before."""
    camera, shown = al.Camera.from_hfov((640, 480), 55), picture_of_box(-100)
    covered = shown.copy()
    for corner in al.Tracker(camera).track(shown).marker.corners_px:
        cv2.circle(covered, np.round(corner).astype(int).tolist(), 15, (60, 90, 130), -1)
    tracker = al.Tracker(camera)
    assert tracker.track(shown).marker is not None
    assert tracker.track(covered).marker is not None, "a hand that passes in a film"
    tracker.reset()
    assert tracker.track(covered).marker is None

    assert al.estimate_light([shown, covered], camera, quality="fast").views == (0,)
    with pytest.raises(al.UserError, match="shows no marker"):
        al.estimate_light(shown, camera, empty_bgr=covered)


def test_a_known_caster_is_the_real_object_of_the_answer(picture_of_box):
    camera = al.Camera.from_hfov((640, 480), 55)
    picture = picture_of_box(-100)
    base, top = box_corners()
    known = al.estimate_light(picture, camera, quality="fast", caster="box:0.05x0.05x0.08")
    assert known.light is not None
    points = known.illumination.real_object.points_marker()
    nearest = np.linalg.norm(points[:, None] - np.concatenate([base, top]), axis=2).min(axis=0)
    assert nearest.max() < 0.002
    assert al.make_estimator(quality="fast", caster="sphere:0.2").estimate(al.Tracker(camera).track(picture)).reason


def test_other_views_are_tracked_frames_and_those_without_a_marker_are_left_out(picture_of_box):
    camera = al.Camera.from_hfov((640, 480), 55)
    tracker, estimator = al.Tracker(camera), al.make_estimator("proxy", "fast")
    first, empty = tracker.track(picture_of_box(-100)), tracker.track(np.full((480, 640, 3), 140, np.uint8))
    answer = estimator.estimate(first, [empty])
    assert answer.views == (0,)
    assert answer.span_rad is None
    for wrong in ([picture_of_box(-90)], first, None):
        with pytest.raises(TypeError, match=r"\bothers\b"):
            estimator.estimate(first, wrong)


def test_other_views_may_come_one_by_one(picture_of_box):
    tracker, estimator = al.Tracker(al.Camera.from_hfov((640, 480), 55)), al.make_estimator("proxy", "fast")
    first, second = (tracker.track(picture_of_box(azimuth)) for azimuth in (-100, -90))
    assert estimator.estimate(first, (each for each in [second])).views == (0, 1)


TYPED = """
import dataclasses

import cv2
import numpy as np
from numpy.typing import NDArray

import ashe_live as al


def light_of(estimator: al.LightEstimator, tracker: al.Tracker, frame: al.Frame) -> al.LightEstimate:
    return estimator.estimate(tracker.track(frame.image_bgr, frame.time_s))


def shown(renderer: al.Renderer, tracked: al.TrackedFrame, light: al.Light | None) -> NDArray[np.uint8]:
    lights = () if light is None else (light,)
    return renderer.render(tracked, al.model_names(), al.Illumination(lights))


picture = cv2.imread("table.png")
assert picture is not None
calibration = cv2.calibrateCamera([], [], (640, 480), None, None)
camera = al.Camera((640, 480), calibration[1], calibration[2], "file")
for estimate in (
    al.estimate_light(picture, camera),
    al.estimate_light([picture, cv2.flip(picture, 0)], camera),
    al.estimate_light(picture, camera, empty_bgr=cv2.GaussianBlur(picture, (3, 3), 0)),
):
    direction: NDArray[np.float64] | None = None if estimate.light is None else estimate.light.to_light_marker
tracked = al.Tracker(camera).track(picture)
al.write_png("half.png", cv2.resize(picture, (320, 240)))
solved, rotation, shift = cv2.solvePnP(np.zeros((4, 3)), np.zeros((4, 2)), camera.K, camera.dist)
T_cam_table = np.eye(4, dtype=np.float32)
T_cam_table[:3, :3], T_cam_table[:3, 3] = cv2.Rodrigues(rotation)[0], shift[:, 0]
corners, _ = cv2.projectPoints(np.zeros((4, 3)), rotation, shift, camera.K, camera.dist)
pose = al.MarkerPose(T_cam_table, corners.reshape(4, 2), 0.08, 0.0, None, covariance=np.eye(6, dtype=np.float32))
al.TrackedFrame(al.Frame(picture, 0, 0.0), camera, pose)
al.Tracker(dataclasses.replace(camera, source="estimated"), side_m="0.08")
"""


def test_programs_that_are_written_as_the_page_says_pass_a_strict_check_of_types(tmp_path):
    """With pictures as OpenCV's own types have them; a wrong argument, in the last line, is found."""
    (tmp_path / "page.py").write_text("\n".join(EXAMPLES))
    (tmp_path / "typed.py").write_text(TYPED)
    mypy = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--config-file", os.devnull]
    done = subprocess.run(
        [*mypy, "--cache-dir", "types", "page.py", "typed.py"],
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(CHECKOUT)},
        capture_output=True,
        text=True,
    )
    last = len(TYPED.splitlines())
    errors = [line for line in done.stdout.splitlines() if ": error: " in line]
    assert [error.split(": error: ")[0] for error in errors] == [f"typed.py:{last}"], done.stdout + done.stderr
    assert "side_m" in errors[0]

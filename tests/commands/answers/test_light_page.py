"""The page of thumbnails: what is drawn into a picture, how large it is, and what the page says about it."""

import base64
import re
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.commands.answers.light_page import WIDTH_PX, LightPage, picture_of
from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.areas import grown
from ashe_live.light.shape.predicted import outline, painted, shadow_outline
from tests.light.painted_scenes import HFOV_DEG, SIDE_M, VIEW, tracked_frame
from tests.light.synthetic_masks import camera_towards, direction

SIZE = (WIDTH_PX, 360)
CAMERA = Camera.from_hfov(SIZE, HFOV_DEG)
FROM_EAST = direction(10.0, 50.0)


def grey(T_cam_marker: Float = VIEW) -> TrackedFrame:
    return tracked_frame(np.full((SIZE[1], SIZE[0], 3), 110, np.uint8), CAMERA, T_cam_marker)


def lit_from(*to_lights: Float) -> LightEstimate:
    return LightEstimate("test", 7, Illumination(tuple(Light(each) for each in to_lights)))


def drawn(picture: Image, frame: TrackedFrame) -> Mask:
    return np.asarray((picture != frame.frame.image_bgr).any(axis=2))


@pytest.mark.parametrize("to_light", [FROM_EAST, direction(190.0, 30.0), direction(80.0, 70.0)])
def test_an_arrow_comes_from_the_light_and_points_to_the_marker(to_light: Float) -> None:
    frame = grey()
    rows, columns = np.nonzero(drawn(picture_of(frame, lit_from(to_light)), frame))
    towards, middle = project(CAMERA, VIEW, np.array([SIDE_M * to_light, np.zeros(3)]))
    along = (towards - middle) / np.linalg.norm(towards - middle)
    places = np.column_stack([columns, rows]) - middle
    far, aside = places @ along, places @ np.array([-along[1], along[0]])
    assert far.min() > 0
    assert np.abs(aside).max() < 0.25 * np.ptp(far)
    at_tip = far < far.min() + 0.3 * np.ptp(far)
    assert np.ptp(aside[at_tip]) > 2 * np.ptp(aside[~at_tip])  # which has barbs


def test_a_light_whose_arrow_is_out_of_view_has_none_beside_one_that_has() -> None:
    T_cam_marker = camera_towards((0.0, 0.0), 0.12, 50.0)
    frame, at_eye = grey(T_cam_marker), -T_cam_marker[2, :3]
    assert not drawn(picture_of(frame, lit_from(at_eye)), frame).any()
    both, one = (picture_of(frame, lit_from(*lights)) for lights in ((at_eye, FROM_EAST), (FROM_EAST,)))
    np.testing.assert_array_equal(both, one)
    assert drawn(one, frame).any()


def test_the_fitted_body_and_its_shadow_are_outlined() -> None:
    frame, alone = grey(), lit_from(FROM_EAST)
    body = Proxy("ball", np.array([[0.1, 0.0, 0.03, 0.03, 0.03]]))
    with_body = replace(alone, illumination=replace(alone.illumination, real_object=body))
    lines = (picture_of(frame, with_body) != picture_of(frame, alone)).any(axis=2)
    points = body.points_marker()
    shadow = shadow_outline(CAMERA, VIEW, points, Light(FROM_EAST).homogeneous)
    for each in (outline(CAMERA, VIEW, points), shadow):
        filled = painted([each], (SIZE[1], SIZE[0])).body
        border = grown(filled, 1) & ~filled
        assert np.count_nonzero(lines & border) > 0.9 * np.count_nonzero(border) > 50


@pytest.mark.parametrize(
    ("size", "shown"),
    [((2 * WIDTH_PX, 500), (WIDTH_PX, 250)), ((320, 240), (320, 240)), ((5000, 1), (WIDTH_PX, 1)), ((1, 9), (1, 9))],
)
def test_a_picture_without_light_is_no_larger_than_it_was_and_keeps_its_shape(
    size: tuple[int, int], shown: tuple[int, int]
) -> None:
    frame = tracked_frame(np.full((size[1], size[0], 3), 90, np.uint8), Camera.from_hfov(size, 60.0))
    for tracked, estimate in ((frame, None), (replace(frame, marker=None), lit_from(FROM_EAST))):
        assert picture_of(tracked, estimate).shape == (shown[1], shown[0], 3)


def page_of(path: Path, *names: str) -> str:
    page = LightPage()
    assert not page.has_figures
    for name in names:
        page.add(name, 'a "light"', np.full((30, 50, 3), 200, np.uint8))
    assert page.has_figures
    return page.write(path, overwrite=False).read_text(encoding="utf-8")


def test_each_picture_has_its_size_and_says_what_is_said_about_it(tmp_path: Path) -> None:
    text = page_of(tmp_path / "one.html", "a.png")
    ((data, attributes),) = re.findall(r'<img src="data:image/jpeg;base64,([^"]+)" ([^>]*)>', text)
    assert attributes == 'width="50" height="30" alt="a.png: a &quot;light&quot;"'
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (30, 50, 3)
    assert "<h1>Light in 1 picture</h1>" in text
    assert "<h1>Light in 2 pictures</h1>" in page_of(tmp_path / "two.html", "a.png", "b.png")


def test_a_name_that_is_no_text_is_no_reason_to_lose_the_page(tmp_path: Path) -> None:
    assert r"caf\udce9.png" in page_of(tmp_path / "page.html", "caf\udce9.png")


def test_a_file_that_has_appeared_meanwhile_stays_and_the_page_is_put_beside_it(tmp_path: Path) -> None:
    """A batch may take an hour."""
    page, path = LightPage(), tmp_path / "page.html"
    page.add("a.png", "light", None)
    path.write_text("precious")
    written = page.write(path, overwrite=False)
    assert path.read_text() == "precious"
    assert written.parent == tmp_path
    assert "a.png" in written.read_text(encoding="utf-8")
    assert page.write(path, overwrite=True) == path

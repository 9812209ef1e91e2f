"""The camera's conventions: pixel centres at integers, scaling about the image's edge, files and their errors."""

import json
import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import DISTORTION_LENGTHS, Camera, drawn_size, fitted, read_camera_file
from ashe_live.core.ranges import DRAWN, FIELD_OF_VIEW, FOCAL, SIDE
from ashe_live.errors import UserError


def test_hfov_spans_the_columns_edge_to_edge() -> None:
    camera = Camera.from_hfov((640, 480), 90)
    assert camera.K[0, 0] == pytest.approx(320)
    assert camera.hfov_deg == pytest.approx(90)
    left_edge = (-0.5 - camera.K[0, 2]) / camera.K[0, 0]
    assert math.degrees(math.atan(left_edge)) == pytest.approx(-45)


@pytest.mark.parametrize("hfov_deg", [FIELD_OF_VIEW.low, FIELD_OF_VIEW.high])
@pytest.mark.parametrize("width", [SIDE.low, SIDE.high])
def test_every_field_of_view_goes_with_every_width(hfov_deg: float, width: float) -> None:
    camera = Camera.from_hfov((int(width), 1), hfov_deg)
    assert camera.K[0, 0] in FOCAL
    assert camera.hfov_deg == pytest.approx(hfov_deg)


@pytest.mark.parametrize("size", [(640, 480), (480, 640), (1080, 1920), (100, 100)])
def test_a_field_of_view_across_the_longer_side_is_the_same_camera_however_it_is_held(size: tuple[int, int]) -> None:
    camera = Camera.from_longer_side(size, 60)
    held_across = Camera.from_hfov((max(size), min(size)), 60)
    assert camera.size == size
    assert camera.K[0, 0] == camera.K[1, 1] == held_across.K[0, 0]


@pytest.mark.parametrize(
    ("size", "film_mm"),
    [((4032, 3024), 26), ((3024, 4032), 24), ((3024, 4032), 26), ((3024, 4032), 28), ((1080, 1920), 30)],
)
def test_what_is_assumed_of_a_camera_holds_for_phones_within_its_sigma(size: tuple[int, int], film_mm: float) -> None:
    """By the focal length that sees as much on 35 mm film, along its diagonal."""
    true_px = film_mm * math.hypot(*size) / math.hypot(36, 24)
    camera = Camera.assumed(size)
    assert camera.source == "assumed"
    assert abs(camera.K[0, 0] - true_px) < (1 if size[0] > size[1] else 0.5) * camera.focal_sigma_px


def test_resizing_keeps_the_direction_of_every_edge() -> None:
    K = [[800, 0, 610.0], [0, 820, 371.0], [0, 0, 1]]
    camera = Camera((1280, 720), np.array(K), np.zeros(5), "file")
    small = camera.resized((640, 360))
    for edge, small_edge in ((-0.5, -0.5), (1279.5, 639.5)):
        assert (small_edge - small.K[0, 2]) / small.K[0, 0] == pytest.approx((edge - camera.K[0, 2]) / camera.K[0, 0])
    np.testing.assert_allclose(small.resized((1280, 720)).K, camera.K)


def test_resizing_allows_for_rounding_to_whole_pixels_and_refuses_another_shape() -> None:
    camera = Camera.from_hfov((1920, 1080), 60)
    assert camera.resized((853, 480)).size == (853, 480)
    for wrong in ((640, 480), (850, 480), (857, 480), (1920, 1082)):
        with pytest.raises(ValueError, match="aspect ratio"):
            camera.resized(wrong)
    with pytest.raises(UserError, match="the lens does not fit the picture"):
        fitted(camera, (640, 480), "the lens")


@pytest.mark.parametrize(("size", "said"), [((1080, 1920), "hold the camera as"), ((640, 480), "at this aspect ratio")])
def test_of_a_picture_that_was_taken_upright_the_other_way_to_hold_the_camera_is_named(size, said: str) -> None:
    with pytest.raises(UserError, match="does not fit the picture") as caught:
        fitted(Camera.from_hfov((1920, 1080), 60), size)
    assert said in caught.value.remedy


def test_a_picture_that_is_too_large_is_not_told_to_be_calibrated_for() -> None:
    with pytest.raises(ValueError, match="a side of the picture's size must be a number from 1 to 16384 px"):
        fitted(Camera.from_hfov((640, 480), 60), (32000, 24000))


@pytest.mark.parametrize("count", range(16))
def test_distortion_has_as_many_coefficients_as_opencv_takes(count: int) -> None:
    def with_distortion() -> Camera:
        return Camera((640, 480), np.diag([500.0, 500.0, 1.0]), np.full(count, 0.01), "file")

    if count in DISTORTION_LENGTHS:
        points = np.array([(0.1, 0.2, 1.0)])
        assert cv2.projectPoints(points, np.zeros(3), np.zeros(3), with_distortion().K, with_distortion().dist)
        assert not with_distortion().without_distortion().is_distorted
    else:
        with pytest.raises(ValueError, match=f"dist has {count} coefficients"):
            with_distortion()


@pytest.mark.parametrize("size", [(640, 480), (4096, 4096), (16384, 9216), (3000, 16000), (16384, 1)])
def test_what_is_too_large_to_be_drawn_is_reduced_and_keeps_its_shape(size: tuple[int, int]) -> None:
    width, height = drawn_size(size)
    assert width * height in DRAWN
    if size[0] * size[1] in DRAWN:
        assert (width, height) == size
    else:
        assert width * height > 0.999 * DRAWN.high
        assert abs(width - height * size[0] / size[1]) < 2 * max(size) / min(size)


@pytest.mark.parametrize("hfov_deg", [0.0, 180.0, -60.0, math.nan])
def test_a_field_of_view_that_no_camera_has_is_named(hfov_deg: float) -> None:
    for make in (Camera.from_hfov, Camera.from_longer_side):
        with pytest.raises(ValueError, match="fov_deg"):
            make((640, 480), hfov_deg)
    with pytest.raises(ValueError, match="focal_px"):
        Camera.from_focal((640, 480), 0.0)


@pytest.mark.parametrize("sigma_px", [-1.0, math.inf, 1e300, None, "1", True, np.ones(2)])
def test_a_deviation_that_no_focal_length_has_is_wrong_use(sigma_px: float) -> None:
    with pytest.raises((ValueError, TypeError), match="focal_sigma_px"):
        Camera.from_focal((640, 480), 500.0, focal_sigma_px=sigma_px)


def test_a_picture_nearly_at_right_angles_to_the_lens_is_refused() -> None:
    """An estimate by such a camera ended in NumPy's words. A part cut out of a wide picture is as good as any."""
    beside = np.array([(430.0, 0.0, 1e7), (0.0, 430.0, 240.0), (0.0, 0.0, 1.0)])
    for K in (beside, beside[[1, 0, 2]][:, [1, 0, 2]]):
        with pytest.raises(ValueError, match="principal point"):
            Camera((640, 480), K, np.zeros(5), "file")
    Camera((640, 480), [(430.0, 0.0, -9000.0), (0.0, 430.0, 4000.0), (0.0, 0.0, 1.0)], np.zeros(5), "file")


def test_a_size_and_an_angle_of_another_kind_are_named() -> None:
    for size in (None, 7, ("a", 3), (640.5, 480)):
        for make in (Camera.assumed, Camera.from_hfov((640, 480), 60.0).resized):
            with pytest.raises(TypeError, match="size"):
                make(size)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="fov_deg"):
        Camera.from_longer_side((640, 480), 200.0)


def test_a_source_that_is_none_is_wrong_use() -> None:
    with pytest.raises(ValueError, match="source 'guess' is not one of file, flag, exif, assumed, estimated"):
        Camera.from_focal((640, 480), 500.0, "guess")


def test_reads_a_calibration(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({"size": [640, 480], "K": np.diag([500, 500, 1]).tolist(), "dist": [0.1, 0, 0, 0]}))
    camera = read_camera_file(path)
    assert (camera.size, camera.source, camera.is_distorted) == ((640, 480), "file", True)


@pytest.mark.parametrize("shape", [(1, -1), (-1, 1)])
def test_distortion_may_stand_in_a_row_or_a_column_as_opencv_has_it(tmp_path: Path, shape: tuple[int, int]) -> None:
    K, dist = np.diag([500.0, 500, 1]), np.array([0.1, -0.02, 0.001, 0, 0])
    camera = Camera((640, 480), K, dist.reshape(shape), "file")
    np.testing.assert_array_equal(camera.dist, dist)
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({"size": [640, 480], "K": K.tolist(), "dist": dist.reshape(shape).tolist()}))
    np.testing.assert_array_equal(read_camera_file(path).dist, dist)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ('"size": 640, "K": [[1,0,0],[0,1,0],[0,0,1]]', "(size is not a width and a height)"),
        ('"size": [640, 480, 3], "K": [[1,0,0],[0,1,0],[0,0,1]]', "(size is not a width and a height)"),
        ('"size": [640, 480], "K": [[1,0,0],[0,1],[0,0,1]]', "(K is not made of numbers, in rows of one length)"),
        ('"size": [640, 480], "K": [[1,0,0],[0,1,0],[0,0,1]], "dist": {"k1": 0}', "(dist is not made of numbers"),
    ],
)
def test_what_is_wrong_in_a_camera_file_is_said_in_its_own_words(tmp_path: Path, values: str, said: str) -> None:
    """Python's would speak of values to unpack, and NumPy's of an inhomogeneous shape."""
    (tmp_path / "camera.json").write_text(f"{{{values}}}")
    with pytest.raises(UserError) as caught:
        read_camera_file(tmp_path / "camera.json")
    assert said in caught.value.message


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        "null",
        '{"size": [640, 480]}',
        '{"size": [640], "K": [[1,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480.5], "K": [[1,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[0,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[NaN,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[1,0,0],[0,1,0],[0,0,1]], "dist": [1, 2, 3]}',
        '{"size": [640, 480], "K": [[1,0,0],[0,1,0],[0,0,1]], "dist": "none"}',
        '{"size": [640, 480], "K": [[1e400,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[1e300,0,0],[0,1,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[500,0,1e300],[0,500,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[500,0,0],[0,500,1e300],[0,0,1]]}',
        '{"size": [640, 480], "K": [[500,0,0],[0,1e300,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[500,1e300,0],[0,500,0],[0,0,1]]}',
        '{"size": [640, 480], "K": [[500,0,0],[0,500,0],[0,0,2]]}',
        '{"size": [640, 480], "K": [[500,0,0],[0,500,0],[0,1e-3,1]]}',
        '{"size": [640, 480], "K": [[500,0,0],[0,500,0],[0,0,1]], "dist": [1e300, 0, 0, 0]}',
        '{"size": [99999999999999999999, 480], "K": [[500,0,0],[0,500,0],[0,0,1]]}',
        "[" * 100_000,
    ],
)
def test_a_file_that_is_no_calibration_is_named(tmp_path: Path, content: str) -> None:
    path = tmp_path / "camera.json"
    path.write_text(content)
    with pytest.raises(UserError, match=r"camera\.json is (empty|not (a calibration|JSON))"):
        read_camera_file(path)


@pytest.mark.parametrize(
    "content",
    [
        "%YAML:1.0\n---\nimage_width: 640\n",  # as OpenCV's FileStorage writes it
        "image_width: 640\ncamera_matrix:\n  rows: 3\n",  # as ROS does
        '<?xml version="1.0"?>\n<opencv_storage></opencv_storage>\n',
        "1 SIMPLE_RADIAL 640 480 600 320 240 0.01\n",  # as COLMAP does
    ],
)
def test_of_other_programs_calibrations_it_is_said_what_is_needed(tmp_path: Path, content: str) -> None:
    """To write them again, as they are, would not help."""
    path = tmp_path / "camera.yaml"
    path.write_text(content)
    with pytest.raises(UserError, match="is not JSON") as caught:
        read_camera_file(path)
    assert '{"size": [width, height], "K": 3x3 numbers' in caught.value.remedy


@pytest.mark.parametrize(
    ("key", "model", "is_read"),
    [("distortion_model", "equidistant", False), ("model", "Fisheye", False), ("distortion_model", "plumb_bob", True)],
)
def test_four_coefficients_of_a_fisheye_model_are_taken_for_no_others(
    tmp_path: Path, key: str, model: str, is_read: bool
) -> None:
    path = tmp_path / "camera.json"
    K = [[400, 0, 319.5], [0, 400, 239.5], [0, 0, 1]]
    path.write_text(json.dumps({"size": [640, 480], "K": K, "dist": [0.1, 0.01, 0.0, 0.0], key: model}))
    if is_read:
        assert read_camera_file(path).is_distorted
        return
    with pytest.raises(UserError, match=model):
        read_camera_file(path)


@pytest.mark.parametrize(
    ("K", "words"),
    [
        ("[[430,200,320],[0,430,240],[0,0,1]]", "skew"),
        ("[[430,0,320],[200,430,240],[0,0,1]]", "must be 0"),
        ("[[430,0,320],[0,700,240],[0,0,1]]", "too unlike"),
        ("[[430,0,5000],[0,430,-5000],[0,0,1]]", "far outside of the picture"),
    ],
)
def test_a_lens_that_no_camera_has_is_refused_and_said(tmp_path: Path, K: str, words: str) -> None:
    """By OpenCV's model, which knows no skew: its poses would be confidently wrong."""
    path = tmp_path / "camera.json"
    path.write_text(f'{{"size": [640, 480], "K": {K}}}')
    with pytest.raises(UserError, match=words):
        read_camera_file(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no file"):
        read_camera_file(tmp_path / "camera.json")

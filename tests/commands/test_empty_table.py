"""`estimate --empty`: a photo of the table without the object."""

import math
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.transforms import angle_between, image_from_plane
from ashe_live.files.resources import resource
from ashe_live.tracking.families.markers import parse_marker
from tests.light.painted_scenes import BOX, HFOV_DEG, SIDE_M, Painted, paint
from tests.light.synthetic_masks import camera_towards

KNOWN = ("--hfov", f"{HFOV_DEG:g}", "--marker", "aruco:4x4_50:0")


@dataclass(frozen=True)
class Photos:
    full: Path
    empty: Path
    aside: Path  # the empty table from another side
    other: Path  # another one
    to_light: np.ndarray


def printed(painted: Painted, marker: str = "aruco:4x4_50:0") -> Image:
    """The picture with a print on its sheet that can be read."""
    tracked = painted.tracked
    print_px = 200
    metres = SIDE_M / print_px
    plane_from_print = np.array([(metres, 0, -SIDE_M / 2), (0, -metres, SIDE_M / 2), (0, 0, 1)])
    pixels = image_from_plane(tracked.camera, tracked.marker.T_cam_marker) @ plane_from_print
    bitmap = cv2.cvtColor(parse_marker(marker).bitmap(print_px), cv2.COLOR_GRAY2BGR)
    image = np.array(tracked.frame.image_bgr)
    size, border = tracked.camera.size, cv2.BORDER_TRANSPARENT
    return cv2.warpPerspective(bitmap // 2 + 20, pixels, size, dst=image, flags=cv2.INTER_AREA, borderMode=border)


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Photos:
    folder = tmp_path_factory.mktemp("photos")
    scene = paint(BOX, ground="bricks", seed=1)
    empty = paint(ground="bricks", seed=2)
    aside = paint(ground="bricks", T_cam_marker=camera_towards((0.0, 0.0), 0.5, 80.0), seed=3)
    other = paint(ground="striped", seed=4)
    for name, painted in (("full", scene), ("empty", empty), ("aside", aside), ("other", other)):
        cv2.imwrite(str(folder / f"{name}.png"), printed(painted))
    return Photos(*(folder / f"{name}.png" for name in ("full", "empty", "aside", "other")), scene.to_light)


@pytest.mark.parametrize("name", ["empty", "aside"])
def test_the_light_is_found_over_the_empty_table(run, photos, name):
    (record,) = run("estimate", "--json", *KNOWN, photos.full, "--empty", getattr(photos, name)).records
    (light,) = record["lights"]
    assert math.degrees(angle_between(np.array(light["to_light_marker"]), photos.to_light)) < 2.5


def test_an_empty_table_over_itself_has_no_light(run, photos):
    outcome = run("estimate", *KNOWN, photos.empty, "--empty", photos.empty)
    assert outcome.status == 4
    assert "no clear light" in outcome.out[0]


def test_repeated_estimates_are_over_the_empty_table_as_well(run, photos):
    asked = "estimate", "--json", *KNOWN, photos.full, "--empty", photos.empty
    (once,), (again,) = run(*asked).records, run(*asked, "--repeat", 1).records
    assert once["lights"][0]["to_light_marker"] == pytest.approx(again["lights"][0]["to_light_marker"], abs=1e-6)


def test_a_picture_that_is_no_clean_plate_is_said_in_one_line_with_status_2(run, photos, tmp_path):
    other_size, blank, notes = tmp_path / "small.png", tmp_path / "blank.png", tmp_path / "notes.txt"
    notes.write_text("the table was empty")
    empty = cv2.imread(str(photos.empty))
    cv2.imwrite(str(other_size), cv2.resize(empty, (320, 240)))
    cv2.imwrite(str(blank), np.full_like(empty, 128))
    for path, said in (
        (photos.other, "another view"),
        (other_size, "another size (320x240 and 640x480)"),
        (blank, "no marker"),
        (tmp_path / "none.png", "no file"),
        (resource("assets", "clips", "table.mp4"), "is a clip, and the empty table is shown by a photo"),
        (notes, "is not a clip or photo"),
    ):
        line = run("estimate", *KNOWN, photos.full, "--empty", path).refusal
        assert said in line
        assert path.name in line


def test_an_empty_table_with_another_marker_is_not_said_to_show_none(run, photos, tmp_path):
    another = tmp_path / "another.png"
    cv2.imwrite(str(another), printed(paint(ground="bricks", seed=2), "aruco:4x4_50:7"))
    line = run("estimate", *KNOWN, photos.full, "--empty", another).refusal
    assert "shows no marker" not in line
    assert "aruco:4x4_50:7 is in view" in line


@pytest.mark.parametrize(("flags", "said"), [(("--together",), "moves"), (("--estimator", "paper"), "no use of")])
def test_what_an_empty_table_is_of_no_use_for_is_said(run, photos, flags, said):
    assert said in run("estimate", *KNOWN, photos.full, photos.full, "--empty", photos.empty, *flags).refusal

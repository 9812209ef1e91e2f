"""Values of flags: what they mean, up to their limits and not beyond, and what is said of wrong ones."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ashe_live.commands.flags import values


@pytest.mark.parametrize(
    ("parse", "text", "value"),
    [
        (values.side_m, "0.0001", 1e-4),
        (values.side_m, "10", 10.0),
        (values.millimetres, "0.1", 0.1),
        (values.millimetres, "1e4", 10_000.0),
        (values.angle_deg, "179", 179.0),
        (values.count, "1", 1),
        (values.count, "1000000000", 10**9),
        (values.index, "0", 0),
        (values.views, "12", 12),
        (values.path, "a b.jpg", Path("a b.jpg")),
        (values.size, "1280x720", (1280, 720)),
        (values.size, "4096X4096", (4096, 4096)),
        (values.size, "16384x1", (16384, 1)),
        (values.frame_range, "30:90", (30, 90)),
        (values.frame_range, "30:", (30, None)),
        (values.frame_range, ":90", (0, 90)),
        (values.frame_range, ":", (0, None)),
        (values.frame_range, "7:7", (7, 7)),
        (values.camera, "0", "0"),
        (values.camera, "65535", "65535"),
        (values.camera, "/dev/video2", "/dev/video2"),
        (values.model, "mug", "mug"),
        (values.model, "7=mug", "7=mug"),
        (values.model, "a=b.obj", "a=b.obj"),
    ],
)
def test_what_is_right_is_taken(parse: Callable[[str], Any], text: str, value: object) -> None:
    assert parse(text) == value


@pytest.mark.parametrize("text", ["0.00009", "nan", "8 feet", "-80", "", 5000 * "9"])
def test_a_length_that_nobody_can_mean_is_not_guessed_at(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError) as said:
        values.side_m(text)
    assert "write" not in str(said.value)


@pytest.mark.parametrize(
    ("parse", "text", "said"),
    [
        (values.side_m, "10.1", "not a number from 0.0001 to 10 m"),
        (values.side_m, "0.00009", "not a number"),
        (values.side_m, "nan", "not a number"),
        (values.side_m, "8cm", "not a number from 0.0001 to 10 m: for 8 cm write 0.08"),
        (values.side_m, "80", "to 10 m: for 80 mm write 0.08"),
        (values.side_m, "0,08", "to 10 m: for 0.08 m write 0.08"),
        (values.millimetres, "8 CM", "to 10000 mm: for 8 cm write 80"),
        (values.millimetres, "0.08", "to 10000 mm: for 0.08 m write 80"),
        (values.angle_deg, "180", "not a number from 0.1 to 179 degrees"),
        (values.focal_px, "inf", "not a number"),
        (values.count, "0", "not a whole number from 1 to 1000000000"),
        (values.count, "1000000001", "not a whole number"),
        (values.count, "1.5", "not a whole number"),
        (values.index, "-1", "not a whole number from 0"),
        (values.views, "13", "not a whole number from 1 to 12"),
        (values.path, "", "it is empty and names no file"),
        (values.model, "", "it is empty and names no model"),
        (values.model, "7=", "'7=' names no model: write 7=NAME or 7=FILE"),
        (values.camera, "", "it is empty and names no camera"),
        (values.camera, "65536", "not a camera's number from 0 to 65535"),
        (values.camera, 5000 * "9", "not a camera's number"),
        (values.size, "1280", "is not a size like 1280x720"),
        (values.size, "1280x720x3", "is not a size"),
        (values.size, "0x720", "is not a size"),
        (values.size, "16385x1", "is not a size"),
        (values.size, "-1x1", "is not a size"),
        (values.size, "١x١", "is not a size"),
        (values.size, 5000 * "9" + "x1", "is not a size"),
        (values.size, "4097x4096", "has more pixels than can be drawn"),
        (values.frame_range, "30", "is not a range of frames"),
        (values.frame_range, "90:30", "is not a range of frames"),
        (values.frame_range, "a:", "is not a range of frames"),
        (values.frame_range, "-1:", "is not a range of frames"),
    ],
)
def test_what_is_wrong_is_said(parse: Callable[[str], Any], text: str, said: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError) as caught:
        parse(text)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("text", "marker", "name"),
    [
        ("mug", None, "mug"),
        ("7=mug", "7", "mug"),
        ("aruco:4x4_50:7=mug", "aruco:4x4_50:7", "mug"),
        ("pattern:a.png=b=c.obj", "pattern:a.png", "b=c.obj"),
        ("x=y.obj", None, "x=y.obj"),
        ("=mug", None, "=mug"),
    ],
)
def test_a_model_may_have_a_marker_of_its_own_and_a_file_an_equals_sign(
    text: str, marker: str | None, name: str
) -> None:
    assert values.marker_and_model(text) == (marker, name)

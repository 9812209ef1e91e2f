"""The flags that a command was given mean the same when they are given again."""

import pytest

from ashe_live.commands.flags.parser import build_parser
from ashe_live.commands.viewing.replay_flags import replay_flags


@pytest.mark.parametrize(
    "flags",
    [
        [],
        ["--marker-size", "0.15", "--focal-px", "812.5", "--quality", "fast"],
        ["--hfov", "71", "--caster", "box:0.06x0.04x0.12", "--light", "lamp", "--no-filter"],
        ["--camera-file", "camera.json", "--estimate-at", "12", "--estimator", "paper"],
    ],
)
def test_flags_given_again_are_the_same_flags(flags: list[str]) -> None:
    parser = build_parser()
    options = parser.parse_args(["play", "clip.mp4", *flags])
    assert parser.parse_args(["play", "clip.mp4", *replay_flags(options)]) == options


def test_what_the_window_chooses_by_itself_is_no_flag() -> None:
    options = build_parser().parse_args(["play", "clip.mp4", "--quality", "auto", "--loop", "--out", "here.mp4"])
    assert replay_flags(options) == []


def test_which_axis_of_the_first_file_is_up_is_no_flag_as_another_model_may_be_the_first_by_then() -> None:
    options = build_parser().parse_args(["play", "clip.mp4", "--model", "bolt.stl", "--up", "x"])
    assert replay_flags(options) == []


def test_the_demo_has_no_flags_for_what_is_known_of_its_clip() -> None:
    parser = build_parser()
    options = parser.parse_args(["demo", "--quality", "fast", "--light", "sun"])
    options.marker, options.marker_size = "aruco:4x4_50:0", 0.12
    again = parser.parse_args(["demo", *replay_flags(options)])
    assert (again.quality, again.light) == ("fast", "sun")

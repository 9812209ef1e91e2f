"""Options with the settings behind them: whose value it was that could not be used."""

import argparse
from pathlib import Path

import pytest

from ashe_live.commands.flags.options import parsed, with_origin
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.errors import UserError

SETTINGS = {"marker": "aruco:4x4_50:99", "hfov": 60}
UNKNOWN = UserError("there is no marker aruco:4x4_50:99", "choose 0 to 49")


def options(marker: str = "aruco:4x4_50:99", **more: object) -> argparse.Namespace:
    return argparse.Namespace(from_settings=SETTINGS, marker=marker, **more)


def test_of_a_value_from_the_settings_their_file_is_named() -> None:
    said = with_origin(UNKNOWN, options())
    assert said.message == UNKNOWN.message
    assert said.remedy == f"choose 0 to 49 (`marker` is set in {settings_path()})"


@pytest.mark.parametrize(
    ("error", "given"),
    [
        (UNKNOWN, options(marker="aruco:4x4_50:7")),  # a flag has replaced it, and the same value stands elsewhere
        (UserError("the disk is full", "make room"), options()),
        (UNKNOWN, argparse.Namespace(marker="aruco:4x4_50:99")),
        (UNKNOWN, None),
    ],
)
def test_of_another_error_or_value_it_is_not(error: UserError, given: argparse.Namespace | None) -> None:
    assert with_origin(error, given) is error


def test_an_axis_that_begins_like_a_flag_is_none_and_elsewhere_its_letter_is_a_name() -> None:
    for axis in ("z", "-z"):
        assert parsed(["play", "y", "--up", axis, "--mirror"]).up == axis
        assert parsed(["--model", "x", "--up", axis]).model == ("x",)
    assert parsed(["play", "y"]).file == Path("y")


def test_a_camera_may_be_a_number_there() -> None:
    given = argparse.Namespace(from_settings={"camera": 2}, camera="2")
    for said in ("camera 2 cannot be used", "there is no camera /dev/video2"):
        assert "`camera` is set in" in with_origin(UserError(said, "choose another"), given).remedy
    for other in ("there is no camera 21", "there is no file a2.mp4"):
        error = UserError(other, "choose another")
        assert with_origin(error, given) is error


def test_one_of_several_models_may_be_that_of_the_settings() -> None:
    given = argparse.Namespace(from_settings={"model": "teapot"}, model=("mug", "teapot"))
    said = with_origin(UserError("there is no model teapot", "choose another"), given)
    assert "`model` is set in" in said.remedy

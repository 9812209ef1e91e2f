"""What --model says of markers."""

import argparse

import pytest

from ashe_live.commands.flags.marker_choice import with_marker
from ashe_live.commands.flags.model_choice import chosen_models, other_markers, with_markers_spelled, without_model
from ashe_live.commands.flags.options import parsed
from ashe_live.errors import UserError
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel


def options(*arguments: str) -> argparse.Namespace:
    return parsed(["play", "a.mp4", *arguments])


def models(*names: str) -> list[str]:
    return [word for name in names for word in ("--model", name)]


def test_without_a_flag_there_is_the_cube():
    chosen = with_markers_spelled(options())
    assert chosen_models(chosen) == (ChosenModel("cube"),)
    assert chosen.takes_any_marker
    assert other_markers(chosen) == []


def test_several_stand_on_the_followed_marker():
    chosen = with_markers_spelled(options(*models("mug", "a=b.glb")))  # a file's name may have an equals sign
    assert chosen_models(chosen) == (ChosenModel("mug"), ChosenModel("a=b.glb"))
    assert chosen.takes_any_marker


def test_a_number_is_a_marker_of_the_followed_ones_family():
    named = models("07=tree.glb", "mug", "7=cube", "3=lantern")
    chosen = with_markers_spelled(options("--marker", "apriltag:36h11:3", *named))
    other = "apriltag:36h11:7"
    assert chosen_models(chosen) == (
        ChosenModel("mug"),
        ChosenModel("lantern"),
        ChosenModel("tree.glb", other),
        ChosenModel("cube", other),
    )
    assert [marker.spec for marker in other_markers(chosen)] == [other]


def test_a_number_stays_that_of_the_marker_when_another_one_is_followed():
    chosen = with_markers_spelled(options("--marker", "apriltag:36h11:3", *models("mug", "7=tree")))
    for followed in ("cube", "aruco:4x4_50:7", "apriltag:36h11:7"):
        later = with_marker(chosen, followed)
        assert chosen_models(later)[0] == ChosenModel("mug")
        others = {"apriltag:36h11:7"} - {followed}
        assert {marker.spec for marker in other_markers(later)} == others


def test_the_first_numbered_marker_is_followed_where_none_is_named():
    chosen = with_markers_spelled(options(*models("4=mug", "apriltag:36h11:7=tree")))
    assert (chosen.marker, chosen.takes_any_marker) == ("aruco:4x4_50:4", False)
    assert chosen_models(chosen) == (ChosenModel("mug"), ChosenModel("tree", "apriltag:36h11:7"))


def test_of_several_markers_in_view_one_without_a_model_of_its_own_may_be_followed():
    unnamed = options(*models("tree", "03=mug", "aruco:4x4_50:9=cube"))
    assert with_markers_spelled(unnamed).takes_any_marker
    assert without_model(unnamed, ["aruco:4x4_50:9", "apriltag:36h11:5", "apriltag:36h11:3"]) == ["apriltag:36h11:5"]
    assert without_model(unnamed, ["apriltag:36h11:9", "cube"]) == ["apriltag:36h11:9", "cube"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--marker", "aruco:4x4_50:0", *models("7=mug")), "no model is for the marker aruco:4x4_50:0"),
        (("--marker", "cube", *models("tree", "7=mug")), "no family of numbers"),
        (models("tree", "50=mug"), "no marker 50"),
        (models(*["mug"] * (MOST_MODELS + 1)), "too many"),
    ],
)
def test_what_cannot_be_is_said(arguments, said):
    with pytest.raises(UserError, match=said):
        with_markers_spelled(options(*arguments))


def test_as_many_models_as_there_may_be_are_taken():
    assert len(chosen_models(with_markers_spelled(options(*models(*["mug"] * MOST_MODELS))))) == MOST_MODELS


def test_a_marker_without_a_model_is_refused(capsys):
    with pytest.raises(SystemExit):
        options("--model", "7=")
    assert "names no model" in capsys.readouterr().err

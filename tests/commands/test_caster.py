"""`--caster`: what it may be, what it reaches, and what is said where it cannot be."""

import cv2
import pytest

from ashe_live.commands import webcam
from ashe_live.commands.flags.parser import build_parser
from ashe_live.commands.flags.setup import light_preset
from ashe_live.core.caster import Caster
from ashe_live.light.estimators.preset import BALANCED, FAST
from tests.checkout import CHECKOUT
from tests.painted_cubes import CAMERA, CubeScene, looking, painted, sun

WRONG = ["tin", "box:0.1x0.1", "sphere:-1", "cylinder:axb", "none.glb", "sphere:60"]


def test_it_reaches_the_estimator_with_the_other_choices():
    options = build_parser().parse_args(
        ["webcam", "--caster", "box:0.06x0.05x0.1", "--light", "sun", "--quality", "fast"]
    )
    assert light_preset(options) == FAST.assuming("sun", Caster.box(0.06, 0.05, 0.1))
    assert light_preset(build_parser().parse_args(["demo"])) == BALANCED
    of_suns = light_preset(build_parser().parse_args(["demo", "--light", "sun", "--quality", "accurate"]))
    assert [look.light for look in of_suns.looks] == ["sun", "sun"]
    model = str(CHECKOUT / "assets" / "models" / "goblet.glb")
    caster = light_preset(build_parser().parse_args(["play", "a.mp4", "--caster", model])).caster
    assert caster is not None
    assert caster.kind == "hull"


@pytest.mark.parametrize("spec", WRONG)
def test_what_is_no_body_is_one_line_and_status_2(run, files, spec):
    assert run("estimate", files["photo"], "--caster", spec).refusal


def test_a_model_that_is_damaged_is_one_line(run, files):
    assert "broken.glb" in run("estimate", files["photo"], "--caster", files["broken_model"]).refusal


def test_the_paper_cube_needs_none(run, files):
    outcome = run("estimate", files["photo"], "--marker", "cube", "--caster", "sphere:0.03")
    assert (outcome.status, len(outcome.err)) == (2, 1)
    assert "leave out --caster" in outcome.err[0]


@pytest.mark.parametrize("command", ["estimate", "play"])
def test_a_cube_in_view_needs_none(run, command, tmp_path):
    """Also where nobody has named it, and nothing has been done by then."""
    photo, out = tmp_path / "cube.png", tmp_path / "out.png"
    assert cv2.imwrite(str(photo), painted(CubeScene(CAMERA, looking(0.4, 40, 30), [sun(200, 40)])))
    more = ("--headless", "--out", out) if command == "play" else ()
    outcome = run(command, photo, "--hfov", "60", "--caster", "sphere:0.02", *more)
    assert outcome.status == 2
    assert "leave out --caster" in [*outcome.err, *outcome.out][-1]
    assert not out.exists()


def test_no_camera_is_opened_for_a_cube_with_a_caster(run, monkeypatch):
    monkeypatch.setattr(webcam, "WebcamSource", lambda *_: pytest.fail("the camera was opened"))
    outcome = run("webcam", "--marker", "cube+aruco:4x4_50:3", "--caster", "sphere:0.03")
    assert (outcome.status, len(outcome.err)) == (2, 1)
    assert "leave out --caster" in outcome.err[0]


def test_the_papers_method_has_no_use_for_it(run, files):
    outcome = run("estimate", files["photo"], "--estimator", "paper", "--caster", "sphere:0.03")
    assert (outcome.status, len(outcome.err)) == (2, 1)


def test_the_answer_says_which_body_it_is(run, film):
    (record,) = run(
        "estimate", "--json", "--camera-file", film.camera_file, "--caster", "box:0.05x0.05x0.08", film.path
    ).records
    assert record["light"]["kind"] != "none"
    assert record["caster"]["family"] == "box"
    assert max(spheroid[2] for spheroid in record["caster"]["spheroids_marker"]) == pytest.approx(0.08)


def test_a_wrong_one_is_reported_also_before_a_clip_is_played(run, film):
    assert "box:WxDxH" in run("play", film.path, "--headless", "--caster", "box:1x1", "--hfov", "55").refusal

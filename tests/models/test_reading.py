"""A person's files are read in a process of their own, to the same result, and shipped ones here."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from ashe_live.errors import UserError
from ashe_live.models import reading
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import placed_on_marker
from ashe_live.models.reading import read_model
from ashe_live.process.children import Limits


@pytest.fixture
def ball(tmp_path: Path) -> str:
    trimesh.creation.icosphere(subdivisions=3).export(tmp_path / "ball.ply")
    return str(tmp_path / "ball.ply")


def test_the_result_is_the_same_wherever_it_is_read(ball):
    here = placed_on_marker(load_model(ball), 0.08)
    there = read_model(ball, 0.08)
    np.testing.assert_array_equal(here.bounds, there.bounds)
    np.testing.assert_array_equal(here.outline, there.outline)
    for mine, theirs in zip(here.model.parts, there.model.parts, strict=True):
        np.testing.assert_array_equal(mine.vertices, theirs.vertices)
        np.testing.assert_array_equal(mine.triangles, theirs.triangles)


def test_a_person_s_file_is_read_apart_however_small_and_a_shipped_one_here(ball, monkeypatch):
    asked = []

    def isolated_call(_function, arguments, *_others):
        asked.append(arguments[0])
        return "there"

    monkeypatch.setattr(reading, "isolated_call", isolated_call)
    assert read_model(ball, 0.08) == "there"
    assert read_model("cube", 0.08).model.name == "cube"
    assert asked == [ball]


def test_what_is_wrong_is_said_from_there_too(tmp_path):
    (tmp_path / "torn.glb").write_bytes(b"glTF" + bytes(100))
    with pytest.raises(UserError, match="malformed"):
        read_model(str(tmp_path / "torn.glb"), 0.08)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to all of it")
def test_a_reader_that_takes_too_much_is_an_error_and_nothing_more(ball, monkeypatch, capfd):
    monkeypatch.setattr(reading, "LIMITS", Limits(0, memory_bytes=1, silent=True))
    with pytest.raises(UserError, match="could not be read"):
        read_model(ball, 0.08)
    assert capfd.readouterr().err == ""


SCRIPT = """
import numpy as np
import ashe_live as al
from dataclasses import replace
from ashe_live.core.types import Frame
from ashe_live.models import reading
camera = al.Camera.from_hfov((64, 48), 60)
T_cam_marker = np.array([(1, 0, 0, 0), (0, -1, 0, 0), (0, 0, -1, 0.3), (0, 0, 0, 1)])
pose = al.MarkerPose(T_cam_marker, np.zeros((4, 2)), 0.08, 0.1, None)
grey = np.full((48, 64, 3), 140, np.uint8)
tracked = al.TrackedFrame(Frame(grey, 0, 0.0), camera, pose)
with al.Renderer((64, 48)) as renderer:
    picture = renderer.render(tracked, "ball.ply")
    print((picture != grey).any())
    reading.LIMITS = replace(reading.LIMITS, memory_bytes=1)
    try:
        renderer.render(tracked, "./ball.ply")
    except al.UserError as error:
        print(error.message)
"""


def test_a_program_that_embeds_this_one_has_files_read_apart_too(tmp_path, ball):
    """As a script that does not guard its main part, as scripts are."""
    (tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, cwd=Path(ball).parent)
    drawn, refused = done.stdout.splitlines()
    assert drawn == "True"
    assert "could not be read" in refused
    assert done.stderr == ""

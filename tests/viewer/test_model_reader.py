"""Large files are read in a process of their own, to the same result."""

import os
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from ashe_live.errors import UserError
from ashe_live.viewer import model_reader
from ashe_live.viewer.model_reader import read_model


def test_the_result_is_the_same_wherever_it_is_read(tmp_path, monkeypatch):
    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=3).export(path)
    here = read_model(str(path), 0.08)
    monkeypatch.setattr(model_reader, "SMALL_FILE_BYTES", 0)
    there = read_model(str(path), 0.08)
    np.testing.assert_array_equal(here.bounds, there.bounds)
    np.testing.assert_array_equal(here.outline, there.outline)
    for mine, theirs in zip(here.model.parts, there.model.parts, strict=True):
        np.testing.assert_array_equal(mine.vertices, theirs.vertices)
        np.testing.assert_array_equal(mine.triangles, theirs.triangles)


def test_what_is_wrong_is_said_from_there_too(tmp_path, monkeypatch):
    monkeypatch.setattr(model_reader, "SMALL_FILE_BYTES", 0)
    (tmp_path / "torn.glb").write_bytes(b"glTF" + bytes(100))
    with pytest.raises(UserError, match="malformed"):
        read_model(str(tmp_path / "torn.glb"), 0.08)


def test_a_reader_that_dies_is_an_error_and_nothing_more(tmp_path, monkeypatch):
    (tmp_path / "huge.obj").write_bytes(b"f 1 2 3\n" * 1000)
    monkeypatch.setattr(model_reader, "SMALL_FILE_BYTES", 0)
    monkeypatch.setattr(model_reader, "_answer", _dies)
    with pytest.raises(UserError, match="too much for its reader"):
        read_model(str(tmp_path / "huge.obj"), 0.08)


def _dies(*_):
    os._exit(9)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to it")
def test_the_reader_may_take_so_much_memory_and_no_more():
    code = (
        "from ashe_live.viewer.model_reader import MAX_MEMORY_BYTES, _limit_memory\n"
        "_limit_memory()\n"
        "bytearray(100_000_000)\n"
        "try:\n    bytearray(MAX_MEMORY_BYTES)\nexcept MemoryError:\n    print('refused')\n"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "refused\n"

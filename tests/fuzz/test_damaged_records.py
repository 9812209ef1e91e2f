"""What the program wrote itself and reads again, with some values replaced: it is used, refused or forgotten."""

import copy
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.core.camera import read_camera_file
from ashe_live.errors import UserError
from ashe_live.models.assembly.up import UPS
from ashe_live.models.memory import ModelMemory
from ashe_live.models.placement import PlacedModel, Placement
from ashe_live.tracking.focal.focal import FocalEstimate
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.viewer.output.as_shown import read_as_shown
from ashe_live.viewer.table.shelf import Shelf
from tests.fuzz.damaged import files, is_refused
from tests.fuzz.materials import SHOWN

SIDE_M = 0.08
CAMERA = {
    "size": [64, 48],
    "K": [[50.0, 0.0, 31.5], [0.0, 50.0, 23.5], [0.0, 0.0, 1.0]],
    "dist": [0.1, 0.0, 0.0, 0.0, 0.0],
}
MOVED = Placement(1.5, 0.7, (0.02, -0.04))
PLACES = {"mug": {"up": "z", "places": {"0": {"scale": 2.0, "turn_deg": 30.0, "shift_sides": [0.5, 1.0]}}}}
FOCAL_LENGTHS = {"webcam, 640x480": {"focal_px": 620.0, "sigma_px": 5.0, "views": 12}}
others = st.one_of(
    st.sampled_from(
        [None, True, 0, -1, 0.0, -0.0, 1e308, -1e308, 1e-320, math.nan, math.inf, -math.inf, 10**30, 10**400, -(10**20)]
    ),
    st.sampled_from(
        ["", "x", "1", "cube", "nan", "\0", "\ud800", "../../x", [], {}, [[]], [0], [0, 0, 0], [1e308] * 3]
    ),
)
changes = st.lists(st.tuples(st.integers(0, 10**6), others), min_size=1, max_size=3)


def places(record: Any) -> Iterator[tuple[Any, Any]]:
    """Each value of a JSON document, as what it is in and its key or index there."""
    items = record.items() if isinstance(record, dict) else enumerate(record)
    for key, value in items:
        yield record, key
        if isinstance(value, dict | list):
            yield from places(value)


def changed(record: Any, changes: list[tuple[int, Any]]) -> str:
    """The document's text with some values replaced."""
    other = {"": copy.deepcopy(record)}
    for at, value in changes:
        there = list(places(other))
        holder, key = there[at % len(there)]
        holder[key] = copy.deepcopy(value)
    return json.dumps(other[""])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("records")


def written(folder: Path, text: str) -> Path:
    path = folder / "record.json"
    path.write_text(text, encoding="utf-8")
    return path


class Shipped(Shelf):
    """Starts no process for a model's file that is not there."""

    def loaded(self, name: str, up: str | None = None) -> PlacedModel:
        if name not in self.names:
            raise UserError(f"there is no model {name!r}", "choose another")
        return super().loaded(name, up)


@pytest.fixture(scope="module")
def shelf() -> Shelf:
    return Shipped("cube", SIDE_M)


@files(300)
@given(changes)
def test_a_recording_is_shown_again_as_its_file_says_or_not_at_all(folder: Path, shelf: Shelf, changes: Any) -> None:
    """What is taken can be written and read once more, so there is nothing in it that no light or place may be."""
    path = written(folder, changed(SHOWN, changes))
    if is_refused(lambda: read_as_shown(path, shelf)):
        return
    taken = read_as_shown(path, shelf).to_json()
    again = read_as_shown(written(folder, json.dumps(taken, allow_nan=False)), shelf).to_json()
    assert [each["models"] for each in again["shown"]] == [each["models"] for each in taken["shown"]]


@files(100)
@given(changes)
def test_a_damaged_camera_file_is_a_camera_or_refused(folder: Path, changes: Any) -> None:
    path = written(folder, changed(CAMERA, changes))
    if is_refused(lambda: read_camera_file(path)):
        return
    camera = read_camera_file(path)
    assert np.isfinite(camera.K).all()
    assert np.isfinite(camera.dist).all()
    assert camera.focal_sigma_px is not None
    assert camera.focal_sigma_px > 0


@files(100)
@given(changes)
def test_models_stand_where_they_were_left_or_as_they_come(folder: Path, changes: Any) -> None:
    path = written(folder, changed(PLACES, changes))
    memory = ModelMemory(path)
    for where in ("0", "1"):
        place = memory.placement("mug", where, SIDE_M)
        assert place is None or np.isfinite(place.marker_from_placed).all()
    assert memory.up("mug") in (None, *UPS)
    memory.keep_placement("mug", "0", MOVED, SIDE_M)
    memory.keep_up("cube", UPS[1])
    again = ModelMemory(path)
    assert again.up("cube") == UPS[1]
    left = again.placement("mug", "0", SIDE_M)
    assert left is not None
    np.testing.assert_allclose(left.marker_from_placed, MOVED.marker_from_placed, atol=1e-12)


@files(100)
@given(changes)
def test_a_kept_focal_length_is_one_or_forgotten(folder: Path, changes: Any) -> None:
    path = written(folder, changed(FOCAL_LENGTHS, changes))
    memory = FocalMemory("webcam", path)
    known = memory.recall((640, 480))
    assert known is None or (0 < known.focal_px < math.inf and 0 < known.sigma_px < math.inf)
    sure = FocalEstimate((640, 480), 600.0, 1e-6, 20)
    memory.keep(sure)
    again = FocalMemory("webcam", path).recall((640, 480))
    assert again is not None
    assert again.relative_sigma <= sure.relative_sigma

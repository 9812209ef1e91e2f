"""Models by name and by file; the last good one stays."""

import threading
from concurrent.futures import wait
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.models.assembly.up import UPS
from ashe_live.models.catalogue import model_names
from ashe_live.models.memory import ModelMemory
from ashe_live.models.reading import read_model
from ashe_live.viewer.table import shelf as shelf_module
from ashe_live.viewer.table.shelf import Shelf
from tests.patience import PATIENCE_S


def awaited(shelf: Shelf):
    """The model that is shown once the chosen one has been read, or could not be."""
    wait([shelf._load(shelf.chosen_name)], PATIENCE_S)
    shelf.poll()
    return shelf.shown


def test_it_begins_with_the_shipped_models_and_the_chosen_one():
    shelf = Shelf("lantern", 0.08)
    assert tuple(shelf.names) == model_names()
    assert shelf.chosen_name == "lantern"
    shelf.poll()
    assert shelf.shown_name == "lantern"


def test_a_file_comes_before_the_shipped_ones(tmp_path):
    path = tmp_path / "tile.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    shelf = Shelf(str(path), 0.08)
    assert shelf.names == [str(path), *model_names()]
    assert shelf.choose(0)


def test_nothing_of_that_name_is_an_error_at_once():
    with pytest.raises(UserError, match="no model"):
        Shelf("teapot", 0.08)


def test_the_old_model_is_shown_until_the_new_one_is_there(monkeypatch):
    go_on = threading.Event()

    def slowly(name: str, side_m: float, _up: str | None):
        if name != "cube":
            go_on.wait(PATIENCE_S)
        return read_model(name, side_m)

    monkeypatch.setattr(shelf_module, "read_model", slowly)
    shelf = Shelf("cube", 0.08)
    cube = shelf.shown
    shelf.step(+1)
    shelf.poll()
    assert shelf.shown is cube
    go_on.set()
    assert awaited(shelf) is not cube


def test_who_waits_sees_for_how_long(monkeypatch):
    go_on = threading.Event()

    def slowly(_name: str, _side_m: float, _up: str | None):
        go_on.wait(PATIENCE_S)
        return read_model("cube", 0.08)

    shelf = Shelf("cube", 0.08)
    monkeypatch.setattr(shelf_module, "read_model", slowly)
    monkeypatch.setattr(shelf_module, "SILENT_S", 0.0)
    assert shelf.progress(True) is None
    shelf.choose(shelf.names.index("tree"))
    shelf.poll()
    assert shelf.progress(True) == "loading tree: 0 s"
    go_on.set()
    awaited(shelf)
    assert shelf.progress(False) == "loading tree: 0 s"  # until it has been prepared for drawing
    assert shelf.progress(True) is None
    assert shelf.progress(True) is None


@pytest.mark.parametrize("error", [MemoryError(), RecursionError("too deep"), ValueError("odd")])
def test_nothing_that_a_model_does_ends_the_viewer(monkeypatch, error):
    shelf = Shelf("cube", 0.08)

    def failing(_name: str, _side_m: float, _up: str | None):
        raise error

    cube = shelf.shown
    monkeypatch.setattr(shelf_module, "read_model", failing)
    shelf.choose(shelf.names.index("tree"))
    assert awaited(shelf) is cube
    assert "tree" in shelf.take_error().message


def test_a_mended_file_can_be_chosen_again(monkeypatch):
    shelf = Shelf("cube", 0.08)
    cube = shelf.shown

    def failing(_name: str, _side_m: float, _up: str | None):
        raise UserError("tree.glb is torn", "mend it")

    monkeypatch.setattr(shelf_module, "read_model", failing)
    shelf.choose(shelf.names.index("tree"))
    awaited(shelf)
    monkeypatch.setattr(shelf_module, "read_model", read_model)
    shelf.choose(shelf.names.index("tree"))
    assert awaited(shelf) is not cube


def test_a_model_that_fails_is_reported_once_and_the_last_good_one_stays(monkeypatch):
    def failing(name: str, side_m: float, _up: str | None):
        if name == "mug":
            raise UserError("mug.glb is damaged", "export it again")
        return read_model(name, side_m)

    monkeypatch.setattr(shelf_module, "read_model", failing)
    shelf = Shelf("cube", 0.08)
    shelf.choose(shelf.names.index("tree"))
    tree = awaited(shelf)
    shelf.choose(shelf.names.index("mug"))
    assert awaited(shelf) is tree
    assert shelf.chosen_name == "tree"
    assert "mug" in shelf.take_error().message
    assert shelf.take_error() is None
    assert shelf.shown is tree


def test_stepping_goes_round_and_no_number_is_out_of_reach():
    shelf = Shelf("cube", 0.08)
    for _ in shelf.names:
        shelf.step(-1)
    assert shelf.chosen_name == "cube"
    assert not shelf.choose(len(shelf.names))
    assert shelf.chosen_name == "cube"


TILE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def test_a_dropped_model_joins_after_the_others_and_is_chosen(tmp_path):
    path = tmp_path / "tile.obj"
    path.write_text(TILE)
    shelf = Shelf("cube", 0.08)
    cube = shelf.shown
    shelf.add(str(path))
    tile = awaited(shelf)
    assert tile is not cube
    assert shelf.names == [*model_names(), str(path)]
    path.write_text(TILE.replace("0 1 0", "0 2 0"))
    shelf.add(str(path))  # once more, after it was changed
    assert awaited(shelf).bounds[1, 0] < tile.bounds[1, 0]
    assert shelf.names.count(str(path)) == 1
    path.write_text("f 1 2 3\n")
    shelf.add(str(path))
    assert awaited(shelf) is not cube  # the last that was good
    assert "tile.obj" in str(shelf.take_error())


def test_of_models_dropped_together_the_first_is_chosen_and_the_others_join(tmp_path):
    paths = [str(tmp_path / f"{name}.obj") for name in ("b", "a", "c")]
    for path in paths[1:]:
        Path(path).write_text(TILE)
    shelf = Shelf("cube", 0.08)
    cube = shelf.shown
    shelf.add(paths[1])
    awaited(shelf)
    shelf.add(*paths)
    assert shelf.chosen_name == paths[0]
    assert shelf.names == [*model_names(), paths[1], paths[0], paths[2]]
    assert awaited(shelf) is not cube
    assert "b.obj" in str(shelf.take_error())  # no file is there: it alone is taken off again
    assert shelf.names == [*model_names(), *paths[1:]]
    shelf.step(+1)
    awaited(shelf)
    assert shelf.shown_name == paths[2]


@pytest.mark.parametrize("content", [None, "", "nonsense", "v 0 0 0\nf 1 2 3\n"])
def test_a_dropped_model_that_cannot_be_read_leaves_all_as_it_was(tmp_path, content):
    path = tmp_path / "broken.obj"
    if content is not None:
        path.write_text(content)
    shelf = Shelf("mug", 0.08)
    mug = shelf.shown
    shelf.add(str(path))
    assert awaited(shelf) is mug
    assert shelf.names == list(model_names())
    assert shelf.chosen_name == "mug"
    assert "broken.obj" in str(shelf.take_error())


@pytest.mark.parametrize("ask", [Shelf.turn_up, lambda shelf: shelf.add(shelf.shown_name)])
def test_a_shown_file_that_is_read_anew_and_broken_meanwhile_is_reported_once_and_stays(tmp_path, ask):
    path = tmp_path / "tile.obj"
    path.write_text(TILE)
    shelf = Shelf(str(path), 0.08, up="y")
    tile = shelf.shown
    path.write_text("nonsense")
    ask(shelf)
    assert awaited(shelf) is tile
    assert "tile.obj" in str(shelf.take_error())
    assert awaited(shelf) is tile  # not read over and over
    assert shelf.take_error() is None
    path.write_text(TILE)
    assert shelf.turn_up() == "z"
    assert awaited(shelf).model.up == "z"


def height_over_width(shelf: Shelf) -> float:
    (x, y, z), upper = shelf.shown.bounds
    return float((upper[2] - z) / max(upper[0] - x, upper[1] - y))


def test_a_model_stands_on_another_side_when_asked_and_the_next_time_too(tmp_path):
    (tmp_path / "tower.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
    )
    name, memory = str(tmp_path / "tower.ply"), ModelMemory(tmp_path / "models.json")
    shelf = Shelf(name, 0.08, "y", memory)
    assert height_over_width(shelf) == pytest.approx(1 / 5)
    assert shelf.turn_up() == "z"
    awaited(shelf)
    assert height_over_width(shelf) == pytest.approx(5)
    assert height_over_width(Shelf(name, 0.08, None, memory)) == pytest.approx(5)
    assert height_over_width(Shelf(name, 0.08, "x", memory)) == pytest.approx(1 / 5)  # a flag holds for this time
    turned = [shelf.turn_up() for _ in UPS]
    assert sorted(turned) == sorted(UPS)
    assert [shelf.turn_up(-1) for _ in UPS[1:]] == turned[-2::-1]


def test_what_should_be_known_of_a_model_is_reported_once(tmp_path):
    (tmp_path / "tile.obj").write_text(TILE + "l 1 2\n")
    shelf = Shelf(str(tmp_path / "tile.obj"), 0.08)
    left_out, up = shelf.take_notes()
    assert left_out == "tile.obj: points and lines are left out"
    assert up.startswith("tile.obj is taken to stand with ")
    shelf.choose(1)
    awaited(shelf)
    assert shelf.take_notes() == []  # of a shipped model there is nothing to tell
    shelf.choose(0)
    awaited(shelf)
    assert shelf.take_notes() == []

"""A model's file as the object that casts the shadow."""

from pathlib import Path

import numpy as np
import pytest

from ashe_live.core.caster import Caster
from ashe_live.errors import UserError
from ashe_live.models.caster import MOST_MISSED, read_caster
from ashe_live.models.loading import load_model_file
from tests.checkout import CHECKOUT

TETRAHEDRON = "v 0 0 0\nv 0.06 0 0\nv 0 0 -0.05\nv 0 0.1 0\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"


def written(folder: Path, text: str) -> str:
    path = folder / "thing.obj"
    path.write_text(text)
    return str(path)


def test_sizes_are_read_where_no_file_is_named() -> None:
    assert read_caster("cylinder:0.03x0.1") == Caster.cylinder(0.03, 0.1)


def test_a_files_hull_stands_as_it_is_loaded_with_its_unit_for_a_metre(tmp_path: Path) -> None:
    hull = read_caster(written(tmp_path, TETRAHEDRON))
    corners = np.array(hull.spheroids)[:, :3]
    assert hull.kind == "hull"
    assert len(corners) == 4
    np.testing.assert_allclose(np.ptp(corners, axis=0), (0.06, 0.05, 0.1), atol=1e-6)
    assert corners[:, 2].min() == 0


def test_hollows_are_filled_and_points_inside_are_left_out(tmp_path: Path) -> None:
    dented = TETRAHEDRON + "v 0.01 0.02 -0.01\nf 1 2 5\nf 2 3 5\n"
    hulls = [read_caster(written(tmp_path, text)).spheroids for text in (dented, TETRAHEDRON)]
    assert set(hulls[0]) == set(hulls[1])


def test_a_round_models_hull_is_as_large_as_it_is() -> None:
    path = CHECKOUT / "assets" / "models" / "goblet.glb"
    lower, upper = load_model_file(path).bounds
    hull = np.array(read_caster(str(path)).spheroids)[:, :3]
    extent = upper - lower
    np.testing.assert_allclose(np.ptp(hull, axis=0), extent, atol=2.5 * MOST_MISSED * extent.max())
    # Few are enough: each of them costs time in every estimate.
    assert len(hull) < 150


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("v 0 0 0\n", "no triangles"),
        (TETRAHEDRON.replace("0.0", "6").replace("0.1", "100"), "sizes are metres"),
        ("v 0 0 0\nv 0.06 0 0\nv 0 0 -0.05\nf 1 2 3\n", "casts no shadow"),
    ],
)
def test_a_model_that_cannot_stand_on_the_table_is_said_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UserError, match=said) as told:
        read_caster(written(tmp_path, text))
    assert "\n" not in str(told.value)


def test_of_a_file_that_is_no_model_it_is_said_what_is_wrong(tmp_path: Path) -> None:
    """Not that there is no such caster."""
    text, folder = tmp_path / "sizes.txt", tmp_path / "models"
    text.write_text("6 x 4 x 12")
    folder.mkdir()
    for path, said in ((text, "sizes.txt is not a supported kind of model file"), (folder, "models is a folder")):
        with pytest.raises(UserError, match=said):
            read_caster(str(path))


def test_sizes_are_sizes_though_a_file_is_called_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("sphere:0.03").touch()
    assert read_caster("sphere:0.03") == Caster.sphere(0.03)


def test_a_file_that_is_missing_is_said(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no file"):
        read_caster(str(tmp_path / "none.glb"))

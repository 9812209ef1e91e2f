"""Which way is up: said by a flag, told by the shape, or as most files of that format are."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from ashe_live.commands.flags import option_groups
from ashe_live.models.assembly.up import UPS, z_up_from
from ashe_live.models.loading import load_model_file
from ashe_live.models.memory import ModelMemory

SUFFIXES = (".obj", ".ply", ".stl")


def tapered() -> trimesh.Trimesh:
    """A vase: it stands on a flat foot at z = 0, and is as deep as it is broad."""
    return trimesh.creation.revolve([(0, 0), (1, 0), (1.4, 1.5), (0.5, 3), (0, 3.2)], sections=24)


def saved(mesh: trimesh.Trimesh, path: Path, up: str) -> Path:
    """Whose z is along `up` in the file."""
    turned = mesh.copy()
    turned.apply_transform(np.linalg.inv(z_up_from(up)))
    turned.export(path)
    return path


@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_stands_on_a_foot_stands_in_every_format(tmp_path: Path, suffix: str, up: str) -> None:
    model = load_model_file(saved(tapered(), tmp_path / f"vase{suffix}", up))
    assert model.up == up
    assert model.is_up_guessed
    np.testing.assert_allclose(model.bounds[:, 2], (0, 3.2), atol=1e-5)
    # The broad end is below.
    heights = np.concatenate([part.vertices[:, 2] for part in model.parts])
    radii = np.concatenate([np.hypot(part.vertices[:, 0], part.vertices[:, 1]) for part in model.parts])
    assert radii[heights < 1].max() > radii[heights > 2.9].max()


def stool() -> trimesh.Trimesh:
    """Three legs, none of whose feet is flat, below a seat that is as flat above as below."""
    seat = trimesh.creation.cylinder(0.5, 0.1, sections=24)
    legs = []
    for turn in np.arange(3) * 2 * np.pi / 3:
        leg = trimesh.creation.capsule(0.8, 0.04, count=[8, 8])
        leg.apply_translation((0.4 * np.cos(turn), 0.4 * np.sin(turn), -0.85))
        legs.append(leg)
    return trimesh.util.concatenate([seat, *legs])


def bottle() -> trimesh.Trimesh:
    """It stands on a rim, and is long enough to lie more firmly than it stands, had it edges to lie on."""
    return trimesh.creation.revolve(
        [(0, 0.05), (0.6, 0.05), (0.8, 0), (1, 0.1), (1, 4), (0.3, 5), (0.3, 7)], sections=24
    )


@pytest.mark.parametrize("middle_m", [0.0, 40.0])
@pytest.mark.parametrize("made", [stool, bottle, tapered])
@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_cannot_lie_stands_wherever_its_origin_is(tmp_path: Path, suffix: str, up: str, made, middle_m) -> None:
    mesh = made()
    mesh.apply_translation(middle_m - mesh.bounds.mean(axis=0))
    assert load_model_file(saved(mesh, tmp_path / f"thing{suffix}", up)).up == up


@pytest.mark.parametrize(("suffix", "up"), [(".obj", "y"), (".ply", "y"), (".stl", "z")])
def test_a_shape_without_evidence_stands_as_most_of_its_format(tmp_path: Path, suffix: str, up: str) -> None:
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / f"ball{suffix}")
    assert load_model_file(tmp_path / f"ball{suffix}").up == up


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_flat_thing_at_a_maps_coordinates_is_a_model_too(tmp_path: Path, axis: int) -> None:
    """Its thickness is less than the least difference that there is between numbers so large."""
    corners = np.insert(10.0 * np.array([(0, 0), (1, 0), (1, 1), (0, 1)]), axis, 0.0, axis=1) + 5_200_000
    lines = [f"v {x:.1f} {y:.1f} {z:.1f}" for x, y, z in corners]
    (tmp_path / "tile.obj").write_text("\n".join([*lines, "f 1 2 3 4", ""]))
    lower, upper = load_model_file(tmp_path / "tile.obj").bounds
    np.testing.assert_allclose(sorted(upper - lower), (0, 10, 10))


@pytest.mark.parametrize("up", UPS)
def test_what_is_said_holds(tmp_path: Path, up: str) -> None:
    model = load_model_file(saved(tapered(), tmp_path / "vase.glb", up), up)
    np.testing.assert_allclose(model.bounds[:, 2], (0, 3.2), atol=1e-5)
    assert model.up == up
    assert not model.is_up_guessed


@pytest.mark.parametrize("up", UPS)
def test_a_side_is_turned_and_never_mirrored(up: str) -> None:
    turn = z_up_from(up)[:3, :3]
    np.testing.assert_allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1)
    axis = np.eye(3)["xyz".index(up[-1])] * (-1 if up[0] == "-" else 1)
    np.testing.assert_allclose(turn @ axis, (0, 0, 1))


def test_the_command_line_knows_the_same_axes() -> None:
    assert set(option_groups.UPS) == set(UPS)


def test_what_was_said_is_remembered_for_each_file(tmp_path: Path) -> None:
    memory = ModelMemory(tmp_path / "folder" / "models.json")
    assert memory.up("a.obj") is None
    memory.keep_up("a.obj", "z")
    memory.keep_up(str(tmp_path / "a.obj"), "x")
    again = ModelMemory(tmp_path / "folder" / "models.json")
    assert (again.up("a.obj"), again.up(str(tmp_path / "a.obj"))) == ("z", "x")


@pytest.mark.parametrize("content", ["", "[]", "nonsense", '{"%s": 3}', '{"%s": {"up": "w"}}', '{"%s": {"up": [1]}}'])
def test_a_memory_that_is_damaged_is_as_if_there_were_none(tmp_path: Path, content: str) -> None:
    path = tmp_path / "models.json"
    path.write_text(content.replace("%s", str(tmp_path / "a.obj")))
    memory = ModelMemory(path)
    assert memory.up(str(tmp_path / "a.obj")) is None
    memory.keep_up(str(tmp_path / "a.obj"), "-z")
    assert memory.up(str(tmp_path / "a.obj")) == "-z"

"""What looks alike is drawn at once, however many meshes it is in the file; nothing of it is lost."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.errors import UserError
from ashe_live.models.assembly.merging import merged
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Motion
from ashe_live.models.parsing import limits
from ashe_live.models.primitives import box
from tests.models.gltf_files import UVS, Document, png


def test_parts_of_one_look_become_one_and_keep_every_corner() -> None:
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    parts = [
        box((1, 1, 1), colour).moved(1.0, np.array((place, 0.0, 0.0))) for place, colour in enumerate((red, blue, red))
    ]
    first, second = merged(parts)
    assert first.material.base_colour == red
    assert second is parts[1]
    expected = np.concatenate([part.vertices[part.triangles] for part in (parts[0], parts[2])])
    np.testing.assert_array_equal(first.vertices[first.triangles], expected)
    expected = np.concatenate([part.normals[part.triangles] for part in (parts[0], parts[2])])
    np.testing.assert_array_equal(first.normals[first.triangles], expected)


def test_every_vertex_keeps_what_is_its_own() -> None:
    """Colours, both sets of texture coordinates, and places and normals while it moves."""
    parts = []
    for number in range(3):
        part = box((1, 1, 1)).moved(1.0, np.array((number, 0.0, 0.0)))
        count = len(part.vertices)
        numbers = number + np.arange(count) / count
        motion = Motion(np.stack([part.vertices, 2 * part.vertices]), np.stack([part.normals, -part.normals]), 3.0)
        own = {"uvs": np.stack([numbers, -numbers], 1), "more_uvs": np.stack([numbers, 9 * numbers], 1)}
        colours = np.column_stack([numbers / 9] * 3 + [np.ones(count)])
        parts.append(replace(part, colours=colours, motion=motion, faces_inwards=True, **own))
    (one,) = merged(parts)
    assert one.faces_inwards
    assert one.motion.duration_s == 3
    for name in ("colours", "uvs", "more_uvs"):
        expected = np.concatenate([getattr(part, name)[part.triangles] for part in parts])
        np.testing.assert_array_equal(getattr(one, name)[one.triangles], expected)
    for name in ("vertices", "normals"):
        expected = np.concatenate([getattr(part.motion, name)[:, part.triangles] for part in parts], axis=1)
        np.testing.assert_array_equal(getattr(one.motion, name)[:, one.triangles], expected)


def test_parts_that_let_light_through_stay_apart() -> None:
    glass = Material(base_colour=(1, 1, 1, 0.5), alpha=Alpha.BLEND)
    parts = [replace(box((1, 1, 1)), material=glass) for _ in range(3)]
    assert merged(parts) == tuple(parts)


def test_the_same_picture_is_the_same_look_and_another_is_not(tmp_path: Path) -> None:
    document = Document()
    red, green = (document.embedded(png(colour)) for colour in ((255, 0, 0, 255), (0, 255, 0, 255)))
    for texture in (red, green, red):
        material = {"pbrMetallicRoughness": {"baseColorTexture": texture}}
        document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert sorted(len(part.triangles) for part in model.parts) == [2, 4]


def test_too_many_looks_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_SURFACES", 2)
    document = Document()
    for share in (0.1, 0.2, 0.3):
        document.quad(material={"pbrMetallicRoughness": {"roughnessFactor": share}})
    with pytest.raises(UserError, match="3 surfaces of different materials"):
        load_model_file(document.save(tmp_path / "a.glb"))

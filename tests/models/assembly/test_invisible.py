"""A model is said to be invisible where nothing of it is seen, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.models.assembly.invisible import WORDS, nothing_is_seen
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh
from ashe_live.models.primitives import box

BOX = box((1.0, 1.0, 1.0))
HOLES = np.zeros((4, 4, 4), np.uint8)
LEAF = HOLES.copy()
LEAF[1, 2, 3] = 255


def part(opacity: float, alpha: Alpha, texels: np.ndarray | None = None, of_vertices: float | None = None) -> Mesh:
    count = len(BOX.vertices)
    colours = None if of_vertices is None else np.tile(np.float32((1, 1, 1, of_vertices)), (count, 1))
    material = Material(base_colour=(1.0, 1.0, 1.0, opacity), base_map=texels, alpha=alpha)
    return replace(BOX, material=material, uvs=np.zeros((count, 2), np.float32), colours=colours)


UNSEEN = [
    part(0.0, Alpha.BLEND),
    part(1.0, Alpha.BLEND, HOLES),
    part(1.0, Alpha.BLEND, LEAF, of_vertices=0.0),
    part(0.4, Alpha.CUT_OUT),
    part(1.0, Alpha.CUT_OUT, HOLES),
    part(0.7, Alpha.CUT_OUT, LEAF, of_vertices=0.7),
]
SEEN = [
    part(0.0, Alpha.OPAQUE, HOLES, of_vertices=0.0),  # of which alpha says nothing
    part(0.01, Alpha.BLEND),
    part(1.0, Alpha.BLEND, LEAF, of_vertices=0.1),
    part(0.5, Alpha.CUT_OUT),  # as opaque as the cut-off is
    part(1.0, Alpha.CUT_OUT, LEAF),
]


@pytest.mark.parametrize("number", range(len(UNSEEN)))
def test_what_is_transparent_throughout_is_not_seen(number: int) -> None:
    assert nothing_is_seen([UNSEEN[number]])


@pytest.mark.parametrize("number", range(len(SEEN)))
def test_one_part_that_is_seen_is_enough(number: int) -> None:
    assert not nothing_is_seen([SEEN[number]])
    assert not nothing_is_seen([*UNSEEN, SEEN[number], *UNSEEN])


@pytest.mark.parametrize(("opacity", "is_said"), [("d 0", True), ("d 0.01", False)])
def test_a_file_of_a_model_that_is_not_seen_is_said_to_be_that(tmp_path, opacity: str, is_said: bool) -> None:
    (tmp_path / "a.mtl").write_text(f"newmtl m\nKd 1 0 0\n{opacity}\n")
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert (WORDS in load_model_file(tmp_path / "a.obj").notes) is is_said

"""Surfaces in one place are worth a word where chance decides what is seen of them, and nowhere else."""

from dataclasses import replace

import numpy as np

from ashe_live.models.assembly.overlaps import overlap_visibly
from ashe_live.models.material import Material
from ashe_live.models.mesh import Mesh

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
ONE_DIAGONAL, OTHER_DIAGONAL = np.array([(0, 1, 2), (0, 2, 3)]), np.array([(0, 1, 3), (1, 2, 3)])
RED, BLUE = Material(base_colour=(1.0, 0.0, 0.0, 1.0)), Material(base_colour=(0.0, 0.0, 1.0, 1.0))


def _square(material: Material, triangles: np.ndarray = ONE_DIAGONAL, offset: tuple[float, ...] = (0, 0, 0)) -> Mesh:
    normals = np.tile(np.float32((0, 0, 1)), (4, 1))
    return Mesh(CORNERS + np.float32(offset), normals, triangles, uvs=CORNERS[:, :2], material=material)


def test_two_colours_in_one_place_are_reported_whichever_way_they_were_cut() -> None:
    for triangles in (ONE_DIAGONAL, OTHER_DIAGONAL, ONE_DIAGONAL[:, ::-1]):
        assert overlap_visibly([_square(RED), _square(BLUE, triangles)])


def test_colours_of_vertices_and_places_on_a_picture_count() -> None:
    colours = np.ones((4, 4), np.float32)
    white, dark = (replace(_square(Material()), colours=colours * share) for share in (1.0, np.float32(0.3)))
    assert overlap_visibly([white, dark])
    assert not overlap_visibly([white, white])
    pictured = Material(base_map=np.zeros((2, 2, 4), np.uint8))
    one, moved = (replace(_square(pictured), uvs=CORNERS[:, :2] + np.float32(shift)) for shift in (0.0, 0.4))
    assert overlap_visibly([one, moved])
    assert not overlap_visibly([one, one])


def test_metal_and_polish_count() -> None:
    plain = Material(metallic=0.0, roughness=0.8)
    for other in (replace(plain, metallic=1.0), replace(plain, roughness=0.2)):
        assert overlap_visibly([_square(plain), _square(other)])


def test_copies_neighbours_and_layers_are_not() -> None:
    assert not overlap_visibly([_square(RED), _square(RED, OTHER_DIAGONAL)])
    assert not overlap_visibly([_square(RED), _square(BLUE, offset=(1, 0, 0))])
    assert not overlap_visibly([_square(RED), _square(BLUE, offset=(0, 0, 0.01))])
    upright = replace(_square(BLUE), vertices=CORNERS[:, [0, 2, 1]])
    assert not overlap_visibly([_square(RED), upright])


def test_a_sheet_with_a_front_and_a_back_of_its_own_is_not() -> None:
    front, back = (replace(material, double_sided=False) for material in (RED, BLUE))
    assert not overlap_visibly([_square(front), _square(back, ONE_DIAGONAL[:, ::-1])])
    assert overlap_visibly([_square(front), _square(back)])


def test_normals_count_each_as_its_side_is_seen() -> None:
    """Of a triangle that is wound the other way round the back is seen, where its normal is turned round."""
    leaning = np.tile(np.float32((0.6, 0, 0.8)), (4, 1))
    assert overlap_visibly([_square(RED), replace(_square(RED), normals=leaning)])
    behind = _square(RED, ONE_DIAGONAL[:, ::-1])
    assert overlap_visibly([_square(RED), behind])
    assert not overlap_visibly([_square(RED), replace(behind, normals=-behind.normals)])

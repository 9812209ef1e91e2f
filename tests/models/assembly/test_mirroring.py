"""Polished metal is worth a word where it would mirror the model, as geometry has it, or the sky, and nowhere else."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.models.assembly.mirroring import BOTH, ITSELF, LEAST_SHARE, SKY, words_on_mirrors
from ashe_live.models.material import Material
from ashe_live.models.mesh import Mesh
from ashe_live.models.primitives import box, revolved

METAL, PLASTIC = Material(metallic=1.0, roughness=0.2), Material(roughness=0.2)


def _turned(radii: np.ndarray, heights: np.ndarray, material: Material) -> Mesh:
    turned = revolved(np.column_stack([radii, heights]), 64)
    return replace(turned, uvs=turned.vertices[:, :2], material=material)


def _ball(material: Material) -> Mesh:
    polar = np.linspace(0, math.pi, 33)
    return _turned(np.sin(polar), 1.05 - np.cos(polar), material)


def mirrors_itself(parts: list[Mesh]) -> bool:
    return words_on_mirrors(parts) in (ITSELF, BOTH)


def _tray(material: Material) -> Mesh:
    return _turned(np.linspace(2.0, 0.0, 20), np.zeros(20), material)


def test_what_bulges_everywhere_mirrors_nothing_of_itself() -> None:
    assert not mirrors_itself([_ball(METAL)])
    assert not mirrors_itself([_turned(np.array([0, 1, 1, 0]), np.array([0, 0, 2, 2]), METAL)])
    assert not mirrors_itself([_tray(METAL)])


def test_the_inside_of_a_bowl_mirrors_the_bowl_and_of_a_closed_one_nobody_sees_it() -> None:
    polar = np.linspace(0, math.pi / 2, 33)
    bowl = _turned(np.sin(polar), 1 - np.cos(polar), METAL)
    assert mirrors_itself([bowl])
    assert not mirrors_itself([bowl, _turned(np.linspace(1, 0, 20), np.ones(20), PLASTIC)])


def test_a_tray_mirrors_what_stands_on_it_if_it_is_polished_metal() -> None:
    assert mirrors_itself([_tray(METAL), _ball(PLASTIC)])
    for other in (PLASTIC, Material(metallic=1.0, roughness=0.9)):
        assert not mirrors_itself([_tray(other), _ball(PLASTIC)])


@pytest.mark.parametrize(("metal", "told"), [(255, True), (20, False)])
def test_a_map_says_what_is_metal(metal: int, told: bool) -> None:
    texels = np.full((2, 2, 4), (0, 60, metal, 255), np.uint8)
    tray = _tray(Material(metallic=1.0, roughness=1.0, metallic_roughness_map=texels))
    assert mirrors_itself([tray, _ball(PLASTIC)]) is told


@pytest.mark.parametrize("turn_deg", range(0, 360, 60))
def test_it_is_looked_at_from_all_around(turn_deg: float) -> None:
    """The floor of a deep niche is seen from the front alone."""
    turn = np.radians(turn_deg)
    R = np.array([(np.cos(turn), -np.sin(turn), 0), (np.sin(turn), np.cos(turn), 0), (0, 0, 1)])
    floor, back = replace(box((2, 2, 0.01)), material=METAL), box((0.01, 2, 4)).moved(1.0, np.array((-1.0, 0, 0)))
    sides = [box((2, 0.01, 4)).moved(1.0, np.array((0.0, y, 0))) for y in (-1.0, 1.0)]
    parts = [replace(part, vertices=part.vertices @ R.T, normals=part.normals @ R.T) for part in (floor, back, *sides)]
    assert mirrors_itself(parts)


@pytest.mark.parametrize(("height", "is_seen"), [(0.12, False), (0.4, True)])
def test_a_floor_mirrors_a_wall_as_far_as_that_is_high_over_the_tangent_of_35_degrees(height, is_seen) -> None:
    """Of six views three show it, of which two see the wall from aside; in all they show the floor 24 square metres."""
    floor, wall = box((2, 2, 0.01)), box((0.01, 2, height)).moved(1.0, np.array((-1.0, 0, 0)))
    mirrored = 2 * height / math.tan(math.radians(35)) * (1 + 2 * math.cos(math.radians(60)))
    assert (mirrored > 1.4 * LEAST_SHARE * 24) is is_seen
    assert (mirrored < 0.7 * LEAST_SHARE * 24) is not is_seen
    assert mirrors_itself([replace(floor, material=METAL), wall]) is is_seen


def test_a_mirrored_sky_is_reported_where_it_is_seen_clearly_from_above() -> None:
    blurred = replace(METAL, roughness=0.5)
    for mesh in (_tray, _ball):
        assert words_on_mirrors([mesh(METAL)]) == SKY
        assert words_on_mirrors([mesh(blurred)]) is words_on_mirrors([mesh(PLASTIC)]) is None
    on_tray = _ball(PLASTIC)
    assert words_on_mirrors([_tray(METAL), on_tray]) == BOTH
    assert words_on_mirrors([_tray(blurred), on_tray]) == ITSELF


def test_walls_that_lean_over_mirror_the_ground_alone() -> None:
    """Of a funnel's outside, seen from 35 degrees, the mirrored direction points down."""
    funnel = _turned(np.linspace(1.0, 2.0, 20), np.linspace(0.0, 1.0, 20), METAL)
    lid = _turned(np.linspace(2.0, 0.0, 20), np.ones(20), PLASTIC)
    assert words_on_mirrors([funnel, lid]) is None

"""From a file's triangles to ours: which side is the front, and what becomes of normals that cannot be moved along."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.models.assembly.geometry import RawMesh, RawMotion, placed_mesh
from ashe_live.models.material import Material
from ashe_live.models.mesh import face_normals
from ashe_live.models.primitives import revolved

BALL = revolved([(np.sin(polar), -np.cos(polar)) for polar in np.linspace(0, np.pi, 9)], 12)
OUTWARDS = BALL.vertices / np.linalg.norm(BALL.vertices, axis=1, keepdims=True)
BOTH_SIDES, ONE_SIDE = Material(double_sided=True), Material(double_sided=False)


def _ball(material: Material = ONE_SIDE, sense: int = 1) -> RawMesh:
    """Of single corners, with normals; inside out where `sense` is -1."""
    triangles = BALL.triangles.astype(np.int64)[:, ::sense]
    return RawMesh(BALL.vertices.astype(float), triangles, material, normals=sense * OUTWARDS.astype(float))


@pytest.mark.parametrize("T", [np.eye(4), np.diag([1.0, -2.0, 3.0, 1.0])])
def test_triangles_run_as_their_normals_say_whichever_way_each_does_in_the_file(T: np.ndarray) -> None:
    ball = _ball()
    is_turned = np.random.default_rng(1).random(len(ball.triangles)) < 0.5
    mixed = replace(ball, triangles=np.where(is_turned[:, None], ball.triangles[:, ::-1], ball.triangles))
    placed = placed_mesh(mixed, T)
    facing = face_normals(placed.vertices, placed.triangles)
    middles = placed.vertices[placed.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", facing, middles) > 0).all()
    assert (np.einsum("ij,ij->i", placed.normals, placed.vertices) > 0).all()


def test_what_is_flattened_has_the_normals_of_its_plane() -> None:
    """The file's cannot be moved along where a node scales an axis to nothing."""
    quad = np.array([(0, 0, 0), (1, 0, 1), (1, 1, 2), (0, 1, 1)], float)
    raw = RawMesh(quad, np.array([(0, 1, 2), (0, 2, 3)]), ONE_SIDE, normals=np.tile((1.0, 0, 0), (4, 1)))
    placed = placed_mesh(raw, np.diag([1.0, 1, 0, 1]))
    assert len(placed.triangles) == 2
    np.testing.assert_array_equal(placed.normals, [(0, 0, 1)] * len(placed.normals))


def test_only_a_closed_surface_that_is_seen_from_within_alone_faces_inwards() -> None:
    assert placed_mesh(_ball(ONE_SIDE, -1), np.eye(4)).faces_inwards
    assert not placed_mesh(_ball(ONE_SIDE), np.eye(4)).faces_inwards
    assert not placed_mesh(_ball(BOTH_SIDES, -1), np.eye(4)).faces_inwards
    hollow = _ball(ONE_SIDE, -1)
    without_top = hollow.vertices[hollow.triangles].mean(axis=1)[:, 2] < 0.7
    assert not placed_mesh(replace(hollow, triangles=hollow.triangles[without_top]), np.eye(4)).faces_inwards


@pytest.mark.parametrize("has_normals", [True, False])
def test_what_is_inside_out_and_seen_from_both_sides_is_turned_in_all_its_poses(has_normals: bool) -> None:
    """Its normals in the second pose lean, so that they are told from those that its triangles have there."""
    ball = _ball(BOTH_SIDES, -1)
    leaning = ball.normals + np.array((0.0, 0.0, 0.5))
    poses = np.stack([ball.vertices, 2 * ball.vertices]).astype(np.float32)
    motion = RawMotion(poses, np.stack([ball.normals, leaning]).astype(np.float32) if has_normals else None, 1.0)
    placed = placed_mesh(replace(ball, normals=ball.normals if has_normals else None, motion=motion), np.eye(4))
    outwards = placed.vertices / np.linalg.norm(placed.vertices, axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", placed.normals, outwards) > 0.8).all()
    second = placed.motion.normals[1]
    if has_normals:
        expected = outwards - np.array((0.0, 0.0, 0.5))
        np.testing.assert_allclose(second, expected / np.linalg.norm(expected, axis=1, keepdims=True), atol=1e-5)
    else:
        assert (np.einsum("ij,ij->i", second, outwards) > 0.8).all()

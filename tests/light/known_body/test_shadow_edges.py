"""How a shadow's edges move with the light, and how its penumbra widens: against finite differences."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.known_body.outline.edges import ShadowEdges, shadow_edges
from ashe_live.light.pixels.view import View
from ashe_live.tracking.cube.faces import CORNERS
from tests.painted_cubes import CAMERA, EDGE_M, looking

BODY = Proxy("box", np.column_stack([EDGE_M * CORNERS, np.zeros((8, 2))]))


def view(moved: Float | None = None) -> View:
    """moved: (6,) a turn and a shift of the marker in its own axes."""
    T = looking(0.5, 45, 30)
    if moved is not None:
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = cv2.Rodrigues(moved[:3])[0], moved[3:]
        T = T @ step
    marker = MarkerPose(T, np.zeros((4, 2)), EDGE_M, 0.0, None, body=BODY)
    return View.of(TrackedFrame(Frame(np.full((480, 640, 3), 90, np.uint8), 0, 0.0), CAMERA, marker), 640)


def edges_of(light: Float, body: Proxy = BODY, moved: Float | None = None) -> ShadowEdges:
    edges = shadow_edges(body, light, view(moved))
    assert edges is not None
    return edges


def reach(edges: ShadowEdges, normal: Float) -> float:
    """How far a convex outline reaches along a normal."""
    return float((edges.points_px @ normal).max())


@pytest.mark.parametrize("light", [(0.9, -0.5, 1.0, 0.0), (-0.4, 0.7, 1.0, 2.5)])
@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_points_movement_is_its_edges_lines(light: tuple[float, ...], number: int) -> None:
    here = np.array(light)
    edges = edges_of(here)
    small = 1e-5
    moved = here.copy()
    moved[(0, 1, 3)[number]] += small
    assert_moves(edges, edges_of(moved), edges.by_light[:, number], small)


@pytest.mark.parametrize("light", [(0.9, -0.5, 1.0, 0.0), (-0.4, 0.7, 1.0, 2.5)])
@pytest.mark.parametrize("number", range(6))
def test_a_frame_that_is_off_moves_the_edges(light: tuple[float, ...], number: int) -> None:
    small, here = 1e-6, np.array(light)
    edges = edges_of(here)
    moved = small * np.eye(6)[number]
    by_frame = edges.by_errors(PoseShapeErrors(np.eye(6)[:, [number]], np.zeros((8, 3, 1))), here)[:, 0]
    assert_moves(edges, edges_of(here, moved=moved), by_frame, small)


@pytest.mark.parametrize("light", [(0.9, -0.5, 1.0, 0.0), (-0.4, 0.7, 1.0, 2.5)])
@pytest.mark.parametrize("axis", range(3))
def test_a_body_that_is_off_moves_the_edges(light: tuple[float, ...], axis: int) -> None:
    """Each of its upper points by another way."""
    small, here = 1e-6, np.array(light)
    edges = edges_of(here)
    points = np.zeros((8, 3, 1))
    points[4:, axis, 0] = 1.0, -0.5, 0.7, 0.2
    spheroids = BODY.spheroids_marker.copy()
    spheroids[:, :3] += small * points[..., 0]
    by_points = edges.by_errors(PoseShapeErrors(np.zeros((6, 1)), points), here)[:, 0]
    assert np.abs(by_points).max() > 0
    assert_moves(edges, edges_of(here, Proxy("box", spheroids)), by_points, small, turning=1e-4)


def assert_moves(edges: ShadowEdges, after: ShadowEdges, rate: Float, small: float, turning: float = 1e-6) -> None:
    """Whether outlines move by `rate` (n,) pixels over `small`; turning: of an edge that is the same, at most."""
    compared = 0
    for index in np.flatnonzero(edges.to_corner_px > 4)[::7]:
        # The moved outline's point nearest to this one, along the normal of its own edge.
        near = np.argmin(np.linalg.norm(after.points_px - edges.points_px[index], axis=1))
        along = (after.points_px[near] - edges.points_px[index]) @ after.normals_px[near]
        turned = float(after.normals_px[near] @ edges.normals_px[index])
        if turned < 1 - turning:
            continue
        compared += 1
        assert along / small == pytest.approx(rate[index], abs=0.02 * np.abs(rate).max())
    assert compared > 5


def test_what_is_cast_by_the_foot_neither_moves_nor_blurs() -> None:
    edges = edges_of(np.array((0.9, -0.5, 1.0, 0.0)))
    foot = (np.abs(edges.by_size) < 1e-9) & (edges.to_corner_px > 2)
    assert foot.any()
    assert np.abs(edges.by_light[foot, :2]).max() < 1e-6
    assert edges.by_size.max() > 5


@pytest.mark.parametrize("light", [(0.9, -0.5, 1.0, 0.0), (-0.4, 0.7, 1.0, 2.5), (0.3, 0.2, 1.0, 6.0)])
def test_a_penumbra_is_as_wide_as_the_lights_disc_moves_the_edge(light: tuple[float, ...]) -> None:
    here = np.array(light) / np.linalg.norm(light[:3])
    edges = edges_of(here)
    # By moves of the light along the axes, over its distance from the marker's centre.
    x, y, z, w = here
    by_moves = edges.by_light @ np.array([[1 / z, 0, -x / z**2], [0, 1 / z, -y / z**2], [0, 0, -w / z**2]])
    # A disc of 1 rad reaches by half of that, and a semicircular density's standard deviation is half of its reach.
    assert edges.by_size == pytest.approx(np.linalg.norm(by_moves, axis=1) / 4, abs=1e-6)


def test_normals_point_out_of_the_shadow_at_right_angles_to_its_edges() -> None:
    edges = edges_of(np.array((0.9, -0.5, 1.0, 0.0)))
    middle = edges.points_px.mean(axis=0)
    assert (((edges.points_px - middle) * edges.normals_px).sum(axis=1) > 0).all()
    assert np.linalg.norm(edges.normals_px, axis=1) == pytest.approx(1)
    # No point of a convex outline reaches farther along an edge's normal than that edge.
    for point, normal in zip(edges.points_px, edges.normals_px, strict=True):
        assert reach(edges, normal) == pytest.approx(float(point @ normal), abs=1e-6)


def test_a_light_below_the_table_casts_no_shadow() -> None:
    assert shadow_edges(BODY, np.array((1.0, 0.0, 1e-9, 0.0)), view()) is None
    assert shadow_edges(BODY, np.array((1.0, 0.0, -0.5, 0.0)), view()) is None


def test_straight_above_the_shadow_is_the_foot() -> None:
    edges = edges_of(np.array((0.0, 0.0, 1.0, 0.0)))
    places = raycast_to_plane(CAMERA, looking(0.5, 45, 30), edges.points_px)
    assert np.abs(places[:, :2]).max(axis=1) == pytest.approx(EDGE_M / 2)
    assert np.isfinite(edges.by_light).all()
    assert np.isfinite(edges.by_size).all()

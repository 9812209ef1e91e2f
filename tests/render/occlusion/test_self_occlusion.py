"""What a model's parts hide of sky and ground from one another, against what geometry says."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import directions_on_spiral
from ashe_live.core.light import Illumination
from ashe_live.models.material import Material
from ashe_live.models.mesh import Mesh, Motion
from ashe_live.models.placement import PlacedModel
from ashe_live.models.primitives import box
from ashe_live.quality import FAST
from ashe_live.render.gl.geometry import GpuModel, GpuPart
from ashe_live.render.gl.programs import Programs
from ashe_live.render.occlusion.contact import ContactPatch
from ashe_live.render.occlusion.occlusion import Known, occlusion_steps
from ashe_live.render.occlusion.stand_in import CELLS, MOST_TRIANGLES, stand_in_for
from ashe_live.render.occlusion.surface_samples import samples_on
from ashe_live.render.scene import Scene

FLOOR_Z = 0.01
Find = Callable[..., list[np.ndarray]]


@pytest.fixture
def openness(ctx, stage, monkeypatch: pytest.MonkeyPatch) -> Find:
    """(n, 4) of the vertices of each mesh that stands in a model together with the others."""

    def find(*parts: Mesh) -> list[np.ndarray]:
        found: list[np.ndarray] = []
        with monkeypatch.context() as patch:
            patch.setattr(GpuPart, "set_openness", lambda _, values: found.append(values / 255))
            programs = Programs(ctx)
            placed: PlacedModel = stage.placed(*parts)
            model = GpuModel(ctx, placed, programs)
            contact = ContactPatch(ctx, programs, model)
            for _ in (*model.upload(), *occlusion_steps(ctx, programs, model, contact, Known())):
                pass
            for held in (contact, model, programs):
                held.release()
        return found

    return find


def _floor(columns: int = 40, half: float = 0.06) -> Mesh:
    """A square grid in the plane z = FLOOR_Z, seen from above, with triangles between `columns` rows and columns."""
    steps = np.linspace(-half, half, columns + 1)
    x, y = np.meshgrid(steps, steps)
    places = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, FLOOR_Z)]).astype(np.float32)
    row, column = np.divmod(np.arange(columns * columns), columns)
    a = row * (columns + 1) + column
    b, c, d = a + 1, a + columns + 1, a + columns + 2
    triangles = np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    return Mesh(places, np.tile(np.float32((0, 0, 1)), (len(places), 1)), triangles)


def test_nothing_is_hidden_from_a_convex_body(openness: Find) -> None:
    (found,) = openness(replace(box((0.05, 0.06, 0.07)), material=Material(double_sided=False)))
    np.testing.assert_allclose(found, 1.0, atol=0.01)


def test_wall_hides_from_the_floor_what_its_form_factor_says(openness: Find) -> None:
    """Of a long wall of height h, at its distance x: (1 - x / sqrt(x^2 + h^2)) / 2."""
    height = 0.05
    floor = _floor()
    wall = box((0.004, 1.0, height)).moved(1.0, np.array([-0.062, 0, FLOOR_Z]))
    found, _ = openness(floor, wall)
    x = floor.vertices[:, 0] + 0.06
    inner = (np.abs(floor.vertices[:, 1]) < 0.05) & (x > 0.004)
    np.testing.assert_allclose(found[inner, 0], 1 - 0.5 * (1 - x[inner] / np.hypot(x[inner], height)), atol=0.06)
    np.testing.assert_allclose(found[inner, 3], 1.0, atol=0.02)  # below, the ground is open


def _tube(radius: float, below: float, above: float, inward: bool) -> Mesh:
    """An upright tube of 96 sides without ends, seen from within or from outside."""
    angles = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(96)])
    heights = np.linspace(below, above, 9)
    places = np.concatenate([radius * around + (0, 0, z) for z in heights]).astype(np.float32)
    a = np.arange(8 * 96)
    b = a // 96 * 96 + (a + 1) % 96
    outward = np.concatenate([np.column_stack([a, b, b + 96]), np.column_stack([a, b + 96, a + 96])])
    normals = np.tile(around, (9, 1)).astype(np.float32)
    return Mesh(places, -normals if inward else normals, outward[:, ::-1] if inward else outward)


def test_bottom_of_a_round_pit_sees_what_its_form_factor_says_and_alike_all_around(openness: Find) -> None:
    """Of a disc of radius r at the height h, at the distance a from the axis: half of
    1 - (a^2 + h^2 - r^2) / sqrt((a^2 + h^2 + r^2)^2 - 4 a^2 r^2). Few directions pass through it, and none of them may
    show by itself."""
    radius = 0.02
    for height in (0.02, 0.04):
        floor, top = _floor(40, radius), FLOOR_Z + height
        walls = _tube(radius, FLOOR_Z, top, inward=True), _tube(radius + 0.003, 0.0, top, inward=False)
        found = openness(floor, *walls)[0][:, 0]
        a = np.hypot(*floor.vertices[:, :2].T.astype(float))
        total = a**2 + height**2 + radius**2
        expected = 0.5 * (1 - (total - 2 * radius**2) / np.sqrt(total**2 - (2 * a * radius) ** 2))
        error = (found - expected)[a < 0.9 * radius]
        assert abs(error.mean()) < 0.02
        assert error.std() < 0.016


def test_inside_of_a_closed_box_sees_neither_sky_nor_ground(openness: Find) -> None:
    closed = replace(box((0.05, 0.06, 0.07)), material=Material(double_sided=True))
    (found,) = openness(closed)
    np.testing.assert_allclose(found[:, :2], 1.0, atol=0.01)
    of_sky = 0.5 - 0.5 * closed.normals[:, 2]
    assert (of_sky * found[:, 2] + (1 - of_sky) * found[:, 3]).max() < 0.25  # a depth map leaks at edges


def test_vertices_within_another_part_do_not_darken_what_is_seen(openness: Find) -> None:
    """A tall box of eight corners, half of which are within a base: its open sides are lit as such."""
    base = box((0.04, 0.04, 0.02))
    tower = box((0.02, 0.02, 0.12))
    _, found = openness(base, tower)
    sides = np.abs(tower.normals[:, 2]) < 0.5
    low = tower.vertices[:, 2] < 0.01
    middle = (found[sides & low].mean(axis=0) + found[sides & ~low].mean(axis=0)) / 2
    assert middle[0] > 0.95
    assert middle[1] > 0.75  # the base hides some ground


def test_of_a_model_that_moves_it_is_the_mean(openness: Find) -> None:
    floor, lid = _floor(20, 0.03), box((0.06, 0.06, 0.004))
    near, away = (lid.moved(1.0, np.array([0, 0, z])) for z in (0.02, 0.3))
    poses = np.stack([near.vertices, away.vertices]), np.stack([lid.normals, lid.normals])
    middle = np.abs(floor.vertices[:, :2]).max(axis=1) < 0.01
    moving = replace(away, motion=Motion(*poses, duration_s=1.0))
    low, mean, high = (openness(floor, each)[0][middle, 0].mean() for each in (near, moving, away))
    assert low + 0.1 < mean < high - 0.01


def test_directions_are_spread_evenly() -> None:
    directions = directions_on_spiral(80)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    np.testing.assert_allclose(directions.mean(axis=0), 0.0, atol=0.02)
    np.testing.assert_allclose(directions.T @ directions / 80, np.eye(3) / 3, atol=0.02)


def test_few_vertices_get_what_comes_nearest_to_the_points_between_them() -> None:
    """A linear function is found again, and what has no weight does not count."""
    mesh = _floor(2)
    samples = samples_on(mesh, 500 / (0.12 * 0.12))
    places, normals = samples.places_and_normals()
    np.testing.assert_allclose(normals, np.tile((0, 0, 1), (len(normals), 1)), atol=1e-6)
    np.testing.assert_allclose(samples.areas.sum(), 0.12 * 0.12)
    values = 0.5 + 5 * places[:, 0].astype(float)
    wrong = places[:, 1] > 0.03
    found = samples.fitted(np.where(wrong, 0.0, values), np.where(wrong, 0.0, samples.areas))
    np.testing.assert_allclose(found, 0.5 + 5 * mesh.vertices[:, 0], atol=0.06)


def test_large_model_has_a_stand_in_of_the_same_shape(stage) -> None:
    floor = _floor(200)
    assert len(floor.triangles) > MOST_TRIANGLES
    placed = stage.placed(floor)
    stand_in = stand_in_for(placed)
    (coarse,) = stand_in.placed.model.parts
    assert len(coarse.triangles) < MOST_TRIANGLES / 3
    # Within a cell of its place.
    (vertices,) = stand_in.vertices
    aside = np.abs(coarse.vertices[vertices] - floor.vertices).max()
    assert aside <= 0.12 / CELLS * 1.001
    inwards = stand_in_for(stage.placed(replace(floor, faces_inwards=True))).placed.model.parts[0]
    assert inwards.faces_inwards  # as a hull that outlines a figure, which hides nothing from it
    small = stage.placed(box((0.05, 0.05, 0.05)))
    assert stand_in_for(small).placed is small


def test_stand_in_hides_as_much(openness: Find) -> None:
    wall = box((0.004, 0.12, 0.05)).moved(1.0, np.array([-0.062, 0, FLOOR_Z]))
    fine, rough = _floor(160), _floor(40)
    (of_fine, _), (of_rough, _) = openness(fine, wall), openness(rough, wall)
    assert len(fine.triangles) > MOST_TRIANGLES
    x = np.linspace(-0.05, 0.05, 11)
    along = []
    for mesh, found in ((fine, of_fine), (rough, of_rough)):
        near = [np.abs(mesh.vertices[:, :2] - (each, 0.0)).sum(axis=1).argmin() for each in x]
        along.append(found[near, 0])
    np.testing.assert_allclose(along[0], along[1], atol=0.08)


def test_hidden_sky_darkens_and_pale_parts_light_each_other(make_renderer, stage) -> None:
    """The floor of a pit: darker than open floor, and of white walls less so than of black ones' share of the sky."""
    floor = replace(_floor(40), material=Material(base_colour=(0.8, 0.8, 0.8, 1.0), roughness=1.0))
    walls = [
        box(size).moved(1.0, np.array([*at, FLOOR_Z]))
        for size, at in (
            ((0.004, 0.04, 0.03), (-0.02, 0.0)),
            ((0.004, 0.04, 0.03), (0.02, 0.0)),
            ((0.04, 0.004, 0.03), (0.0, -0.02)),
            ((0.04, 0.004, 0.03), (0.0, 0.02)),
        )
    ]
    tracked = stage.tracked(90, stage.pose(-90, 80, 0.3))
    renderer = make_renderer(FAST.render)
    renderer.render(Scene(tracked, stage.placed(floor, *walls), Illumination()))
    pit, outside = stage.along(renderer.read_bgr(), tracked, np.array([0.0, 0.05]))
    # Of the sky 1 / (1 + (h / r)^2) at the middle of a round pit, and with the walls' light (albedo 0.8) at most three
    # times that.
    open_share = 1 / (1 + (0.03 / 0.018) ** 2)
    assert 1.3 * open_share < pit / outside < min(3.5 * open_share, 0.95)

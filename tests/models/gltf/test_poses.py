"""Sparse arrays, morph targets, skins and instances: where vertices are, as the specification says."""

import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.errors import UserError
from ashe_live.models.gltf.motion.pose import matrix_of
from ashe_live.models.loading import load_model_file
from ashe_live.models.mesh import Model, face_normals
from tests.models.gltf_files import CORNERS, TRIANGLES, Document

Y_UP = np.float32([(1, 0, 0), (0, 0, -1), (0, 1, 0)])  # from z up


def places(model: Model) -> np.ndarray:
    """(n, 3) of all places, sorted, y up as in the file."""
    corners = np.concatenate([part.vertices for part in model.parts]) @ Y_UP
    return np.unique(np.round(corners, 5) + 0.0, axis=0)


def expected(corners: np.ndarray) -> np.ndarray:
    return np.unique(np.round(np.asarray(corners, dtype=np.float64), 5) + 0.0, axis=0)


def assert_there(vertices: np.ndarray, corners: np.ndarray, within: float = 1e-4) -> None:
    """Each of the mesh's vertices is at a corner, y up as in the file, and none is left out."""
    apart = np.linalg.norm((vertices @ Y_UP)[:, None] - np.asarray(corners)[None], axis=2)
    assert apart.min(axis=0).max() < within
    assert apart.min(axis=1).max() < within


def bare_quad(document: Document, **primitive) -> None:
    """Without normals, so that what moves may turn."""
    document.quad()
    own = document.json["meshes"][0]["primitives"][0]
    del own["attributes"]["NORMAL"]
    own.update(primitive)


@pytest.mark.parametrize("has_base", [True, False])
def test_a_sparse_accessor_replaces_some_items(tmp_path: Path, has_base: bool) -> None:
    document = Document()
    bare_quad(document)
    accessor = document.json["accessors"][0]
    moved = np.float32([(2, 3, 4), (5, 6, 7)])
    accessor["sparse"] = {
        "count": 2,
        "indices": {
            "bufferView": document.view(np.uint16([9, 9, 1, 2]).tobytes()),
            "byteOffset": 4,
            "componentType": 5123,
        },
        "values": {"bufferView": document.view(b"head" + moved.tobytes()), "byteOffset": 4},
    }
    base = CORNERS.copy()
    if not has_base:
        del accessor["bufferView"]
        base[:] = 0
    base[[1, 2]] = moved
    model = load_model_file(document.save(tmp_path / "a.glb"))
    # Of nothing but two places, the second triangle has no area.
    np.testing.assert_allclose(places(model), expected(base if has_base else base[:3]), atol=1e-5)


def test_a_sparse_accessor_names_what_is_there(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    document.json["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": document.view(np.uint16([4]).tobytes()), "componentType": 5123},
        "values": {"bufferView": document.view(np.zeros(3, np.float32).tobytes())},
    }
    with pytest.raises(UserError, match="replaces item 4 of 4"):
        load_model_file(document.save(tmp_path / "a.glb"))
    document.json["accessors"][0]["sparse"]["count"] = 5
    with pytest.raises(UserError, match=r"accessors\[0\].sparse.count is 5 of 4 items"):
        load_model_file(document.save(tmp_path / "a.glb"))


@pytest.mark.parametrize("of_node", [True, False])
def test_morph_targets_move_by_their_weights(tmp_path: Path, of_node: bool) -> None:
    document = Document()
    bare_quad(document)
    up, out = np.float32([(0, 0, 4)] * 4), np.float32(CORNERS * 2)
    document.json["meshes"][0]["primitives"][0]["targets"] = [
        {"POSITION": document.accessor(up)},
        {"POSITION": document.accessor(out)},
    ]
    document.json["meshes"][0]["weights"] = [1, 1] if of_node else [0.25, 0.5]
    if of_node:
        document.json["nodes"][0]["weights"] = [0.25, 0.5]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    np.testing.assert_allclose(places(model), expected(CORNERS + 0.25 * up + 0.5 * out), atol=1e-5)


def skinned_quad(document: Document) -> None:
    """Its left corners follow the first joint, its right ones the second, whose bind pose is at x = 1."""
    joints = np.uint8([(0, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 0)])
    weights = np.float32([(1, 0, 0, 0)] * 4)
    bare_quad(document)
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own |= {"JOINTS_0": document.accessor(joints), "WEIGHTS_0": document.accessor(weights)}
    bound = np.stack([np.eye(4), np.eye(4)]).astype(np.float32)
    bound[1, 3, 0] = -1  # column by column
    bound_at = document.accessor(bound.reshape(2, 16))
    document.json["skins"] = [{"joints": [1, 2], "inverseBindMatrices": bound_at}]
    document.json["nodes"][0] |= {"skin": 0, "translation": [100, 0, 0]}  # which is of no account
    quarter = [0, 0, math.sqrt(0.5), math.sqrt(0.5)]
    document.json["nodes"] += [{"children": [2]}, {"translation": [1, 0, 0], "rotation": quarter}]
    document.json["scenes"][0]["nodes"] = [0, 1]


def test_a_skin_follows_its_joints(tmp_path: Path) -> None:
    document = Document()
    skinned_quad(document)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    # The right side is turned by 90 degrees about (1, 0): (1, 1) comes to (0, 0).
    np.testing.assert_allclose(places(model), expected([(0, 0, 0), (1, 0, 0), (0, 0, 0), (0, 1, 0)]), atol=1e-5)


def test_a_skin_of_one_joint_follows_it(tmp_path: Path) -> None:
    """Its arrays hold a single item."""
    document = Document()
    skinned_quad(document)
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own["JOINTS_0"] = document.accessor(np.zeros((4, 4), np.uint8))
    bound = np.eye(4, dtype=np.float32)
    bound[3, 0] = -1
    document.json["skins"] = [{"joints": [2], "inverseBindMatrices": document.accessor(bound.reshape(1, 16))}]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    np.testing.assert_allclose(places(model), expected([(1, -1, 0), (1, 0, 0), (0, 0, 0), (0, -1, 0)]), atol=1e-5)


def with_normals(document: Document, normals: np.ndarray) -> None:
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own["NORMAL"] = document.accessor(np.float32(normals))


def test_normals_follow_a_joint_that_flattens_as_they_follow_a_node(tmp_path: Path) -> None:
    leaning = np.float32([(0.6, 0.0, 0.8)] * 4)
    found = []
    for is_skinned in (True, False):
        document = Document()
        if is_skinned:
            skinned_quad(document)
            document.json["nodes"][1]["scale"] = [1, 1, 0.25]
            document.json["nodes"][2] = {"translation": [1, 0, 0]}
        else:
            bare_quad(document)
            document.json["nodes"][0]["scale"] = [1, 1, 0.25]
        with_normals(document, leaning)
        found.append(load_model_file(document.save(tmp_path / "a.glb")).parts[0].normals)
    np.testing.assert_allclose(found[0], found[1], atol=1e-5)


@pytest.mark.parametrize("has_normals", [True, False])
def test_a_skin_whose_joints_mirror_it_keeps_its_front(tmp_path: Path, has_normals: bool) -> None:
    """As the mesh at a node that mirrors: a quad that faced up still does."""
    document = Document()
    skinned_quad(document)
    document.json["nodes"][1]["scale"] = [-1, 1, 1]
    document.json["nodes"][2] = {"translation": [1, 0, 0]}
    if has_normals:
        with_normals(document, [(0, 0, 1)] * 4)
    part = load_model_file(document.save(tmp_path / "a.glb")).parts[0]
    assert part.vertices[:, 0].max() - part.vertices[:, 0].min() > 0
    for normals in (part.normals, face_normals(part.vertices, part.triangles)):
        np.testing.assert_array_less(0, (normals @ Y_UP)[:, 2])


def test_what_moves_apart_is_not_welded(tmp_path: Path) -> None:
    """A door in its frame: two quads side by side in one plane, of which one swings open."""
    document = Document()
    corners = np.concatenate([CORNERS, CORNERS + np.float32([1, 0, 0])]).astype(np.float32)
    document.quad(POSITION=document.accessor(corners))
    own = document.json["meshes"][0]["primitives"][0]
    own["attributes"] = {"POSITION": own["attributes"]["POSITION"]}
    own["indices"] = document.accessor(np.concatenate([TRIANGLES, TRIANGLES + 4]).ravel().astype(np.uint16))
    swung = np.float32([(0, 0, 0)] * 4 + [(0, 0, 3)] * 4)
    own["targets"] = [{"POSITION": document.accessor(swung)}]
    animated(document, "weights", np.float32([0, 1]))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    motion = model.parts[0].motion
    assert_there(motion.vertices[-1], corners + swung)


def test_what_is_folded_has_an_edge_where_it_has_no_normals(tmp_path: Path) -> None:
    """3.7.2.1: flat normals, also of triangles that share vertices and lie in one plane at first."""
    document = Document()
    bare_quad(document)
    lifted = document.accessor(np.float32([(0, 0, 0), (0, 0, 1), (0, 0, 0), (0, 0, 0)]))
    document.json["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": lifted}]
    animated(document, "weights", np.float32([0, 1]))
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    folded, normals = part.motion.vertices[-1], part.motion.normals[-1]
    flat = face_normals(folded, part.triangles)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert flat[0] @ flat[1] < 0.8
    np.testing.assert_allclose(normals[part.triangles], np.repeat(flat[:, None], 3, axis=1), atol=1e-6)


def test_weights_count_by_their_share(tmp_path: Path) -> None:
    document = Document()
    skinned_quad(document)
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own["JOINTS_0"] = document.accessor(np.uint8([(0, 1, 0, 0)] * 4))
    own["WEIGHTS_0"] = document.accessor(np.uint8([(51, 51, 0, 0)] * 4), normalised=True)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    turned = np.column_stack([1 - CORNERS[:, 1], CORNERS[:, 0] - 1, 0 * CORNERS[:, 0]])
    np.testing.assert_allclose(places(model), expected((CORNERS + turned) / 2), atol=1e-5)


@pytest.mark.parametrize("is_said", [True, False])
def test_a_vertex_may_follow_more_than_four_joints(tmp_path: Path, is_said: bool) -> None:
    """Half of the weight in the first set, half in the second; integers can be nothing but shares."""
    document = Document()
    skinned_quad(document)
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    for number, weights in enumerate((np.uint8([(128, 0, 0, 0)] * 4), np.float32([(128 / 255, 0, 0, 0)] * 4))):
        own[f"JOINTS_{number}"] = document.accessor(np.uint8([(number, 0, 0, 0)] * 4))
        own[f"WEIGHTS_{number}"] = document.accessor(weights, normalised=is_said and number == 0)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    turned = np.column_stack([1 - CORNERS[:, 1], CORNERS[:, 0] - 1, 0 * CORNERS[:, 0]])
    np.testing.assert_allclose(places(model), expected((CORNERS + turned) / 2), atol=1e-5)


def test_a_vertex_of_no_joint_is_said(tmp_path: Path) -> None:
    document = Document()
    skinned_quad(document)
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own["JOINTS_0"] = document.accessor(np.uint8([(2, 0, 0, 0)] * 4))
    with pytest.raises(UserError, match="a vertex follows joint 2 of 2"):
        load_model_file(document.save(tmp_path / "a.glb"))


@pytest.mark.parametrize("shape", [(1, 16), (2, 4)])
def test_a_skin_has_a_matrix_for_each_joint(tmp_path: Path, shape: tuple[int, int]) -> None:
    document = Document()
    skinned_quad(document)
    document.json["skins"][0]["inverseBindMatrices"] = document.accessor(np.zeros(shape, np.float32))
    with pytest.raises(UserError, match="fewer inverse bind matrices than joints"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_a_skin_without_matrices_is_bound_where_its_joints_frames_are_the_scenes(tmp_path: Path) -> None:
    """3.7.3.1: then they are identities. Normals turn with the joint of their vertex."""
    document = Document()
    skinned_quad(document)
    with_normals(document, [(0, 0, 1)] * 4)
    del document.json["skins"][0]["inverseBindMatrices"]
    half = math.sqrt(0.5)
    document.json["nodes"][1:] = [{"rotation": [half, 0, 0, half], "children": [2]}, {"translation": [0, 5, 0]}]
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    # About x by 90 degrees: y becomes z, z becomes -y; the second joint is 5 above.
    assert_there(part.vertices, [(0, 0, 0), (1, 0, 5), (1, 0, 6), (0, 0, 1)])
    np.testing.assert_allclose(part.normals @ Y_UP, [(0, -1, 0)] * 4, atol=1e-6)


def test_morph_targets_turn_normals(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    with_normals(document, [(0, 0, 1)] * 4)
    targets = [{"NORMAL": document.accessor(np.float32([turn] * 4))} for turn in ((4, 0, 0), (0, 9, 0))]
    document.json["meshes"][0]["primitives"][0]["targets"] = targets
    document.json["meshes"][0]["weights"] = [0.25, 0]
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    np.testing.assert_allclose(part.normals @ Y_UP, [(math.sqrt(0.5), 0, math.sqrt(0.5))] * 4, atol=1e-6)


def animated(
    document: Document, path: str, values: np.ndarray, interpolation: str = "LINEAR", times: Sequence[float] = (0, 1)
) -> None:
    frames = document.accessor(np.float32(times))
    sampler = {"input": frames, "output": document.accessor(values), "interpolation": interpolation}
    channel = {"sampler": 0, "target": {"node": 0, "path": path}}
    document.json["animations"] = [{"samplers": [sampler], "channels": [channel]}]


SPLINE = np.float32([(8, 8, 8), (0, 0, 5), (1, 2, 3), (4, 5, 6), (9, 9, 9), (8, 8, 8)])


def spline(t: float) -> np.ndarray:
    """The cubic through (0, 0, 5) and (9, 9, 9) at 0 and 1 that leaves by (1, 2, 3) and arrives by (4, 5, 6)."""
    powers = np.linalg.solve(
        [(1, 0, 0, 0), (1, 1, 1, 1), (0, 1, 0, 0), (0, 1, 2, 3)],
        np.float64([SPLINE[1], SPLINE[4], SPLINE[2], SPLINE[3]]),
    )
    return np.array([1, t, t**2, t**3]) @ powers


@pytest.mark.parametrize(
    ("interpolation", "values", "at"),
    [
        ("LINEAR", np.float32([(0, 0, 5), (9, 9, 9)]), lambda t: np.array((9 * t, 9 * t, 5 + 4 * t))),
        ("STEP", np.float32([(0, 0, 5), (9, 9, 9)]), lambda t: np.array((0, 0, 5) if t < 1 else (9, 9, 9))),
        ("CUBICSPLINE", SPLINE, spline),
    ],
)
def test_between_keyframes_it_moves_as_the_format_says(tmp_path: Path, interpolation: str, values, at) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "translation", values, interpolation)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.notes == ()
    assert model.duration_s == 1
    np.testing.assert_allclose(places(model), expected(CORNERS + at(0.0)), atol=1e-5)
    motion = model.parts[0].motion
    assert motion is not None
    count = len(motion.vertices)
    for number, vertices in enumerate(motion.vertices):
        assert_there(vertices, CORNERS + at(number / (count - 1)))
        np.testing.assert_allclose(motion.normals[number], np.tile((0, -1, 0), (len(vertices), 1)), atol=1e-5)


@pytest.mark.parametrize("interpolation", ["LINEAR", "STEP", "CUBICSPLINE"])
def test_keyframes_may_be_any_time_apart(tmp_path: Path, interpolation: str) -> None:
    """Two seconds at rest, four on the way, at the speed that the spline's tangents say."""
    document = Document()
    bare_quad(document)
    still, speed = (0, 0, 0), (2.25, 0, 0)
    reached = [still, still, (9, 0, 0)]
    values = reached if interpolation != "CUBICSPLINE" else [
        still, reached[0], still, still, reached[1], speed, speed, reached[2], still
    ]  # fmt: skip
    animated(document, "translation", np.float32(values), interpolation, times=(0, 2, 6))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.duration_s == 6
    motion = model.parts[0].motion
    assert motion is not None
    for number, vertices in enumerate(motion.vertices):
        time_s = 6 * number / (len(motion.vertices) - 1)
        on_the_way = 0 if interpolation == "STEP" and time_s < 6 else max(0.0, 2.25 * (time_s - 2))
        assert_there(vertices, CORNERS + np.array((on_the_way, 0, 0)))


def test_normals_stay_upright_on_what_is_stretched(tmp_path: Path) -> None:
    document = Document()
    document.quad({"rotation": [math.sin(math.pi / 8), 0, 0, math.cos(math.pi / 8)]})
    document.json["nodes"] = [{"children": [1]}, document.json["nodes"][0]]
    animated(document, "scale", np.float32([(-1, 1, 1), (-2, 3, 1)]))
    part = load_model_file(document.save(tmp_path / "a.glb")).parts[0]
    assert part.motion is not None
    for vertices, normals in zip(part.motion.vertices, part.motion.normals, strict=True):
        edges = vertices[part.triangles[:, 1:]] - vertices[part.triangles[:, :1]]
        np.testing.assert_allclose(np.einsum("tek,tk->te", edges, normals[part.triangles[:, 0]]), 0, atol=1e-5)
        assert (normals @ Y_UP @ (0, -1, 1) > 0).all()  # still on the side that they were on


def test_what_is_turned_as_it_is_inside_out_stays_so_while_it_moves(tmp_path: Path) -> None:
    document = Document()
    corners = np.float32([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])  # of a tetrahedron about the origin
    document.quad(material={"doubleSided": True})
    document.json["meshes"][0]["primitives"][0] |= {
        "attributes": {"POSITION": document.accessor(corners), "NORMAL": document.accessor(-corners)},
        "indices": document.accessor(np.uint16([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]).ravel()),
    }
    animated(document, "scale", np.float32([(1, 1, 1), (2, 2, 2)]))
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    assert part.motion is not None
    for vertices, normals in zip(part.motion.vertices, part.motion.normals, strict=True):
        assert (np.einsum("ij,ij->i", vertices, normals) > 0.9).all()
        assert (np.einsum("ij,ij->i", vertices[part.triangles[:, 0]], face_normals(vertices, part.triangles)) > 0).all()


def test_what_moves_keeps_the_normals_of_its_file(tmp_path: Path) -> None:
    """Which smooth what the triangles are not: here both triangles of a quad lean to +x, and later to +y."""
    document = Document()
    document.quad(NORMAL=document.accessor(np.float32([(0.6, 0, 0.8)] * 4)))
    quarter = math.sqrt(0.5)
    animated(document, "rotation", np.float32([(0, 0, 0, 1), (0, 0, quarter, quarter)]))
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    assert part.motion is not None
    np.testing.assert_allclose(part.motion.normals[0], part.normals, atol=1e-6)
    np.testing.assert_allclose(part.motion.normals[-1] @ Y_UP, [(0, 0.6, 0.8)] * 4, atol=1e-5)


def test_a_spline_that_comes_back_to_where_it_began_moves_in_between(tmp_path: Path) -> None:
    """Appendix C: between two keyframes of the same value it follows their tangents."""
    document = Document()
    bare_quad(document)
    still, out, back = (0, 0, 0), (4, 0, 0), (-4, 0, 0)
    animated(document, "translation", np.float32([still, still, out, back, still, still]), "CUBICSPLINE")
    model = load_model_file(document.save(tmp_path / "a.glb"))
    motion = model.parts[0].motion
    assert motion is not None
    assert_there(motion.at(0.5)[0], CORNERS + np.array((4 / 8 + 4 / 8, 0, 0)), within=1e-2)


def test_a_rotation_goes_the_shorter_way_at_an_even_pace(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    half, opposite = math.sin(math.radians(60)), -math.cos(math.radians(60))
    animated(document, "rotation", np.float32([(0, 0, 0, 1), (0, 0, -half, opposite)]))  # 120 degrees, negated
    model = load_model_file(document.save(tmp_path / "a.glb"))
    motion = model.parts[0].motion
    assert motion is not None
    for time_s in (0.2, 0.5, 0.9):
        angle = math.radians(120 * time_s)
        turned = CORNERS @ np.array(
            [(math.cos(angle), math.sin(angle), 0), (-math.sin(angle), math.cos(angle), 0), (0, 0, 1)]
        )
        assert_there(motion.at(time_s)[0], turned, within=2e-3)  # as a line between poses cuts the arc


def test_a_rotation_may_rest_between_keyframes(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    quarter = math.sqrt(0.5)
    none, turned = (0, 0, 0, 1), (0, 0, quarter, quarter)
    animated(document, "rotation", np.float32([none, none, turned]), times=(0, 1, 2))
    motion = load_model_file(document.save(tmp_path / "a.glb")).parts[0].motion
    assert motion is not None
    assert_there(motion.at(0.5)[0], CORNERS)
    assert_there(motion.vertices[-1], [(0, 0, 0), (0, 1, 0), (-1, 1, 0), (-1, 0, 0)])


def test_what_grows_from_nothing_is_whole_when_it_has_grown(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "scale", np.float32([(0, 0, 0), (1, 1, 1)]))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    motion = model.parts[0].motion
    assert motion is not None
    assert np.ptp(motion.vertices[0], axis=0).max() == 0
    assert_there(motion.vertices[-1], CORNERS)
    np.testing.assert_allclose(np.linalg.norm(motion.normals, axis=2), 1, atol=1e-5)


def test_a_skin_follows_a_joint_that_turns_and_what_stands_still_costs_nothing(tmp_path: Path) -> None:
    document = Document()
    skinned_quad(document)
    document.quad({"translation": [5, 0, 0]})
    quarter = math.sqrt(0.5)
    animated(document, "rotation", np.float32([(0, 0, 0, 1), (0, 0, quarter, quarter)]))
    document.json["animations"][0]["channels"][0]["target"]["node"] = 2
    model = load_model_file(document.save(tmp_path / "a.glb"))
    moving = [part for part in model.parts if part.motion is not None]
    assert len(moving) == 1
    assert len(model.parts) == 2
    assert_there(moving[0].motion.vertices[-1], [(0, 0, 0), (1, 0, 0), (0, 0, 0), (0, 1, 0)])


def test_morph_targets_go_from_weight_to_weight(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    up = np.float32([(0, 0, 4)] * 4)
    document.json["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": document.accessor(up)}] * 2
    animated(document, "weights", np.float32([0.5, 0.25, 0, 0]))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    np.testing.assert_allclose(places(model), expected(CORNERS + 0.75 * up), atol=1e-5)
    motion = model.parts[0].motion
    assert motion is not None
    assert_there(motion.at(0.5)[0], CORNERS + 0.375 * up)


def test_what_is_too_long_to_be_kept_stands_as_it_begins_and_says_so(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]))
    document.json["animations"][0]["samplers"][0]["input"] = document.accessor(np.float32([0, 1e6]))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.duration_s == 0
    assert model.notes == ("its animation is too long to be played: it stands as that begins",)
    np.testing.assert_allclose(places(model), expected(CORNERS + np.float32((0, 0, 5))), atol=1e-5)


def test_animations_of_different_things_are_played_together_and_of_the_same_only_the_first(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32([(0, 0, 0), (8, 0, 0)]))
    (first,) = document.json["animations"]
    animated(document, "translation", np.float32([(0, 0, 0), (0, 9, 0)]))
    (instead,) = document.json["animations"]
    animated(document, "scale", np.float32([(1, 1, 1), (2, 2, 2)]))
    document.json["animations"] = [first, instead, *document.json["animations"]]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.notes == ("1 of its 3 animations are not played",)
    motion = model.parts[0].motion
    assert motion is not None
    assert_there(motion.vertices[-1], 2 * CORNERS + (8, 0, 0))


def test_an_animation_begins_with_its_first_keyframe(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]), times=(3, 5))
    (first,) = document.json["animations"]
    animated(document, "scale", np.float32([(2, 2, 2), (3, 3, 3)]), times=(4, 4.5))
    document.json["animations"].insert(0, first)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    motion = model.parts[0].motion
    assert model.duration_s == 2
    # The other animation has its first value before it begins, and its last one after its end.
    assert_there(motion.vertices[0], 2 * CORNERS + np.float32((0, 0, 5)))
    assert_there(motion.vertices[-1], 3 * CORNERS + np.float32((9, 9, 9)))


def test_what_stands_on_what_stands_on_what_moves_moves(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    document.json["nodes"] += [{"children": [0]}, {"children": [1]}]
    document.json["scenes"][0]["nodes"] = [2]
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]))
    document.json["animations"][0]["channels"][0]["target"]["node"] = 2
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    assert_there(part.motion.vertices[-1], CORNERS + np.float32((9, 9, 9)))


def test_a_channel_of_no_keyframes_is_said(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]))
    document.json["animations"][0]["channels"][0]["sampler"] = 1
    with pytest.raises(UserError, match="a channel names sampler 1 of 1"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_an_animation_of_what_is_not_drawn_plays_nothing(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    document.json["nodes"].append({})
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]))
    document.json["animations"][0]["channels"][0]["target"]["node"] = 1
    assert load_model_file(document.save(tmp_path / "a.glb")).duration_s == 0


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 3), (-0.3, 0.5, 0.2)])
@pytest.mark.parametrize("length", [1.0, 0.2, 7.0])
def test_a_quaternion_of_any_length_turns_about_its_axis(axis: tuple[float, float, float], length: float) -> None:
    angle = 1.1
    along = np.array(axis, dtype=np.float64) / np.linalg.norm(axis)
    quaternion = length * np.append(math.sin(angle / 2) * along, math.cos(angle / 2))
    matrix = matrix_of((1, 2, 3), quaternion, (2, 3, 4))
    np.testing.assert_allclose(matrix[:3, :3], cv2.Rodrigues(angle * along)[0] * (2, 3, 4), atol=1e-12)
    np.testing.assert_array_equal(matrix[:, 3], (1, 2, 3, 1))
    np.testing.assert_array_equal(matrix_of(None, (0, 0, 0, 0), None), np.eye(4))


def test_a_mesh_is_drawn_wherever_its_node_says(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    moves, sizes = np.float32([(0, 0, 0), (10, 0, 0)]), np.float32([(1, 1, 1), (2, 2, 2)])
    turns = np.int16([(0, 0, 0, 32767), (0, 0, 32767, 0)])
    own = {"TRANSLATION": document.accessor(moves), "SCALE": document.accessor(sizes)}
    own["ROTATION"] = document.accessor(turns, normalised=True)
    document.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": own}}
    document.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    both = np.concatenate([CORNERS, CORNERS * (-2, -2, 2) + (10, 0, 0)])
    np.testing.assert_allclose(places(model), expected(both), atol=1e-5)


def test_a_node_that_is_not_seen_is_left_out(tmp_path: Path) -> None:
    document = Document()
    document.quad()
    document.quad({"translation": [5, 0, 0], "extensions": {"KHR_node_visibility": {"visible": False}}})
    assert load_model_file(document.save(tmp_path / "a.glb")).triangle_count == 2


def test_a_skin_follows_joints_that_are_not_seen(tmp_path: Path) -> None:
    """KHR_node_visibility is about what is drawn: a joint is where it is all the same."""
    document = Document()
    skinned_quad(document)
    seen = places(load_model_file(document.save(tmp_path / "a.glb")))
    document.json["nodes"][1]["extensions"] = {"KHR_node_visibility": {"visible": False}}
    np.testing.assert_allclose(places(load_model_file(document.save(tmp_path / "b.glb"))), seen)


def test_quantised_places_are_placed_by_their_node(tmp_path: Path) -> None:
    """KHR_mesh_quantization: integers that a node scales, and normals as shares of the largest."""
    document = Document()
    document.quad({"scale": [0.01] * 3})
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    own["POSITION"] = document.accessor(np.int16(CORNERS * 100))
    del document.json["accessors"][own["POSITION"]]["normalized"]
    own["NORMAL"] = document.accessor(np.int8([(0, 0, 127)] * 4), normalised=True)
    document.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    np.testing.assert_allclose(places(model), expected(CORNERS), atol=1e-5)
    np.testing.assert_allclose(model.parts[0].normals, [(0, -1, 0)] * 4, atol=1e-6)


def test_what_is_far_from_the_origin_is_not_torn(tmp_path: Path) -> None:
    """At a map's coordinates a float counts half metres."""
    document = Document()
    bare_quad(document)
    document.json["nodes"][0]["translation"] = [4_400_000.3, 0, 5_300_000.7]
    model = load_model_file(document.save(tmp_path / "a.glb"))
    size = np.ptp(places(model), axis=0)
    np.testing.assert_allclose(size, (1, 1, 0), atol=1e-6)
    assert np.abs(model.bounds).max() < 2
    (tmp_path / "a.obj").write_text("v 4400000.25 5300000 0\nv 4400001.25 5300000 0\nv 4400000.25 5300001 0\nf 1 2 3\n")
    np.testing.assert_allclose(np.ptp(load_model_file(tmp_path / "a.obj").bounds, axis=0), (1, 1, 0), atol=1e-6)


def test_what_moves_far_from_the_origin_is_not_torn(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    document.json["nodes"][0]["translation"] = [4_400_000.3, 0, 5_300_000.7]
    half = math.sin(math.radians(45))
    animated(document, "rotation", np.float32([(0, 0, 0, 1), (0, 0, half, half)]))
    motion = load_model_file(document.save(tmp_path / "a.glb")).parts[0].motion
    assert motion is not None
    for pose in motion.vertices:
        vertices = np.unique(np.round(pose, 6), axis=0)
        apart = np.sort(np.linalg.norm(vertices[:, None] - vertices, axis=2), axis=1)
        np.testing.assert_allclose(apart, np.tile((0, 1, 1, math.sqrt(2)), (4, 1)), atol=1e-5)  # a square, turned


def test_points_and_lines_are_left_out_and_said(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    lines = {"attributes": {"POSITION": document.accessor(CORNERS)}, "mode": 1}
    document.json["meshes"][0]["primitives"].append(lines)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.triangle_count == len(TRIANGLES)
    assert model.notes == ("points and lines are left out",)


@pytest.mark.parametrize(
    ("times", "values"),
    [
        *(((0, last), [(0, 0, 5), (9, 9, 9)]) for last in (np.nan, np.inf, -1, 0)),
        ((0, 1), [(0, 0, 5), (9, np.nan, 9)]),
        ((0, 1), [(0, 0, 5)]),
        ((0, 1), [(0, 0, 5, 1), (9, 9, 9, 1)]),
    ],
)
def test_a_damaged_animation_is_said_to_be_left_out(tmp_path: Path, times: tuple, values: list) -> None:
    """Times that do not increase, values that are none, and fewer or other ones than the path has."""
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32(values), times=times)
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.duration_s == 0
    assert model.notes == ("what of its animation is damaged is left out",)
    np.testing.assert_allclose(places(model), expected(CORNERS), atol=1e-5)


@pytest.mark.parametrize("target", [{"path": "translation"}, {"node": 0, "path": "colour"}])
def test_what_an_animation_does_to_other_things_is_left_out(tmp_path: Path, target: dict) -> None:
    """3.11: "When node isn't defined, channel SHOULD be ignored"; extensions define paths of their own."""
    document = Document()
    bare_quad(document)
    animated(document, "translation", np.float32([(0, 0, 5), (9, 9, 9)]))
    document.json["animations"][0]["channels"][0]["target"] = target
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert (model.duration_s, model.notes) == (0, ())


def test_what_grows_for_too_long_to_be_kept_stands_at_rest(tmp_path: Path) -> None:
    document = Document()
    bare_quad(document)
    animated(document, "scale", np.float32([(0, 0, 0), (9, 9, 9)]), times=(0, 1e6))
    model = load_model_file(document.save(tmp_path / "a.glb"))
    np.testing.assert_allclose(places(model), expected(CORNERS), atol=1e-5)

"""An animation played from its first keyframe to its last, kept as the poses of whatever moves."""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.assembly.geometry import RawMesh, RawMotion
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.gltf.motion.animation import Animation
from ashe_live.models.gltf.motion.pose import Pose, Shape, of_normals
from ashe_live.models.parsing.json_kinds import Json

SMALL = 0.5  # of the largest that a mesh becomes while it moves


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """A primitive at a node, once for each of the node's instances."""

    node: int
    instance: int
    shape: Shape
    T: Float  # (4, 4) from the mesh to the scene
    mesh: RawMesh

    @property
    def has_extent(self) -> bool:
        corners = self.mesh.vertices[self.mesh.triangles].reshape(-1, 3) @ self.T[:3, :3].T
        return bool(len(corners) and np.any(np.ptp(corners, axis=0) > 0))

    def posed(self, header: Json, pose: Pose) -> tuple[Float, Float | None, bool]:
        """(n, 3) vertices and normals in the scene, None without these, and whether they are mirrored there."""
        weights = pose.weights(self.node, header["meshes"][header["nodes"][self.node]["mesh"]])
        joints = pose.joints(self.node)
        vertices, normals = self.shape.posed(weights, joints)
        if joints is not None:
            return vertices, normals, False
        T = pose.instances(self.node)[self.instance]
        turned = None if normals is None else normals @ of_normals(T[:3, :3]).T
        return vertices @ T[:3, :3].T + T[:3, 3], turned, bool(np.linalg.det(T[:3, :3]) < 0)


def played(
    header: Json, arrays: Arrays, drawn: list[Drawn], animation: Animation
) -> list[tuple[Float, RawMesh]] | None:
    """All that is drawn, with the poses of what moves; None where these are more than can be kept."""
    moved = Pose(header, arrays, {}).moved_by(animation.moving)
    moving = [place for place, each in enumerate(drawn) if each.node in moved]
    meshes = [(each.T, each.mesh) for each in drawn]
    times = animation.times(sum(len(drawn[place].mesh.vertices) for place in moving))
    if not moving or times is None:
        return None if moving else meshes
    kept = {place: _Poses(drawn[place], len(times)) for place in moving}
    for number, time_s in enumerate(times):
        pose = Pose(header, arrays, animation.at(time_s))
        for place, poses in kept.items():
            poses.keep(number, *drawn[place].posed(header, pose))
    for place, poses in kept.items():
        meshes[place] = poses.T, poses.mesh(animation.duration_s)
    return meshes


class _Poses:
    """The poses of one moving mesh in the scene, from where it begins: far away, single precision would tear them."""

    def __init__(self, drawn: Drawn, count: int) -> None:
        mesh = self._mesh = drawn.mesh
        shape = count, len(mesh.vertices), 3
        self._begin: Float = drawn.T[:3, :3] @ mesh.vertices.mean(axis=0, dtype=np.float64) + drawn.T[:3, 3]
        self.T = np.eye(4)  # (4, 4) from the poses to the scene
        self.T[:3, 3] = self._begin
        self._vertices = np.empty(shape, np.float32)
        self._normals = None if mesh.normals is None else np.empty(shape, np.float32)
        self._mirrored = np.zeros(count, np.bool_)

    def keep(self, number: int, vertices: Float, normals: Float | None, is_mirrored: bool) -> None:
        self._vertices[number], self._mirrored[number] = vertices - self._begin, is_mirrored
        if normals is not None and self._normals is not None:
            self._normals[number] = normals

    def mesh(self, duration_s: float) -> RawMesh:
        """The mesh in its first pose that is not small (things that are to grow begin as nothing), with its motion."""
        extents = np.nan_to_num(np.ptp(self._vertices, axis=1).sum(axis=1))
        first = int(np.argmax(extents >= SMALL * extents.max()))
        triangles = self._mesh.triangles
        return replace(
            self._mesh,
            vertices=self._vertices[first],
            triangles=triangles[:, ::-1] if self._mirrored[first] else triangles,
            normals=None if self._normals is None else self._normals[first].astype(np.float64),
            motion=RawMotion(self._vertices, self._normals, duration_s),
        )

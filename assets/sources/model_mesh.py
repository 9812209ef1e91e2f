"""Building closed textured shells for the shipped models, and writing them as GLB."""

import io
import math

import numpy as np
import trimesh
from PIL import Image

PALETTE_COLUMNS, PALETTE_SIZE = 8, 256


class Model:
    """Collects closed shells of triangles with a texture coordinate at every corner."""

    def __init__(self):
        self.corners, self.uvs, self.creases = [], [], []

    def shell(self, points, faces, uv, crease_deg):
        """`uv`: (n, 2) a point or (m, 3, 2) a corner; edges sharper than `crease_deg` stay sharp."""
        corners = np.asarray(points, float)[faces]
        uv = np.asarray(uv, float)
        uv = uv[faces] if uv.ndim == 2 else uv
        real = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 1e-12
        corners, uv = corners[real], uv[real]
        if np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) < 0:  # inside out
            corners, uv = corners[:, ::-1], uv[:, ::-1]
        self.corners.append(corners)
        self.uvs.append(uv)
        self.creases.append(crease_deg)

    def normals(self):
        """Corner normals: the mean of the faces around a point, of those within the crease angle."""
        result = []
        for corners, crease in zip(self.corners, self.creases, strict=True):
            area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            unit = area / np.linalg.norm(area, axis=1, keepdims=True)
            keys = np.round(corners.reshape(-1, 3) * 1e7).astype(np.int64)
            _, where = np.unique(keys, axis=0, return_inverse=True)
            order = np.argsort(where.ravel(), kind="stable")
            groups = np.split(order, np.flatnonzero(np.diff(where.ravel()[order])) + 1)
            normals = np.empty((len(keys), 3))
            for group in groups:
                faces = group // 3
                near = unit[faces] @ unit[faces].T >= math.cos(math.radians(crease)) - 1e-6
                summed = near @ area[faces]
                normals[group] = summed / np.linalg.norm(summed, axis=1, keepdims=True)
            result.append(normals)
        return np.concatenate(result)

    def mesh(self, material):
        """Standing on y = 0 only if the points do."""
        points = np.concatenate(self.corners).reshape(-1, 3)
        uv, normals = np.concatenate(self.uvs).reshape(-1, 2), self.normals()
        table = np.round(np.hstack([points * 1e6, normals * 1e4, uv * 1e5])).astype(np.int64)
        _, first, index = np.unique(table, axis=0, return_index=True, return_inverse=True)
        return trimesh.Trimesh(
            points[first],
            index.reshape(-1, 3),
            vertex_normals=normals[first],
            process=False,
            visual=trimesh.visual.TextureVisuals(uv=uv[first], material=material),
        )

    def save(self, path, image, roughness, metallic=0.0):
        """Alone, set on y = 0, with one base-colour texture."""
        encoded = io.BytesIO()
        image.convert("RGB").save(encoded, "JPEG", quality=90)
        material = trimesh.visual.material.PBRMaterial(
            name=path.stem,
            baseColorTexture=Image.open(encoded),
            baseColorFactor=(255, 255, 255, 255),
            metallicFactor=metallic,
            roughnessFactor=roughness,
            doubleSided=False,
        )
        mesh = self.mesh(material)
        mesh.vertices[:, 1] -= mesh.vertices[:, 1].min()
        write_glb(path, {path.stem: mesh})


def write_glb(path, meshes):
    """A file of meshes by name."""
    path.write_bytes(trimesh.Scene(meshes).export(file_type="glb", include_normals=True))
    triangles, vertices = (sum(len(getattr(m, what)) for m in meshes.values()) for what in ("faces", "vertices"))
    high = max(m.vertices[:, 1].max() for m in meshes.values())
    kilobytes = path.stat().st_size / 1024
    print(f"{path.name}: {triangles} triangles, {vertices} vertices, {high:.4f} m high, {kilobytes:.0f} KB")


def palette(pairs, rng):
    """One column a colour, from its dark tone (bottom) to its light one (top), slightly mottled."""
    width = PALETTE_SIZE // PALETTE_COLUMNS
    image = np.zeros((PALETTE_SIZE, PALETTE_SIZE, 3))
    for k, (dark, light) in enumerate(pairs):
        blend = np.linspace(1, 0, PALETTE_SIZE)[:, None, None]
        image[:, k * width : (k + 1) * width] = np.array(dark) * (1 - blend) + np.array(light) * blend
    image += rng.normal(0, 1.5, image.shape[:2])[..., None]
    return Image.fromarray(np.clip(image, 0, 255).astype(np.uint8))


def tint(count, column, v):
    """Texture coordinates in a palette column: `v` from 0 (dark) to 1 (light), one each or one for all."""
    v = np.clip(np.broadcast_to(np.asarray(v, float), count if np.ndim(count) else (count,)), 0.02, 0.98)
    return np.stack([np.full(v.shape, (column + 0.5) / PALETTE_COLUMNS), v], -1)

"""Meshes of one surface made one: what is drawn costs as many calls as there are surfaces, however many nodes."""

from collections.abc import Hashable, Iterable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from ashe_live.models.material import MAPS, Alpha, Material
from ashe_live.models.mesh import Mesh, Motion

ATTRIBUTES = ("vertices", "normals", "uvs", "more_uvs", "colours")  # of a Mesh, one a vertex


def merged(parts: Iterable[Mesh]) -> tuple[Mesh, ...]:
    """In the order of their first. Blended ones stay apart, as they are drawn from the farthest to the nearest."""
    alike: dict[Hashable, list[Mesh]] = {}
    for number, part in enumerate(parts):
        is_blended = part.material.alpha is Alpha.BLEND
        has = tuple(values is not None for values in (part.uvs, part.more_uvs, part.colours, part.motion))
        key = *has, part.faces_inwards, number if is_blended else _surface(part.material)
        alike.setdefault(key, []).append(part)
    return tuple(_joined(group) if len(group) > 1 else group[0] for group in alike.values())


def _surface(material: Material) -> Hashable:
    """Equal for materials that look alike: by their numbers, and by where their maps' texels lie."""
    maps = [(name, texels.ctypes.data, texels.shape) for name, texels in material.maps.items()]
    numbers = [getattr(material, field.name) for field in fields(material) if field.name not in (*MAPS, "layouts")]
    return tuple(maps), tuple(numbers), tuple(material.layouts.items())


def _joined(group: list[Mesh]) -> Mesh:
    """One mesh of several that have attributes of the same names."""
    firsts = np.cumsum([0, *(len(part.vertices) for part in group[:-1])])
    names = [name for name in ATTRIBUTES if getattr(group[0], name) is not None]
    joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in group]) for name in names}
    motions = [part.motion for part in group if part.motion is not None]
    if motions:  # all of one animation, so of the same moments
        vertices = np.concatenate([each.vertices for each in motions], axis=1)
        normals = np.concatenate([each.normals for each in motions], axis=1)
        joined["motion"] = Motion(vertices, normals, motions[0].duration_s)
    triangles = np.concatenate([part.triangles + first for part, first in zip(group, firsts, strict=True)])
    return replace(group[0], triangles=triangles, **joined)

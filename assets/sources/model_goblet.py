"""Goblet of satin brass with an enamel knot: metal and gloss."""

import io

import numpy as np
from mesh_grids import lathe
from model_mesh import Model
from PIL import Image
from trimesh.visual.material import PBRMaterial

SATIN = 0.4  # roughness of brushed metal: what it mirrors is a glow, as a small picture of the surroundings allows
BRASS = (222, 178, 92)


def goblet():
    """Its parts: a shape and its material each."""
    bowl, polished, enamel = Model(), Model(), Model()
    lip = [(0.03135 + 0.00095 * np.cos(t), 0.0930 + 0.00095 * np.sin(t)) for t in np.linspace(0.0, np.pi, 9)]
    outer = [(0.0, 0.0500), (0.0100, 0.0506), (0.0200, 0.0545), (0.0270, 0.0610), (0.0310, 0.0700), (0.0325, 0.0800)]
    inner = [(0.0308, 0.0800), (0.0293, 0.0705), (0.0255, 0.0622), (0.0190, 0.0562), (0.0, 0.0525)]
    points, faces, uv = lathe([*rounded([*outer, lip[0]]), *lip[1:-1], *rounded([lip[-1], *inner])], 72)
    bowl.shell(points, faces, uv, 60)
    stem = [(0.0300, 0.0012), (0.0200, 0.0045), (0.0100, 0.0075), (0.0060, 0.0125), (0.0046, 0.0200), (0.0044, 0.0400)]
    foot = [(0.0, 0.0), (0.0293, 0.0), *rounded([*stem, (0.0060, 0.0470), (0.0110, 0.0508)]), (0.0, 0.0515)]
    points, faces, uv = lathe(foot, 64)
    polished.shell(points, faces, uv, 50)
    profile = [(0.0095 * np.sin(t), 0.030 - 0.0065 * np.cos(t)) for t in np.linspace(0, np.pi, 17)]
    points, faces, uv = lathe(profile, 40)
    enamel.shell(points, faces, uv, 60)
    brass = {"baseColorFactor": (*BRASS, 255), "metallicFactor": 1.0, "doubleSided": False}
    return {
        "bowl": (
            bowl,
            PBRMaterial(
                name="bowl",
                roughnessFactor=SATIN,
                occlusionTexture=shaded_inside(),
                **brass,
            ),
        ),
        "foot": (polished, PBRMaterial(name="foot", roughnessFactor=SATIN, **brass)),
        "knot": (
            enamel,
            PBRMaterial(
                name="enamel",
                baseColorFactor=(14, 60, 92, 255),
                metallicFactor=0.0,
                roughnessFactor=0.2,
                doubleSided=False,
            ),
        ),
    }


def rounded(profile, each=4):
    """The profile with `each` points to a step, on the curve through them (Catmull and Rom 1974)."""
    points = np.array(profile)
    points = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    t = np.arange(each)[:, None] / each
    steps = []
    for a, b, c, d in zip(points, points[1:], points[2:], points[3:], strict=False):
        steps.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    return [tuple(each) for each in np.vstack([*steps, points[-2:-1]])]


def shaded_inside():
    """What the bowl's own wall keeps away from its inner side, the map's upper half: most of all at the bottom."""
    v = 1 - (np.arange(128) + 0.5) / 128
    share = np.interp(v, [0.52, 0.56, 0.85, 1.0], [1.0, 0.8, 0.4, 0.35])
    return encoded(np.tile(np.round(255 * share).astype(np.uint8)[:, None, None], (1, 8, 3)))


def encoded(rgb):
    content = io.BytesIO()
    Image.fromarray(rgb).save(content, "JPEG", quality=90, subsampling=0)
    return Image.open(content)

"""Goblet of hammered and polished brass with an enamel knot: metal, gloss and a normal map."""

import io

import numpy as np
from mesh_grids import lathe, ring
from model_mesh import Model
from PIL import Image
from trimesh.visual.material import PBRMaterial

HAMMER_BLOWS, TILE_SIZE, TILES = 70, 128, (3, 5)  # rows and columns of the map
DEPTH = 1.6  # of the dents' slope: how far the light plays on them
BRASS = (222, 178, 92)


def goblet(rng):
    """Its parts: a shape and its material each."""
    bowl, polished, enamel = Model(), Model(), Model()
    points, faces, uv = lathe(
        [
            (0, 0.0500),
            (0.0100, 0.0506),
            (0.0200, 0.0545),
            (0.0270, 0.0610),
            (0.0310, 0.0700),
            (0.0325, 0.0800),
            (0.0322, 0.0930),
            (0.0305, 0.0930),
            (0.0308, 0.0800),
            (0.0293, 0.0705),
            (0.0255, 0.0622),
            (0.0190, 0.0562),
            (0, 0.0525),
        ],
        64,
    )
    bowl.shell(points, faces, uv, 50)
    points, faces, uv = lathe(
        [
            (0, 0),
            (0.0295, 0),
            (0.0300, 0.0012),
            (0.0285, 0.0028),
            (0.0200, 0.0045),
            (0.0100, 0.0075),
            (0.0060, 0.0125),
            (0.0046, 0.0200),
            (0.0044, 0.0400),
            (0.0060, 0.0470),
            (0.0110, 0.0508),
            (0, 0.0515),
        ],
        48,
    )
    polished.shell(points, faces, uv, 40)
    points, faces = ring(np.array([0.0, 0.0, 0.0]), 0.0313, 0.0013, turns=64, sides=10)
    points = points[:, [0, 2, 1]] + (0, 0.0930, 0)  # lying
    polished.shell(points, faces, np.zeros((len(points), 2)), 90)
    profile = [(0.0095 * np.sin(t), 0.030 - 0.0065 * np.cos(t)) for t in np.linspace(0, np.pi, 17)]
    points, faces, uv = lathe(profile, 40)
    enamel.shell(points, faces, uv, 60)
    brass = {"baseColorFactor": (*BRASS, 255), "metallicFactor": 1.0, "doubleSided": False}
    return {
        "bowl": (
            bowl,
            PBRMaterial(
                name="hammered",
                roughnessFactor=0.25,
                normalTexture=hammered(rng),
                occlusionTexture=shaded_inside(),
                **brass,
            ),
        ),
        "foot": (polished, PBRMaterial(name="polished", roughnessFactor=0.12, **brass)),
        "knot": (
            enamel,
            PBRMaterial(
                name="enamel",
                baseColorFactor=(14, 60, 92, 255),
                metallicFactor=0.0,
                roughnessFactor=0.08,
                doubleSided=False,
            ),
        ),
    }


def hammered(rng):
    """Tiles of round dents side by side, as a normal map (x right, y up)."""
    blows = rng.random((HAMMER_BLOWS, 2))
    y, x = np.mgrid[:TILE_SIZE, :TILE_SIZE] / TILE_SIZE
    offsets = np.stack([x, y], -1)[:, :, None] - blows
    offsets -= np.round(offsets)  # the nearest of the tile's copies
    nearest = np.argmin((offsets**2).sum(-1), axis=2)[..., None, None]
    slope = DEPTH * np.take_along_axis(offsets, nearest, axis=2)[:, :, 0]
    # The surface rises away from a dent's middle; the picture's rows run downwards.
    normal = np.dstack([-slope[..., 0], slope[..., 1], np.ones((TILE_SIZE, TILE_SIZE))])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return encoded(np.tile(np.round(normal * 127 + 128).astype(np.uint8), (*TILES, 1)))


def shaded_inside():
    """What the bowl's own wall keeps away from its inner side, the map's upper half: most of all at the bottom."""
    v = 1 - (np.arange(128) + 0.5) / 128
    share = np.interp(v, [0.52, 0.56, 0.85, 1.0], [1.0, 0.8, 0.4, 0.35])
    return encoded(np.tile(np.round(255 * share).astype(np.uint8)[:, None, None], (1, 8, 3)))


def encoded(rgb):
    content = io.BytesIO()
    Image.fromarray(rgb).save(content, "JPEG", quality=90, subsampling=0)
    return Image.open(content)

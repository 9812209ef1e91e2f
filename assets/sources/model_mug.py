"""Stoneware mug with a handle."""

import math

import numpy as np
from mesh_grids import lathe, tube
from model_mesh import Model
from PIL import Image, ImageFilter


def mug(rng):
    """Stoneware mug, glazed down to an uneven line above the bare foot."""
    profile = [
        (0, 0.002),
        (0.026, 0.002),
        (0.0275, 0),
        (0.0305, 0),
        (0.0325, 0.001),
        (0.0355, 0.0045),
        (0.0378, 0.010),
        (0.0388, 0.018),
        (0.0390, 0.030),
        (0.0387, 0.055),
        (0.0384, 0.080),
        (0.0384, 0.0875),
        (0.0382, 0.0892),
        (0.0374, 0.0902),
        (0.0362, 0.0904),
        (0.0351, 0.0899),
        (0.0346, 0.0885),
        (0.0345, 0.080),
        (0.0348, 0.055),
        (0.0350, 0.030),
        (0.0345, 0.018),
        (0.0325, 0.0095),
        (0.027, 0.0068),
        (0.015, 0.006),
        (0, 0.006),
    ]
    model = Model()
    points, faces, uv = lathe(profile, 72)
    model.shell(points, faces, uv, 50)
    s = np.linspace(0, 1, 33)
    bow = np.array(
        [[0.0365, 0.070], [0.0500, 0.0765], [0.0700, 0.0690], [0.0700, 0.0350], [0.0500, 0.0220], [0.0370, 0.0245]]
    )
    binomial = np.array([math.comb(5, k) for k in range(6)])
    weight = binomial * s[:, None] ** np.arange(6) * (1 - s[:, None]) ** (5 - np.arange(6))
    path = np.column_stack([weight @ bow, 0 * s])
    path[:, 0] += 0.012 * np.sin(math.pi * s) ** 2
    points, faces = tube(path, 0.0062 - 0.0014 * np.sin(math.pi * s), 16, flatten=0.72)
    model.shell(points, faces, np.tile([0.02, 0.42], (len(points), 1)), 60)
    y, x = np.mgrid[:512, :512] / 512
    v, image = 1 - y, np.zeros((512, 512, 3))
    line = (
        0.205
        + 0.012 * np.sin(2 * math.pi * (3 * x + 0.2))
        + 0.008 * np.sin(2 * math.pi * (7 * x + 0.6))
        + 0.005 * np.sin(2 * math.pi * 13 * x)
    )
    clay, glaze, inside = np.array([196, 164, 126.0]), np.array([38, 92, 112.0]), np.array([226, 218, 200.0])
    image[:] = clay
    image[v > line] = glaze
    pool = np.clip((v - line) / 0.05, 0, 1)  # darker where the glaze pools at its lower edge
    image[v > line] *= (0.72 + 0.28 * pool)[v > line][:, None]
    inner = np.clip((v - 0.500) / 0.02, 0, 1)[..., None]
    image = image * (1 - inner) + inside * inner
    specks = (
        np.asarray(
            Image.fromarray((rng.random((512, 512)) > 0.9972).astype(np.uint8) * 255).filter(
                ImageFilter.GaussianBlur(0.8)
            ),
            float,
        )[..., None]
        / 255
    )
    image = image * (1 - 0.9 * specks) + rng.normal(0, 1.2, (512, 512, 1))
    return model, Image.fromarray(np.clip(image, 0, 255).astype(np.uint8)), 0.28

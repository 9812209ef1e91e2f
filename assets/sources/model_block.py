"""Wooden alphabet block: a rounded cube with a painted face on each side."""

import math

import numpy as np
from mesh_grids import grid_faces
from model_mesh import Model
from PIL import Image, ImageDraw, ImageFilter, ImageFont


def block(rng):
    """Alphabet block: a rounded cube, its six faces in a 3 x 2 atlas."""
    half, r, cell = 0.040, 0.0045, 256
    bend = half - r + r * np.tan(np.linspace(0, math.pi / 4, 5))
    line = np.concatenate([-bend[::-1], np.linspace(-half + r, half - r, 5)[1:-1], bend])
    a, b = np.meshgrid(line, line, indexing="ij")
    model, points, faces, uvs = Model(), [], [], []
    # Right and up of the picture on each face, seen from outside: +z, -z, +x, -x, +y, -y.
    for k, (right, up) in enumerate(
        [("+x", "+y"), ("-x", "+y"), ("-z", "+y"), ("+z", "+y"), ("+x", "-z"), ("+x", "+z")]
    ):
        axis = lambda s: (1 if s[0] == "+" else -1) * np.eye(3)["xyz".index(s[1])]  # noqa: E731
        x, y = axis(right), axis(up)
        cube = a[..., None] * x + b[..., None] * y + half * np.cross(x, y)
        inner = np.clip(cube, -half + r, half - r)
        away = cube - inner
        place = inner + r * away / np.linalg.norm(away, axis=-1, keepdims=True)
        faces.append(grid_faces(len(line) - 1, len(line) - 1) + k * len(line) ** 2)
        points.append(place.reshape(-1, 3))
        inset = 0.5 + 0.494 * np.stack([a, b], -1).reshape(-1, 2) / half
        uvs.append((inset + np.array([k % 3, 1 - k // 3])) / [3, 2])
    model.shell(np.concatenate(points), np.concatenate(faces), np.concatenate(uvs), 40)
    atlas = Image.new("RGB", (3 * cell, 2 * cell))
    inks = [(190, 52, 38), (32, 104, 128), (214, 142, 30), (72, 122, 62), (190, 52, 38), (32, 104, 128)]
    for k, (letter, ink) in enumerate(zip("ASHE*L", inks, strict=True)):
        atlas.paste(block_face(letter, ink, cell, rng), (k % 3 * cell, k // 3 * cell))
    return model, atlas, 0.55


def block_face(letter, ink, size, rng):
    """Planed beech with a painted frame and a letter (or a sun)."""
    y, x = np.mgrid[:size, :size] / size
    warp = 0.05 * np.sin(2 * math.pi * (x * rng.uniform(0.4, 0.9) + rng.random())) + 0.02 * np.sin(
        9 * x + 6 * rng.random()
    )
    grain = np.sin(2 * math.pi * (y + warp) * rng.uniform(9, 12) + 2 * np.sin(5 * (y + warp) + 6 * rng.random()))
    fibre = np.repeat(rng.normal(0, 1, (size, size // 32)), 32, axis=1)
    tone = 1 + 0.035 * grain + 0.018 * fibre
    wood = Image.fromarray(np.clip(np.array([222, 182, 130]) * tone[..., None], 0, 255).astype(np.uint8))
    big = 4 * size
    mask = Image.new("L", (big, big))
    draw = ImageDraw.Draw(mask)
    draw.rounded_rectangle(
        [0.09 * big, 0.09 * big, 0.91 * big, 0.91 * big], 0.07 * big, outline=255, width=int(0.045 * big)
    )
    if letter == "*":
        c = big / 2
        draw.ellipse([c - 0.13 * big, c - 0.13 * big, c + 0.13 * big, c + 0.13 * big], fill=255)
        for k in range(12):
            s, d = math.sin(k * math.pi / 6), math.cos(k * math.pi / 6)
            draw.line(
                [c + 0.18 * big * s, c + 0.18 * big * d, c + 0.28 * big * s, c + 0.28 * big * d], 255, int(0.035 * big)
            )
    else:
        font = ImageFont.load_default(size=0.78 * big)
        draw.text((big / 2, big / 2), letter, 255, font, anchor="mm", stroke_width=int(0.022 * big), stroke_fill=255)
    mask = mask.resize((size, size), Image.LANCZOS).point(lambda v: int(0.93 * v))
    return Image.composite(Image.new("RGB", (size, size), ink), wood, mask).filter(ImageFilter.GaussianBlur(0.4))

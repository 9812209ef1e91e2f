"""Shaders of the grounds (Blender). The families of `families.GROUNDS` and, for the sealed set, of `HELD_OUT`."""

import math
from typing import Any

from scenes.tracing.nodes import Nodes, material

Params = dict[str, Any]


def ground_material(spec: Params) -> Any:
    """A level ground in its own coordinates (metres), turned and shifted by the specification."""
    made, n = material("ground")
    turn = (0.0, 0.0, math.radians(spec["yaw_deg"]))
    where = n("ShaderNodeMapping", n("ShaderNodeTexCoord", output=3), (*spec["offset"], 0.0), turn)
    colour, height, depth_m = BUILDERS[spec["family"]](n, where, spec)
    broad = n.noise(where, 3.0 / spec["scale"], 2.0)
    dirt = n.ramp(n.noise(where, 9.0, 3.0), 0.5, 0.75, 0.0, 0.5 * spec["dirt"])
    colour = n.mix(n.ramp(broad, 0.25, 0.75, 0.0, 0.22), colour, [0.7 * c for c in spec["colour"]])
    colour = n.mix(dirt, colour, [0.45 * c for c in spec["colour"]])
    if spec["moss"]:
        low = n.ramp(height, 0.2, 0.6, 1.0, 0.15)
        spread = n.ramp(n.noise(where, 14.0, 4.0), 0.62 - 0.2 * spec["moss"], 0.74 - 0.2 * spec["moss"])
        colour = n.mix(n.math("MULTIPLY", low, spread), colour, (0.06, 0.09, 0.025))
    bump = n("ShaderNodeBump", _Height=height, _Strength=0.8 * spec["relief"], _Distance=depth_m) if depth_m else None
    n.principled(
        colour, n.ramp(broad, 0.2, 0.8, 0.9 * spec["gloss"], 1.1 * spec["gloss"]), _Normal=bump, _Specular_IOR_Level=0.4
    )
    return made


def _mul(n: Nodes, where: Any, x: float, y: float) -> Any:
    return n("ShaderNodeVectorMath", where, (x, y, 1.0), operation="MULTIPLY")


def _grain(n: Nodes, where: Any, spec: Params, scale: float, low: float = 0.55, detail: float = 3.0) -> tuple[Any, Any]:
    """The ground's colour with a grain, and the grain."""
    grain = n.noise(where, scale / spec["scale"], detail)
    return n.mix(
        n.ramp(grain, 0.3, 0.72, 0.0, spec["contrast"]), spec["colour"], [low * c for c in spec["colour"]]
    ), grain


def _plain(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    colour, grain = _grain(n, where, spec, 220.0, 0.88)
    return colour, grain, 0.0


def _wood(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    width = 0.12 * spec["scale"]
    split = n("ShaderNodeSeparateXYZ", where)
    y = split.node.outputs[1]
    across = n.math("DIVIDE", y, width)
    board = n.math("FLOOR", across)
    random = n("ShaderNodeTexWhiteNoise", None, board, noise_dimensions="1D")
    shifted = n("ShaderNodeCombineXYZ", n.math("ADD", split, n.math("MULTIPLY", random, 9.0)), y, board)
    figure = n.noise(_mul(n, shifted, 1.1, 9.0), 1.6, 3.0)
    rings = n.math("SINE", n.math("MULTIPLY", figure, 62.0))
    fibre = n.noise(_mul(n, shifted, 9.0, 330.0), 1.0, 1.5)
    colour = n.mix(
        n.ramp(rings, -0.2, 1.0, 0.0, 0.45 * spec["contrast"]), spec["colour"], [0.6 * c for c in spec["colour"]]
    )
    colour = n.mix(n.ramp(fibre, 0.3, 0.7, 0.0, 0.35 * spec["contrast"]), colour, [0.55 * c for c in spec["colour"]])
    colour = n("ShaderNodeHueSaturation", _Value=n.ramp(random, 0.0, 1.0, 0.82, 1.15), _Color=colour)
    edge = n.math("ABSOLUTE", n.math("SUBTRACT", n.math("FRACT", across), 0.5))
    groove = n.ramp(edge, 0.5 - 0.0016 / width, 0.5 - 0.0006 / width)
    height = n.math("SUBTRACT", n.math("MULTIPLY", fibre, 0.2), groove)
    return n.mix(n.math("MULTIPLY", groove, 0.8), colour, [0.1 * c for c in spec["colour"]]), height, 0.0012


def _worn_wood(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    colour, height, _ = _wood(n, where, spec)
    cracks = n.ramp(n.noise(_mul(n, where, 3.0, 120.0), 1.0, 2.0), 0.60, 0.66)
    knots = n.ramp(n("ShaderNodeTexVoronoi", _Vector=_mul(n, where, 1.0, 2.2), _Scale=6.0), 0.05, 0.12, 1.0, 0.0)
    colour = n.mix(
        n.math("MULTIPLY", n.math("MAXIMUM", cracks, knots), 0.75), colour, [0.2 * c for c in spec["colour"]]
    )
    return colour, n.math("SUBTRACT", height, cracks), 0.0016


def _concrete(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    colour, _ = _grain(n, where, spec, 25.0, 0.75)
    fine = n.noise(where, 500.0, 2.0)
    pits = n.ramp(n("ShaderNodeTexVoronoi", _Vector=where, _Scale=110.0), 0.10, 0.2, 1.0, 0.0)
    some = n.math("MULTIPLY", pits, n.ramp(n.noise(where, 30.0), 0.5, 0.6))
    colour = n.mix(n.ramp(fine, 0.3, 0.7, 0.0, 0.3), colour, [0.6 * c for c in spec["colour"]])
    return (
        n.mix(n.math("MULTIPLY", some, 0.6), colour, [0.4 * c for c in spec["colour"]]),
        n.math("SUBTRACT", fine, some),
        0.001,
    )


def _cracked_concrete(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    colour, _ = _grain(n, where, spec, 60.0, 0.65)
    shift = n("ShaderNodeTexNoise", _Vector=where, _Scale=18.0, _Detail=2.0, output=1)
    shift = n("ShaderNodeVectorMath", shift, (0.06, 0.06, 0.0), operation="MULTIPLY")
    bent = n("ShaderNodeVectorMath", where, shift, operation="ADD")
    edges = n("ShaderNodeTexVoronoi", _Vector=bent, _Scale=4.5 / spec["scale"], feature="DISTANCE_TO_EDGE")
    crack = n.ramp(edges, 0.004, 0.016, 1.0, 0.0)
    return (
        n.mix(n.math("MULTIPLY", crack, 0.85), colour, [0.15 * c for c in spec["colour"]]),
        n.math("SUBTRACT", 0.8, crack),
        0.0,
    )


def _cells(n: Nodes, where: Any, wide: float, high: float, joint: float, offset: float) -> tuple[Any, Any]:
    """Joint (1 in it) and a random value for each brick or tile."""
    brick = n.tree.nodes.new("ShaderNodeTexBrick")
    n.tree.links.new(where, brick.inputs["Vector"])
    brick.offset = offset
    sizes = {"Scale": 1.0, "Mortar Size": joint, "Mortar Smooth": 0.3, "Brick Width": wide, "Row Height": high}
    tones = {"Color1": (0, 0, 0, 1), "Color2": (1, 1, 1, 1), "Mortar": (0.5, 0.5, 0.5, 1)}
    for name, value in (sizes | tones).items():
        brick.inputs[name].default_value = value
    return brick.outputs["Fac"], brick.outputs["Color"]


def _tiles(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    side = 0.13 * spec["scale"]
    joint, random = _cells(n, where, side, side, 0.0025, 0.0)
    colour, _ = _grain(n, where, spec, 60.0, 0.85)
    colour = n.mix(n.math("MULTIPLY", random, 0.25), colour, [0.75 * c for c in spec["colour"]])
    wavy = n.math("MULTIPLY", n.noise(where, 22.0, 2.0), 0.25)
    return n.mix(n.math("MULTIPLY", joint, 0.8), colour, spec["second"]), n.math("SUBTRACT", wavy, joint), 0.002


def _terracotta(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    """Large tiles with a slate-like relief and dirty joints."""
    side = 0.3 * spec["scale"]
    joint, random = _cells(n, where, side, side, 0.007, 0.0)
    colour, _ = _grain(n, where, spec, 35.0, 0.7)
    bent = n("ShaderNodeTexNoise", _Vector=where, _Scale=7.0, _Detail=3.0, _Distortion=1.5)
    ridge = n.ramp(n.math("ABSOLUTE", n.math("SUBTRACT", bent, 0.5)), 0.0, 0.03, 1.0, 0.0)
    colour = n.mix(n.math("MULTIPLY", ridge, 0.3), colour, [0.55 * c for c in spec["colour"]])
    colour = n.mix(n.math("MULTIPLY", random, 0.2), colour, [0.8 * c for c in spec["colour"]])
    height = n.math("SUBTRACT", n.math("MULTIPLY", bent, 1.2), n.math("MULTIPLY", joint, 1.2))
    return n.mix(n.math("MULTIPLY", joint, 0.75), colour, [0.35 * c + 0.05 for c in spec["colour"]]), height, 0.004


def _brick(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    joint, random = _cells(n, where, 0.19 * spec["scale"], 0.085 * spec["scale"], 0.006, 0.5)
    colour, grain = _grain(n, where, spec, 140.0, 0.55)
    colour = n.mix(n.math("MULTIPLY", random, 0.45), colour, [0.6 * c for c in spec["colour"]])
    mortar = (0.12, 0.105, 0.09) if spec["contrast"] > 0.6 else (0.4, 0.38, 0.34)
    return n.mix(joint, colour, mortar), n.math("SUBTRACT", n.math("MULTIPLY", grain, 0.5), joint), 0.005


def _cloth(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    weave = n("ShaderNodeTexChecker", where, (1, 1, 1), (0, 0, 0), 700.0)
    fleck = n.noise(_mul(n, where, 1.0, 2.5), 130.0, 2.5)
    colour = n.mix(
        n.ramp(fleck, 0.35, 0.65, 0.0, 0.5 * spec["contrast"]), spec["colour"], [0.6 * c for c in spec["colour"]]
    )
    folds = n("ShaderNodeTexNoise", _Vector=_mul(n, where, 1.0, 0.35), _Scale=5.0, _Detail=2.0, _Distortion=0.6)
    crease = n.ramp(n.math("ABSOLUTE", n.math("SUBTRACT", folds, 0.5)), 0.0, 0.05)
    height = n.math("ADD", n.math("MULTIPLY", crease, 0.4), n.math("MULTIPLY", weave, 0.03))
    return n.mix(0.08, colour, weave), n.math("ADD", height, n.math("MULTIPLY", folds, 2.5)), 0.008


def _relief(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    """An embossed table cloth: scrolls in low relief, slightly shiny."""
    bent = n("ShaderNodeTexNoise", _Vector=where, _Scale=24.0 / spec["scale"], _Detail=2.0, _Distortion=3.5)
    scroll = n.ramp(n.math("ABSOLUTE", n.math("SUBTRACT", bent, 0.5)), 0.02, 0.09)
    fine = n("ShaderNodeTexNoise", _Vector=where, _Scale=300.0, _Detail=2.0, _Distortion=2.0)
    colour = n.mix(
        n.math("MULTIPLY", scroll, 0.3 * spec["contrast"]), spec["colour"], [0.6 * c for c in spec["colour"]]
    )
    return colour, n.math("ADD", scroll, n.math("MULTIPLY", fine, 0.35)), 0.0025


def _print(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    blobs = n("ShaderNodeTexVoronoi", _Vector=where, _Scale=22.0 / spec["scale"])
    ink = n.ramp(blobs, 0.34, 0.36, spec["contrast"], 0.0)
    return n.mix(ink, spec["colour"], spec["second"]), n.noise(where, 400.0), 0.0


def _stripes(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    x = n("ShaderNodeSeparateXYZ", where)
    wave = n.math("SINE", n.math("MULTIPLY", x, 130.0 / spec["scale"]))
    colour = n.mix(n.ramp(wave, -0.1, 0.1, 0.0, spec["contrast"]), spec["colour"], spec["second"])
    return colour, n.noise(where, 400.0), 0.0


def _stone(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    """Split slabs: a striated, uneven surface and wide joints."""
    joint, _ = _cells(n, where, 0.55 * spec["scale"], 0.38 * spec["scale"], 0.006, 0.4)
    layers = n("ShaderNodeTexNoise", _Vector=_mul(n, where, 1.0, 3.0), _Scale=22.0, _Detail=3.5, _Distortion=0.8)
    colour, _ = _grain(n, where, spec, 18.0, 0.7)
    colour = n.mix(n.ramp(layers, 0.4, 0.65, 0.0, 0.4), colour, [0.7 * c for c in spec["colour"]])
    return n.mix(joint, colour, (0.05, 0.045, 0.04)), n.math("SUBTRACT", layers, joint), 0.006


def _gravel(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    stones = n("ShaderNodeTexVoronoi", _Vector=where, _Scale=120.0 / spec["scale"], feature="DISTANCE_TO_EDGE")
    random = n("ShaderNodeTexVoronoi", _Vector=where, _Scale=120.0 / spec["scale"], output=1)
    tone = n.mix(
        spec["contrast"], spec["colour"], n("ShaderNodeHueSaturation", _Saturation=0.25, _Value=0.7, _Color=random)
    )
    return n.mix(n.ramp(stones, 0.0, 0.12, 0.8, 0.0), tone, (0.03, 0.028, 0.025)), n.ramp(stones, 0.0, 0.3), 0.003


def _herringbone(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    """Parquet of short staves whose direction changes from field to field."""
    field = n("ShaderNodeTexChecker", where, (1, 1, 1), (0, 0, 0), 3.6 / spec["scale"])
    turned = n("ShaderNodeMapping", where, None, (0.0, 0.0, math.pi / 2))
    both = n.mix(field, where, turned)
    joint, random = _cells(n, both, 0.28 * spec["scale"], 0.046 * spec["scale"], 0.0012, 0.5)
    fibre = n.noise(_mul(n, both, 6.0, 150.0), 1.0, 3.0)
    colour = n.mix(n.ramp(fibre, 0.3, 0.7, 0.0, 0.4), spec["colour"], [0.6 * c for c in spec["colour"]])
    colour = n.mix(n.math("MULTIPLY", random, 0.5), colour, [0.6 * c for c in spec["colour"]])
    return n.mix(joint, colour, [0.15 * c for c in spec["colour"]]), n.math("SUBTRACT", fibre, joint), 0.0008


def _leaf_print(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    bent = n("ShaderNodeTexNoise", _Vector=where, _Scale=14.0 / spec["scale"], _Detail=0.0, _Distortion=1.2)
    leaves = n.ramp(n.math("SINE", n.math("MULTIPLY", bent, 26.0)), 0.3, 0.36, 0.0, spec["contrast"])
    return n.mix(leaves, spec["colour"], spec["second"]), n.noise(where, 500.0), 0.0


def _asphalt(n: Nodes, where: Any, spec: Params) -> tuple[Any, Any, float]:
    stones = n("ShaderNodeTexVoronoi", _Vector=where, _Scale=260.0)
    random = n("ShaderNodeTexVoronoi", _Vector=where, _Scale=260.0, output=1)
    light = n.ramp(n("ShaderNodeSeparateXYZ", random), 0.55, 0.95, 0.0, 0.7 * spec["contrast"])
    return (
        n.mix(light, spec["colour"], [min(2.6 * c, 0.5) for c in spec["colour"]]),
        n.ramp(stones, 0.0, 0.5, 1.0, 0.0),
        0.0025,
    )


BUILDERS = {
    "plain": _plain, "wood": _wood, "worn_wood": _worn_wood, "concrete": _concrete,
    "cracked_concrete": _cracked_concrete,
    "tiles": _tiles, "terracotta": _terracotta, "brick": _brick, "cloth": _cloth, "relief": _relief, "print": _print,
    "stripes": _stripes, "stone": _stone, "gravel": _gravel, "herringbone": _herringbone, "leaf_print": _leaf_print,
    "asphalt": _asphalt,
}  # fmt: skip

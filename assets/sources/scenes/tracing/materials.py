"""Shaders of objects, of the marker's sheet and of flat marks (Blender)."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from scenes.tracing.nodes import Nodes, material

Params = dict[str, Any]


def object_materials(spec: Params) -> list[Any]:
    """The four slots that shapes name: the material, its second colour, dark holes, leaves."""
    first = SHADERS[spec["family"]](spec, spec["colour"])
    other = SHADERS["matte" if spec["family"] in ("printed", "speckled") else spec["family"]](spec, spec["second"])
    dark, n = material("dark")
    n.principled((0.012, 0.011, 0.01), 0.6)
    leaf, n = material("leaf")
    base = n("ShaderNodeBsdfPrincipled", _Base_Color=(0.07, 0.17, 0.035), _Roughness=0.5)
    n(
        "ShaderNodeOutputMaterial",
        n("ShaderNodeMixShader", 0.3, base, n("ShaderNodeBsdfTranslucent", (0.10, 0.26, 0.03))),
    )
    return [first, other, dark, leaf]


def _where(n: Nodes, spec: Params) -> Any:
    return n("ShaderNodeMapping", n("ShaderNodeTexCoord", output=3), (spec["seed"], 2 * spec["seed"], 0.0))


def _plain(spec: Params, colour: Any, **more: Any) -> Any:
    made, n = material("plain")
    grain = n.noise(_where(n, spec), 3 * spec["scale"], 3.0)
    tone = n.mix(n.ramp(grain, 0.3, 0.7, 0.0, 0.18), colour, [0.75 * c for c in colour])
    n.principled(tone, spec["roughness"], **more)
    return made


def _matte(spec: Params, colour: Any) -> Any:
    return _plain(spec, colour, _Specular_IOR_Level=0.25)


def _plastic(spec: Params, colour: Any) -> Any:
    made, n = material("plastic")
    n.principled(colour, spec["roughness"])
    return made


def _porcelain(_spec: Params, colour: Any) -> Any:
    made, n = material("porcelain")
    n.principled(colour, 0.35, _Coat_Weight=0.9, _Coat_Roughness=0.06)
    return made


def _translucent(spec: Params, colour: Any) -> Any:
    """Light falls through: paper, thin plastic."""
    made, n = material("thin")
    base = n("ShaderNodeBsdfPrincipled", _Base_Color=colour, _Roughness=spec["roughness"])
    through = n("ShaderNodeBsdfTranslucent", [min(1.05 * c, 0.95) for c in colour])
    n("ShaderNodeOutputMaterial", n("ShaderNodeMixShader", spec["translucent"], base, through))
    return made


def _speckled(spec: Params, colour: Any) -> Any:
    made, n = material("speckled")
    cells = n("ShaderNodeTexVoronoi", _Vector=_where(n, spec), _Scale=8 * spec["scale"])
    random = n(
        "ShaderNodeSeparateXYZ", n("ShaderNodeTexVoronoi", _Vector=_where(n, spec), _Scale=8 * spec["scale"], output=1)
    )
    spots = n.math("MULTIPLY", n.ramp(cells, 0.22, 0.3, 1.0, 0.0), n.ramp(random, 0.6, 0.7))
    n.principled(n.mix(spots, colour, [0.3 * c for c in colour]), spec["roughness"], _Specular_IOR_Level=0.3)
    return made


def _metal(spec: Params, colour: Any) -> Any:
    made, n = material("metal")
    n.principled([0.45 + 0.4 * c for c in colour], spec["roughness"], _Metallic=1.0)
    return made


def _fabric(spec: Params, colour: Any) -> Any:
    made, n = material("fabric")
    where = _where(n, spec)
    weave = n("ShaderNodeTexChecker", where, colour, [0.7 * c for c in colour], 14 * spec["scale"])
    bump = n("ShaderNodeBump", _Height=n.noise(where, 6 * spec["scale"]), _Strength=0.6, _Distance=0.002)
    n.principled(weave, 0.95, _Normal=bump, _Specular_IOR_Level=0.1)
    return made


def _printed(spec: Params, colour: Any) -> Any:
    made, n = material("printed")
    where, second, pattern = _where(n, spec), spec["second"], spec["pattern"]
    if pattern == "checks":
        ink = n("ShaderNodeTexChecker", where, (1, 1, 1), (0, 0, 0), spec["scale"] * 0.8)
    elif pattern == "dots":
        ink = n.ramp(n("ShaderNodeTexVoronoi", _Vector=where, _Scale=spec["scale"]), 0.3, 0.33, 1.0, 0.0)
    else:
        z = n("ShaderNodeSeparateXYZ", n("ShaderNodeTexCoord", output=3)).node.outputs[2]
        if pattern == "bands":
            ink = n.ramp(n.math("SINE", n.math("MULTIPLY", z, 4 * spec["scale"])), 0.05, 0.15)
        else:
            blot = n.ramp(n.noise(where, 0.6 * spec["scale"], 1.0), 0.5, 0.52)
            ink = n.math(
                "MULTIPLY", blot, n.ramp(n.math("ABSOLUTE", n.math("SUBTRACT", z, 0.045)), 0.018, 0.019, 1.0, 0.0)
            )
    n.principled(n.mix(ink, colour, second), spec["roughness"])
    return made


def _painted_wood(spec: Params, colour: Any) -> Any:
    made, n = material("painted wood")
    stretched = n("ShaderNodeVectorMath", _where(n, spec), (1.0, 1.0, 0.08), operation="MULTIPLY")
    grain = n.ramp(n.noise(stretched, 5 * spec["scale"], 3.0), 0.35, 0.65, 0.0, 0.4)
    n.principled(n.mix(grain, colour, [0.5 * c for c in colour]), 0.55)
    return made


SHADERS = {
    "matte": _matte, "plastic": _plastic, "porcelain": _porcelain, "paper": _translucent, "thin_plastic": _translucent,
    "speckled": _speckled, "metal": _metal, "fabric": _fabric, "printed": _printed, "ground_coloured": _matte,
    "painted_wood": _painted_wood,
}  # fmt: skip


def sheet_material(sheet: Params) -> Any:
    """The printed paper: uv from 0 to 1 over the sheet, the picture's upper edge at +y."""
    cells = np.array(sheet["cells"], float)
    each = 480 // len(cells)
    square = np.kron(cells, np.ones((each, each)))
    margin = round(len(square) * (sheet["paper_side_m"] / sheet["side_m"] - 1) / 2)
    reflectance = np.full((len(square) + 2 * margin,) * 2, sheet["paper"])
    inner = slice(margin, margin + len(square))
    reflectance[inner, inner] = sheet["ink"] + (sheet["paper"] - sheet["ink"]) * square
    total = len(reflectance)
    image = bpy.data.images.new("sheet", total, total, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    rgba = np.dstack([reflectance, reflectance * 0.992, reflectance * 0.965, np.ones_like(reflectance)])
    image.pixels.foreach_set(rgba[::-1].astype(np.float32).ravel())  # Blender's rows run upwards
    image.pack()
    made, n = material("sheet")
    n.principled(n("ShaderNodeTexImage", image=image, extension="EXTEND"), 0.65, _Specular_IOR_Level=0.25)
    return made


def cube_paper(spec: Params, net: Path) -> Any:
    """Printed paper of the cube: of the light on its white, `colour` is sent back, and `through` goes through.

    Toner lies outside: what it lets pass of light that comes from within passes it once, what is sent back twice.
    """
    image = bpy.data.images.load(str(net))
    image.colorspace_settings.name = "Non-Color"
    made, n = material("cube paper")
    print_ = n("ShaderNodeTexImage", image=image, extension="EXTEND", interpolation="Cubic")
    white, share = np.array(spec["colour"]), spec["through"]
    least = spec["ink"] / float(white.mean())
    # Each shader's colour is over the share of the light that the mix gives to it.
    sent = n.mix(print_, [float(v) for v in least * white / (1 - share)], [float(v) for v in white / (1 - share)])
    let = n.mix(print_, (least**0.5,) * 3, (1.0, 1.0, 0.97))
    back = n("ShaderNodeBsdfPrincipled", _Base_Color=sent, _Roughness=spec["roughness"], _Specular_IOR_Level=0.25)
    n("ShaderNodeOutputMaterial", n("ShaderNodeMixShader", share, back, n("ShaderNodeBsdfTranslucent", let)))
    return made


def mark_material(patch: Params) -> Any:
    """A flat mark: opaque, or a stain that multiplies what is below it and fades out along its border."""
    made, n = material("mark")
    if patch["opaque"]:
        if patch["kind"] == "print":
            checks = n(
                "ShaderNodeTexChecker", n("ShaderNodeTexCoord", output=3), patch["colour"], (0.6, 0.58, 0.55), 90.0
            )
            n.principled(checks, 0.6)
        else:
            n.principled(patch["colour"], 0.6, _Specular_IOR_Level=0.25)
        return made
    fade = n("ShaderNodeAttribute", attribute_name="fade", output=2)
    clear = n("ShaderNodeBsdfTransparent", n.mix(fade, (1, 1, 1), [float(np.sqrt(c)) for c in patch["colour"]]))
    if patch["gloss"]:
        shine = n("ShaderNodeBsdfGlossy", (1, 1, 1), patch["gloss"])
        clear = n("ShaderNodeMixShader", n.math("MULTIPLY", fade, 0.04), clear, shine)
    n("ShaderNodeOutputMaterial", clear)
    return made

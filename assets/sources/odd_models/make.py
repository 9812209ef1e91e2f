"""Models of many features as Blender writes them, each with its true triangles, for compare.py.

    python make.py DIR [--first 0] [--count 400]        needs bpy (the extra `scenes`)

Seeded by their numbers; others are made from --first on. What leaves the truth open is left out: an exporter that
applies modifiers drops shape keys, so that a model has one or the other.
"""

import argparse
import math
import random
from pathlib import Path

import bpy
import numpy as np

FORMATS = ("glb", "glb", "glb", "gltf", "obj", "obj", "ply", "stl")
MODIFIERS = ("SOLIDIFY", "ARRAY", "SUBSURF", "WIREFRAME", "MIRROR", "BEVEL", "SCREW", "DECIMATE", "TRIANGULATE")
MOST_POLYGONS, MOST_TRIANGLES = 3000, 40_000
FAR_M = 5e4  # as models at a map's coordinates


def shape(chance: random.Random) -> bpy.types.Object:
    place = {
        "location": (chance.uniform(-1, 1), chance.uniform(-1, 1), chance.uniform(-0.5, 2)),
        "rotation": [chance.uniform(0, math.tau) for _ in range(3)],
    }
    mesh = bpy.ops.mesh
    match chance.randrange(10):
        case 0:
            mesh.primitive_monkey_add(**place)
        case 1:
            mesh.primitive_torus_add(**place)
        case 2:
            mesh.primitive_cube_add(**place)
        case 3:
            mesh.primitive_cone_add(**place, vertices=chance.choice([3, 5, 32]))
        case 4:
            mesh.primitive_ico_sphere_add(**place, subdivisions=chance.randint(1, 3))
        case 5:
            mesh.primitive_grid_add(**place, x_subdivisions=8, y_subdivisions=8)
        case 6:
            mesh.primitive_cylinder_add(**place, end_fill_type=chance.choice(["NGON", "TRIFAN", "NOTHING"]))
        case 7:
            bpy.ops.object.text_add(**place)
            bpy.context.object.data.body, bpy.context.object.data.extrude = chance.choice(["R8&", "Qg", "%B"]), 0.1
        case 8:
            bpy.ops.curve.primitive_bezier_circle_add(**place)
            bpy.context.object.data.bevel_depth = 0.15
        case 9:
            bpy.ops.object.metaball_add(type=chance.choice(["BALL", "ELLIPSOID"]), **place)
    if bpy.context.object.type != "MESH":
        bpy.ops.object.convert(target="MESH")
    return bpy.context.object


def paint(thing: bpy.types.Object, chance: random.Random, name: str) -> None:
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = nodes["Principled BSDF"].inputs
    surface["Base Color"].default_value = [*(chance.random() for _ in range(3)), 1]
    surface["Roughness"].default_value = chance.random()
    kind = chance.choice(["plain", "picture", "vertices", "metal", "coat"])
    if kind == "picture":
        picture = nodes.new("ShaderNodeTexImage")
        picture.image = bpy.data.images.new(name, *chance.choice([(16, 16), (32, 8), (7, 13)]))
        texels = np.random.default_rng(len(picture.image.pixels)).random(len(picture.image.pixels))
        texels[3::4] = 1
        picture.image.pixels.foreach_set(texels.astype(np.float32))
        picture.image.pack()
        links.new(picture.outputs[0], surface["Base Color"])
    elif kind == "vertices":
        for each in thing.data.color_attributes.new("Col", "BYTE_COLOR", chance.choice(["POINT", "CORNER"])).data:
            each.color = (chance.random(), chance.random(), chance.random(), 1)
        colours = nodes.new("ShaderNodeVertexColor")
        colours.layer_name = "Col"
        links.new(colours.outputs[0], surface["Base Color"])
    elif kind == "metal":
        surface["Metallic"].default_value = 1
    elif kind == "coat":
        surface["Coat Weight"].default_value = 0.8
    thing.data.materials.append(material)


def modify(thing: bpy.types.Object, chance: random.Random) -> None:
    for _ in range(chance.choice([0, 1, 1, 2])):
        kind = chance.choice(MODIFIERS)
        if len(thing.data.polygons) > MOST_POLYGONS or (kind == "SCREW" and len(thing.data.vertices) > 100):
            continue
        modifier = thing.modifiers.new(kind, kind)
        if kind == "SUBSURF":
            modifier.levels = modifier.render_levels = 1
        elif kind == "SCREW":
            modifier.steps = modifier.render_steps = 8


def deform(thing: bpy.types.Object, chance: random.Random) -> None:
    # First triangles, as a quad that is bent afterwards may be cut along either diagonal.
    bpy.ops.object.modifier_apply(modifier=thing.modifiers.new("first", "TRIANGULATE").name)
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="other")
    for corner in key.data:
        corner.co *= chance.uniform(0.8, 1.5)
    key.value = chance.random()


def move(thing: bpy.types.Object) -> None:
    thing.keyframe_insert("location", frame=1)
    thing.location.x += 1
    thing.keyframe_insert("location", frame=20)


def truth() -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 3) and triangles (m, 3) of all that is there, as Blender draws it."""
    places, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), int)], 0
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if instance.object.type == "MESH":
            mesh = instance.object.to_mesh()
            mesh.calc_loop_triangles()
            places.append(np.array([instance.matrix_world @ vertex.co for vertex in mesh.vertices]).reshape(-1, 3))
            triangles.append(np.array([each.vertices[:] for each in mesh.loop_triangles], int).reshape(-1, 3) + count)
            count += len(mesh.vertices)
            instance.object.to_mesh_clear()
    return np.vstack(places), np.vstack(triangles)


def export(path: Path, up: str, chance: random.Random, has_keys: bool) -> None:
    forward, is_text = ("NEGATIVE_Z" if up == "y" else "Y"), chance.random() < 0.5
    axes = {"up_axis": up.upper(), "forward_axis": forward}
    match path.suffix:
        case ".obj":
            bpy.ops.wm.obj_export(filepath=str(path), export_colors=is_text, **axes)
        case ".ply":
            bpy.ops.wm.ply_export(filepath=str(path), ascii_format=is_text, **axes)
        case ".stl":
            bpy.ops.wm.stl_export(filepath=str(path), ascii_format=is_text, **axes)
        case suffix:
            kind = "GLB" if suffix == ".glb" else "GLTF_SEPARATE"
            bpy.ops.export_scene.gltf(filepath=str(path), export_format=kind, export_apply=not has_keys)


def build(number: int) -> tuple[random.Random, bool]:
    """The model of that number alone in Blender's scene; what chance has left, and whether it has shape keys."""
    chance = random.Random(number)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things: list[bpy.types.Object] = []
    has_keys = chance.random() < 0.2
    for _ in range(chance.choice([1, 1, 2, 3])):
        thing = shape(chance)
        if chance.random() < 0.3:
            thing.scale = (
                chance.uniform(0.3, 2),
                chance.uniform(0.3, 2),
                chance.choice([1, -1]) * chance.uniform(0.3, 2),
            )
        if things and chance.random() < 0.4:
            thing.parent = chance.choice(things)
        paint(thing, chance, f"picture{number}-{len(things)}")
        (deform if has_keys else modify)(thing, chance)
        for polygon in thing.data.polygons:
            polygon.use_smooth = number % 2 == 0
        if chance.random() < 0.15:
            move(thing)
        things.append(thing)
    if chance.random() < 0.1 and not any(thing.animation_data for thing in things):
        for thing in things:
            thing.location.x += 0 if thing.parent else FAR_M
    bpy.context.scene.frame_set(1)
    bpy.context.view_layer.update()
    return chance, has_keys


def make(number: int, folder: Path) -> None:
    chance, has_keys = build(number)
    places, triangles = truth()
    if not 0 < len(triangles) <= MOST_TRIANGLES:
        return
    suffix = chance.choice(FORMATS)
    up = chance.choice("yz") if suffix == "obj" else "z" if suffix in ("ply", "stl") else "y"
    export(folder / f"{number:03}.{suffix}", up, chance, has_keys)
    np.savez_compressed(folder / f"{number:03}.npz", places=places, triangles=triangles, up=up)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=400)
    options = parser.parse_args()
    options.folder.mkdir(parents=True)
    for each in range(options.first, options.first + options.count):
        make(each, options.folder)

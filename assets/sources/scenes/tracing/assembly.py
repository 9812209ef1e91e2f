"""Builds a specified scene in Blender: objects, sheet, marks, ground, lights in groups of their own, surroundings."""

import math
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np
from mathutils import Matrix
from mesh_grids import grid_faces

from scenes.geometry import surroundings
from scenes.geometry.index import BEYOND, GROUND, ROLES, SHEET
from scenes.geometry.paper_cube import NET, sheets
from scenes.geometry.poses import direction
from scenes.geometry.shapes import Part, built
from scenes.tracing.grounds import ground_material
from scenes.tracing.materials import cube_paper, mark_material, object_materials, sheet_material
from scenes.tracing.nodes import material, mesh_object

Params = dict[str, Any]
MARK_LIFT_M = 0.00006
SHARP_DEG = 38.0
CUBE = "cube"  # where other markers have their dictionary


def clear() -> None:
    """Removes what the last scene left."""
    for kept in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.images, bpy.data.lights,
                 bpy.data.worlds, bpy.data.cameras):  # fmt: skip
        for each in list(kept):
            kept.remove(each)


def assemble(scene: Params, folder: Path) -> list[Any]:
    """Fills Blender's scene; the objects of `scene["objects"]`, a list of Blender's for each. folder: the set's."""
    ground_z = scene["ground"]["z_m"]
    _ground(scene["ground"], ground_z)
    is_cube = scene["marker"]["dictionary"] == CUBE
    if not is_cube:
        _sheet(scene["marker"], ground_z)
    bpy.context.scene.cycles.max_bounces, bpy.context.scene.cycles.diffuse_bounces = (8, 4) if is_cube else (4, 2)
    for number, patch in enumerate(scene["patches"]):
        _mark(patch, ground_z + (number + 1) * MARK_LIFT_M)
    made = [_thing(spec, ground_z, folder) for spec in scene["objects"]]
    _surroundings(scene["surroundings"])
    for number, light in enumerate(scene["lights"]):
        _light(light, f"light{number}")
    _camera(scene["camera"])
    return made


def _merged(name: str, parts: list[Part], materials: list[Any], bevel_m: float) -> Any:
    offsets = np.cumsum([0, *(len(part.points) for part in parts)])
    points = np.concatenate([part.points for part in parts])
    faces = np.concatenate([part.faces + offset for part, offset in zip(parts, offsets, strict=False)])
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.loops.add(3 * len(faces))
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    for each in materials:
        mesh.materials.append(each)
    mesh.polygons.foreach_set(
        "material_index", np.repeat([p.slot for p in parts], [len(p.faces) for p in parts]).astype(np.int32)
    )
    mesh.polygons.foreach_set("use_smooth", np.repeat([p.smooth for p in parts], [len(p.faces) for p in parts]))
    mesh.update(calc_edges=True)
    tidy = bmesh.new()  # closes the seam of bodies of revolution, and drops triangles without an area
    tidy.from_mesh(mesh)
    bmesh.ops.remove_doubles(tidy, verts=tidy.verts, dist=1e-6)
    bmesh.ops.dissolve_degenerate(tidy, edges=tidy.edges, dist=1e-7)
    tidy.to_mesh(mesh)
    tidy.free()
    mesh.set_sharp_from_angle(angle=math.radians(SHARP_DEG))
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    if bevel_m:
        rounded = obj.modifiers.new("bevel", "BEVEL")
        rounded.width, rounded.segments, rounded.limit_method, rounded.harden_normals = bevel_m, 2, "ANGLE", False
    return obj


def _monkey(size: float, materials: list[Any]) -> Any:
    mesh = bpy.data.meshes.new("monkey")
    head = bmesh.new()
    turn = Matrix.Rotation(math.radians(90), 4, "Z")
    bmesh.ops.create_monkey(head, matrix=turn @ Matrix.Scale(0.44 * size, 4))
    lowest = min(v.co.z for v in head.verts)
    for v in head.verts:
        v.co.z -= lowest
    for face in head.faces:
        face.smooth = True
    head.to_mesh(mesh)
    head.free()
    mesh.materials.append(materials[0])
    obj = bpy.data.objects.new("monkey", mesh)
    bpy.context.scene.collection.objects.link(obj)
    finer = obj.modifiers.new("finer", "SUBSURF")
    finer.levels = finer.render_levels = 2
    return obj


def _paper_cube(spec: Params, folder: Path) -> Any:
    """The folded cube, its print as uv over the net."""
    points, faces, where, start = [], [], [], 0
    for own, (rows, columns), net in sheets(spec["params"]):
        faces.append(grid_faces(rows - 1, columns - 1) + start)
        points.append(own)
        where.append(net * [1, -1] + [0, 1])  # Blender's pictures run upwards
        start += len(own)
    order = np.concatenate(faces)
    made = [cube_paper(spec["material"], folder / NET)]
    obj = mesh_object("cube", np.concatenate(points), order.tolist(), made, smooth=True)
    obj.data.uv_layers.new().data.foreach_set("uv", np.concatenate(where)[order.ravel()].astype(np.float32).ravel())
    return obj


def _thing(spec: Params, ground_z: float, folder: Path) -> list[Any]:
    if spec["family"] == "paper_cube":
        made = [_paper_cube(spec, folder)]
    elif spec["family"] == "monkey":
        made = [_monkey(spec["params"]["size_m"], object_materials(spec["material"]))]
    else:
        materials = object_materials(spec["material"])
        parts = built(spec["family"], spec["params"])
        made = []
        for bevel in sorted({part.bevel_m for part in parts}):
            made.append(_merged(spec["family"], [p for p in parts if p.bevel_m == bevel], materials, bevel))
    for obj in made:
        obj.location = spec.get("xyz_m", [*spec["xy_m"], ground_z])
        obj.rotation_euler = (0, 0, math.radians(spec["yaw_deg"]))
        obj.pass_index = ROLES[spec["role"]]
    return made


def _ground(spec: Params, z: float) -> None:
    made = ground_material(spec)
    if spec["edge_m"] is None:
        h = 4.0
        top = mesh_object("ground", [(-h, -h, z), (h, -h, z), (h, h, z), (-h, h, z)], [(0, 1, 2, 3)], [made])
    else:  # a table's top, with the floor far below
        h, turns = spec["edge_m"], 64 if spec["round"] else 4
        a = (np.arange(turns) + 0.5) * 2 * math.pi / turns
        r = h if spec["round"] else h * math.sqrt(2)
        rim = np.column_stack([r * np.cos(a), r * np.sin(a)])
        points = [(*p, z) for p in rim] + [(*p, z - 0.025) for p in rim]
        sides = [(k, (k + 1) % turns, turns + (k + 1) % turns, turns + k) for k in range(turns)]
        top = mesh_object("ground", points, [tuple(range(turns)), *[s[::-1] for s in sides]], [made])
        floor, n = material("floor")
        n.principled([0.6 * c for c in spec["second"]], 0.7)
        below = z - 0.7
        far = mesh_object(
            "floor", [(-4, -4, below), (4, -4, below), (4, 4, below), (-4, 4, below)], [(0, 1, 2, 3)], [floor]
        )
        far.pass_index = BEYOND
    top.pass_index = GROUND


def sheet_height(sheet: Params, x: Any, y: Any) -> Any:
    """Height of a curled sheet over z = 0: a parabola across one direction, zero along the marker's middle."""
    a = math.radians(sheet["curl_azimuth_deg"])
    along = (x * math.cos(a) + y * math.sin(a)) / (sheet["paper_side_m"] / 2)
    return sheet["curl_m"] * along**2


def _sheet(sheet: Params, ground_z: float) -> None:
    h, count = sheet["paper_side_m"] / 2, 13
    u = np.linspace(-h, h, count)
    x, y = np.meshgrid(u, u)
    cut = 1 + math.tan(math.radians(sheet["cut_deg"])) * x / h * 0.04  # not cut quite square
    z = sheet_height(sheet, x, y)
    faces = [(i * count + k, i * count + k + 1, (i + 1) * count + k + 1, (i + 1) * count + k)
             for i in range(count - 1) for k in range(count - 1)]  # fmt: skip
    obj = mesh_object(
        "sheet", np.stack([x, y * cut, z], -1).reshape(-1, 3), faces, [sheet_material(sheet)], smooth=True
    )
    uv = obj.data.uv_layers.new()
    where = np.stack([x / (2 * h) + 0.5, y * cut / (2 * h) + 0.5], -1).reshape(-1, 2)
    order = np.array([v for face in faces for v in face])
    uv.data.foreach_set("uv", where[order].astype(np.float32).ravel())
    obj.pass_index = SHEET
    if ground_z < -0.0005:
        card, n = material("card")
        n.principled((0.55, 0.5, 0.42), 0.8)
        top = [(-h, -h), (h, -h), (h, h), (-h, h)]
        points = [(*p, -0.00012) for p in top] + [(*p, ground_z) for p in top]
        sides = [(k, k + 4, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4)]
        mesh_object("card", points, [(0, 1, 2, 3), *sides], [card]).pass_index = SHEET


def _mark(patch: Params, z: float) -> None:
    """A flat mark; the attribute `fade` is 1 inside and falls to 0 over its soft border."""
    outline = np.asarray(patch["outline_m"])
    middle = outline.mean(axis=0)
    size = np.linalg.norm(outline - middle, axis=1).mean()
    inner = middle + (outline - middle) * max(1 - patch["soft_m"] / size, 0.1)
    n = len(outline)
    points = [(*p, z) for p in outline] + [(*p, z) for p in inner]
    ring = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)]
    obj = mesh_object("mark", points, [*ring, tuple(range(n, 2 * n))], [mark_material(patch)])
    fade = obj.data.attributes.new("fade", "FLOAT", "POINT")
    fade.data.foreach_set("value", np.repeat([0.0, 1.0], n).astype(np.float32))
    obj.pass_index = GROUND


def _surroundings(spec: Params) -> None:
    light = surroundings.radiance(spec)
    rows, columns = light.shape[:2]
    image = bpy.data.images.new("surroundings", columns, rows, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.dstack([light, np.ones((rows, columns))]).astype(np.float32).ravel())
    image.pack()
    world = bpy.data.worlds.new("surroundings")
    bpy.context.scene.world = world
    world.use_nodes, world.lightgroup = True, "ambient"
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 128
    tree = world.node_tree
    tree.nodes.clear()
    picture, background = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeBackground")
    picture.image = image
    tree.links.new(picture.outputs[0], background.inputs[0])
    tree.links.new(background.outputs[0], tree.nodes.new("ShaderNodeOutputWorld").inputs[0])


def _light(light: Params, group: str) -> None:
    """Its luminance on the open level ground (a lamp's at the marker's centre) is `strength`; surroundings give 1."""
    luminance = float(np.dot(light["colour"], surroundings.LUMINANCE))
    if light.get("position_m") is not None:
        lamp = bpy.data.lights.new(group, "POINT")
        lamp.shadow_soft_size = light["radius_m"]
        at = np.asarray(light["position_m"])
        distance = float(np.linalg.norm(at))
        # A point lamp of P watts gives P / (4 pi distance^2) to what faces it.
        lamp.energy = light["strength"] / luminance * 4 * math.pi * distance**3 / float(at[2])
    else:
        lamp = bpy.data.lights.new(group, "SUN")
        lamp.angle = math.radians(light["angular_diameter_deg"])
        lamp.energy = light["strength"] / luminance / math.sin(math.radians(light["elevation_deg"]))
    lamp.color = light["colour"]
    obj = bpy.data.objects.new(group, lamp)
    obj.lightgroup = group
    if light.get("position_m") is not None:
        obj.location = light["position_m"]
    else:
        d = direction(light["azimuth_deg"], light["elevation_deg"])  # a sun shines along its own -z
        x = np.cross([0, 0, 1], d) / np.linalg.norm(np.cross([0, 0, 1], d))
        obj.matrix_world = Matrix(np.column_stack([x, np.cross(d, x), d]).tolist()).to_4x4()
    bpy.context.scene.collection.objects.link(obj)


def _camera(spec: Params) -> None:
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle, lens.clip_start = "HORIZONTAL", math.radians(spec["hfov_deg"]), 0.01
    camera = bpy.data.objects.new("camera", lens)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    place_camera(camera, spec["R"], spec["t"])


def place_camera(camera: Any, R: Any, t: Any) -> None:
    """Blender's camera looks along -z with y up."""
    R = np.asarray(R)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R.T @ np.diag([1.0, -1.0, -1.0]), -R.T @ np.asarray(t)
    camera.matrix_world = Matrix(pose.tolist())

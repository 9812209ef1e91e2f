"""Path-traces some of make.py's models on the marker, on the clip's table and under its light, for compare_pictures.py.

    python trace.py DIR [--count 60] [--width 160]        needs bpy (the extra `scenes`)

Writes bare.png and, for the first models that stand still, NNN.png and NNN_mask.png (where it is seen), and
pictures.json. What glTF can say of a material is traced as Blender has it; of other formats what Blender reads from the
file, and matt plastic, white or in the vertices' colours, where that says nothing. Three things are mended, as the path
tracer is off there: of faces that lie in one place one is kept, since rays that leave one meet the other by chance;
textures are decoded before they are interpolated, as glTF asks and Cycles does not; and faces of smooth meshes that are
turned away from the light get none, where Cycles moves the places from which it looks for what hides the light.
"""

import argparse
import json
import math
import sys
from pathlib import Path

import bpy  # before what it brings along

# isort: split
import bmesh
import numpy as np
from make import FAR_M, build, truth
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import clip_scene as content
import render_reference as reference

HFOV = math.radians(26)
AZIMUTH, ELEVATION, DISTANCE_M = math.radians(-110), math.radians(35), 0.42
LOOKED_AT_M = (0.0, 0.0, 0.035)
# Of what files without materials and normals look like, as ashe_live/models/material.py and docs/models.md have it.
UNKNOWN_ROUGHNESS, SHARP = 0.7, math.radians(40)
IN_ONE_PLACE, FLAT = 1e-5, 1e-3  # of the mesh's size; radians


def camera_pose() -> tuple[np.ndarray, np.ndarray]:
    """R (3, 3) and t (3,) from the marker's frame to OpenCV's camera."""
    flat = math.cos(ELEVATION)
    outwards = np.array((flat * math.cos(AZIMUTH), flat * math.sin(AZIMUTH), math.sin(ELEVATION)))
    right = np.cross(-outwards, (0, 0, 1))
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(-outwards, right), -outwards])
    return rotation, -rotation @ (np.array(LOOKED_AT_M) + DISTANCE_M * outwards)


def stage() -> bpy.types.Scene:
    """The table, the marker's sheet, the light and the camera, beside what there is."""
    things = list(bpy.data.objects)
    scene = bpy.context.scene
    rotation, translation = camera_pose()
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle, lens.clip_start = "HORIZONTAL", HFOV, 0.01
    camera = bpy.data.objects.new("camera", lens)
    scene.collection.objects.link(camera)
    scene.camera = camera
    world_from_camera = np.eye(4)
    world_from_camera[:3, :3] = rotation.T @ np.diag((1, -1, -1))
    world_from_camera[:3, 3] = -rotation.T @ translation
    camera.matrix_world = Matrix(world_from_camera.tolist())
    content.square("table", 5.0, content.TABLE_Z, content.wood())
    content.square("paper", content.PAPER_SIDE, 0.0, content.paper())
    content.lights()
    for thing in bpy.data.objects:
        thing["is_stage"] = thing not in things
    return scene


def put_on_marker() -> None:
    """All that is there, as the viewer places a model on the marker."""
    places, triangles = truth()
    corners = places[triangles].reshape(-1, 3)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    width, depth, height = upper - lower
    sides = width / reference.FOOTPRINT_SIDES, depth / reference.FOOTPRINT_SIDES, height / reference.HEIGHT_SIDES
    foot = Vector(((lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]))
    roots = [thing for thing in bpy.data.objects if thing.parent is None]
    stand = bpy.data.objects.new("stand", None)
    bpy.context.scene.collection.objects.link(stand)
    stand.matrix_world = Matrix.Scale(content.MARKER_SIDE / max(sides), 4) @ Matrix.Translation(-foot)
    for thing in roots:
        thing.parent = stand


def read(path: Path, up: str) -> None:
    """The file as Blender reads it, as the only thing in its scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    axes = {"up_axis": up.upper(), "forward_axis": "NEGATIVE_Z" if up == "y" else "Y"}
    importers = {".obj": bpy.ops.wm.obj_import, ".ply": bpy.ops.wm.ply_import, ".stl": bpy.ops.wm.stl_import}
    importers[path.suffix](filepath=str(path), **axes)
    for thing in bpy.data.objects:
        if path.suffix != ".obj":
            thing.data.set_sharp_from_angle(angle=SHARP)
        if not any(thing.data.materials):
            plain = bpy.data.materials.new("plain")
            plain.use_nodes = True
            surface = plain.node_tree.nodes["Principled BSDF"].inputs
            surface["Base Color"].default_value = (1, 1, 1, 1)
            surface["Roughness"].default_value = UNKNOWN_ROUGHNESS
            if thing.data.color_attributes:
                colours = plain.node_tree.nodes.new("ShaderNodeVertexColor")
                colours.layer_name = thing.data.color_attributes[0].name
                plain.node_tree.links.new(colours.outputs[0], surface["Base Color"])
            thing.data.materials.append(plain)


def without_doubles() -> None:
    """Of faces with the same corners one is left."""
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in [each for each in bpy.data.objects if each.type == "MESH"]:
        evaluated = thing.evaluated_get(graph)
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=graph)
        shape = bmesh.new()
        shape.from_mesh(mesh)
        near = IN_ONE_PLACE * max(thing.dimensions) / max(max(thing.scale), 1e-9)
        # Files may have cut two faces in one place along different diagonals.
        bmesh.ops.join_triangles(shape, faces=shape.faces, angle_face_threshold=FLAT, angle_shape_threshold=math.pi)
        places = bmesh.ops.find_doubles(shape, verts=shape.verts, dist=near)["targetmap"]
        kept, doubles = set(), []
        for face in shape.faces:
            corners = frozenset(places.get(corner, corner) for corner in face.verts)
            doubles += [face] if corners in kept else []
            kept.add(corners)
        if doubles:
            bmesh.ops.delete(shape, geom=doubles, context="FACES_ONLY")
            shape.to_mesh(mesh)
            thing.modifiers.clear()
            thing.data = mesh
        shape.free()


def decoded_pictures() -> None:
    """Textures of encoded bytes become ones of linear numbers, as which they are interpolated."""
    for image in [each for each in bpy.data.images if each.colorspace_settings.name == "sRGB" and not each.is_float]:
        texels = np.array(image.pixels[:]).reshape(-1, 4)
        colours = texels[:, :3]
        texels[:, :3] = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
        linear = bpy.data.images.new(image.name, *image.size, alpha=True, float_buffer=True)
        linear.colorspace_settings.name = "Non-Color"
        linear.pixels.foreach_set(texels.astype(np.float32).ravel())
        linear.pack()
        image.user_remap(linear)


def traced(folder: Path, name: str, samples: int) -> None:
    virtual = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    for thing in virtual:
        thing.shadow_terminator_geometry_offset = 0.0
    scene = stage()
    prepare(scene, samples)
    part = folder / "part.png"
    reference.write_png(folder / f"{name}.png", reference.photo(reference.render_linear(scene, part, samples)))
    if virtual:
        for thing in bpy.data.objects:
            thing.is_holdout = bool(thing["is_stage"])
        scene.cycles.use_denoising = False
        seen = reference.render_linear(scene, part, 4, transparent=True)[..., 3]
        reference.write_png(folder / f"{name}_mask.png", seen)


def prepare(scene: bpy.types.Scene, samples: int) -> None:
    """As render_clip.py renders."""
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_light_tree = False
    scene.cycles.use_denoising, scene.cycles.denoiser = True, "OPENIMAGEDENOISE"
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 4, 2, 2
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.render.resolution_x, scene.render.resolution_y = reference.SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "PNG", "16"
    scene.view_settings.view_transform = "Raw"
    scene.view_settings.exposure = -math.log2(reference.PNG_WHITE)


def record() -> dict:
    view = reference.View(84, math.degrees(content.SUN_AZIMUTH), math.degrees(content.SUN_ELEVATION), ())
    width, height = reference.SIZE
    k = (width / 2) / math.tan(HFOV / 2)
    rotation, translation = camera_pose()
    known = reference.view_record("odd", view)
    known |= {"size": reference.SIZE, "K": [[k, 0, (width - 1) / 2], [0, k, (height - 1) / 2], [0, 0, 1]]}
    return known | {"R": rotation.tolist(), "t": translation.tolist()}


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--width", type=int, default=160, help="pixels; of models with detail below one: 320")
    options = parser.parse_args()
    folder, samples = options.folder, options.samples
    reference.SIZE = options.width, options.width * 3 // 4
    if not (folder / "bare.png").exists():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        traced(folder, "bare", 4 * samples)
    (folder / "pictures.json").write_text(json.dumps(record(), indent=1) + "\n")
    count = 0
    for known in sorted(folder.glob("*.npz")):
        (path,) = (
            each for each in folder.glob(f"{known.stem}.*") if each.suffix in (".glb", ".gltf", ".obj", ".ply", ".stl")
        )
        if path.suffix.startswith(".gl"):
            build(int(known.stem))
        else:
            read(path, str(np.load(known)["up"]))
        # The viewer makes a moving model as small as all its poses need, and Blender's renderer tears what is far away.
        moves = any(thing.animation_data for thing in bpy.data.objects)
        if moves or np.abs(np.load(known)["places"]).max() > FAR_M / 2:
            continue
        if not (folder / f"{known.stem}_mask.png").exists():
            without_doubles()
            decoded_pictures()
            put_on_marker()
            traced(folder, known.stem, samples)
        count += 1
        if count == options.count:
            break


if __name__ == "__main__":
    main()

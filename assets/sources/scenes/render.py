"""Path-traces specified scenes with Blender's Cycles into linear radiance, each light in a layer of its own.

    bpyenv/bin/python -m scenes.render sets/training:4 sets/development:1 sets/sealed:1

Writes radiance/ID.npz a scene: float16 radiance (h, w, 3) RGB as `light0`, `light1`, `light2`, `ambient`; `index`
(h, w), what is seen (geometry/index.py); and the triangles of the objects as rendered, `points{i}` (marker's frame) and
`faces{i}`. Of a take, radiance has an axis for frames before the others.
Scenes that exist already are left out, so that it can be stopped and started again, and others may run beside it.
"""

import argparse
import json
import os
import tempfile
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from scenes.tracing import assembly

SAMPLES = 8  # a pixel; what is left of the noise is denoised
LAYERS = ("light0", "light1", "light2", "ambient")


def set_up(samples: int, threads: int, folder: Path) -> None:
    """An empty scene whose compositor denoises every light group by itself into a file of its own."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, layer = bpy.context.scene, bpy.context.scene.view_layers[0]
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.cycles.use_adaptive_sampling = scene.cycles.use_light_tree = scene.cycles.use_denoising = False
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 4, 2, 2
    scene.cycles.transparent_max_bounces = 6
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.sample_clamp_indirect = 6.0
    scene.render.use_persistent_data = False
    layer.cycles.denoising_store_passes = layer.use_pass_object_index = True
    for name in LAYERS:
        bpy.ops.scene.view_layer_add_lightgroup(name=name)
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    rendered, files = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeOutputFile")
    files.base_path = str(folder)
    files.format.file_format, files.format.color_depth, files.format.exr_codec = "OPEN_EXR", "32", "NONE"
    files.file_slots.clear()
    for name in LAYERS:
        files.file_slots.new(f"{name}_")
        denoised = tree.nodes.new("CompositorNodeDenoise")
        denoised.prefilter = "FAST"
        for socket, pass_name in enumerate((f"Combined_{name}", "Denoising Normal", "Denoising Albedo")):
            tree.links.new(rendered.outputs[pass_name], denoised.inputs[socket])
        tree.links.new(denoised.outputs[0], files.inputs[f"{name}_"])
    files.file_slots.new("index_")
    tree.links.new(rendered.outputs["IndexOB"], files.inputs["index_"])


def layer(folder: Path, name: str, size: list[int]) -> Any:
    """(h, w, 3) float32, the upper row first."""
    image = bpy.data.images.load(str(next(folder.glob(f"{name}_*.exr"))))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(size[0] * size[1] * 4, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(size[1], size[0], 4)[::-1, :, :3]


def triangles(objects: list[Any]) -> tuple[Any, Any]:
    """(n, 3) points in the world and (m, 3) faces of Blender's objects, modifiers applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    points, faces, start = [], [], 0
    for obj in objects:
        mesh = obj.evaluated_get(graph).to_mesh()
        mesh.calc_loop_triangles()
        own = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", own)
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        world = np.array(obj.matrix_world)
        points.append(own.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
        faces.append(corners.reshape(-1, 3) + start)
        start += len(points[-1])
        obj.to_mesh_clear()
    return np.concatenate(points).astype(np.float32), np.concatenate(faces)


def rendered(spec: dict[str, Any], source: Path, folder: Path) -> dict[str, Any]:
    """What one scene's file holds; `source`: the set's folder."""
    assembly.clear()
    made = assembly.assemble(spec, source)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = spec["size"]
    shots = []
    for number, pose in enumerate(spec.get("frames", [spec["camera"]])):
        assembly.place_camera(scene.camera, pose["R"], pose["t"])
        scene.cycles.seed = spec["render_seed"] + number
        for stale in folder.glob("*.exr"):
            stale.unlink()
        bpy.ops.render.render()
        shot = {name: layer(folder, name, spec["size"]).clip(0, 60000).astype(np.float16) for name in LAYERS}
        shots.append(shot | {"index": np.round(layer(folder, "index", spec["size"])[..., 0]).astype(np.uint8)})
    content = {name: np.stack([shot[name] for shot in shots]) for name in shots[0]} if "frames" in spec else shots[0]
    for number, objects in enumerate(made):
        content[f"points{number}"], content[f"faces{number}"] = triangles(objects)
    return content


def interleaved(sets: list[str]) -> list[tuple[Path, dict[str, Any]]]:
    """Each scene with its set's folder, so that sets given as FOLDER:WEIGHT grow together in those proportions."""
    ranked = []
    for each in sets:
        folder, _, weight = each.partition(":")
        scenes = json.loads((Path(folder) / "specifications.json").read_text())["scenes"]
        ranked += [((number + 0.5) / float(weight or 1), Path(folder), spec) for number, spec in enumerate(scenes)]
    return [(folder, spec) for _, folder, spec in sorted(ranked, key=lambda item: item[0])]


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("sets", nargs="+", help="folders with specifications.json, each FOLDER or FOLDER:WEIGHT")
    ask.add_argument("--count", type=int, help="only the first so many scenes of all")
    ask.add_argument("--samples", type=int, default=SAMPLES)
    ask.add_argument("--threads", type=int, default=1)
    asked = ask.parse_args()
    with tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as work:
        set_up(asked.samples, asked.threads, Path(work))
        for folder, spec in interleaved(asked.sets)[: asked.count]:
            path = folder / "radiance" / f"{spec['id']}.npz"
            if path.exists():
                continue
            path.parent.mkdir(exist_ok=True)
            start = time.perf_counter()
            content = rendered(spec, folder, Path(work))
            part = path.with_name(f".{path.stem}.{os.getpid()}")
            with part.open("wb") as file:
                np.savez_compressed(file, **content)
            part.rename(path)
            print(f"{spec['id']} {time.perf_counter() - start:.2f} s", flush=True)


if __name__ == "__main__":
    main()

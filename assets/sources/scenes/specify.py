"""Draws a set of scenes as specifications, from a seed: what stands where, made of what, lit and photographed how.

    env/bin/python -m scenes.specify --set training --count 600 --out /tmp/sets/training

writes specifications.json. Scene i of a set depends on the set's seed and on i alone, so that a longer list begins
with the shorter one. A scene is rendered once and developed into several pictures, as its lights are kept apart.
"""

import argparse
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.drawing import cubes, families
from scenes.drawing.families import HELD_OUT, Params, Rng, between, pick
from scenes.drawing.layout import HELD_OUT_SHARE, layout
from scenes.drawing.motion import FRAMES, frames
from scenes.photo.camera import camera_settings

BASES = {"clean": 27, "texture": 22, "clutter": 18, "dark": 9, "partial": 6, "misleading": 18}
LAMP_BASES = {"clean": 2, "texture": 2, "dark": 1}
CUBE_BASES = {"clean": 3, "texture": 2}
TRIES = 2000


@dataclass(frozen=True)
class SceneSet:
    """What a set is: its seed, whether it shows the held-out families, lamps near by, short takes, or the paper cube.

    `developed`: how often the same is photographed, each time by another camera, the lights as strong as chance has it.
    """

    seed: int
    sealed: bool = False
    lamps: bool = False
    takes: bool = False
    cubes: bool = False
    developed: int = 1


SETS = {
    "training": SceneSet(13001, developed=2),
    "development": SceneSet(13002),
    "sealed": SceneSet(13003, sealed=True),
    "near_training": SceneSet(14001, lamps=True),
    "near_development": SceneSet(14002, lamps=True),
    "near_sealed": SceneSet(14003, sealed=True, lamps=True),
    "takes_training": SceneSet(14011, takes=True),
    "takes_development": SceneSet(14012, takes=True),
    "takes_sealed": SceneSet(14013, sealed=True, takes=True),
    "cube_training": SceneSet(15001, cubes=True),
    "cube_development": SceneSet(15002, cubes=True),
    "cube_sealed": SceneSet(15003, sealed=True, cubes=True),
    "near_takes_training": SceneSet(14021, lamps=True, takes=True),
    "cube_takes_training": SceneSet(15011, cubes=True, takes=True),
    "cube_takes_sealed": SceneSet(15013, sealed=True, cubes=True, takes=True),
}


def specification(set_name: str, index: int) -> Params:
    """Scene `index` of a set; raises RuntimeError when no layout that fits is found."""
    about = SETS[set_name]
    rng = np.random.default_rng([about.seed, index])
    base = pick(rng, CUBE_BASES if about.cubes else LAMP_BASES if about.lamps else BASES)
    dark_ground = base == "dark" and rng.random() < 0.4
    for _ in range(TRIES):
        ground = families.ground(rng, _ground_family(rng, base, about.sealed), dark_ground)
        if about.cubes:
            scene = cubes.layout(rng, index, ground, about.sealed)
        else:
            scene = layout(rng, base, ground, about.sealed, base == "dark" and not dark_ground, about.lamps)
        if scene is not None:
            break
    else:
        raise RuntimeError(f"no layout found for scene {index} of {set_name}")
    scene = {"id": f"{set_name}_{index:05d}", "set": set_name, "index": index, "base": base} | scene
    scene["surroundings"] = families.surroundings(rng, pick(rng, families.SURROUNDINGS))
    if about.cubes:
        wanted = cubes.pictures(rng, index)
        scene["pictures"] = [_picture(rng, scene, number, *each) for number, each in enumerate(wanted)]
    else:
        scene["pictures"] = _pictures(rng, scene, about.lamps)
    scene["render_seed"] = int(rng.integers(1 << 30))
    scene["pictures"] += _again(np.random.default_rng([about.seed, index, 1]), scene, about.developed - 1)
    if about.takes:
        scene |= frames(rng, scene)
    return scene


def _ground_family(rng: Rng, base: str, sealed: bool) -> str:
    if sealed and rng.random() < HELD_OUT_SHARE:
        return str(rng.choice(HELD_OUT["ground"]))
    only = {"clean": families.PLAIN_GROUNDS, "texture": families.BUSY_GROUNDS}.get(base)
    return pick(rng, families.GROUNDS, only)


def _pictures(rng: Rng, scene: Params, lamps: bool) -> list[Params]:
    """What is developed from the scene's radiance: which lights shine, how strongly, through which camera."""
    base, lights = scene["base"], scene["lights"]
    named = [light["kind"] if light["kind"] in ("soft", "low", "high") else base for light in lights]
    extra = rng.random()
    if lamps:
        wanted = [("near", [0]), ("near", [1])]
        if extra < 0.25:
            wanted.append(("near", [0, 2]))
    elif scene["without_object"]:
        wanted = [("misleading", [0]), ("misleading", [1])]
        if scene["patches"]:
            wanted.append(("misleading", []))
    elif base == "misleading":
        wanted = [("misleading", []), ("texture" if named[0] == base else named[0], [0])]
        if extra < 0.6:
            wanted.append(("texture" if named[1] == base else named[1], [1]))
    else:
        wanted = [(kind, [number]) for number, kind in enumerate(named)]
        if extra < 0.4:
            wanted.append(("two", [0, 1]))
        elif extra < 0.72:
            wanted.append(("diffuse", []))
    return [_picture(rng, scene, number, *each) for number, each in enumerate(wanted)]


def _again(rng: Rng, scene: Params, times: int) -> list[Params]:
    """Every picture so many times more."""
    first, made = scene["pictures"], []
    for picture in first * times:
        shining = picture["lights"] or picture["unseen_lights"]
        made.append(_picture(rng, scene, len(first) + len(made), picture["category"], shining))
        others = {name: weight for name, weight in families.CAMERAS.items() if name != picture["camera"]["family"]}
        made[-1]["camera"] = camera_settings(rng, pick(rng, others))
    return made


def _picture(rng: Rng, scene: Params, number: int, category: str, shining: list[int]) -> Params:
    gains = [round(float(np.exp(rng.normal(0, 0.25))), 4) for _ in shining]
    if len(shining) == 2:  # the weaker one is to be seen: 0.35 to 1 of the stronger one's light on the ground
        one, other = (scene["lights"][k]["strength"] for k in shining)
        gains[1] = round(gains[0] * between(rng, 0.35, 1.0) * one / other, 4)
    misleading = category == "misleading"
    return {
        "id": f"{scene['id']}_{number}", "category": category, "lights": [] if misleading else shining, "gains": gains,
        "unseen_lights": shining if misleading else [], "camera": camera_settings(rng, pick(rng, families.CAMERAS)),
    }  # fmt: skip


def onto_marker(scene: Params) -> Params | None:
    """The scene as its first light shows it from where the shadow of its object's top falls onto the marker's centre.

    The marker lies flat and is mostly lit in all sets, but where people put an object beside it, the shadow often falls
    onto it. None where that takes a light below 18 or above 62 degrees, or the scene is not of one object in a sun.
    """
    casters = [each for each in scene["objects"] if each["role"] == "caster"]
    pictures = [each for each in scene["pictures"] if each["lights"] == [0]]
    marker = scene["marker"]
    is_flat = marker["card_m"] < 0.001 and marker["curl_m"] == 0
    others = len(scene["objects"]) > 1 or scene["patches"] or scene["partial_kind"] or scene["without_object"]
    is_near = "position_m" in scene["lights"][0]
    if not casters or not pictures or not is_flat or others or is_near:
        return None
    x, y = casters[0]["xy_m"]
    elevation_deg = math.degrees(math.atan2(casters[0]["height_m"], 1.05 * math.hypot(x, y)))
    if not 18 < elevation_deg < 62:
        return None
    first = scene["lights"][0] | {
        "azimuth_deg": round(math.degrees(math.atan2(y, x)) % 360, 5), "elevation_deg": round(elevation_deg, 5),
    }  # fmt: skip
    picture = pictures[0]
    if first["kind"] in ("low", "high"):  # it no longer is
        first["kind"], picture = "plain", picture | {"category": scene["base"]}
    return scene | {"lights": [first, *scene["lights"][1:]], "pictures": [picture]}


def empty(scene: Params) -> Params | None:
    """The scene before its object stood there, with other noise; None if it never has one."""
    others = [each for each in scene["objects"] if each["role"] != "caster"]
    if len(others) == len(scene["objects"]):
        return None
    pictures = [each | {"camera": each["camera"] | {"seed": each["camera"]["seed"] + 1}} for each in scene["pictures"]]
    return scene | {"objects": others, "pictures": pictures, "render_seed": scene["render_seed"] + 1}


def of_frames(scene: Params, count: int) -> Params:
    """A take of so many of its frames, from the first to the last, as evenly spread as they can be."""
    kept = np.round(np.linspace(0, len(scene["frames"]) - 1, count)).astype(int)
    return scene | {"frames": [scene["frames"][number] for number in kept]}


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--set", choices=SETS, required=True)
    which = ask.add_mutually_exclusive_group(required=True)
    which.add_argument("--count", type=int, help="the first so many scenes")
    which.add_argument("--scenes", type=int, nargs="+", metavar="I", help="these scenes of the set, by number")
    ask.add_argument("--out", type=Path, required=True)
    ask.add_argument("--onto-marker", action="store_true", help="in a light whose shadow falls onto the marker")
    ask.add_argument("--empty", action="store_true", help="without the object that casts the shadow: clean plates")
    ask.add_argument(
        "--frames", type=int, metavar="N", help=f"so many of a take's frames (2 to {FRAMES}), which render sooner"
    )
    asked = ask.parse_args()
    if asked.frames is not None and not (SETS[asked.set].takes and 2 <= asked.frames <= FRAMES):
        ask.error(f"--frames is for sets of takes, and from 2 to {FRAMES}")
    asked.out.mkdir(parents=True, exist_ok=True)
    indices = range(asked.count) if asked.scenes is None else asked.scenes
    scenes = [specification(asked.set, index) for index in indices]
    if asked.onto_marker:
        scenes = [shaded for scene in scenes if (shaded := onto_marker(scene)) is not None]
    if asked.empty:
        scenes = [bare for scene in scenes if (bare := empty(scene)) is not None]
    if asked.frames is not None:
        scenes = [of_frames(scene, asked.frames) for scene in scenes]
    lines = ",\n".join(json.dumps(scene) for scene in scenes)
    content = f'{{"format": 1, "set": "{asked.set}", "seed": {SETS[asked.set].seed}, "scenes": [\n{lines}\n]}}\n'
    (asked.out / "specifications.json").write_text(content)
    if SETS[asked.set].cubes:
        cubes.write_net(asked.out)
    print(f"{len(scenes)} scenes, {sum(len(scene['pictures']) for scene in scenes)} pictures")


if __name__ == "__main__":
    main()

"""Pictures of paper cubes with known truth, painted by this bench or path-traced by the generator of scenes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np

from ashe_live.bench.cases import EXACT_PX, decoded, ground_truth
from ashe_live.bench.cube.ambient import NORMALS, painted_sky
from ashe_live.bench.cube.painted_scene import CubeScene, hull_of
from ashe_live.bench.cube.painter import cast_on_table, painted, projected
from ashe_live.bench.cube.scenes import CubeSet, before
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.core.arrays import Float, Image, Mask, directions_on_spiral
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.errors import UserError
from ashe_live.tracking.cube.faces import CUBE

FPS = 30.0  # of painted frames by which a cube is followed
# Of the cube's area in the picture, from which on a shadow is seen: less is a sliver beside the cube's foot.
SEEN = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class CubePicture:
    """A picture with its truth, in the frame of the table under the cube."""

    id: str
    image: Image
    camera: Camera
    T_cam_cube: Float  # (4, 4)
    edge_m: float
    lights: Float  # (n, 4) homogeneous, metres: w = 0 for suns
    shows_shadows: bool  # of all lights: enough of each lies in the picture and not behind the cube
    sky_on_ball: Float  # (m, 3) what the sky gives to `directions_on_spiral(m)`, over all light on level ground
    table_rgb: Float  # (3,) reflectance
    before: Iterable[Image] = ()  # frames of the same cube by which it was followed, to be read once
    together: bool = False  # those are given as further views
    fps: float = FPS  # of all of them


def painted_pictures(one: CubeSet, count: int, seed: int) -> Iterator[CubePicture]:
    """The first so many of a set."""
    for number, scene in enumerate(one.scenes(count, seed)):
        yield CubePicture(
            id=f"{one.name} {number}",
            image=painted(scene),
            camera=scene.camera,
            T_cam_cube=scene.T_cam_cube,
            edge_m=scene.edge_m,
            lights=np.array([each.point for each in scene.lights]).reshape(-1, 4),
            shows_shadows=all(is_seen(scene, light.point) for light in scene.lights),
            sky_on_ball=painted_sky(scene),
            table_rgb=scene.table_rgb,
            before=map(painted, before(scene)) if one.followed else (),
            together=one.together,
        )


class Entry(NamedTuple):
    """What a folder's ground truth says of a picture, or of a take."""

    folder: Path
    content: Mapping[str, Any]
    together: bool = False  # a take's frames are given as further views of its last one


def traced_pictures(folders: Sequence[Path]) -> dict[str, list[Entry]]:
    """By category, every picture and every take of a cube in the folders' ground truths, for `traced_picture`.

    Also pictures on which the generator's own look for the cube found none. Takes come twice: the last frame alone, and
    with those before it. Raises UserError where a folder has no truth about cubes.
    """
    found: dict[str, list[Entry]] = {}
    for folder in folders:
        with ground_truth(folder, "scenes", "`scenes`, or `takes` with `frames`") as content:
            entries = [each for name in ("scenes", "marker_not_found", "takes") for each in content.get(name, [])]
            cubes = [(each["category"], each) for each in entries if each["marker"].get("dictionary") == CUBE]
        if not cubes:
            raise UserError(f"{folder} has no pictures of a paper cube", "ashe-live bench light measures on others")
        for category, each in cubes:
            found.setdefault(category, []).append(Entry(folder, each))
            if "video" in each:
                found.setdefault(f"{category}, views", []).append(Entry(folder, each, together=True))
    return found


def traced_picture(about: Entry) -> CubePicture:
    """A path-traced picture; raises UserError where it cannot be read, or its entry lacks something."""
    folder = about.folder
    try:
        return _read(about)
    except (ValueError, KeyError, IndexError, TypeError) as error:
        raise UserError(f"{folder} has a picture without its truth ({error})", "make the set again") from error


def _read(about: Entry) -> CubePicture:
    entry = about.content
    *before, image = _frames(about)
    last = entry["frames"][-1] if "frames" in entry else entry
    size = int(entry["size"][0]), int(entry["size"][1])
    lights = entry["lights"]
    level = np.array(entry["ambient"]["irradiance_ground"]) + sum(np.array(one["irradiance_ground"]) for one in lights)
    sky = np.maximum(_quadratic(directions_on_spiral(NORMALS)) @ np.array(entry["ambient"]["on_ball"]), 0.0) / level
    camera = Camera(size, np.array(entry["K"]), np.zeros(5), "file", EXACT_PX)
    T_cam_cube = rigid(last["R"], last["t"])
    points, edge_m = np.array([_point(each) for each in lights]).reshape(-1, 4), entry["marker"]["side_m"]
    perfect = CubeScene(camera, T_cam_cube, [], edge_m=edge_m)  # without its folds, for what is seen of its shadows
    return CubePicture(
        id=entry["id"],
        image=image,
        camera=camera,
        T_cam_cube=T_cam_cube,
        edge_m=edge_m,
        lights=points,
        shows_shadows=all(is_seen(perfect, point) for point in points),
        sky_on_ball=sky,
        table_rgb=np.array(entry["ground"]["albedo"], dtype=np.float64),
        before=before,
        together=about.together,
        fps=float(entry.get("fps", FPS)),
    )


def _frames(about: Entry) -> list[Image]:
    """All of a take, or the picture alone."""
    folder, entry = about.folder, about.content
    if "video" in entry:
        with ClipSource(folder / entry["video"]) as clip:
            frames = [frame.image_bgr for frame in clip]
        if len(frames) != len(entry["frames"]):
            raise ValueError(f"{entry['video']} has {len(frames)} frames")
        return frames
    image = decoded(folder / entry["image"], cv2.IMREAD_COLOR)
    if image is None:
        raise UserError(f"cannot read the picture {entry['image']}", "is it there, and a PNG or JPEG?")
    return [image]


def _point(light: Mapping[str, Any]) -> Float:
    """(4,)"""
    if "lamp" in light:
        return np.append(light["lamp"]["position_m"], 1.0)
    return np.append(light["dir_to_light"], 0.0)


def _quadratic(normals: Float) -> Float:
    """(n, 9) terms of an irradiance's quadratic in the normal (n, 3), as the generator has them."""
    x, y, z = normals.T
    return np.column_stack([np.ones_like(x), x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1])


def is_seen(scene: CubeScene, light: Float) -> bool:
    """Whether enough of the cube's shadow on the table in a light (4,) lies in the picture and not behind the cube."""
    body = hull_of(scene)
    cube, shadow = (_silhouette(scene, points) for points in (body, cast_on_table(body, light)))
    return int(np.count_nonzero(shadow & ~cube)) > SEEN * int(np.count_nonzero(cube))


def _silhouette(scene: CubeScene, points: Float) -> Mask:
    """(h, w) where the hull of points (n, 3), the cube's frame, lies in the picture."""
    mask = np.zeros(scene.camera.size[::-1], np.uint8)
    pixels = projected(scene.camera, scene.T_cam_cube, points).astype(np.float32)
    cv2.fillConvexPoly(mask, np.round(cv2.convexHull(pixels)[:, 0]).astype(np.int32), 1)
    return mask > 0

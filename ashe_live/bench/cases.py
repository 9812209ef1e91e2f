"""Pictures with a known light: rendered scenes and photos, read from a folder's ground_truth.json."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask, set_given_frozen
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.files.reading import read_bytes, read_json
from ashe_live.tracking import preset
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.poses.pose import estimate_pose
from ashe_live.tracking.tracker import MarkerTracker

GROUND_TRUTH = "ground_truth.json"
MOST_TRUTH_BYTES, MOST_PICTURE_BYTES = 100_000_000, 200_000_000
EXACT_PX = 1e-6  # standard deviation of a rendered scene's focal length
PHOTO_CATEGORY = "photo"
# Kinds of families that a set's pictures are drawn from, as far as its ground truth states them.
KINDS = ("object_family", "material", "ground", "camera", "surroundings")


@dataclass(frozen=True, slots=True)
class Case:
    """One picture with the true pose of its marker and the true directions of its lights."""

    id: str  # within its folder
    folder: str
    category: str
    caster: str | None  # kind of the object that casts the shadow; None: not stated
    image_path: Path
    camera: Camera
    marker: MarkerPose
    to_lights_marker: Float | None  # (n, 3) unit, strongest first; n = 0: no directional light, None: not known
    mask_paths: Mapping[str, Path]  # by name: object, shadow, ...; 1-bit pictures
    tags: Mapping[str, str] = field(default_factory=dict)  # the families that the picture belongs to, by kind: KINDS
    marker_spec: str | None = None  # as `parse_marker` reads it; None: not stated, or of a pattern file
    lamp_m: Float | None = None  # (3,) place of the strongest light, marker frame; None for a sun
    lamp_radius_m: float | None = None  # of that lamp; None: not stated
    foot_m: Float | None = None  # (2,) where the object that casts the shadow stands; None: not stated
    empty_path: Path | None = None  # the same view without that object; None: not known, or not used

    def __post_init__(self) -> None:
        set_given_frozen(self, to_lights_marker=(-1, 3), lamp_m=(3,), foot_m=(2,))

    def tracked(self, index: int = 0) -> TrackedFrame:
        """The picture as a frame, with the true pose; raises UserError when it cannot be read."""
        image = decoded(self.image_path, cv2.IMREAD_COLOR)
        if image is None:
            raise UserError(f"cannot read the picture {self.image_path}", "is it there, and a PNG or JPEG?")
        tracked = TrackedFrame(Frame(np.asarray(image, dtype=np.uint8), index, 0.0), self.camera, self.marker)
        if self.empty_path is None:
            return tracked
        empty = decoded(self.empty_path, cv2.IMREAD_COLOR)
        if empty is None or empty.shape != image.shape:
            raise UserError(f"{self.empty_path} is no picture of the size of {self.image_path}", "render it again")
        return replace(tracked, clean_plate_bgr=np.asarray(empty, dtype=np.uint8))

    def followed(self, index: int = 0) -> TrackedFrame:
        """As `tracked`, but with the tracker's own pose, as users have it, where it finds the marker."""
        given = self.tracked(index)
        if self.marker_spec is None:
            return given
        tracker = MarkerTracker(parse_marker(self.marker_spec), self.camera, self.marker.side_m, preset.BALANCED)
        found = tracker.track(given.frame)
        return given if found.marker is None else replace(found, clean_plate_bgr=given.clean_plate_bgr)

    def mask(self, name: str) -> Mask | None:
        """(h, w), or None when there is none of that name; raises UserError when it cannot be read."""
        if name not in self.mask_paths:
            return None
        picture = decoded(self.mask_paths[name], cv2.IMREAD_GRAYSCALE)
        if picture is None:
            raise UserError(f"cannot read the mask {self.mask_paths[name]}", "is it there, and a PNG?")
        return np.asarray(picture) > 127


def decoded(path: Path, flags: int) -> Image | None:
    """As cv2.imread, but reads regular files only, as a pipe could block. None if it is not a picture."""
    content = np.frombuffer(read_bytes(path, MOST_PICTURE_BYTES), dtype=np.uint8)
    picture = cv2.imdecode(content, flags) if content.size else None
    return None if picture is None else np.asarray(picture, dtype=np.uint8)


@contextmanager
def ground_truth(folder: Path, what: str, needs: str, file: str = GROUND_TRUTH) -> Iterator[Any]:
    """The content of a folder's ground_truth.json, or of another `file` there, in which a list of `what` is read.

    Raises UserError if it cannot be read, or if it is no such list, for which it `needs` something.
    """
    path = folder / file
    try:
        yield read_json(path, MOST_TRUTH_BYTES)
    except (ValueError, KeyError, IndexError, TypeError, AttributeError) as error:
        raise UserError(f"{path} is no list of {what} ({error})", f"it needs {needs}") from error


def read_cases(folder: Path) -> list[Case]:
    """The cases of a folder whose ground_truth.json lists `scenes` or `photos`; raises UserError if it has none."""
    with ground_truth(folder, "scenes", "`scenes` or `photos`") as content:
        return [*_scenes(folder, content.get("scenes", [])), *_photos(folder, content)]


def cases_of(folders: Iterable[Path], limit: int | None = None, every: int = 1) -> list[Case]:
    """Of each folder the first `limit` cases, and of these every `every`th. Raises UserError as `read_cases`."""
    return [case for folder in folders for case in read_cases(folder)[:limit:every]]


def over_empty_tables(cases: Iterable[Case], folder: Path) -> list[Case]:
    """The cases that a folder has pictures of the same names of, without the object; over these, as clean plates.

    Raises UserError if there are none.
    """
    named = [replace(case, empty_path=folder / case.image_path.name) for case in cases]
    found = [case for case in named if case.empty_path is not None and case.empty_path.is_file()]
    if not found:
        raise UserError(f"{folder} has no picture of the scenes' names", "name a set of `scenes.specify --empty`")
    return found


def _scenes(folder: Path, scenes: list[dict[str, Any]]) -> Iterator[Case]:
    """Rendered scenes, with camera, pose, corners, lights and masks given."""
    for scene in scenes:
        camera, marker = rendering_camera(scene), scene["marker"]
        T_cam_marker = rigid(scene["R"], scene["t"])
        corners_px = _corners_px(camera, T_cam_marker, marker)
        pose = rendered_pose(camera, T_cam_marker, corners_px, marker["side_m"])
        yield rendered_case(folder, scene, "image", camera, pose)


def rendered_case(folder: Path, entry: Mapping[str, Any], key: str, camera: Camera, marker: MarkerPose) -> Case:
    """A rendered scene or take by its entry in the truth; key: of its file there, "image" or, of a take, "video"."""
    lamp = next(iter(_by_strength(entry)), {}).get("lamp", {})
    caster, tags = entry.get("caster") or {}, entry.get("tags", {})
    foot_m = caster.get("base_xy_m")
    return Case(
        id=entry["id"],
        folder=folder.resolve().name,
        category=entry.get("category", "scene" if key == "image" else "take"),
        caster=caster.get("type"),
        image_path=folder / entry[key],
        camera=camera,
        marker=marker,
        to_lights_marker=_to_lights_marker(entry),
        mask_paths={name: folder / file for name, file in entry.get("masks", {}).items()},
        tags={kind: str(tags[kind]) for kind in KINDS if kind in tags},
        marker_spec=_marker_spec_of(entry["marker"]),
        lamp_m=np.array(lamp["position_m"], dtype=np.float64) if lamp else None,
        lamp_radius_m=lamp.get("radius_m"),
        foot_m=None if foot_m is None else np.array(foot_m, dtype=np.float64),
    )


def _photos(folder: Path, content: dict[str, Any]) -> Iterator[Case]:
    """Photos, with focal length, corners and, for some, the direction of the sun given; the pose is estimated."""
    for file, photo in content.get("photos", {}).items():
        width, height = photo["size"]
        camera = Camera.from_focal((width, height), photo["f_px"], "file")
        corners_px = np.array(photo["corners_px"], dtype=np.float64)
        marker = estimate_pose(corners_px, camera, content["marker"]["side_units"])
        if marker is None:
            raise ValueError(f"the corners of {file} are not those of a square")
        light = photo.get("to_light_marker")
        lights = None if light is None else np.array([light], dtype=np.float64)
        yield Case(
            id=Path(file).stem,
            folder=folder.resolve().name,
            category=PHOTO_CATEGORY,
            caster=None,
            image_path=folder / file,
            camera=camera,
            marker=marker,
            to_lights_marker=lights,
            mask_paths={},
        )


def rendering_camera(scene: Mapping[str, Any]) -> Camera:
    """The camera that a scene or take was rendered with."""
    width, height = scene["size"]
    dist = np.array(scene.get("dist") or np.zeros(5), dtype=np.float64)
    return Camera((width, height), np.array(scene["K"], dtype=np.float64), dist, "file", EXACT_PX)


def _marker_spec_of(marker: Mapping[str, Any]) -> str | None:
    """`marker_spec` of a Case, as far as its marker is stated."""
    if "dictionary" not in marker or "id" not in marker:
        return None
    return f"aruco:{str(marker['dictionary']).removeprefix('DICT_').lower()}:{marker['id']}"


def _to_lights_marker(scene: Mapping[str, Any]) -> Float | None:
    """(n, 3) unit vectors, strongest first; None when the scene does not state them."""
    if "lights" not in scene:
        return None if scene.get("directional", True) else np.empty((0, 3))
    return np.array([light["dir_to_light"] for light in _by_strength(scene)], dtype=np.float64).reshape(-1, 3)


def _by_strength(scene: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The scene's lights, strongest first."""
    return sorted(scene.get("lights", []), key=lambda light: -light.get("relative_strength", 1.0))


def _corners_px(camera: Camera, T_cam_marker: Float, marker: Mapping[str, Any]) -> Float:
    if "corners_px" in marker:
        return np.array(marker["corners_px"], dtype=np.float64)
    return _projected_square(camera, T_cam_marker, marker["side_m"])


def _projected_square(camera: Camera, T_cam_marker: Float, side_m: float) -> Float:
    """(4, 2) pixels of the marker's corners, with distortion."""
    rotation, _ = cv2.Rodrigues(T_cam_marker[:3, :3])
    pixels, _ = cv2.projectPoints(square_corners(side_m), rotation, T_cam_marker[:3, 3], camera.K, camera.dist)
    return np.asarray(pixels, dtype=np.float64).reshape(-1, 2)


def rendered_pose(camera: Camera, T_cam_marker: Float, corners_px: Float, side_m: float) -> MarkerPose:
    """The true pose (4, 4) of a marker that is seen with its corners at (4, 2), pixels."""
    offsets = _projected_square(camera, T_cam_marker, side_m) - corners_px
    rms_px = float(np.sqrt(np.mean(np.sum(offsets**2, axis=1))))
    return MarkerPose(T_cam_marker, corners_px, side_m, rms_px, None)

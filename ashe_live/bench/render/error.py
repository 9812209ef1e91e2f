"""Differences of the pictures from a path tracer's of the same scene in the same light (assets/reference)."""

import json
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np

from ashe_live.bench.metrics import overlap
from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.contract import Json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import direction_from_angles, project, raycast_to_plane, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import PlacedModel, placed_on_marker
from ashe_live.render.gl.offscreen import Context
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.lights.cast_shadows import is_inside, shadow_hull
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.occlusion.occlusion import Known
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

GROUND_POINTS = 5  # places in the shadow at which the ground's brightness is compared
PATCH_PX = 5  # side of the square around each, over which brightness is averaged
APART_PX = 12  # least distance of two of these places
KNOWN = Known()  # what the references' models hide, computed once for all pictures of each


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """One view with one model: the scene, and the path tracer's picture of it."""

    name: str
    scene: Scene  # the picture without the model, and the true light, as a perfect estimate would give it
    expected: Image  # (h, w, 3) BGR, with the model
    is_model: Mask  # (h, w)
    shadow_brightness: Float  # (h, w) luminance of shadowed over lit ground; NaN where no lit ground is
    is_ground: Mask  # (h, w) lit ground, without the real object and its shadow

    @property
    def kind(self) -> str:
        """The kind of its light, as in the contract."""
        assert self.scene.illumination.light is not None
        return self.scene.illumination.light.kind


@dataclass(frozen=True, slots=True)
class PictureError:
    """How far the renderer's picture is from the path tracer's; NaN where there is nothing to compare."""

    # Intersection over union of the pixels outside of model and real shadow that lost more than half of the light.
    shadow_iou: float
    shadow_de: float  # mean CIE 1976 colour difference where the path tracer's shadow is
    model_de: float  # mean CIE 1976 colour difference on the model
    ground: float  # largest relative error of the ground's luminance, of GROUND_POINTS places deep in the shadow


def read_references(folder: Path) -> list[Reference]:
    """The references in a folder that render_reference.py wrote."""
    record = json.loads((folder / "reference.json").read_text(encoding="utf-8"))
    return [_reference(folder, view, model) for view in record["views"] for model in view["models"]]


def picture_error(ctx: Context, reference: Reference, preset: RenderPreset) -> PictureError:
    """The error of the renderer's picture of the same scene."""
    assert reference.scene.tracked is not None
    bare = reference.scene.tracked.frame.image_bgr
    renderer = SceneRenderer(ctx, preset, reference.scene.tracked.frame.size, known=KNOWN)
    renderer.render(reference.scene)
    picture = renderer.read_bgr()
    renderer.release()
    kernel = np.ones((3, 3), np.uint8)
    beside = cv2.dilate(reference.is_model.astype(np.uint8), kernel) == 0
    within = cv2.erode(reference.is_model.astype(np.uint8), kernel) > 0
    threshold = (1 + reference.shadow_brightness) / 2
    ours, truth = (beside & (_darkening(image, bare) < threshold) for image in (picture, reference.expected))
    difference = colour_difference(picture, reference.expected)
    smooth = (cv2.blur(_luminance(image), (PATCH_PX, PATCH_PX)) for image in (picture, reference.expected))
    found, expected = (np.array([image[at] for at in _deepest(truth & reference.is_ground)]) for image in smooth)
    return PictureError(
        overlap(ours, truth),
        mean_where(difference, truth),
        mean_where(difference, within),
        float(np.abs(found / expected - 1).max()) if len(found) else math.nan,
    )


def camera_and_marker(view: Json) -> tuple[Camera, MarkerPose]:
    """Those of a rendered picture, as they are written down."""
    camera = Camera(tuple(view["size"]), np.array(view["K"]), np.zeros(5), "file")
    T_cam_marker, side_m = rigid(view["R"], view["t"]), view["marker_side_m"]
    corners_px = project(camera, T_cam_marker, square_corners(side_m))
    return camera, MarkerPose(T_cam_marker, corners_px, side_m, 0.0, None)


def _reference(folder: Path, view: Json, model: str) -> Reference:
    name = view["name"]
    bare = read_picture(folder / f"{name}.png")
    camera, marker = camera_and_marker(view)
    light = _light(view)
    pixels = np.stack(np.meshgrid(*map(np.arange, camera.size)), axis=-1).reshape(-1, 2)
    ground = raycast_to_plane(camera, marker.T_cam_marker, pixels)[:, :2]
    lighting = lighting_of((light,))
    linear = LINEAR_FROM_SRGB_8BIT[bare[..., ::-1]].reshape(-1, 3)
    x, y = view["caster"]["base_xy_m"]
    discs = [(x, y, height, radius, 0.0) for radius, height in view["caster"]["profile_m"]]
    proxy = Proxy("lathe", np.array(discs))
    outline = cv2.convexHull(project(camera, marker.T_cam_marker, proxy.points_marker()).astype(np.float32))
    silhouette = cv2.fillConvexPoly(np.zeros(bare.shape[:2], np.uint8), np.round(outline).astype(np.int32), 1) > 0
    is_object = silhouette.ravel()
    # Points of the real object are taken to be as far from the light as its foot.
    level = np.where(is_object[:, None], lighting.level_at(proxy.foot_marker[None, :2]), lighting.level_at(ground))
    is_lit = is_object | ~is_inside(shadow_hull(proxy.points_marker(), lighting.lights[0]), ground)
    tracked = TrackedFrame(Frame(bare, 0, 0.0), camera, marker)
    scene = Scene(
        tracked,
        _placed(model, marker.side_m),
        Illumination(
            (light,),
            real_object=proxy,
            ground_rgb=np.nanmedian(linear / level, axis=0),
            seen_in=tracked,
        ),
    )
    is_model = read_picture(folder / f"{name}_{model}_mask.png")[..., 0] > 127
    brightness = np.where(is_lit, np.dot(view["shadow_ratio"], REC709_LUMINANCE) / (level @ REC709_LUMINANCE), np.nan)
    expected = read_picture(folder / f"{name}_{model}.png")
    is_ground = (is_lit & ~is_object).reshape(is_model.shape)
    return Reference(f"{name}, {model}", scene, expected, is_model, brightness.reshape(is_model.shape), is_ground)


@cache
def _placed(model: str, side_m: float) -> PlacedModel:
    """The same model for all views that show it."""
    return placed_on_marker(load_model(model), side_m)


def _light(view: Json) -> Light:
    """The true light of a view's record."""
    towards = direction_from_angles(math.radians(view["azimuth_deg"]), math.radians(view["elevation_deg"]))
    ratio = np.array(view["shadow_ratio"])
    if (distance_m := view.get("distance_m")) is None:
        size_rad = math.radians(view["angular_diameter_deg"])
        return Light(towards, angular_size_rad=size_rad, shadow_rgb_ratio=ratio)
    return Light(towards, shadow_rgb_ratio=ratio, inverse_distance=1 / distance_m, radius_m=view["radius_m"])


def read_picture(path: Path) -> Image:
    """(h, w, 3) BGR. Raises FileNotFoundError."""
    image = cv2.imread(str(path))
    if image is None:
        raise FileNotFoundError(f"no picture at {path}")
    return np.asarray(image, np.uint8)


def _darkening(image: Image, bare: Image) -> Float:
    """(h, w) brightness in linear light over that of the picture without the model."""
    return np.asarray(_luminance(image) / np.maximum(_luminance(bare), 1e-3))


def _luminance(image: Image) -> Float:
    """(h, w) in linear light."""
    return np.asarray(LINEAR_FROM_SRGB_8BIT[image[..., ::-1]] @ REC709_LUMINANCE)


def _deepest(mask: Mask) -> list[tuple[int, int]]:
    """Row and column of up to GROUND_POINTS pixels of the mask, the farthest from its border first."""
    depth = cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 3)
    found = []
    for _ in range(GROUND_POINTS):
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        if depth[row, column] < PATCH_PX / 2:
            break
        found.append((int(row), int(column)))
        cv2.circle(depth, (int(column), int(row)), APART_PX, 0.0, cv2.FILLED)
    return found


def colour_difference(a: Image, b: Image) -> Float:
    """(h, w) Euclidean distance in CIE L*a*b*."""
    labs = [cv2.cvtColor(each.astype(np.float32) / 255, cv2.COLOR_BGR2LAB) for each in (a, b)]
    return np.asarray(np.linalg.norm(labs[0] - labs[1], axis=2), dtype=np.float64)


def smooth_difference(one: Image, other: Image, sigma_px: float = 1.0) -> Float:
    """(h, w) CIE 1976 colour differences of pictures (h, w, 3) BGR after a blur by `sigma_px`."""
    return colour_difference(*(cv2.GaussianBlur(each, (0, 0), sigma_px).astype(np.uint8) for each in (one, other)))


def mean_where(values: Float, where: Mask) -> float:
    """The mean of the values (h, w) within a mask; NaN if that is empty."""
    return float(values[where].mean()) if where.any() else math.nan

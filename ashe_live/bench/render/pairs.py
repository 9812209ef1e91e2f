"""Differences from path-traced photos of the same scenes with the model standing there, or without the sheet.

The photos are those of assets/sources/scenes/pairs.py: lens, noise, tone curve, sharpening and JPEG are a camera's.
"""

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.bench.render.borders import shadow_border
from ashe_live.bench.render.error import camera_and_marker, mean_where, read_picture, smooth_difference
from ashe_live.bench.render.flip import flip_error
from ashe_live.bench.render.forced_choice import crop_features
from ashe_live.bench.render.seams import seam_pixels
from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.contract import Json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.explanation.border_widths import border_widths
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import Placement, placed_on_marker
from ashe_live.render.gl.offscreen import Context
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

CHANGED_LEVELS = 8  # of 255 in any channel: a pixel that differs by more was changed by the model or its shadow
SEEN_SHADOW = 0.5  # least share of the sun's light that is gone in a pixel that counts as shadow
DARKEST_LEVEL = 8.0  # of 255, added to brightness before its logarithm is taken: below it there is only noise
BORDER_PX = 2  # width of the rim on either side of an outline that counts as neither side
FINE_PX = 2.0  # standard deviation of the blur that relief is finer than
LEAST_RELIEF_PX = 100  # pixels of ground well within the shadow that are needed to measure its relief
TINY = 0.02  # scale of a model that hides nothing: without any model the sheet would not be covered


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """A scene as the renderer gets it, with its true light, and photos of what its picture should look like."""

    name: str
    stem: Path  # the beginning of its files' names
    scene: Scene
    expected: Image  # (h, w, 3) BGR, with the model
    without_sheet: Image  # (h, w, 3) BGR, and without the model
    is_model: Mask  # (h, w)
    is_sheet: Mask  # (h, w)
    white_rgb: Float | None  # (3,) what white of radiance 1 was exposed to, linear RGB; None: not stated, as
    sky: Float | None  # (3,) share of the sky in the light on level ground
    sky_slope: Float | None  # (2, 3) how that sky leans, as `Illumination.sky_slope_rgb`

    @property
    def tracked(self) -> TrackedFrame:
        assert self.scene.tracked is not None
        return self.scene.tracked

    @property
    def bare(self) -> Image:
        """(h, w, 3) BGR: the photo that the model is drawn on."""
        return self.tracked.frame.image_bgr

    def file(self, name: str) -> Path:
        """The path of one of its files, by what follows the stem."""
        return self.stem.with_name(f"{self.stem.name}_{name}")


class Regions(NamedTuple):
    """Regions of a pair's photo, (h, w) each."""

    changed: Mask  # pixels that model or shadow change in either picture
    model: Mask  # well within its outline
    beside: Mask  # well outside of it
    shadow: Mask  # the part of `beside` in the model's shadow


@dataclass(frozen=True, slots=True, eq=False)
class PairError:
    """How far a photo with a virtual model is from the photo with the real one."""

    flip: float  # mean LDR-FLIP where model or shadow change the photo; NaN where they nowhere do, as all others
    border_ratio: float  # median over places on the shadow's border of its width over the true one; NaN without any
    border_places: int
    ground_de: float  # mean CIE 1976 colour difference in the shadow on the ground
    paper_de: float  # the same in the shadow on the sheet
    model_de: float  # the same on the model
    relief_ratio: float  # fine contrast of the ground within the shadow over the true one; NaN if too little is seen
    seam_px: int  # pixels of the ground that are a seam between shadows
    virtual_features: Float  # (n, 7) of crops that show the virtual model, for telling it from the real one
    real_features: Float  # (n, 7) of the same crops of the photo with the real model
    hidden_de: float  # mean colour difference, after a blur, of the covered sheet from the ground without a sheet
    hidden_relief_ratio: float  # fine contrast of what covers the sheet over that of the ground without one


def read_pairs(folder: Path) -> list[Pair]:
    """The pairs in a folder that scenes/pairs.py developed. Raises UserError where it holds none."""
    try:
        record = json.loads((folder / "pairs.json").read_text(encoding="utf-8"))
        return [_pair(folder, entry, record["model"]) for entry in record["pairs"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{folder} holds no pairs ({error})", "make them: assets/sources/README.md says how") from error


def pair_error(ctx: Context, pair: Pair, preset: RenderPreset) -> PairError:
    ours = drawn(ctx, pair.scene, preset)
    where = regions(pair, ours)
    difference = smooth_difference(ours, pair.expected)
    widths = [_border(pair, image) for image in (ours, pair.expected)]
    both = np.isfinite(widths[0]) & np.isfinite(widths[1])
    return PairError(
        mean_where(flip_error(ours, pair.expected), where.changed),
        float(np.median(widths[0][both] / widths[1][both])) if both.any() else math.nan,
        int(both.sum()),
        mean_where(difference, where.shadow & ~pair.is_sheet),
        mean_where(difference, where.shadow & pair.is_sheet),
        mean_where(difference, where.model),
        relief_ratio(ours, pair.expected, eroded(where.shadow & ~pair.is_sheet)),
        seam_pixels(ours, (pair.expected, pair.bare), eroded(where.beside)),
        crop_features(ours, pair.is_model),
        crop_features(pair.expected, pair.is_model),
        *hidden_errors(ctx, pair, preset),
    )


def regions(pair: Pair, ours: Image) -> Regions:
    """The regions for a picture (h, w, 3) of ours and its photo."""
    changed = np.zeros(pair.is_model.shape, bool)
    for image in (ours, pair.expected):
        smooth = [cv2.GaussianBlur(each, (0, 0), 1.0).astype(int) for each in (image, pair.bare)]
        changed |= np.abs(smooth[0] - smooth[1]).max(axis=2) > CHANGED_LEVELS
    beside = ~dilated(pair.is_model)
    return Regions(changed, eroded(pair.is_model), beside, beside & _is_shadow(pair))


def eroded(mask: Mask) -> Mask:
    """(h, w) pixels whose neighbours within BORDER_PX are all in the mask."""
    return ~dilated(~mask)


def dilated(mask: Mask) -> Mask:
    """(h, w) pixels within BORDER_PX of the mask."""
    return cv2.dilate(mask.astype(np.uint8), np.ones((2 * BORDER_PX + 1,) * 2, np.uint8)) > 0


def relief_ratio(ours: Image, expected: Image, where: Mask) -> float:
    """Standard deviation of the logarithm of brightness about its mean around, ours over that of the photo."""
    if where.sum() < LEAST_RELIEF_PX:
        return math.nan
    found, true = (
        float((fine - cv2.GaussianBlur(fine, (0, 0), FINE_PX))[where].std())
        for fine in (np.log(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) + DARKEST_LEVEL) for image in (ours, expected))
    )
    return found / max(true, 1e-6)


def hidden_errors(ctx: Context, pair: Pair, preset: RenderPreset) -> tuple[float, float]:
    """`hidden_de` and `hidden_relief_ratio` of a PairError: the covered sheet compared with ground without a sheet."""
    scene = replace(pair.scene, placement=Placement(scale=TINY), covers_marker=True)
    covered = drawn(ctx, scene, preset)
    return (
        mean_where(smooth_difference(covered, pair.without_sheet, 2.0), pair.is_sheet),
        relief_ratio(covered, pair.without_sheet, eroded(pair.is_sheet)),
    )


def drawn(ctx: Context, scene: Scene, preset: RenderPreset) -> Image:
    assert scene.tracked is not None
    return pictured(SceneRenderer(ctx, preset, scene.tracked.frame.size), scene)


def pictured(renderer: SceneRenderer, scene: Scene) -> Image:
    """The picture (h, w, 3) BGR of a scene; releases the renderer."""
    renderer.render(scene)
    picture = renderer.read_bgr()
    renderer.release()
    return picture


def _is_shadow(pair: Pair) -> Mask:
    """(h, w) where the path tracer's model takes more than half of what the sun gives."""
    (light,) = pair.scene.illumination.lights
    assert light.shadow_rgb_ratio is not None
    ratio = float(np.mean(light.shadow_rgb_ratio))
    with_model, without = (
        cv2.GaussianBlur(LINEAR_FROM_SRGB_8BIT[each].sum(axis=2), (0, 0), 1.0) for each in (pair.expected, pair.bare)
    )
    return np.asarray(with_model < (1 - SEEN_SHADOW * (1 - ratio)) * without)


def _border(pair: Pair, image: Image) -> Float:
    tracked = pair.tracked
    assert pair.scene.model is not None
    points = np.concatenate([part.vertices for part in pair.scene.model.model.parts]).astype(np.float64)
    (light,) = pair.scene.illumination.lights
    places, outward = shadow_border(points, light.to_light_marker, tracked.camera, tracked.pose.T_cam_marker)
    return border_widths(image, places, outward)


def ground_rgb(bare: Image) -> Float:
    """(3,) median of a photo (h, w, 3) BGR, linear."""
    return np.asarray(np.median(LINEAR_FROM_SRGB_8BIT[bare[..., ::-1]].reshape(-1, 3), axis=0))


def _pair(folder: Path, entry: Json, model: str) -> Pair:
    camera, marker = camera_and_marker(entry)
    bare, expected, without_sheet = (
        read_picture(folder / f"{entry['id']}_{version}.jpg") for version in ("bare", "model", "open")
    )
    tracked = TrackedFrame(Frame(bare, 0, 0.0), camera, marker)
    light = Light(
        np.array(entry["to_light"]),
        angular_size_rad=math.radians(entry["angular_diameter_deg"]),
        shadow_rgb_ratio=np.array(entry["shadow_ratio"]),
    )
    sheet = project(camera, marker.T_cam_marker, square_corners(entry["paper_side_m"]))
    is_sheet = np.zeros(bare.shape[:2], np.uint8)
    cv2.fillConvexPoly(is_sheet, np.round(sheet).astype(np.int32), 1)
    is_model = read_picture(folder / f"{entry['id']}_mask.png")[..., 0] > 127
    body = Proxy("hull", np.pad(np.array(entry["body_m"]), ((0, 0), (0, 2))))
    illumination = Illumination((light,), real_object=body, ground_rgb=ground_rgb(bare), seen_in=tracked)
    scene = Scene(tracked, placed_on_marker(load_model(model), marker.side_m), illumination)
    name = f"{entry['id']} ({entry['ground']}, {entry['camera']}, {entry['angular_diameter_deg']:.1f} deg)"
    return Pair(
        name,
        folder / entry["id"],
        scene,
        expected,
        without_sheet,
        is_model,
        is_sheet > 0,
        *(np.array(entry[key]) if key in entry else None for key in ("white_rgb", "sky", "sky_slope")),
    )

"""The steps of an estimate as pictures for the user: its ground model, regions, explanations, fit and residual.

Nothing is computed again: the pictures are drawn from the trace that the estimator recorded.
"""

from dataclasses import dataclass
from operator import itemgetter

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.colours import OBJECT_BGR, PAPER_BGR, SHADOW_BGR, UNEXPLAINED_BGR, UNSEEN_BGR
from ashe_live.drawing.light_rose import light_rose
from ashe_live.drawing.light_text import light_text
from ashe_live.drawing.overlays import draw_outline, tinted, with_body, with_masks
from ashe_live.light.estimators.view_search import Trace
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.pixels.areas import grown, resized
from ashe_live.light.pixels.log_colour import linear_rgb, log_opponent
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import predicted

RIM_PX = 2  # width of the rim of an unlit area, where colours mix
MOST_EXPLANATIONS = 4  # the most that are drawn, the likeliest first
REACH_SHARE = 0.08  # sigma of the Gaussian by which unlit areas are inpainted, as a fraction of the picture's width
WIDEST_PX = 640  # of the pictures


@dataclass(frozen=True, slots=True)
class DebugPicture:
    """One step."""

    title: str
    image_bgr: Image  # (h, w, 3)


def debug_pictures(tracked: TrackedFrame, estimate: LightEstimate, trace: Trace | None = None) -> list[DebugPicture]:
    """The steps of `estimate`, which was made from `tracked`, in their order; those that were not reached are missing.

    trace: of this estimate; without it, only the contents of the estimate itself are drawn. Raises ValueError when the
    frame has no marker.
    """
    if tracked.marker is None:
        raise ValueError("a frame without a marker has no marker frame to answer in")
    view = View.of(tracked, WIDEST_PX)
    photo, camera, T_cam_marker = view.image_bgr, view.camera, view.T_cam_marker
    pictures = [DebugPicture("photo", photo), *([] if trace is None else traced_pictures(view, trace))]
    if estimate.object_mask is not None or estimate.shadow_mask is not None:
        pictures.append(DebugPicture("object and shadow", with_masks(photo, estimate)))
        pictures.append(DebugPicture("their outlines and hulls", _with_hulls(photo, estimate)))
    if (body := estimate.illumination.real_object) is not None:
        fitted = with_body(photo, camera, T_cam_marker, body, estimate.lights)
        pictures.append(DebugPicture(f"fitted {body.family} and its shadow", fitted))
        rest = _with_residual(photo, view, estimate, body)
        pictures.append(DebugPicture("red: not explained, green: not seen", rest))
    rose = light_rose(estimate.lights, min(photo.shape[:2]), camera_centre(T_cam_marker))
    summary = "; ".join(light_text(light) for light in estimate.lights) or f"none: {estimate.reason}"
    pictures.append(DebugPicture(summary, centred(rose, photo.shape)))
    return pictures


def traced_pictures(view: View, trace: Trace) -> list[DebugPicture]:
    """The estimator's model of the ground, its regions, and the likeliest explanations with their probabilities.

    `view` is of the frame that `trace` is of, at the size to draw at; the ground has the trace's own. Without a ground
    the list is empty.
    """
    ground, unlit, coarse = trace.ground, trace.unlit, trace.view
    if ground is None or unlit is None:
        return []
    lit = lit_ground_rgb(coarse.image_bgr, ground, coarse.is_ground & ~grown(unlit, RIM_PX))
    ratio = LINEAR_FROM_SRGB_8BIT[coarse.image_bgr[:, :, ::-1]] / lit
    pictures = [DebugPicture("lit ground", _encoded(lit)), DebugPicture("ratio to lit ground", _encoded(ratio))]
    marked = view.image_bgr
    for region in trace.regions:
        marked = tinted(marked, resized(region.in_frame(region.unlit), marked.shape[1::-1]), UNEXPLAINED_BGR)
    pictures.append(DebugPicture(f"regions {len(trace.regions)}, splits fitted {len(trace.proposals)}", marked))
    if trace.judged:
        likely = sorted(zip(trace.probabilities, trace.judged, strict=True), key=itemgetter(0))[-MOST_EXPLANATIONS:]
        overlaid = view.image_bgr
        for _, each in likely:  # the likeliest on top
            lights = [Light(light.to_light_marker) for light in each.lights]
            overlaid = with_body(overlaid, view.camera, view.T_cam_marker, each.proxy, lights)
        odds = ", ".join(f"{100 * probability:.0f} %" for probability, _ in likely[::-1])
        pictures.append(DebugPicture(f"explanations: {odds}", overlaid))
    return pictures


def lit_ground_rgb(image_bgr: Image, ground: LitGround, is_lit_ground: Mask) -> Float:
    """(h, w, 3) linear RGB of the ground without objects and shadows, inpainted from its lit pixels.

    is_lit_ground: (h, w). Pixels outside of it get a Gaussian mean of the lit colours around, with the slow shading.
    """
    is_lit = is_lit_ground.astype(np.float32)[:, :, None]
    reach = (0, 0), REACH_SHARE * image_bgr.shape[1]
    blurred = cv2.GaussianBlur(np.concatenate([ground.colours * is_lit, is_lit], axis=2), *reach)
    around = blurred[:, :, :3] / np.maximum(blurred[:, :, 3:], 1e-6)
    field = log_opponent(image_bgr) - ground.colours
    return np.maximum(linear_rgb(np.where(is_lit > 0, ground.colours, around) + field), 1e-4)


def centred(picture_bgr: Image, shape: tuple[int, ...]) -> Image:
    """The picture in the middle of a dark sheet of `shape`, so that the pictures of all steps have one size."""
    sheet = np.full(shape, PAPER_BGR, np.uint8)
    height, width = picture_bgr.shape[:2]
    top, left = (shape[0] - height) // 2, (shape[1] - width) // 2
    sheet[top : top + height, left : left + width] = picture_bgr
    return sheet


def _with_hulls(picture_bgr: Image, estimate: LightEstimate) -> Image:
    picture = picture_bgr.copy()
    for mask, colour in ((estimate.shadow_mask, SHADOW_BGR), (estimate.object_mask, OBJECT_BGR)):
        if mask is not None and mask.any():
            inside = resized(mask, picture.shape[1::-1]).astype(np.uint8)
            contours, _ = cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
            cv2.drawContours(picture, contours, -1, colour, 1)
            draw_outline(picture, cv2.convexHull(np.concatenate(contours))[:, 0].astype(np.float64), colour)
    return picture


def _with_residual(photo: Image, view: View, estimate: LightEstimate, body: Proxy) -> Image:
    """The photo, tinted where masks extend beyond the fitted silhouettes, and where these extend beyond the masks."""
    lights = np.array([light.homogeneous for light in estimate.lights]).reshape(-1, 4)
    fitted = predicted(body, lights, view).whole
    masked = np.zeros(photo.shape[:2], np.bool_)
    for mask in (estimate.object_mask, estimate.shadow_mask):
        if mask is not None:
            masked |= resized(mask, photo.shape[1::-1])
    return tinted(tinted(photo, masked & ~fitted, UNEXPLAINED_BGR), fitted & ~masked & view.is_ground, UNSEEN_BGR)


def _encoded(linear: Float) -> Image:
    """(h, w, 3) sRGB BGR of linear RGB."""
    return np.ascontiguousarray((255 * srgb_from_linear(np.clip(linear, 0, 1)) + 0.5).astype(np.uint8)[:, :, ::-1])

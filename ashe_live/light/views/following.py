"""Following: a known body's light, verified and followed in a single frame by alignment alone."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.alignment import SEARCH_RANGES, Alignment, Start, aligned
from ashe_live.light.explanation.judgement.hidden_sky import depths_beyond_sky, is_of_sky_alone
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.lit_ground import fit_lit_ground
from ashe_live.light.ground.preset import COARSE
from ashe_live.light.ground.shadow_shift import shift_of_ratio
from ashe_live.light.pixels.log_colour import DARKEST
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import Body, BodyFrame, LitBody
from ashe_live.light.shape.family import Family, Parts
from ashe_live.light.shape.sight import Sight
from ashe_live.light.views.costs_around import costs_around
from ashe_live.light.views.ground_height import seen_from_ground, seen_from_marker

WIDTH_PX, FINE_WIDTH_PX, REGION_PX = 160, 480, 90  # widths of the frame for its ground and for the region; its size
RANGES = SEARCH_RANGES[0], SEARCH_RANGES[-1]  # two parameters a light need no more rounds than a far one and a near one
# A light is followed down to this mean clarity of the borders of body and shadow, and up to this misfit over the
# object's size.
LEAST_CLARITY, MOST_MISFIT = 0.3, 0.06
# Of a shadow's depth, what is left of it once its light is out: none, but for noise. Where another light comes on
# beside it, a third and more is left.
LEFT_SHARE = 0.15
# Mean clarity of the borders of a body that still stands there, however well it fits: where it has gone, 0.03.
STANDS_CLARITY = 0.12


def follow(estimate: LightEstimate, tracked: TrackedFrame) -> LightEstimate | None:
    """The light of `estimate` as the frame `tracked` shows it; None where that does not show the body and its shadows.

    The body stays as it is; the lights move until the shadows lie on their borders in the picture, lamps at their
    height. Their uncertainty comes mostly from the body, and stays as well. An estimate without a light or a body, or a
    frame without a marker, gives None; so does a body that the marker is printed on, whose borders are not looked for.
    The masks are left out. A body that stands below the marker's plane stands on its own.
    """
    body = estimate.illumination.real_object
    if tracked.marker is None or tracked.marker.body is not None or body is None or not estimate.lights:
        return None
    height_m = max(-_lowest(body), 0.0)
    by_ground = seen_from_marker(estimate.illumination, -height_m)
    found = _followed(replace(estimate, illumination=by_ground), seen_from_ground(tracked, height_m))
    return found and replace(found, illumination=seen_from_marker(found.illumination, height_m))


def has_lost_shadows(estimate: LightEstimate, tracked: TrackedFrame) -> bool:
    """Whether the frame `tracked` shows that the lights of `estimate` are out, or behind a cloud: its body still stands
    there, and ground in its shadows is as bright as other ground that sees as much sky. False where that is not seen.
    """
    body, all_ratios = estimate.illumination.real_object, [light.shadow_rgb_ratio for light in estimate.lights]
    ratios = [ratio for ratio in all_ratios if ratio is not None]
    if tracked.marker is None or body is None or not ratios or len(ratios) < len(all_ratios):
        return False
    height_m = max(-_lowest(body), 0.0)
    by_ground = seen_from_marker(estimate.illumination, -height_m)
    lights, body = by_ground.lights, by_ground.real_object
    assert body is not None
    fine = View.of(seen_from_ground(tracked, height_m), FINE_WIDTH_PX).with_paper_as_ground()
    if tracked.marker.body is None:  # on which the marker is, and where its borders are not looked for
        found = _aligned(lights, body, fine, tracked.frame.index)
        if found is None or found.clear_body < STANDS_CLARITY:
            return False
    depths = depths_beyond_sky(fine, body, np.array([light.homogeneous for light in lights]))
    seeming = [-float(np.log(np.maximum(ratio, DARKEST)).mean()) for ratio in ratios]
    return is_of_sky_alone(depths, seeming, LEFT_SHARE)


def _followed(estimate: LightEstimate, tracked: TrackedFrame) -> LightEstimate | None:
    """As `follow`, of a body that stands on the plane z = 0."""
    lights, body, index = estimate.lights, estimate.illumination.real_object, tracked.frame.index
    assert body is not None
    found = _aligned(lights, body, View.of(tracked, FINE_WIDTH_PX).with_paper_as_ground(), index)
    if found is None or not _is_clear(found):
        return None
    moved = [_moved(light, now) for light, now in zip(lights, found.placed.lit.lights, strict=True)]
    illumination = replace(estimate.illumination, lights=tuple(moved))
    return LightEstimate(
        estimate.estimator, index, illumination, None, views=(index, *estimate.views[1:]), span_rad=estimate.span_rad
    )


def _aligned(lights: Sequence[Light], body: Proxy, fine: View, index: int) -> Alignment | None:
    """The lights moved to where the shadows of a body on the plane lie in `fine`; None where that is not seen."""
    coarse = fine.scaled(WIDTH_PX)
    ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, COARSE)  # a known body needs little of it
    ratios = [light.shadow_rgb_ratio for light in lights]
    if ground is None or any(ratio is None for ratio in ratios):
        return None
    lit = LitBody(_given(body), np.array([light.homogeneous for light in lights]))
    shifts = [shift_of_ratio(ground, ratio) for ratio in ratios if ratio is not None]
    costs = costs_around(lit, shifts, SceneView(index, fine, coarse, ground), REGION_PX)
    if costs is None:
        return None
    (found,) = aligned([Start([lit], Sight.of(costs.region.view), costs)], RANGES)
    return found


def _moved(light: Light, now: Float) -> Light:
    """The light in the place to which its shadow leads, a homogeneous point (4,): a lamp stays at its height.

    From there it gives the marker's centre the less the farther it is, with the third power: by Lambert's cosine, too.
    """
    moved = light.elsewhere(now[:3], float(now[3] / np.linalg.norm(now[:3])))
    if light.intensity_rgb_ratio is None or light.inverse_distance == 0:
        return moved
    nearer = moved.inverse_distance / light.inverse_distance
    return replace(moved, intensity_rgb_ratio=light.intensity_rgb_ratio * nearer**3)


def _is_clear(found: Alignment) -> bool:
    clear = min(found.clear_body, *found.clear_shadows)
    return clear >= LEAST_CLARITY and found.misfit_px <= MOST_MISFIT * found.placed.object_px


def _lowest(proxy: Proxy) -> float:
    """The z of its lowest point, metres."""
    return float((proxy.spheroids_marker[:, 2] - proxy.spheroids_marker[:, 4]).min())


def _given(proxy: Proxy) -> Body:
    """The proxy as the only member of a family without parameters."""
    spheroids, foot = proxy.spheroids_marker, proxy.foot_marker[:2]
    size_m = float(np.ptp(spheroids[:, :3], axis=0).max() + 2 * spheroids[:, 3:].max())
    frame = BodyFrame(foot, max(size_m, np.finfo(np.float64).tiny))
    within = np.array(spheroids)
    within[:, :2] -= foot
    within /= frame.unit_m

    def parts(shapes: Float) -> Parts:
        return np.repeat(within[None], len(shapes), axis=0), np.zeros((len(shapes), *within.shape, 0))

    return Body(frame, Family(proxy.family, None, parts, lambda shape: shape[None], ()), np.empty(0))

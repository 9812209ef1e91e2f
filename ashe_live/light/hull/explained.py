"""An explanation of several views by the hull of the object's silhouettes, where no family explains these.

It stands for what families make of the same object and shadow.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Mask, directions_on_spiral
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.transforms import view_direction
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.hull.carved import Box, Carved, InLight, carved
from ashe_live.light.hull.labelled import labelled
from ashe_live.light.hull.light import HullLight, light_of_hull
from ashe_live.light.hull.surface import surface_of
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.joint.log_odds import share_seen
from ashe_live.light.views.joint.repeated import show_the_same
from ashe_live.light.views.selection import span_rad

# From a narrower span a hull is several times as deep as its object is broad, and bounds no light.
LEAST_SPAN_RAD = np.radians(15.0)
LEAST_SEEN = 0.9  # of body and shadow, in the mean view: a silhouette that is cut carves nothing beyond the cut
# Cost, over that with the hull, that a family leaves unexplained for each pixel of the body. A pixel with a wrong label
# costs ten: that of a twentieth of the body's pixels.
LEAST_GAIN = 0.5
# A hull that explains less than this share of what the family leaves is no better: labels are wrong, or poses of views
# contradict each other.
LEAST_SHARE = 0.4
WIDENED = 0.35  # the box of voxels over the fitted body's
CORNERS = 64  # directions in which a hull's farthest points stand for its convex hull


def with_hull(explanation: JointExplanation, sharpener: Sharpener) -> JointExplanation:
    """The explanation with the hull as its real object, and the light whose shadow that casts.

    As it is where a family explains the silhouettes as well, where there are two lights or a lamp, where the views are
    too near to each other or show too little of body and shadow, and where the hull determines no light. sharpener: of
    all views at full resolution.
    """
    joint = explanation.joint
    span = span_rad([view_direction(each.region.view.T_cam_marker) for each in explanation.each])
    is_sun = len(joint.lights) == 1 and not joint.lights[0].is_lamp
    seen = np.mean([share_seen(each) for each in explanation.each])
    if not is_sun or span < LEAST_SPAN_RAD or seen < LEAST_SEEN:
        return explanation
    start = joint.lights[0].to_light_marker
    # Where a family's body misses parts of the object, their colours are those of what else is unlit around.
    for samples in (
        [each.predicted.body for each in explanation.each],
        [each.predicted.whole for each in explanation.each],
    ):
        hull = _hull_of(explanation, samples, sharpener)
        if not explains_more(explanation, hull, hull.in_light(start)):
            break
        found = light_of_hull(hull, start)
        if found is not None:
            return replace(explanation, joint=_hulled(joint, hull, found))
    return explanation


def without_replaced(several: Sequence[tuple[JointExplanation, float]]) -> list[tuple[JointExplanation, float]]:
    """Explanations with their log odds, without those by families of an object and shadow that another's hull explains.

    A hull stands where no family explains the silhouettes. What families make of the same silhouettes, with lights
    degrees apart, is no other answer: it would take probability from the hull's, and may outweigh it together.
    """
    hulls = [each for each, _ in several if each.joint.hull is not None]
    return [
        (each, odds)
        for each, odds in several
        if each.joint.hull is not None
        or len(each.joint.lights) > 1
        or not any(show_the_same(hull, each) for hull in hulls)
    ]


def _hull_of(explanation: JointExplanation, samples: Sequence[Mask], sharpener: Sharpener) -> Carved:
    """The voxels that the silhouettes allow; samples: (h, w) of each view, where the object's colours are learned."""
    views = labelled([each.costs for each in explanation.each], samples, sharpener.pictures)
    return carved(views, Box.around(explanation.joint.proxy.points_marker(), WIDENED))


def explains_more(explanation: JointExplanation, hull: Carved, seen: InLight) -> bool:
    """Whether the hull explains enough of what the family leaves unexplained."""
    pairs = list(zip(hull.views, (each.predicted for each in explanation.each), strict=True))
    body_px = sum(int(np.count_nonzero(masks.body)) for _, masks in pairs)
    by_family = sum(view.cost(masks.body, masks.shadow) for view, masks in pairs)
    return by_family - seen.cost > max(LEAST_GAIN * max(body_px, 1), LEAST_SHARE * by_family)


def _hulled(joint: Explanation, hull: Carved, found: HullLight) -> Explanation:
    """The explanation with a hull, its light, and its silhouettes as labels."""
    light = FittedLight(np.append(found.to_light_marker, 0.0), found.covariance_rad2)
    masks, ground = found.seen.masks[0], joint.region.is_ground
    split = replace(
        joint.split, object_mask=masks.body & ground, shadow_mask=masks.shadow & ground, undecided=None, parts=()
    )
    return replace(joint, lights=(light,), split=split, hull=_proxy_of(hull, found.seen))


def _proxy_of(hull: Carved, seen: InLight) -> Proxy | None:
    """The voxels that are left in a light as a proxy: their surface, and points that have the same convex hull."""
    occupied = np.zeros(np.prod(hull.box.shape), np.bool_)
    occupied[hull.flat[seen.kept]] = True
    points, triangles = surface_of(occupied.reshape(hull.box.shape), hull.box.low, hull.box.voxel_m)
    if not len(points):
        return None
    farthest = np.unique((points @ directions_on_spiral(CORNERS).T).argmax(axis=0))
    corners = np.column_stack([points[farthest], np.zeros((len(farthest), 2))])
    return Proxy("silhouettes", corners, ProxyMesh(points, triangles))

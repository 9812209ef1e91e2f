"""A view's pixels as a hull needs them: what each costs as lit ground, shadow and object, and where its ray ends."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import OTHER_GROUND, object_cost
from ashe_live.light.pixels.areas import grown, majority, shrunk
from ashe_live.light.pixels.view import plane_homography

MOST_COST = 10.0  # of a pixel over its cheapest label: a colour model that is wrong is wrong by any amount
SURE = 2.0  # cost by which a label must be dearer than another to be refuted
RIM_SURE = 3 * SURE  # in the rim of a shadow, where colours are mixed
BEYOND = 20.0  # cost over shadow's of taking for the object what all views show as shadow on the plane
# A colour fits shadowed ground where its cost is below FITS, and so is LIT_FACTOR times what it costs more than as lit
# ground; it does not fit the object better where that costs no more than BETTER less.
FITS, LIT_FACTOR, BETTER = 0.0, 4.0, 4.0
HALO_PX = 2  # beside an object, where cameras that take noise from colours smear its own over the ground
LEAST_INSIDE = 0.3  # of an object, in which its colours are learned; one that has less is thin
FEW_VIEWS = 4  # among more, one may show something else at a place in shadow: what hides it


@dataclass(frozen=True, slots=True, eq=False)
class Labelled:
    """One view; costs are over the cheapest label's, at most MOST_COST, and 0 off the ground."""

    P: Float  # (3, 4) projection from the marker frame to pixels
    as_lit: Float32  # (h, w)
    as_shadow: Float32  # (h, w)
    as_body: Float32  # (h, w)
    never_body: Mask  # (h, w) where the object's colours are refuted
    surely_lit: Mask  # (h, w)
    frame_px: tuple[float, float, float, float]  # left, top, right, bottom of the whole frame, in the region's pixels
    unreliable: Mask  # (h, w) off the ground, and beside that
    plane_xy: Float  # (h, w, 2) metres, marker frame: where the pixel's ray meets the plane
    focal_px: float
    picture: LightPicture  # at full resolution
    picture_from_region: Float  # (3, 3) pixels
    shift: float  # log of how much darker the ground is in the shadow; negative

    def cost(self, body: Mask, shadow: Mask) -> float:
        """The total cost of the pixels with the object in `body` (h, w), and else in `shadow` (h, w) or lit."""
        return float(np.where(body, self.as_body, np.where(shadow, self.as_shadow, self.as_lit)).sum())


def labelled(several: Sequence[Costs], samples: Sequence[Mask], pictures: Sequence[LightPicture]) -> list[Labelled]:
    """The views of `several` costs, by one light; what all show as shadow on the plane is no object in any of them.

    samples: (h, w) where the object is in each view, about. A family's silhouette covers ground where the object is
    hollow, so that its colours are learned anew from what is neither lit ground nor shadow on the plane. pictures: of
    the whole frames, in any order.
    """
    found = []
    for costs, sample, shadow in zip(several, samples, shadows_on_plane(several), strict=True):
        view = costs.region.view
        picture = next(each for each in pictures if each.view.shows(view.measured))
        unlit = sample & (costs.materials.lit > OTHER_GROUND) & ~grown(shadow, HALO_PX)
        inside = shrunk(unlit, HALO_PX)
        if np.count_nonzero(inside) < LEAST_INSIDE * np.count_nonzero(unlit):
            inside = unlit
        learned = object_cost(costs.region, inside, costs.materials)
        found.append(_labelled(replace(costs, as_object=learned), shadow, picture))
    return found


def shadows_on_plane(several: Sequence[Costs]) -> list[Mask]:
    """(h, w) each view's pixels that lie on the plane in shadow: where every view shows a colour of shadowed ground.

    A dark side of the object looks like shadow too, but another view shows lit ground, or the object's bright side, at
    the place of the plane that it hides.
    """
    fits = [
        np.maximum(costs.materials.contact, LIT_FACTOR * (costs.materials.contact - costs.materials.lit))
        for costs in several
    ]
    allowed = 1 if len(several) > FEW_VIEWS else 0
    found = []
    for costs in several:
        view = costs.region.view
        against = np.zeros(costs.as_object.shape, np.uint8)
        for other, cost in zip(several, fits, strict=True):
            theirs = cv2.warpPerspective(
                cost,
                plane_homography(view, other.region.view),
                view.size,
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=-1e3,  # a place out of view is in no doubt
            )
            against += np.asarray(theirs) >= FITS
        shadow = (against <= allowed) & (costs.materials.contact < costs.as_object + BETTER)
        found.append(majority(shadow & costs.region.is_ground))
    return found


def _labelled(costs: Costs, shadow: Mask, picture: LightPicture) -> Labelled:
    region, lit, shaded = costs.region, costs.materials.lit, costs.materials.contact
    rim = grown(shadow, 1) & (costs.as_object > np.minimum(lit, shaded) - RIM_SURE)
    body = np.where(shadow | rim, shaded + BEYOND, costs.as_object)
    cheapest = np.minimum(np.minimum(lit, shaded), body)
    as_lit, as_shadow, as_body = (
        np.where(region.is_ground, np.minimum(cost - cheapest, MOST_COST), 0).astype(np.float32)
        for cost in (lit, shaded, body)
    )
    view, top, left = region.view, *(part.start or 0 for part in region.window)
    P = np.asarray(view.camera.K @ view.T_cam_marker[:3])
    return Labelled(
        P=P,
        as_lit=as_lit,
        as_shadow=as_shadow,
        as_body=as_body,
        never_body=(body > np.minimum(lit, shaded) + SURE) & region.is_ground,
        surely_lit=(lit < np.minimum(body, shaded) - SURE) & region.is_ground,
        frame_px=(-left, -top, region.frame_shape[1] - 1 - left, region.frame_shape[0] - 1 - top),
        unreliable=region.unreliable,
        plane_xy=_plane_xy(P, lit.shape),
        focal_px=float(view.camera.K[0, 0]),
        picture=picture,
        picture_from_region=np.asarray(picture.view.camera.K @ np.linalg.inv(view.camera.K)),
        shift=float(costs.materials.shift[0]),
    )


def _plane_xy(P: Float, shape: tuple[int, ...]) -> Float:
    """(h, w, 2) the places on the plane that pixels show."""
    v, u = np.mgrid[: shape[0], : shape[1]]
    places = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(P[:, [0, 1, 3]]).T
    return np.asarray(places[..., :2] / np.where(np.abs(places[..., 2:]) < 1e-12, 1e-12, places[..., 2:]))

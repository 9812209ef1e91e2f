"""A light that was found, and how much of the table's light it gives: what its shadow lacks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Mask, upper_quantile, without
from ashe_live.core.transforms import normalised, raycast_to_plane
from ashe_live.light.known_body.outline.edges import ShadowEdges
from ashe_live.light.known_body.outline.fit import FEWEST, ShadowFit
from ashe_live.light.known_body.outline.profiles import EdgeImage, EdgeImages
from ashe_live.light.known_body.outline.room import Outline, Room
from ashe_live.light.known_body.pictures.photo import Photo
from ashe_live.light.known_body.rims import Rims
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.sides.shading import fall_off
from ashe_live.light.known_body.table import CELLS_A_HEIGHT, height_px
from ashe_live.light.shape.directions import FittedLight, fitted_lights
from ashe_live.light.shape.predicted import predicted

# How far a shadow's edge is from where it is dark, and from where it is lit: pixels, plus standard deviations of the
# penumbra.
BEYOND_PX, BEYOND_PENUMBRA = 3.0, 2.2
SOFT_RAD = math.radians(10)  # diameter of the softest sun whose shadow's middle is located
LEAST_WITHIN = 0.9  # of that distance, how far what counts as dark is from all other edges of the shadow
LEAST_LEFT = 0.2  # least part of a lamp's height that is above the body
# How far around another light's edges the table is not clear: pixels, plus standard deviations of their penumbra.
OTHER_EDGE_PX, OTHER_PENUMBRA = 3.0, 2.0


@dataclass(frozen=True, slots=True, eq=False)
class FoundLight:
    """A light of a known body."""

    light: Float  # (4,) homogeneous, marker frame
    covariance: Float  # (p, p) of s = (x, y) / z, and of the nearness w / z where that is determined
    fit: ShadowFit | None  # to its shadow's edges; None where they are hidden: its direction is by map and sides alone
    darkening: float  # part of the table's light that it gives
    confidence: float = 0.0  # probability that it is within NEAR_RAD of a true light; 0 until it is computed
    around: float = 0.0  # that it is within twice as much, where there surely is a light
    may_be_lamp: bool = False  # whether it is likelier a lamp, of uncertain distance, than a sun
    has_folds: bool = False  # whether the covariance has in it how the body and its frame may be off
    exists: float | None = None  # probability that there is such a light; None until it is computed

    @property
    def size_rad(self) -> float:
        """The light's angular diameter; 0 where it is not distinguishable from a point."""
        return 0.0 if self.fit is None else self.fit.size_rad or 0.0

    @property
    def is_lamp(self) -> bool:
        """Whether its distance is known."""
        return bool(self.light[3] > 0)

    @property
    def casting(self) -> Float:
        """(4,) the light whose shadow lies on the edges.

        It differs from the one that is stated where the body is folded badly, or the light may be a lamp.
        """
        return self.light if self.fit is None else self.fit.light

    def sun_alike(self, height: float) -> Float:
        """(3,) the direction of the sun in which the shadow of a body of some height ends where it does in this light.

        It is the best match among suns; a low lamp itself stands higher by several degrees.
        """
        x, y, z, w = self.casting
        left = max(1 - height * float(w / z), LEAST_LEFT)
        return normalised(np.array((x, y, z * left)))

    @property
    def fitted(self) -> FittedLight:
        """Its direction with its covariance."""
        return fitted_lights(self.light[None], self.covariance[:2, :2])[0]


def masks_of(seen: Seen, found: Sequence[FoundLight]) -> tuple[Mask, Mask]:
    """(h, w) of the first picture each: the body, and its shadows."""
    silhouettes = predicted(seen.body, points_of(found), seen.photos[0].view)
    return silhouettes.body, silhouettes.shadow


def points_of(found: Sequence[FoundLight]) -> Float:
    """(l, 4) the points that cast the lights' shadows."""
    return np.array([each.casting for each in found]).reshape(-1, 4)


def images_beside(seen: Seen, others: Sequence[FoundLight]) -> EdgeImages:
    """The pictures for a look at a light's edges, without what lies near those of other lights' shadows."""
    return EdgeImages(tuple(_image_beside(photo, others) for photo in seen.photos)) if others else seen.edge_images


def _image_beside(photo: Photo, others: Sequence[FoundLight]) -> EdgeImage:
    room = photo.room
    for other in others:
        edges = photo.shadow_edges(other.casting)
        if edges is not None:
            penumbra_px = other.size_rad * upper_quantile(edges.by_size, 0.9)
            broad_px = OTHER_EDGE_PX + OTHER_PENUMBRA * penumbra_px
            room = room.beside_shadow(edges.corners_px, broad_px, other.darkening)
    return photo.edge_image if room is photo.room else replace(photo.edge_image, room=room)


def darkenings_rgb(seen: Seen, found: Sequence[FoundLight], least_size_rad: float = 0.0) -> Float:
    """(l, 3) part of the table's light, R, G, B, that each light gives: by how dark its shadow is beside its edges.

    By map and sides where too little of a shadow's edges is seen. least_size_rad: the penumbra of a light of at least
    this diameter is left out, as it may be wider than was measured, if the shadow is broad enough.
    """
    steps = [_step_rgb(seen.showing(one.casting), one, without(found, [one]), least_size_rad) for one in found]
    if all(step is not None for step in steps):
        return np.array(steps)
    overall = seen.darkenings_rgb(points_of(found))
    return np.array([by_all if step is None else step for step, by_all in zip(steps, overall, strict=True)])


def hidden_step(seen: Seen, one: FoundLight) -> float:
    """How much more of the sky the body hides where a light's shadow is found dark than where it is found lit."""
    photo = seen.showing(one.casting)
    edges = photo.shadow_edges(one.casting)
    if edges is None:
        return 0.0
    away_px = BEYOND_PX + BEYOND_PENUMBRA * one.size_rad * float(np.median(edges.by_size))
    cell_px = height_px(seen.body, photo.view) / CELLS_A_HEIGHT
    rim = Rims.of(seen.body, one.casting[None], seen.templates.hidden_sky)
    return rim.hidden_step(seen.is_table) * min(away_px / (float(rim.cells_away[0]) * cell_px), 1.0)


def _step_rgb(photo: Photo, one: FoundLight, others: Sequence[FoundLight], least_size_rad: float) -> Float | None:
    """(3,) R, G, B: the light that is lost across the shadow's edges, over that beyond them; None where few are seen.

    others: lights whose shadows are not lit. least_size_rad: as by `darkenings_rgb`.
    """
    own = photo.shadow_edges(one.casting)
    if one.fit is None or own is None:
        return None
    room = photo.room
    for other in others:
        edges = photo.shadow_edges(other.casting)
        room = room if edges is None else room.outside(edges.corners_px)
    kept, ends = _both_sides(own, room, max(one.size_rad, least_size_rad))
    if least_size_rad > one.size_rad:
        away = _beyond_px(own, least_size_rad)
        kept &= Outline.of(own.corners_px).distances(ends[0]) < -LEAST_WITHIN * away
        if np.count_nonzero(kept) < FEWEST:  # the shadow is not as broad as that
            kept, ends = _both_sides(own, room, one.size_rad)
    if np.count_nonzero(kept) < FEWEST:
        return None
    columns, rows = np.moveaxis(np.round(ends[:, kept]).astype(int), 2, 0)
    dark, bright = photo.picture[rows, columns].astype(np.float64)[..., ::-1]
    # What the light gives at each place, over what else lights it; a lamp's light falls off from the marker's centre.
    given = np.maximum(bright / np.maximum(dark, 1e-4) - 1, 0.0)
    if one.is_lamp:
        x, y, _ = raycast_to_plane(photo.view.camera, photo.view.T_cam_marker, own.points_px[kept]).T
        given = given / np.maximum(fall_off(one.light, x, y), 1e-3)[:, None]
    at_centre = np.median(given, axis=0)
    return np.asarray(at_centre / (1 + at_centre))


def _beyond_px(own: ShadowEdges, size_rad: float) -> Float:
    """(n,) pixels from the points of a shadow's edges, in a light of that diameter, to where all is dark or lit."""
    return np.asarray(BEYOND_PX + BEYOND_PENUMBRA * size_rad * own.by_size)


def _both_sides(own: ShadowEdges, room: Room, size_rad: float) -> tuple[Mask, Float]:
    """(n,) whether the table is seen on both sides of a shadow's edges, and (2, n, 2) pixels there: inside, outside."""
    away = _beyond_px(own, size_rad)
    ends = np.array([own.points_px + sign * away[:, None] * own.normals_px for sign in (-1, 1)])
    is_seen = np.asarray((room.around(ends.reshape(-1, 2)) > 0).reshape(2, -1).all(axis=0))
    return is_seen, ends

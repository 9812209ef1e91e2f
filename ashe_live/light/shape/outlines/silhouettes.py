"""Observations from masks: bounds on the support functions of the object's and its shadows' complete outlines."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask, unit_circle
from ashe_live.light.shape.outlines.contours import Contour, are_beside, contour_of, truncation_mask, values_at

EDGE_SIGMA_PX = 0.7  # standard deviation of edges of masks from the truth
# A shadow's outline this near to the object may continue behind it: edges that are off may leave a gap between them.
CONTACT_PX, CONTACT_SHARE, CONTACT_SIGMAS = 2.0, 0.03, 3.0
# Points whose reach is within this of the farthest may be the true end of the outline.
TIE_PX = 0.5
LEAST_SEEN_OF_BODY, LEAST_SEEN_OF_SHADOW = 6, 1  # directions
# A straight edge of this length, in units of the object's size, counts as measured even if its ends are cut or hidden.
LONG_EDGE, STRAIGHT_PX = 0.3, 0.75
TRIED_EDGES, EDGES = 4, 2  # of an outline, the longest: that are looked at, and that count as measured


@dataclass(frozen=True, slots=True)
class Silhouette:
    """A convex hull, and which of its corners may be artefacts of truncation."""

    hull_px: Float  # (m, 2) corners about the common centre
    certain: Mask  # (m,) whether the outline truly ends at this corner


@dataclass(frozen=True, slots=True)
class Outlines:
    """The silhouettes of an object and of its l shadows, with bounds on their support functions.

    Rows of the bounds: the object, its shadows, and the union of all. The two bounds are equal where an outline was
    measured, and differ where it is hidden (it may extend behind the object) or cut (it may extend infinitely far). The
    union is measured only where it is ambiguous which of them reaches farthest.
    """

    directions: Float  # (d, 2) unit vectors in the image
    centre_px: Float  # (2,) of the object, the origin of all that follows
    size_px: float  # square root of the object's area
    body: Silhouette
    shadows: tuple[Silhouette, ...]
    least_px: Float  # (2 + l, d) lower bounds of the reach along each direction
    most_px: Float  # (2 + l, d) upper bounds

    @property
    def seen(self) -> Mask:
        """(2 + l, d) where an outline was measured, not only bounded."""
        return np.asarray(self.least_px == self.most_px)


def observe_outlines(
    body: Mask,
    shadows: Sequence[Mask],
    unreliable: Mask | None,
    direction_count: int,
    undecided: Mask | None = None,
) -> Outlines | None:
    """Silhouettes from masks (h, w), with what they leave open; None where too little of an outline can be seen.

    shadows: one mask for each light. unreliable: (h, w) pixels without information, such as the marker's or other
    objects'. direction_count: evenly spaced directions; the normals of long straight edges are added. undecided: (h, w)
    pixels that belong to the object or to a shadow, without it being known to which. The method is in docs/maths, "What
    masks bound".
    """
    body_contour = contour_of(body)
    shadow_contours = [contour for contour in map(contour_of, shadows) if contour is not None]
    if body_contour is None or len(shadow_contours) < len(shadows):
        return None
    whole_contour, open_to_each = None, unreliable
    if undecided is not None and undecided.any():
        whole_contour = contour_of(np.logical_or.reduce([body, undecided, *shadows]))
        open_to_each = undecided if unreliable is None else unreliable | undecided
    size = math.sqrt(max(cv2.contourArea(body_contour.hull_px.astype(np.float32)), 1.0))
    centre = 0.5 * (body_contour.hull_px.min(axis=0) + body_contour.hull_px.max(axis=0))
    margin = max(CONTACT_PX, CONTACT_SHARE * size) + CONTACT_SIGMAS * EDGE_SIGMA_PX

    # The object, and each of its shadows by itself.
    doubt = _Doubt(truncation_mask(body.shape, open_to_each), body_contour, margin)
    directions, owner = _directions(direction_count, body_contour, shadow_contours, doubt, size)
    of_body = _body_bounds(doubt, directions, owner, centre)
    of_shadows = [
        _shadow_bounds(contour, doubt, directions, owner == number, centre, of_body.most_px)
        for number, contour in enumerate(shadow_contours, start=2)
    ]
    least = np.stack([one.least_px for one in (of_body, *of_shadows)])
    most = np.stack([one.most_px for one in (of_body, *of_shadows)])

    # The union of all, which what is undecided among them leaves known.
    least_of_whole, most_of_whole = np.full(len(directions), -np.inf), np.full(len(directions), np.inf)
    if whole_contour is not None:
        cut = values_at(whole_contour.hull_px, truncation_mask(body.shape, unreliable))
        points = whole_contour.hull_px - centre
        least_of_whole, most_of_whole = _bounds_of_whole(points, cut, directions, least, most)

    outlines = Outlines(
        directions=directions,
        centre_px=centre,
        size_px=size,
        body=of_body.silhouette,
        shadows=tuple(one.silhouette for one in of_shadows),
        least_px=np.vstack([least, least_of_whole]),
        most_px=np.vstack([most, most_of_whole]),
    )
    seen = outlines.seen.sum(axis=1)
    is_enough = seen[0] + seen[-1] >= LEAST_SEEN_OF_BODY and (seen[1:-1] + seen[-1]).min() >= LEAST_SEEN_OF_SHADOW
    return outlines if is_enough else None


@dataclass(frozen=True, slots=True, eq=False)
class _Bounded:
    """A silhouette with bounds on its reach along d directions."""

    silhouette: Silhouette
    least_px: Float  # (d,)
    most_px: Float  # (d,)


@dataclass(frozen=True, slots=True, eq=False)
class _Doubt:
    """Where an outline may be an artefact: cut by the picture's edge or by other things, or hidden by the object."""

    cut_off: Mask  # (h, w) as from truncation_mask
    body: Contour
    margin_px: float  # so near to the body a shadow's outline may continue behind it

    def cuts(self, points: Float) -> Mask:
        return values_at(points, self.cut_off)

    def hides(self, points: Float) -> Mask:
        return are_beside(points, self.body, self.margin_px)

    def concerns(self, points: Float) -> Mask:
        return self.cuts(points) | self.hides(points)


def _directions(
    count: int, body: Contour, shadows: Sequence[Contour], doubt: _Doubt, size_px: float
) -> tuple[Float, NDArray[np.intp]]:
    """(d, 2) evenly spaced ones and normals of long straight edges; (d,) whose edges': 0 nobody's, 1 the body's, 2 and
    up those of its shadows.
    """
    blocks = [unit_circle(count), _edge_normals(body, doubt.cuts(body.hull_px), doubt.cuts, size_px)]
    blocks += [_edge_normals(shadow, doubt.concerns(shadow.hull_px), doubt.concerns, size_px) for shadow in shadows]
    return np.concatenate(blocks), np.repeat(np.arange(len(blocks)), [len(block) for block in blocks])


def _body_bounds(doubt: _Doubt, directions: Float, owner: NDArray[np.intp], centre_px: Float) -> _Bounded:
    """The body's, along directions (d, 2)."""
    points, cut = doubt.body.hull_px - centre_px, doubt.cuts(doubt.body.hull_px)
    reach = _reach(points, directions)
    most = np.where(_ends_at(cut, points, directions, TIE_PX) & (owner != 1), np.inf, reach)
    return _Bounded(Silhouette(points, ~cut), reach, most)


def _shadow_bounds(
    contour: Contour, doubt: _Doubt, directions: Float, is_own: Mask, centre_px: Float, most_of_body: Float
) -> _Bounded:
    """The same of a shadow; is_own: (d,) normals of its own straight edges, along which it is measured."""
    points = contour.hull_px - centre_px
    cut, hidden = doubt.cuts(contour.hull_px), doubt.hides(contour.hull_px)
    reach = _reach(points, directions)
    # A shadow's hidden part cannot extend beyond the object's outline, which hides it.
    most = np.where(_ends_at(hidden, points, directions, 0.0), np.maximum(reach, most_of_body), reach)
    most = np.where(_ends_at(cut, points, directions, TIE_PX), np.inf, most)
    return _Bounded(Silhouette(points, ~(cut | hidden)), reach, np.where(is_own, reach, most))


def _bounds_of_whole(points: Float, cut: Mask, directions: Float, least: Float, most: Float) -> tuple[Float, Float]:
    """(d,) lower and upper bounds of the union's reach, from the points of the common hull of object and shadows.

    least, most: (1 + l, d) the bounds of each. The union is measured only where none of them was, and unbounded
    elsewhere, so that no outline is counted twice.
    """
    reach = _reach(points, directions)
    unknown = (most.max(axis=0) > least.max(axis=0) + TIE_PX) & ~_ends_at(cut, points, directions, TIE_PX)
    return np.where(unknown, reach, -np.inf), np.where(unknown, reach, np.inf)


def _edge_normals(contour: Contour, doubtful: Mask, is_doubtful: Callable[[Float], Mask], size_px: float) -> Float:
    """(e, 2) outward normals of the longest straight edges whose ends are doubtful but whose line is certain.

    However far such an edge continues, it does so along its line, so the outline's reach along its normal is known.
    """
    empty = np.empty((0, 2))
    if not doubtful.any():
        return empty
    corners = cv2.approxPolyDP(contour.hull_px.astype(np.float32), STRAIGHT_PX, True).reshape(-1, 2).astype(np.float64)
    along = np.roll(corners, -1, axis=0) - corners
    length = np.hypot(along[:, 0], along[:, 1])
    longest = np.argsort(-length, kind="stable")[:TRIED_EDGES]
    longest = longest[length[longest] > LONG_EDGE * size_px]
    between = corners[longest, None] + along[longest, None] * np.array([0.25, 0.5, 0.75])[:, None]
    inner = between.reshape(-1, 2)
    if not len(inner):
        return empty
    off = np.hypot(*(inner[:, None] - contour.points_px).transpose(2, 0, 1)).min(axis=1)
    good = ((off < STRAIGHT_PX + 0.5) & ~is_doubtful(inner)).reshape(-1, 3).all(axis=1)
    chosen = longest[good][:EDGES]
    normals = np.column_stack([along[chosen, 1], -along[chosen, 0]]) / length[chosen, None]
    outward = np.sign(((corners[chosen] - contour.hull_px.mean(axis=0)) * normals).sum(axis=1))
    return np.asarray(normals * outward[:, None])


def _reach(points: Float, directions: Float) -> Float:
    """(d,) support function of points (m, 2): their largest extent along each direction (d, 2)."""
    return np.asarray((points @ directions.T).max(axis=0))


def _ends_at(flagged: Mask, points: Float, directions: Float, tie_px: float) -> Mask:
    """(d,) whether one of the flagged points is the farthest along each direction, or within `tie_px` of that."""
    reaches = points @ directions.T
    flagged_reach = np.where(flagged[:, None], reaches, -np.inf).max(axis=0)
    return np.asarray(flagged_reach >= reaches.max(axis=0) - tie_px)

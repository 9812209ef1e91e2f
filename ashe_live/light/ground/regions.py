"""Regions of the frame in which something stands, each resampled to a resolution that suits its size."""

import math
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import combinations

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, set_frozen
from ashe_live.core.camera import scaled_pixels
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.light.ground.lit_ground import MOST_DISTANCE, LitGround, ground_colours
from ashe_live.light.ground.surroundings import stands_inside, surroundings_in
from ashe_live.light.pixels.areas import closed, distance_to, grown, labelled, majority, resized, shrunk, smoothed
from ashe_live.light.pixels.mixtures import Quantised, nearest_squared_distance
from ashe_live.light.pixels.view import View, Window

APART_PX = 3  # of the coarse picture: areas nearer to each other than twice this belong together
MARGIN_PX = 10  # of a region around what is unlit
UNRELIABLE_PX = 2  # beside what is no ground
# A group with a bounding box of more than this share of the picture, most of which the lit ground nearly explains, is
# sheen, grout or a wall's reflection that connects an object and its shadow with things all over the picture. Then so
# many of its clear parts become regions, if their boxes are at most this share of the group's.
HUGE, MOSTLY_FAINT, CLEAR_PARTS, MUCH_SMALLER = 0.25, 0.5, 2, 0.4
LEAST_CLEAR_PX = 40  # of such a part
# Log brightness below the median of the lit ground's from which on a pixel may be in shadow: a part without any shows
# no light. A part counts by its shadows if they are at least this fraction of the largest part's.
DARKER, LESSER_PART = 0.1, 0.3
BEFORE = 2  # most regions around what stands before surroundings
# An object that partly looks like lit ground leaves a gap between the rest of it and its shadow. Of so many of the
# largest areas, pairs are also tried as one, where the gap is at most this fraction of the smaller one's size. The
# gap's pixels are those whose distances to both add up to less than BULGE times its width.
JOINED, WIDEST_GAP, BULGE = 2, 0.8, 1.4
# Squared Mahalanobis distance from the lit ground's palette, smoothed, beyond which a pixel of a region is something
# else, at a finer scale than that of the coarse picture, in which UNLIT_DISTANCE of `lit_ground` finds what is unlit.
UNLIT_IN_REGION = 7.0
# What lies nearer than this may be ground all the same: what an object's bright side adds to its light, or what glossy
# ground mirrors, is a small part of it, and this is a quarter where colours scatter by 5 %. Shadows take more away.
FAINT_DISTANCE = 30.0


@dataclass(frozen=True, eq=False)
class Region:
    """A window of the frame around an object and its shadow, scaled so that they have a given size in pixels."""

    view: View
    colours: Float32  # (h, w, 3) log-opponent, without the ground's own slow shading
    unlit: Mask  # (h, w) pixels that the lit ground does not explain
    window: Window  # where it lies in the whole frame
    frame_shape: tuple[int, ...]  # (h, w) of the whole frame at this scale
    on_plane: Float32 | None = None  # (h, w) log odds by other views that a pixel lies on the plane; None: one view
    faint: Mask | None = None  # (h, w) of `unlit`, those that the lit ground nearly explains; None: not known
    broad: Mask | None = None  # (h, w) the ground's broad areas in the colours of joints; None: none
    surroundings: Mask | None = None  # (h, w) neither ground nor object: a wall, a floor; None: none are segmented
    quantised: Quantised = field(init=False)  # its colours, quantised to the size of the noise
    unreliable: Mask = field(init=False)  # (h, w) pixels off the ground, and those near enough to see that border

    def __post_init__(self) -> None:
        unreliable = grown(~self.view.is_ground, UNRELIABLE_PX)
        set_frozen(self, quantised=Quantised.of(self.colours), unreliable=unreliable)

    @property
    def is_ground(self) -> Mask:
        return self.view.is_ground

    def with_pose(self, T_cam_marker: Float) -> "Region":
        """The same pixels, seen by a camera with another pose (4, 4)."""
        moved = copy(self)  # without computing anew what depends on pixels alone
        set_frozen(moved, view=replace(self.view, T_cam_marker=T_cam_marker))
        return moved

    def in_frame(self, mask: Mask) -> Mask:
        """A mask (h, w) of the region, embedded in the whole frame at the region's scale."""
        whole = np.zeros(self.frame_shape, np.bool_)
        whole[self.window] = mask
        return whole


def unlit_regions(fine: View, coarse_unlit: Mask, ground: LitGround, size_px: int, count: int) -> list[Region]:
    """The regions around the largest groups of unlit areas of a coarser picture: `count` at most, and a few more.

    A pixel counts less the farther its ground is from the marker, beside which people put their object. The clear parts
    of a group that the lit ground nearly explains come before it, and before both up to BEFORE regions of what stands
    before surroundings. One more is around two of the groups and the gap between, where that is small: it takes no
    other's place, as the third object may be the one that shows its shadow best. Each is scaled to about `size_px`, as
    far as the resolution of `fine` allows.
    """
    groups = [area for area, _ in _groups(coarse_unlit, coarse_unlit, fine)[:count]]
    before = [one for group in groups for one in _before_surroundings(group, ground, fine)][:BEFORE]
    parts = [_clear_parts(group, ground, fine) for group in groups]
    areas = [one for own, group in zip(parts, groups, strict=True) for one in (*own, group)]
    apart = [one for own, group in zip(parts, groups, strict=True) for one in own or [group]]
    pairs = (_joined(one, other) for one, other in combinations(apart[:JOINED], 2))
    together = [area for area in pairs if area is not None]
    chosen = [(area, None) for area in areas[:count] + together]
    return [region_of(fine, area, ground, size_px, surroundings) for area, surroundings in [*before, *chosen]]


def _groups(area: Mask, counted: Mask, fine: View) -> list[tuple[Mask, float]]:
    """Parts of `area` near each other, by how many of the pixels in `counted` they hold, the most first; and how many.

    Masks are (h, w) of a coarser picture than `fine`, in which a pixel counts by its nearness to the marker.
    """
    labels, _ = labelled(grown(area, APART_PX), 8)
    labels[~area] = 0
    sizes = np.bincount(labels[counted], _nearness(fine, counted), minlength=1)[1:]
    return [(labels == i + 1, float(sizes[i])) for i in np.argsort(-sizes, kind="stable") if sizes[i] > 0]


def _before_surroundings(group: Mask, ground: LitGround, fine: View) -> list[tuple[Mask, Mask]]:
    """What is left of a group (h, w) without its surroundings: the largest parts that stand inside the picture.

    Each with the surroundings (h, w).
    """
    surroundings = surroundings_in(group, ground)
    if surroundings is None:
        return []
    inside = group & ~surroundings
    parts = _groups(inside, inside, fine)[:BEFORE]
    return [(part, surroundings) for part, size in parts if size > LESSER_PART * parts[0][1] and stands_inside(part)]


def _clear_parts(group: Mask, ground: LitGround, fine: View) -> list[Mask]:
    """The parts of a group (h, w) that the lit ground does not even nearly explain, where these are few of it."""
    clear = group & (ground.squared_distance > FAINT_DISTANCE)
    is_mostly_faint = np.count_nonzero(clear) < (1 - MOSTLY_FAINT) * np.count_nonzero(group)
    if not is_mostly_faint or _box_px(group) < HUGE * group.size:
        return []
    # What is no ground, as a wall or the marker itself, is at no distance from the ground's colours.
    is_ground = resized(fine.is_ground, group.shape[::-1])
    lit = ground.colours[..., 0][is_ground & (ground.squared_distance < UNLIT_IN_REGION)]
    dark = clear & (ground.colours[..., 0] < (np.median(lit) if len(lit) else -np.inf) - DARKER)
    parts = _groups(clear, dark, fine)[:CLEAR_PARTS]
    largest_px = MUCH_SMALLER * _box_px(group)
    return [
        grown(part, 2) & group
        for part, size in parts
        if size > LESSER_PART * parts[0][1] and np.count_nonzero(part) >= LEAST_CLEAR_PX and _box_px(part) < largest_px
    ]


def _box_px(mask: Mask) -> int:
    _, _, across, down = cv2.boundingRect(mask.astype(np.uint8))
    return across * down


def _nearness(view: View, mask: Mask) -> Float:
    """(n,) 1 / (1 + d²) of the ground in `mask`, at another scale: d its distance from the marker over the camera's."""
    rows, columns = np.nonzero(mask)
    pixels = scaled_pixels(np.column_stack([columns, rows]), view.size[0] / mask.shape[1])
    ground = raycast_to_plane(view.camera, view.T_cam_marker, pixels)
    away = np.hypot(ground[:, 0], ground[:, 1]) / np.linalg.norm(view.T_cam_marker[:3, 3])
    return np.asarray(np.nan_to_num(1 / (1 + away**2)))


def _joined(one: Mask, other: Mask) -> Mask | None:
    """Both groups and the gap between them, each without gaps of its own; None where that is wide for their sizes.

    A split's object is what is connected with its shadow, and the rest of it may be in several parts.
    """
    from_one, from_other = distance_to(one), distance_to(other)
    gap = float(from_one[other].min())
    if gap > WIDEST_GAP * math.sqrt(min(np.count_nonzero(one), np.count_nonzero(other))):
        return None
    return closed(one, APART_PX) | closed(other, APART_PX) | (from_one + from_other < BULGE * gap)


def region_of(fine: View, area: Mask, ground: LitGround, size_px: int, surroundings: Mask | None = None) -> Region:
    """The region around `area`, a mask of the whole frame at any scale, itself scaled to about `size_px`.

    surroundings: a mask of the whole frame at any scale too; None where none are segmented.
    """
    height, width = area.shape
    x, y, across, down = cv2.boundingRect(area.astype(np.uint8))
    scale = min(fine.size[0] / width, max(1.0, size_px / math.sqrt(across * down)))
    view = fine.scaled(round(width * scale))
    window = _window((x, y, across, down), view.size[0] / width, view.size[1] / height, view.is_ground.shape)
    colours = ground_colours(view.image_bgr, ground, window)
    cut, shape = view.cut(window), view.is_ground.shape
    beyond = None if surroundings is None else resized(surroundings, shape[::-1])[window]
    before = cut.is_ground if beyond is None else cut.is_ground & ~beyond
    unlit, faint = _unlit(colours, ground, resized(area, shape[::-1])[window], before)
    broad = None if ground.broad is None else resized(ground.broad.mask, shape[::-1])[window]
    return Region(
        view=cut,
        colours=colours,
        unlit=unlit,
        window=window,
        frame_shape=shape,
        on_plane=_on_plane(ground, shape, window),
        faint=faint,
        broad=broad,
        surroundings=beyond,
    )


def region_with_on_plane(region: Region, ground: LitGround) -> Region:
    """A region that was cut out of one view alone, with the evidence of other views in that view's lit `ground`."""
    return replace(region, on_plane=_on_plane(ground, region.frame_shape, region.window))


def _on_plane(ground: LitGround, frame_shape: tuple[int, ...], window: Window) -> Float32 | None:
    """(h, w) log odds by other views that a window's pixels lie on the plane; None where there are no other views.

    frame_shape: (h, w) of the whole frame at the window's scale.
    """
    if ground.on_plane is None:
        return None
    height, width = frame_shape
    whole = cv2.resize(ground.on_plane, (width, height), interpolation=cv2.INTER_LINEAR)
    return np.asarray(whole[window], dtype=np.float32)


def _window(box: tuple[int, int, int, int], scale_x: float, scale_y: float, shape: tuple[int, ...]) -> Window:
    x, y, across, down = box
    rows = slice(max(0, int(y * scale_y) - MARGIN_PX), min(shape[0], int((y + down) * scale_y) + MARGIN_PX))
    columns = slice(max(0, int(x * scale_x) - MARGIN_PX), min(shape[1], int((x + across) * scale_x) + MARGIN_PX))
    return rows, columns


def _unlit(colours: Float32, ground: LitGround, area: Mask, is_ground: Mask) -> tuple[Mask, Mask]:
    """(h, w) each: the pixels in and around `area` that the lit ground does not explain; those that it nearly does."""
    palette = ground.palette
    squared = nearest_squared_distance(colours.reshape(-1, 3), palette.centres, palette.covariances).reshape(area.shape)
    smooth = smoothed(np.minimum(squared, MOST_DISTANCE))
    nearby, inside = grown(area, 2) & is_ground, shrunk(area, 1) & is_ground
    unlit = majority(((smooth > UNLIT_IN_REGION) & nearby) | inside)
    return unlit, unlit & ~majority(smooth > FAINT_DISTANCE)

"""The light along lines across a shadow's predicted edges: where it falls to its half, and how steeply."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Float32, Mask, upper_median, upper_quantile
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.light.known_body.outline.edges import ShadowEdges, shadow_edges
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.table import height_px
from ashe_live.light.pixels.view import View

SAMPLES = 33  # across an edge
ENDS = 6  # of them at either end, whose means are the levels of shadow and light
LEAST_PX = 3.5  # that an edge is looked for on either side
LEAST_STEP = 0.35  # of an edge, over the light that the shadow takes, from which on it is one
OUTLIER_SHARE, OUTLIER_PX = 0.12, 0.5  # scale of Cauchy's loss: of the reach, and at least
FARTHEST_PX = 1e4  # of an edge from the picture: beyond, it is looked for as if it were there
AS_MUCH = 0.5  # of what any picture shows of a shadow's outline, from which on another shows it too
ALONG: Float32 = np.linspace(-1, 1, SAMPLES, dtype=np.float32)
# (3, samples) weights of the dark level, the lit one, and the sum by the trapezoidal rule.
LEVELS: Float32 = np.zeros((3, SAMPLES), np.float32)
LEVELS[0, :ENDS], LEVELS[1, -ENDS:], LEVELS[2] = 1 / ENDS, 1 / ENDS, 1.0
LEVELS[2, [0, -1]] = 0.5
# (samples - 1, 3) powers of the middles between samples: moments of the rises there.
MOMENTS: Float32 = ((0.5 * (ALONG[1:] + ALONG[:-1]))[:, None] ** np.arange(3)).astype(np.float32)
# Neighbouring points see the same pixels, and a table's stains are wider than these: points over the sample size.
POINTS_A_SAMPLE = 4.5
LARGEST_RAD = math.radians(20)  # of a light's diameter that is stated
SHOWN, CHANCE = 0.85, 0.3  # probability that a place shows a step where there is an edge, and where there is none
# Of a place, by which the log odds of there being an edge grow: where it shows a step, and where it shows none.
BY_STEP, BY_NONE = math.log(SHOWN / CHANCE), math.log((1 - SHOWN) / (1 - CHANCE))


@dataclass(frozen=True, slots=True, eq=False)
class Profiles:
    """Edges as the picture has them."""

    edges: ShadowEdges
    reach_px: Float  # (n,) how far from the prediction they were looked for
    window: Float  # (n,) part of the window that was asked for, which holds an edge's blur, for which there is room
    offset_px: Float  # (n,) outwards of where they are predicted
    light: Float32  # (n, SAMPLES) along the lines outwards
    step: Float  # (n,) light lost, over the table's where no shadow that is known lies
    visible: Mask  # (n,) with room enough on the bare table
    room: Room  # in which they were looked for

    @staticmethod
    def of(edges: ShadowEdges, wanted_px: Float, picture: Float32, room: Room) -> "Profiles":
        """Edges in `picture` (h, w), looked for within `wanted_px` (n,), or less where there is less room."""
        free, left = room.around_and_left(edges.points_px)
        visible = free >= LEAST_PX
        reach = np.where(visible, np.minimum(wanted_px, free), wanted_px)
        middle = edges.points_px.T.clip(-FARTHEST_PX, FARTHEST_PX).astype(np.float32)
        x, y = middle[..., None] + (reach * edges.normals_px.T).astype(np.float32)[..., None] * ALONG
        light = np.asarray(cv2.remap(picture, x, y, cv2.INTER_LINEAR), dtype=np.float32)
        dark, lit, whole = (LEVELS @ light.T).astype(np.float64)
        lost = lit - dark
        # The light on a line that is dark up to the edge and lit beyond it is as much as its lit part is long.
        inside = (whole - (SAMPLES - 1) * dark) / np.where(np.abs(lost) > 1e-6, lost, 1.0)
        offset = reach * (1 - 2 / (SAMPLES - 1) * inside)
        # In a known shadow less light is left, of which another light's edge takes the larger part.
        step = lost / np.maximum(lit, 1e-4) * left
        window, offset = np.minimum(reach / wanted_px, 1.0), np.minimum(np.maximum(offset, -reach), reach)
        return Profiles(edges, reach, window, offset, light, step, visible, room)

    def are_steps(self, darkening: float) -> Mask:
        """(n,) which are visible and as deep as a light's edge that takes this part of the table's light."""
        return np.asarray(self.visible & (self.step > LEAST_STEP * darkening))

    def clear(self, darkening: float) -> float:
        """Of the places that are visible, the part with a step; 0 where none is."""
        return float(self.are_steps(darkening)[self.visible].mean()) if self.visible.any() else 0.0

    def are_edges(self, darkening: float) -> Mask:
        """(m,) which of the outline's sides show steps at an independent place at least, and likelier are edges."""
        count, steps = len(self.edges.corners_px), self.are_steps(darkening)
        shown, visible = (np.bincount(self.edges.side, each, count) for each in (steps, self.visible))
        return np.asarray((shown >= POINTS_A_SAMPLE) & (shown * BY_STEP + (visible - shown) * BY_NONE > 0))

    def are_cut_off(self) -> Mask:
        """(m,) of which of the outline's sides a part lies beyond the picture."""
        is_beyond = self.room.from_border(self.edges.points_px) < LEAST_PX
        return np.asarray(np.bincount(self.edges.side, is_beyond, len(self.edges.corners_px)) > 0)

    def weights(self, darkening: float, loss: float, left_px: Float | None = None) -> Float:
        """(n,) weight of each edge, 0 for what is none; loss: factor on the scale of Cauchy's loss.

        left_px: (n,) what of the offsets is not explained; None: all.
        """
        left_px = self.offset_px if left_px is None else left_px
        scale = loss * np.maximum(OUTLIER_SHARE * self.reach_px, OUTLIER_PX)
        # Near a corner the neighbouring edge bends the half light.
        straight = np.clip(self.edges.to_corner_px / np.maximum(0.7 * self.reach_px, 1e-9), 0, 1) ** 2
        deep = np.clip(self.step / max(darkening, 1e-6), 0, 1) ** 2
        quality = straight * deep * self.window**2
        return np.asarray(self.are_steps(darkening) * quality / (1 + (left_px / scale) ** 2))

    def widths(self, weight: Float) -> tuple[float, float]:
        """The variance of the picture's blur, px^2, and the light's angular diameter, 0 where blur alone explains it.

        A penumbra widens with the height that casts it, blur does not: a weighted linear regression of variances.
        """
        used = weight > 0
        spreads, variance, full = self.edges.by_size[used] ** 2, self._variance_px2(used), weight[used]
        terms = np.column_stack([np.ones(len(full)), spreads, spreads**2, variance, spreads * variance])
        w = full
        for _ in range(3):
            one, x, xx, y, xy = (w @ terms).tolist()
            determinant = (one + 1e-12) * (xx + 1e-12) - x * x
            blur, squared = ((xx + 1e-12) * y - x * xy) / determinant, ((one + 1e-12) * xy - x * y) / determinant
            rest = np.abs(variance - blur - squared * spreads)
            scale = SIGMA_OVER_MAD * upper_median(rest) + 1e-3
            w = full / (1 + (rest / (2 * scale)) ** 2)
        error = scale * math.sqrt(POINTS_A_SAMPLE * abs((one + 1e-12) / determinant))
        blur = min(max(blur, 0.3), 9.0)
        if squared <= 3 * error or squared * upper_quantile(spreads, 0.9) < 0.5 * blur:
            return blur, 0.0
        return blur, min(math.sqrt(squared), LARGEST_RAD)

    def _variance_px2(self, used: Mask) -> Float:
        """(k,) of the rises outwards, of those edges that are `used` (n,)."""
        light = self.light[used]
        total, first, second = (np.maximum(light[:, 1:] - light[:, :-1], 0.0) @ MOMENTS).astype(np.float64).T
        total = np.maximum(total, 1e-9)
        return np.asarray(np.maximum(second / total - (first / total) ** 2, 0.0) * self.reach_px[used] ** 2)


@dataclass(frozen=True, slots=True, eq=False)
class EdgeImage:
    """The picture, the body in it, and where on the table edges can be seen."""

    body: Proxy
    view: View
    light: Float32  # (h, w) linear
    room: Room  # the bare table, without what is in the penumbrae of lights that are known
    pose_shape_errors: PoseShapeErrors | None = None  # how the body and its frame may be off

    @property
    def height_m(self) -> float:
        """Of the body."""
        return self.body.height_m

    @property
    def height_px(self) -> float:
        """Of the body in the picture, as if seen from the side."""
        return height_px(self.body, self.view)

    def edges(self, light: Float) -> ShadowEdges | None:
        """Where those of the shadow in a light (4,), marker frame, are predicted; None where it has none here."""
        return shadow_edges(self.body, light, self.view)

    def profiles(self, edges: ShadowEdges, wanted_px: Float) -> Profiles:
        """The picture across predicted edges, within `wanted_px` (n,) of them, or less where there is less room."""
        return Profiles.of(edges, wanted_px, self.light, self.room)

    def shown(self, light: Float) -> float:
        """Of the outline of a light's (4,) shadow, the part that would be seen."""
        edges = self.edges(light)
        return 0.0 if edges is None else float((self.room.around(edges.points_px) >= LEAST_PX).mean())


@dataclass(frozen=True, slots=True, eq=False)
class EdgeImages:
    """Pictures of one scene, in each of which the body hides other parts of its shadows."""

    several: tuple[EdgeImage, ...]

    def of(self, view: View) -> EdgeImage:
        """The picture of a view."""
        return next(each for each in self.several if each.view is view)

    def showing(self, light: Float) -> EdgeImage:
        """The first picture that shows a light's (4,) shadow: at least half as much of its outline as any."""
        if len(self.several) == 1:
            return self.several[0]
        return next(each for each, shows in zip(self.several, self._show(light), strict=True) if shows)

    def others_showing(self, light: Float, view: View) -> list[EdgeImage]:
        """All pictures that show a light's (4,) shadow, as `showing` has it, but that of a view."""
        if len(self.several) == 1:
            return []
        shows = zip(self.several, self._show(light), strict=True)
        return [each for each, does in shows if does and each.view is not view]

    def _show(self, light: Float) -> list[bool]:
        """Which pictures show a light's (4,) shadow; the first alone where none does."""
        shown = [each.shown(light) for each in self.several]
        most = max(shown)
        return [part >= AS_MUCH * most if most > 0 else number == 0 for number, part in enumerate(shown)]

    def shown(self, light: Float) -> float:
        """Of the outline of a light's (4,) shadow, the part that would be seen in some picture."""
        return max(each.shown(light) for each in self.several)

"""The unary costs of a region's pixels: of labelling each as lit ground, as shadow, or as the object.

Costs are twice negative log densities of colours, so that they can be compared and added up over pixels.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE
from ashe_live.light.pixels.areas import shrunk, smoothed
from ashe_live.light.pixels.log_colour import FROM_OPPONENT, OPPONENT
from ashe_live.light.pixels.mixtures import UNEXPLAINED, Mixture, cost, mixture_of

OBJECT_COLOURS, WIDENING = 4, 1.2  # components of the object's mixture, and a factor on their covariances
# Pairs of the share of its light that a pixel of ground may have lost of what the shadow takes, and the extra cost of
# that share: a penumbra and the pixel's own width mix lit and shadowed ground, half of either where the border is, and
# near the object the sky is hidden as well.
LIT_SHARES = ((0.0, 0.0), (0.22, 2.0), (0.42, 2.0))
SHADED_SHARES = ((1.0, 0.0), (0.58, 2.0), (0.78, 1.0), (0.92, 1.0), (1.25, 1.0))
CONTACT_SHARES = ((1.5, 2.0), (1.8, 3.0))
WIDENED = 0.5  # relative growth of the palette's covariances by a full shift
MOST_COLOURS = 400  # pixels that the object's mixture is fitted to
FEWEST_COLOURS = 12
LEAST_DEPTH = 0.01  # of a shadow, in log brightness: a paler one takes no light
COMMON = 0.02  # least weight of a palette colour that shares of light lost are measured from
OTHER_GROUND = 0.0  # cost of ground that is neither lit nor in this shadow: that of lit ground's rarest colours
NOISE = SHIFT_NOISE.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Materials:
    """The costs of a region's pixels, given the colour shift of its shadow, or of two lights' shadows."""

    shifts: tuple[Float, ...]  # (3,) each: of one light; or of the stronger, of the weaker, and of both blocked
    lit: Float32  # (h, w) cost of lit ground
    shaded: Float32  # (h, w) cost of shadow
    contact: Float32  # (h, w) cost of shadow, also where the object hides the sky
    light_lost: Float32  # (h, w) share of the light that the shadow takes which a pixel of ground lacks
    layers: tuple[Float32, ...] = ()  # (h, w) cost of shadow by each of the shifts, if there are two lights
    # (h, w) no object, but the region's surroundings, and ground of another look: that an object lights, that mirrors
    # one, or that another light does not reach; None: none.
    other_ground: Mask | None = None

    @property
    def shift(self) -> Float:
        """(3,) of the only light's shadow, or of the stronger one's."""
        return self.shifts[0]

    @property
    def lights(self) -> int:
        return 2 if self.layers else 1


def materials_of(region: Region, ground: LitGround, shift: Float) -> Materials:
    """The region's materials if its shadow has the colour shift `shift` (3,)."""
    lit, shaded, deepest = (
        cost_of_shift(region, ground, shift, shares) for shares in (LIT_SHARES, SHADED_SHARES, CONTACT_SHARES)
    )
    lost = share_of_light_lost(region, ground, shift)
    materials = Materials((shift,), lit, shaded, np.minimum(shaded, deepest), lost)
    return materials if region.surroundings is None else with_other_ground(materials, region.surroundings)


def with_other_ground(materials: Materials, other: Mask) -> Materials:
    """The materials if `other` (h, w) too is no object, though it looks like neither lit nor shadowed ground.

    It may be shadow still, where that costs less.
    """
    lit = np.where(other, np.minimum(materials.lit, OTHER_GROUND), materials.lit)
    known = materials.other_ground
    return replace(materials, lit=lit, other_ground=other if known is None else known | other)


def cost_of_shift(region: Region, ground: LitGround, shift: Float, shares: tuple[tuple[float, float], ...]) -> Float32:
    """(h, w) cost of ground in the likeliest of some shares (each with an extra cost) of a shadow of `shift` (3,)."""
    share, extra = np.array(shares).T

    def costs_by(palette: Mixture) -> Float32:
        shown = palette.shifted(shifts_of_shares(shift, share), 1 + WIDENED * share)
        costs = cost(region.quantised.colours, shown, np.repeat(extra, len(palette.weights)))
        return region.quantised.as_picture(costs)

    return smoothed(_by_palette(region, ground, costs_by))


def _by_palette(region: Region, ground: LitGround, values_by: Callable[[Mixture], Float32]) -> Float32:
    """(h, w) what `values_by` says by the ground's palette; in broad areas by what it has beside joints."""
    values = values_by(ground.palette)
    if ground.broad is None or region.broad is None or not region.broad.any():
        return values
    return np.where(region.broad, values_by(ground.broad.palette), values)


def shifts_of_shares(shift: Float, shares: Float) -> Float:
    """(s, 3) colour shifts of pixels of which shares (s,) lie in a shadow of `shift` (3,), the rest in full light.

    Light adds up, its logs do not: half in a shadow of a tenth of the light, a pixel shows a quarter of its shift. A
    share above 1 is a deeper shadow of the same colour.
    """
    ratio = np.exp(FROM_OPPONENT @ shift)
    mixed = np.log(1 - np.minimum(shares, 1.0)[:, None] * (1 - ratio)) @ OPPONENT.T
    return np.asarray(np.where(shares[:, None] <= 1, mixed, shares[:, None] * shift))


def object_cost(region: Region, mask: Mask, materials: Materials | None = None) -> Float32:
    """(h, w) cost under a mixture fitted to the colours well within `mask`, where no edge mixes them with others.

    UNEXPLAINED everywhere where `mask` holds too few pixels. materials: those by which some of it is ground.
    """
    if materials is not None and materials.other_ground is not None:
        mask = mask & ~materials.other_ground
    for margin in (2, 1):
        core = shrunk(mask, margin)
        if np.count_nonzero(core) > max(40, 0.3 * np.count_nonzero(mask)):
            mask = core
            break
    inside = np.flatnonzero(mask)
    if len(inside) < FEWEST_COLOURS:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    samples = region.colours.reshape(-1, 3)[inside[:: len(inside) // MOST_COLOURS + 1]]
    mixture = mixture_of(samples, OBJECT_COLOURS, WIDENING)
    if mixture is None:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    return smoothed(region.quantised.as_picture(cost(region.quantised.colours, mixture)))


def share_of_light_lost(region: Region, ground: LitGround, shift: Float) -> Float32:
    """(h, w) how much of the light that a shadow of `shift` (3,) takes is missing at a pixel, if it is ground.

    By each colour's position on the line from the likeliest palette colour, 0, to its shadowed colour, 1.
    """
    # In units of the noise, so that Euclidean distances to that line are Mahalanobis distances of colours.
    colours, way = region.quantised.colours / NOISE, (shift / SHIFT_NOISE).astype(np.float32)
    length = way @ way

    def likeliest_by(palette: Mixture) -> Float32:
        common = palette.weights >= COMMON
        centres = palette.centres[common] / NOISE
        along = ((colours @ way) - (centres @ way)[:, None]) / length
        fraction = np.clip(along, -0.3, 1.6)
        away = (centres**2).sum(axis=1)[:, None] - 2 * (centres @ colours.T)
        off = away + length * fraction * (fraction - 2 * along) - 2 * np.log(palette.weights[common])[:, None]
        likeliest = np.take_along_axis(fraction, off.argmin(axis=0)[None], axis=0)[0]
        return region.quantised.as_picture(likeliest.astype(np.float32))

    depth = min(float(shift[0]), -LEAST_DEPTH)
    lost = np.expm1(depth * _by_palette(region, ground, likeliest_by)) / math.expm1(depth)
    return np.asarray(lost, dtype=np.float32)

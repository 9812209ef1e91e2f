"""The unary costs of a region's pixels: of labelling each as lit ground, as shadow, or as the object.

Costs are twice negative log densities of colours, so that they can be compared and added up over pixels.
"""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE
from ashe_live.light.pixels.areas import shrunk, smoothed
from ashe_live.light.pixels.mixtures import UNEXPLAINED, cost, mixture_of

OBJECT_COLOURS = 4
# Pairs of the fraction of the shift that a pixel may show, and the extra cost of that fraction: a penumbra and the
# pixel's own width mix lit and shadowed ground, and near the object the sky is hidden as well.
LIT_FRACTIONS = ((0.0, 0.0), (0.25, 2.0), (0.42, 2.0))
SHADED_FRACTIONS = ((1.0, 0.0), (0.55, 2.0), (0.78, 1.0), (1.25, 1.0))
CONTACT_FRACTIONS = ((1.5, 2.0), (1.8, 3.0))
WIDENED = 0.5  # relative growth of the palette's covariances by a full shift
MOST_COLOURS = 400  # pixels that the object's mixture is fitted to
FEWEST_COLOURS = 12
COMMON = 0.02  # least weight of a palette colour that fractions of the shift are measured from
LIT_BY_OBJECT = 0.0  # cost of ground that an object lights or that mirrors it: that of lit ground's rarest colours
NOISE = SHIFT_NOISE.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Materials:
    """The costs of a region's pixels, given the colour shift of its shadow, or of two lights' shadows."""

    shifts: tuple[Float, ...]  # (3,) each: of one light; or of the stronger, of the weaker, and of both blocked
    lit: Float32  # (h, w) cost of lit ground
    shaded: Float32  # (h, w) cost of shadow
    contact: Float32  # (h, w) cost of shadow, also where the object hides the sky
    shift_fraction: Float32  # (h, w) fraction of the shift that a pixel of ground shows: 0 in full light, 1 in shadow
    layers: tuple[Float32, ...] = ()  # (h, w) cost of shadow by each of the shifts, if there are two lights
    lit_by_object: Mask | None = None  # (h, w) no object, but ground that one lights or that mirrors one; None: none

    @property
    def shift(self) -> Float:
        return self.shifts[0]

    @property
    def lights(self) -> int:
        return 2 if self.layers else 1


def materials_of(region: Region, ground: LitGround, shift: Float) -> Materials:
    """The region's materials if its shadow has the colour shift `shift` (3,)."""
    lit, shaded, deepest = (
        cost_of_shift(region, ground, shift, fractions)
        for fractions in (LIT_FRACTIONS, SHADED_FRACTIONS, CONTACT_FRACTIONS)
    )
    return Materials((shift,), lit, shaded, np.minimum(shaded, deepest), fraction_of_shift(region, ground, shift))


def with_faint_as_ground(materials: Materials, faint: Mask) -> Materials:
    """The materials if what is nearly lit ground, `faint` (h, w), is ground: lit by an object's bright side, or glossy.

    It may be shadow still, where that costs less.
    """
    lit = np.where(faint, np.minimum(materials.lit, LIT_BY_OBJECT), materials.lit)
    return replace(materials, lit=lit, lit_by_object=faint)


def cost_of_shift(
    region: Region, ground: LitGround, shift: Float, fractions: tuple[tuple[float, float], ...]
) -> Float32:
    """(h, w) cost of ground that shows the likeliest of some fractions (each with an extra cost) of a shift."""
    fraction, extra = np.array(fractions).T
    shown = ground.palette.shifted(shift, fraction, 1 + WIDENED * fraction)
    costs = cost(region.quantised.colours, shown, np.repeat(extra, len(ground.palette.weights)))
    return smoothed(region.quantised.as_picture(costs))


def object_cost(region: Region, mask: Mask, materials: Materials | None = None) -> Float32:
    """(h, w) cost under a mixture fitted to the colours well within `mask`, where no edge mixes them with others.

    UNEXPLAINED everywhere where `mask` holds too few pixels. materials: those by which some of it is ground.
    """
    if materials is not None and materials.lit_by_object is not None:
        mask = mask & ~materials.lit_by_object
    for margin in (2, 1):
        core = shrunk(mask, margin)
        if np.count_nonzero(core) > max(40, 0.3 * np.count_nonzero(mask)):
            mask = core
            break
    inside = np.flatnonzero(mask)
    if len(inside) < FEWEST_COLOURS:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    samples = region.colours.reshape(-1, 3)[inside[:: len(inside) // MOST_COLOURS + 1]]
    mixture = mixture_of(samples, OBJECT_COLOURS, 1.2)
    if mixture is None:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    return smoothed(region.quantised.as_picture(cost(region.quantised.colours, mixture)))


def fraction_of_shift(region: Region, ground: LitGround, shift: Float) -> Float32:
    """(h, w) each colour's position on the line from the likeliest palette colour, 0, to its shadowed colour, 1."""
    common = ground.palette.weights >= COMMON
    # In units of the noise, so that Euclidean distances to that line are Mahalanobis distances of colours.
    colours, centres = region.quantised.colours / NOISE, ground.palette.centres[common] / NOISE
    way = (shift / SHIFT_NOISE).astype(np.float32)
    length = way @ way
    along = ((colours @ way) - (centres @ way)[:, None]) / length
    fraction = np.clip(along, -0.3, 1.6)
    away = (centres**2).sum(axis=1)[:, None] - 2 * (centres @ colours.T)
    off = away + length * fraction * (fraction - 2 * along) - 2 * np.log(ground.palette.weights[common])[:, None]
    likeliest = np.take_along_axis(fraction, off.argmin(axis=0)[None], axis=0)[0]
    return region.quantised.as_picture(likeliest)

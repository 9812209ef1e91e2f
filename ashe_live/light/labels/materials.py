"""What each pixel of a region costs when taken for lit ground, for shadow, or for the object.

Costs are twice negative log densities of colours, so that they can be compared and added up over pixels.
"""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE
from ashe_live.light.pixels.areas import shrunk, smoothed
from ashe_live.light.pixels.mixtures import UNEXPLAINED, cost, mixture_of

OBJECT_COLOURS = 4
# How much of the shift is seen, and what it costs that it is not all or nothing: a penumbra and a pixel's own width mix
# lit and shadowed ground; near the object the sky is hidden as well.
LIT_SHARES = ((0.0, 0.0), (0.25, 2.0), (0.42, 2.0))
SHADED_SHARES = ((1.0, 0.0), (0.55, 2.0), (0.78, 1.0), (1.25, 1.0))
CONTACT_SHARES = ((1.5, 2.0), (1.8, 3.0))
WIDENED = 0.5  # of the covariances, by a whole shift
MOST_COLOURS = 400
FEWEST_COLOURS = 12
COMMON = 0.02
NOISE = SHIFT_NOISE.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Materials:
    """How a region looks if its shadows are of one shift; or of two lights' shifts and that where both are blocked."""

    shifts: tuple[Float, ...]  # (3,) each: the strongest light's first
    lit: Float32  # (h, w) cost of lit ground
    shaded: Float32  # (h, w) cost of shadow
    contact: Float32  # (h, w) cost of shadow, also where the object hides the sky
    share: Float32  # (h, w) how much of the shift is seen, were this ground: 0 in full light, 1 in shadow
    layers: tuple[Float32, ...] = ()  # (h, w) costs of each of the shifts, where there are several

    @property
    def shift(self) -> Float:
        return self.shifts[0]

    @property
    def lights(self) -> int:
        return 2 if self.layers else 1


def materials_of(region: Region, ground: LitGround, shift: Float) -> Materials:
    """The region's materials, were its shadows of this shift."""
    lit, shaded, deepest = (
        cost_of_shift(region, ground, shift, shares) for shares in (LIT_SHARES, SHADED_SHARES, CONTACT_SHARES)
    )
    return Materials((shift,), lit, shaded, np.minimum(shaded, deepest), share_of_shift(region, ground, shift))


def cost_of_shift(region: Region, ground: LitGround, shift: Float, shares: tuple[tuple[float, float], ...]) -> Float32:
    """(h, w) cost of ground of which the likeliest of some shares of a shift is seen; each share with its own cost."""
    share, more = np.array(shares).T
    shown = ground.palette.shifted(shift, share, 1 + WIDENED * share)
    costs = cost(region.quantised.colours, shown, np.repeat(more, len(ground.palette.weights)))
    return smoothed(region.quantised.pictured(costs))


def object_cost(region: Region, mask: Mask) -> Float32:
    """(h, w) cost of the colours that are found well within `mask`, where no edge mixes them with others."""
    for margin in (2, 1):
        core = shrunk(mask, margin)
        if np.count_nonzero(core) > max(40, 0.3 * np.count_nonzero(mask)):
            mask = core
            break
    inside = np.flatnonzero(mask)
    if len(inside) < FEWEST_COLOURS:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    own = region.colours.reshape(-1, 3)[inside[:: len(inside) // MOST_COLOURS + 1]]
    mixture = mixture_of(own, OBJECT_COLOURS, 1.2)
    if mixture is None:
        return np.full(mask.shape, UNEXPLAINED, np.float32)
    return smoothed(region.quantised.pictured(cost(region.quantised.colours, mixture)))


def share_of_shift(region: Region, ground: LitGround, shift: Float) -> Float32:
    """(h, w) the place of each pixel's colour on the way from the palette's likeliest colour to its shadowed one."""
    common = ground.palette.weights >= COMMON
    # In units of the noise, where distances to the way from lit to shadowed are those of colours.
    colours, centres = region.quantised.colours / NOISE, ground.palette.centres[common] / NOISE
    way = (shift / SHIFT_NOISE).astype(np.float32)
    length = way @ way
    along = ((colours @ way) - (centres @ way)[:, None]) / length
    share = np.clip(along, -0.3, 1.6)
    away = (centres**2).sum(axis=1)[:, None] - 2 * (centres @ colours.T)
    off = away + length * share * (share - 2 * along) - 2 * np.log(ground.palette.weights[common])[:, None]
    likeliest = np.take_along_axis(share, off.argmin(axis=0)[None], axis=0)[0]
    return region.quantised.pictured(likeliest)

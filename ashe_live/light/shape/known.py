"""The families of a body whose shape and size are known: its place and turn alone are free, or its sizes as well."""

import math
from functools import cache, partial

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.caster import Caster
from ashe_live.light.shape.family import Family, Parts
from ashe_live.light.shape.jets import Jet, parameters, stacked, unit_complex

# Turns from which a search starts, in a whole circle: of a box four between one side and the next.
TURNS = 16
# Of x, y and z, which of a kind's sizes each is a multiple of.
SIZES = {"box": (0, 1, 2), "cylinder": (0, 0, 1), "sphere": (0, 0, 0), "hull": (0, 0, 0)}
# Sigma of the prior on the logarithm of a size over the given one, for what the outlines leave open.
SIZE_SPREAD = 0.3


def unit_m(caster: Caster) -> float:
    """The unit of the families' lengths: the larger of radius and height, metres, as in every body frame."""
    return max(caster.radius_m, caster.height_m)


@cache
def family_of(caster: Caster) -> Family:
    """With the parameters x, y and, unless the body is round, its turn in radians; lengths in `unit_m`."""
    return Family(caster.kind, None, partial(_parts, caster), partial(_starts, caster), _free_place(caster))


@cache
def resized_family_of(caster: Caster) -> Family:
    """As `family_of`, and then the logarithm of each of its sizes over the given one."""
    spread = (*_free_place(caster), *(SIZE_SPREAD,) * sizes_of(caster))
    return Family(f"resized {caster.kind}", None, partial(_resized, caster), partial(_resized_starts, caster), spread)


def size_ratios(caster: Caster, shape: Float) -> Float:
    """Each size of a member of `resized_family_of` over the given one: of a box its width, depth and height, of a
    cylinder its radius and height, else one for all.

    shape: (q,) its parameters.
    """
    return np.asarray(np.exp(shape[-sizes_of(caster) :]))


def _free_place(caster: Caster) -> tuple[float, ...]:
    return (math.inf,) * (3 if caster.period_rad else 2)


def sizes_of(caster: Caster) -> int:
    """How many sizes a member of `resized_family_of` has."""
    return 1 + max(SIZES[caster.kind])


def _parts(caster: Caster, theta: Float) -> Parts:
    as_given = np.zeros((len(theta), sizes_of(caster)))
    parts, by_all = _resized(caster, np.concatenate([theta, as_given], axis=1))
    return parts, by_all[..., : theta.shape[1]]


def _resized(caster: Caster, theta: Float) -> Parts:
    (_, q), count = theta.shape, sizes_of(caster)
    free = parameters(theta, logs=range(q - count, q))
    (x, y, *turns), sizes = free[:-count], free[-count:]
    x_size, y_size, z_size = (sizes[i] for i in SIZES[caster.kind])
    across, along, up, radius, half = np.array(caster.spheroids).T / unit_m(caster)
    aside: tuple[Jet, Jet] = x_size.times(across), y_size.times(along)
    for turn in turns:
        turned = unit_complex(turn) * (aside[0] + aside[1].times(np.array([1j])))
        aside = turned.real, turned.imag
    centres = x + aside[0], y + aside[1], z_size.times(up)
    return stacked([(*centres, x_size.times(radius), z_size.times(half))], [len(across)])


def _starts(caster: Caster, seed: Float) -> Float:
    x, y = seed[:2]
    if not caster.period_rad:
        return np.array([(x, y)])
    count = max(2, round(TURNS * caster.period_rad / (2 * math.pi)))
    return np.array([(x, y, caster.period_rad * i / count) for i in range(count)])


def _resized_starts(caster: Caster, seed: Float) -> Float:
    starts = _starts(caster, seed)
    return np.concatenate([starts, np.zeros((len(starts), sizes_of(caster)))], axis=1)

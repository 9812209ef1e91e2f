"""Whether an object whose sizes are given has these in the picture."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.caster import Caster
from ashe_live.light.explanation.explain import refitted_bodies
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.pixels.areas import grown, overlapping
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.known import resized_family_of, size_ratios, sizes_of

# The factor by which a size that fits the picture may differ from the given one: labels err by a tenth at times, and by
# more where shadow is taken for object. A height that is wrong by this factor puts a light up to eight degrees wrong.
MOST_OFF = 1.3
OTHER_HEIGHTS = (0.6, 1.6)  # over the given one, from which others are looked for
LEFT_SHARE = 0.15  # of the object's area: what is left of an unlit area beside it that may be a part of it
TOUCHING_PX = 2  # between the two: a seam of mixed colours


def is_as_given(explanation: Explanation, preset: FitPreset, views: Sequence[View]) -> bool:
    """Whether the picture shows the preset's caster in its given sizes, or at least in none that are far from these.

    Labels alone do not decide that, as they often take shadow for object, or leave out a part of the object. So a body
    of other sizes is fitted to them, and to them with what is left beside the object. It is believed where it also
    explains steps of light and colours better than the given one, by more than its further parameters cost.

    True where there is no caster, or no fit. views: those that were explained, at full resolution.
    """
    caster = preset.caster
    if caster is None:
        return True
    whole, sharpener = _with_what_is_left(explanation), Sharpener.of(views)
    labellings = [explanation] if whole is None else [explanation, whole]
    return all(_is_as_labelled(each, replace(preset, resizes=True), caster, sharpener) for each in labellings)


def _is_as_labelled(explanation: Explanation, preset: FitPreset, caster: Caster, sharpener: Sharpener) -> bool:
    """Whether no body of other sizes explains the explanation's labels better; `preset` resizes the caster."""
    bodies = refitted_bodies(explanation, preset)
    if bodies and _is_near(bodies[0], caster):
        return True
    bodies = [*bodies, *_of_other_heights(explanation.lit, caster)]
    (moved,) = sharpener.sharpened([replace(explanation, bodies=tuple(bodies))])
    likelier = moved.lit
    return likelier.body.family is not resized_family_of(caster) or _is_near(likelier, caster)


def _of_other_heights(given: LitBody, caster: Caster) -> list[LitBody]:
    """The given body with other heights, whose shadows end where its own do: one view leaves that open."""
    found = []
    for factor in OTHER_HEIGHTS:
        sizes = np.zeros(sizes_of(caster))
        sizes[-1] = math.log(factor)
        body = replace(given.body, family=resized_family_of(caster), shape=np.append(given.body.shape, sizes))
        # So many times as high: of a lamp, that is nearer or farther away as well.
        lights = given.lights * np.array([1 / factor, 1 / factor, 1.0, 1 / factor])
        found.append(replace(given, body=body, lights=lights))
    return found


def _with_what_is_left(explanation: Explanation) -> Explanation | None:
    """The explanation with the rest of the unlit area that touches its object labelled as object, too.

    None where the object would hardly be larger. If an object is larger than its caster, the labels that fit the caster
    best cover only a part of it.
    """
    region, split = explanation.region, explanation.split
    rest = region.unlit & ~split.shadow_mask & ~split.object_mask
    if region.surroundings is not None:
        rest &= ~region.surroundings
    touching = grown(split.object_mask, TOUCHING_PX)
    joined = overlapping(rest, touching, 0.0) if (rest & touching).any() else np.zeros_like(rest)
    if np.count_nonzero(joined) < LEFT_SHARE * np.count_nonzero(split.object_mask):
        return None
    return replace(explanation, split=replace(split, object_mask=split.object_mask | joined, undecided=None))


def _is_near(lit: LitBody, caster: Caster) -> bool:
    """Whether all sizes of a member of the caster's resized family are near the given ones."""
    return bool(np.abs(np.log(size_ratios(caster, lit.body.shape))).max() < np.log(MOST_OFF))

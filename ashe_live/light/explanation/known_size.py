"""Whether an object whose sizes are given has these in the picture."""

from dataclasses import replace

import numpy as np

from ashe_live.core.caster import Caster
from ashe_live.light.explanation.explain import refitted_bodies
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.known import resized_family_of, size_ratios

# The factor by which a size that fits the picture may differ from the given one: labels err by a tenth at times, and by
# more where shadow is taken for object. A height that is wrong by this factor puts a light up to eight degrees wrong.
MOST_OFF = 1.3


def is_as_given(explanation: Explanation, preset: FitPreset, sharpener: Sharpener) -> bool:
    """Whether the picture shows the preset's caster in its given sizes rather than in others that are far from these.

    Labels take shadow for object too often to decide this alone; so a body of other sizes that fits them is believed
    where it also explains steps of light and colours better than the given one, by more than its further parameters
    allow.
    True where there is no caster, or no fit. sharpener: of the views that were explained.
    """
    caster = preset.caster
    if caster is None:
        return True
    bodies = refitted_bodies(explanation, replace(preset, resizes=True))
    if not bodies or _is_near(bodies[0], caster):
        return True
    (moved,) = sharpener.sharpened([replace(explanation, bodies=tuple(bodies))])
    likelier = moved.alignment.placed.lit
    return likelier.body.family is not resized_family_of(caster) or _is_near(likelier, caster)


def _is_near(lit: LitBody, caster: Caster) -> bool:
    """Whether all sizes of a member of the caster's resized family are near the given ones."""
    return bool(np.abs(np.log(size_ratios(caster, lit.body.shape))).max() < np.log(MOST_OFF))

"""Whether an object of given sizes looks as large as it was said to be."""

from dataclasses import replace

import numpy as np

from ashe_live.light.explanation.explain import refitted_bodies
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.shape.known import size_ratios

# What a size that fits the labels may differ by, as a factor, from the given one: labels err by a tenth at times, and
# by more where shadow is taken for object. A height that is wrong by so much puts a light up to eight degrees wrong.
MOST_OFF = 1.3


def is_as_given(explanation: Explanation, preset: FitPreset) -> bool:
    """Whether a fit to the explanation's labels with free sizes stays near the given ones of the preset's caster.

    True where there is no caster, or no fit.
    """
    if preset.caster is None:
        return True
    bodies = refitted_bodies(explanation, replace(preset, resizes=True))
    ratios = size_ratios(preset.caster, bodies[0].body.shape) if bodies else np.ones(1)
    return bool(np.abs(np.log(ratios)).max() < np.log(MOST_OFF))

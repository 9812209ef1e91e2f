"""The lights of an aligned body, and how far its borders determine them."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.explanation.alignment import Alignment
from ashe_live.light.outline_fit.search import information_on_lights
from ashe_live.light.shape.directions import (
    FittedLight,
    corrected_for_cut_shadow,
    fitted_lights,
    with_hemisphere_prior,
)

# The misfit, as a fraction of the object's size, at which the body's model error doubles the variance of its borders.
# What this and BORDERS_PER_SAMPLE do not explain is fitted as the overdispersion of `uncertainty.Calibration`.
MODEL_ERROR_SHARE = 0.007


def lights_of(alignment: Alignment) -> tuple[FittedLight, ...]:
    """The lights of an aligned body, with the covariance that its normal equations imply."""
    covariance = np.asarray(np.linalg.inv(_information(alignment)))
    lights = fitted_lights(alignment.placed.lit.lights, covariance)
    return tuple(
        corrected_for_cut_shadow(light, seen) for light, seen in zip(lights, alignment.ends_in_view, strict=True)
    )


def tempered(information: Float, alignment: Alignment) -> Float:
    """The borders' information on the lights, lowered for errors that neighbours share and for the body's misfit."""
    return information / (BORDERS_PER_SAMPLE * (1 + relative_misfit(alignment) ** 2))


def relative_misfit(alignment: Alignment) -> float:
    """The alignment's misfit in units of MODEL_ERROR_SHARE."""
    return alignment.misfit_px / (MODEL_ERROR_SHARE * alignment.placed.object_px)


def _information(alignment: Alignment) -> Float:
    """(split, split) information on the lights, lowered where the misfit shows that the body is a poor model."""
    lit = alignment.placed.lit
    information = information_on_lights(alignment.normal, lit.layout)
    return with_hemisphere_prior(tempered(information, alignment), lit.lights_in_body_frame)

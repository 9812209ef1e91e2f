"""The lights of an aligned body, and how far its borders determine them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised, on_tangent_basis, tangent_basis
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.explanation.alignment import Alignment
from ashe_live.light.outline_fit.search import information_on_lights
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.directions import FittedLight, corrected_for_cut_shadow, fitted_lights, with_hemisphere_prior

# The misfit, as a fraction of the object's size, at which the body's model error doubles the variance of its borders.
# What this and BORDERS_PER_SAMPLE do not explain is fitted as the overdispersion of `uncertainty.Calibration`.
MODEL_ERROR_SHARE = 0.007


def lights_of(alignment: Alignment) -> tuple[FittedLight, ...]:
    """The lights of an aligned body, with the covariance that its normal equations imply."""
    lit = alignment.placed.lit
    # Lowered where the misfit shows that the body is a poor model.
    information = tempered(information_on_lights(alignment.normal, lit.layout), alignment)
    return lights_by_information(lit, information, alignment.ends_in_view)


def lights_by_information(lit: LitBody, information: Float, ends_in_view: Sequence[float]) -> tuple[FittedLight, ...]:
    """The lights of a body, with the covariance that information (split, split) on them and the hemisphere imply.

    ends_in_view: the share of each shadow's far end that is in the picture; where that is cut, the light is lowered.
    """
    total = with_hemisphere_prior(information, lit.lights_in_body_frame)
    lights = fitted_lights(lit.lights, np.asarray(np.linalg.inv(total)))
    return tuple(corrected_for_cut_shadow(light, seen) for light, seen in zip(lights, ends_in_view, strict=True))


def averaged(light: FittedLight, directions: Float, weights: Float, spread_share: float = 0.0) -> FittedLight:
    """The light moved to the mean of n directions about its own.

    The mean of a posterior has the least expected squared error, and what its members differ by is part of its
    uncertainty (Hoeting et al., "Bayesian model averaging", 1999).

    directions: (n, 3) unit vectors, the first one the light's own as these were measured. weights: (n,), of any sum.
    spread_share: the share of the directions' covariance that is added to the light's: 0 where what they differ by is
    a part of the overdispersion that the light's covariance is multiplied by later.
    """
    weights = weights / weights.sum()
    # In space: near the zenith the tangent basis of another direction is turned by far more than that is away.
    towards = normalised(light.to_light_marker + weights @ directions - directions[0])
    about = (directions - weights @ directions) @ tangent_basis(light.to_light_marker).T  # (n, 2), rad
    covariance = light.covariance_rad2 + spread_share * np.einsum("n,ni,nj->ij", weights, about, about)
    return replace(
        light,
        light=np.append(towards, light.light[3]),
        covariance_rad2=on_tangent_basis(towards, covariance, light.to_light_marker),
    )


def tempered(information: Float, alignment: Alignment) -> Float:
    """(split, split) the borders' information on the lights, less for errors that neighbours share and for misfit."""
    return information / (BORDERS_PER_SAMPLE * (1 + relative_misfit(alignment) ** 2))


def relative_misfit(alignment: Alignment) -> float:
    """The alignment's misfit in units of MODEL_ERROR_SHARE."""
    return alignment.misfit_px / (MODEL_ERROR_SHARE * alignment.placed.object_px)

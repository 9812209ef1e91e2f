"""What several pictures say of the same edges: what is no shadow's looks like one from one side, but not from all."""

from dataclasses import replace

import numpy as np

from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.profiles import EdgeImages


def confirmed(fit: ShadowFit, images: EdgeImages, darkening: float) -> ShadowFit:
    """The fit, its edges as clear and as far off as in the mean of its own picture and all others that show the shadow.

    In each of the others the light is moved onto the edges that are seen there, as each picture's frame is off by
    itself. darkening: as of `fitted`.
    """
    others = images.others_showing(fit.light, fit.view)
    if not others:
        return fit
    with_nearness = len(fit.covariance) > 2
    again = [fitted(image, fit.light, darkening, with_nearness, fit.size_rad or 0.0) for image in others]
    several = [fit, *(each for each in again if each is not None)]
    # Where none are found, no place is clear.
    clear = sum(each.clear for each in several) / (1 + len(others))
    misfit_px, misfit_share = np.sqrt(np.mean([(each.misfit_px**2, each.misfit_share**2) for each in several], axis=0))
    return replace(fit, clear=clear, misfit_px=float(misfit_px), misfit_share=float(misfit_share))

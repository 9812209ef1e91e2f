"""A light in words, for the user."""

import math

from ashe_live.core.light import Light


def light_text(light: Light, decimals: int = 0) -> str:
    """Such as "lamp, 62 ± 5 cm, azimuth 30°, elevation 45° ± 4.0°, 90 % sure". `decimals`: of the angles."""
    sigma = "" if light.sigma_rad is None else f" ± {math.degrees(light.sigma_rad):.1f}°"
    # No estimate is certain, whatever a probability is rounded to.
    sure = "" if light.confidence is None else f", {min(100 * light.confidence, 99):.0f} % sure"
    azimuth_deg = round(light.azimuth_deg, decimals) % 360  # a whole turn, to which it may be rounded, is none
    angles = f"azimuth {azimuth_deg:.{decimals}f}°, elevation {light.elevation_deg:.{decimals}f}°"
    return f"{_distance_text(light)}{angles}{sigma}{sure}"


def _distance_text(light: Light) -> str:
    """ "lamp, 62 ± 5 cm, ", the distance from the marker's centre; empty for a sun."""
    if light.inverse_distance == 0:
        return ""
    distance_cm = 100 / light.inverse_distance
    sigma = ""
    if light.lamp_covariance is not None:
        # To first order, the relative error of the distance is that of its inverse.
        sigma = f" ± {distance_cm * math.sqrt(max(light.lamp_covariance[2, 2], 0.0)) / light.inverse_distance:.0f}"
    return f"lamp, {distance_cm:.0f}{sigma} cm, "

"""The light rose: a map of the sky with the lights in it and their confidence ellipses."""

import math
from collections.abc import Sequence

import numpy as np
from PIL import Image as PillowImage
from PIL import ImageDraw, ImageFont

from ashe_live.core.arrays import Float, Image, unit_circle
from ashe_live.core.light import Light
from ashe_live.core.transforms import (
    ELLIPSE_68,
    ELLIPSE_95,
    angles_from_direction,
    direction_from_angles,
    tangent_basis,
)
from ashe_live.drawing.colours import FAINT_BGR, INK_BGR, PAPER_BGR, SHADOW_BGR

ELLIPSE_POINTS = 72  # by which a confidence ellipse is drawn
LEAST_LABELLED_PX = 100  # least side of a rose with labelled azimuths; from twice that on, elevations are labelled too


def light_rose(lights: Sequence[Light], size_px: int, camera_marker: Float | None = None) -> Image:
    """(size, size, 3) BGR: the sky from above, zenith in the centre, horizon at the rim, the marker's x right, y up.

    Each light has its ellipses of 68 and 95 %, if its covariance is known. camera_marker: (3,) the direction of the
    camera from the marker, drawn as a triangle.
    """
    font_px = max(9.0, size_px / 26)
    has_labels = size_px >= LEAST_LABELLED_PX
    radius = max(1.0, size_px / 2 - (2.6 if has_labels else 0.4) * font_px)
    sheet = PillowImage.new("RGB", (size_px, size_px), PAPER_BGR[::-1])
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(font_px)
    faint, centre, line = FAINT_BGR[::-1], size_px / 2, max(1, size_px // 240)

    def at(direction: Float) -> tuple[float, float]:
        azimuth, elevation = angles_from_direction(direction)
        length = radius * (1 - elevation / (math.pi / 2))
        return centre + length * math.cos(azimuth), centre - length * math.sin(azimuth)

    for elevation_deg in (0, 30, 60):
        ring = radius * (1 - elevation_deg / 90)
        draw.circle((centre, centre), ring, outline=faint)
        if size_px >= 2 * LEAST_LABELLED_PX:
            draw.text((centre + 2, centre - ring), f"{elevation_deg}°", faint, font, anchor="la")
    for azimuth_deg in range(0, 360, 90):
        rim = direction_from_angles(math.radians(azimuth_deg), 0.0)
        draw.line((centre, centre, *at(rim)), faint)
        if has_labels:
            label = centre + (radius + 1.2 * font_px) * rim[0], centre - (radius + 1.2 * font_px) * rim[1]
            draw.text(label, f"{azimuth_deg}°", faint, font, anchor="mm")
    if camera_marker is not None:
        x, y = at(camera_marker)
        draw.regular_polygon((x, y, 0.6 * font_px), 3, fill=faint)
        if has_labels:
            draw.text((x, y + 0.5 * font_px), "camera", faint, font, anchor="ma")
    for light in lights:
        draw.line((centre, centre, *at(light.to_light_marker)), INK_BGR[::-1], line)
        draw.circle(at(light.to_light_marker), 1.5 * line, fill=INK_BGR[::-1])
        for squared in (ELLIPSE_68, ELLIPSE_95) if light.covariance_rad2 is not None else ():
            points = [at(direction) for direction in _ellipse(light, squared)]
            draw.line([*points, points[0]], SHADOW_BGR[::-1], line)
    return np.ascontiguousarray(np.asarray(sheet)[:, :, ::-1])


def _ellipse(light: Light, squared_sigmas: float) -> list[Float]:
    """ELLIPSE_POINTS directions (3,) at a squared Mahalanobis distance from the light's direction."""
    assert light.covariance_rad2 is not None
    variances, axes = np.linalg.eigh(light.covariance_rad2)
    offsets = unit_circle(ELLIPSE_POINTS) * np.sqrt(np.maximum(variances, 0) * squared_sigmas)
    directions = []
    for offset in offsets @ axes.T:
        # At most a right angle, so that the ellipse does not wrap around the sphere.
        length = min(float(np.hypot(*offset)), math.pi / 2)
        along = offset @ tangent_basis(light.to_light_marker) / max(float(np.hypot(*offset)), 1e-12)
        directions.append(math.cos(length) * light.to_light_marker + math.sin(length) * along)
    return directions

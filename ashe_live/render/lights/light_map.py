"""The light as a picture of the sky, for other programs: an equirectangular radiance map (.hdr)."""

import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core import arguments
from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination
from ashe_live.files.writing import written_whole
from ashe_live.render.lights.seen_light import lighting_in

HEIGHT_PX = 512  # of the map


def light_map(illumination: Illumination) -> NDArray[np.float32]:
    """(h, 2 h, 3) linear RGB radiance from all around, in units in which lit level white ground has radiance 1.

    In the marker's frame, as Blender lays out an equirectangular world: z up, x in the middle, y a quarter from the
    left. The upper half is the sky as models are drawn in it, leaning as far as it leans, with each light's disc in it,
    a lamp's as seen from the marker's centre; the lower half is black, where the ground is.
    """
    lighting = lighting_in(illumination)
    elevations = math.pi * (0.5 - (np.arange(HEIGHT_PX) + 0.5) / HEIGHT_PX)
    azimuths = 2 * math.pi * (0.5 - (np.arange(2 * HEIGHT_PX) + 0.5) / (2 * HEIGHT_PX))
    flat = np.cos(elevations)[:, None]
    directions = np.stack(
        np.broadcast_arrays(flat * np.cos(azimuths), flat * np.sin(azimuths), np.sin(elevations)[:, None]), -1
    )
    texel_sr: Float = np.broadcast_to((math.pi / HEIGHT_PX) ** 2 * flat, directions.shape[:2])
    is_above = elevations > 0
    radiance = np.zeros((HEIGHT_PX, 2 * HEIGHT_PX, 3))
    # What gives level ground an irradiance of pi times this, and walls that of its slope (docs/maths, "Ambient").
    sky = np.array(lighting.sky)
    leaning = np.maximum(sky + 3 * directions[is_above][..., :2] @ lighting.sky_slope, 0.0)
    to_level = (directions[..., 2] * texel_sr)[is_above]
    level = np.einsum("hw,hwc->c", to_level, leaning) / to_level.sum()
    radiance[is_above] = leaning * np.divide(sky, level, out=np.ones(3), where=level > 0)
    for light in lighting.lights:
        along = directions @ light.to_light
        disc = (along >= math.cos(light.angular_size_rad / 2)) & is_above[:, None]
        if not disc.any():
            disc = along >= along[is_above].max()
        # Energy is kept whatever the texels make of the disc.
        radiance[disc] += math.pi * np.array(light.irradiance) / texel_sr[disc].sum()
    return radiance.astype(np.float32)


def write_light_map(
    path: str | Path, illumination: Illumination, overwrite: bool = False, beside: bool = False
) -> Path:
    """Writes the sky with the lights in it as an equirectangular map, Radiance HDR; returns the path of the file.

    The map is in the marker's frame (z up, x in the middle), in units in which lit level white ground has radiance 1.
    overwrite: replaces a file that is there.
    beside: where a file is at `path` that stays, this one is written beside it, as `NAME-2` and so on.

    Raises UserError when `path` exists (with neither of the two) or cannot be written, ValueError for a name that says
    that it is no HDR.
    """
    target = arguments.path(path, "path")
    if target.suffix.lower() not in (".hdr", ""):
        raise ValueError(f"path is {target.name!r}, and what is written is Radiance HDR: name it .hdr")
    arguments.instance(illumination, Illumination, "illumination")
    _, encoded = cv2.imencode(".hdr", np.ascontiguousarray(light_map(illumination)[..., ::-1]))
    with written_whole(target, overwrite, beside) as file:
        file.stream.write(encoded.tobytes())
    return file.path

"""The colours of a photo as its ICC profile has them (Display P3 of phones, Adobe RGB), in sRGB."""

import io
from functools import cache

import numpy as np
import PIL.Image
from PIL import ImageCms

# In 8 bits: a profile that changes less than this is sRGB by another hand, and the picture keeps its bits.
SAME_COLOUR = 2
PROBE_STEPS = 6  # of each channel


def in_srgb(picture: PIL.Image.Image, profile: bytes) -> PIL.Image.Image:
    """`picture`, of mode RGB, L or CMYK, as RGB; one whose profile cannot be used counts as sRGB."""
    try:
        transform = ImageCms.buildTransform(
            ImageCms.ImageCmsProfile(io.BytesIO(profile)),
            ImageCms.createProfile("sRGB"),
            picture.mode,
            "RGB",
            ImageCms.Intent.RELATIVE_COLORIMETRIC,
        )
        if picture.mode == "RGB" and _changes_nothing(transform):
            return picture
        converted = ImageCms.applyTransform(picture, transform)
    except (ImageCms.PyCMSError, OSError, ValueError, TypeError):  # damaged, or of another kind of picture
        return picture.convert("RGB")
    return picture.convert("RGB") if converted is None else converted


def _changes_nothing(transform: ImageCms.ImageCmsTransform) -> bool:
    probe = _probe()
    converted = ImageCms.applyTransform(probe, transform)
    return converted is not None and bool(
        (np.abs(np.asarray(converted, int) - np.asarray(probe, int)) <= SAME_COLOUR).all()
    )


@cache
def _probe() -> PIL.Image.Image:
    steps = np.linspace(0, 255, PROBE_STEPS).round().astype(np.uint8)
    colours = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(PROBE_STEPS, -1, 3)
    return PIL.Image.fromarray(np.ascontiguousarray(colours))

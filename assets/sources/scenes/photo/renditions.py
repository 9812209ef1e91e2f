"""A pair through simpler cameras, and other photos of the same: what a difference from its photos consists of."""

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.photo.camera import photographed

Params = dict[str, Any]
Rendition = tuple[str, NDArray[np.uint8], int]  # VERSION_NAME, picture (h, w, 3) BGR, quality of its JPEG

# What a camera is without: how it shows light, and all but its lens's blur and its sensor's noise.
UNTONED: Params = {"contrast": 0.0, "saturation": 1.0, "local_tone": 0.0}
LINEAR: Params = UNTONED | {
    "sharpening": 0.0, "luma_denoise": 0.0, "chroma_denoise_px": 0.0, "glare": 0.0, "vignetting": 0.0,
    "jpeg_quality": 98,
}  # fmt: skip
SEED_OF_MODEL = 1  # beyond the picture's own, as pairs.py has it
OTHER_NOISE = 78  # the same of the photo of which noise alone is another
MOVED_PX = (0.25, 0.5)  # to the right


def renditions(
    light: dict[str, NDArray[np.float32]], on_ground: NDArray[np.float64], settings: Params, gains: list[float]
) -> Iterator[Rendition]:
    """`light`: linear radiance (h, w, 3) of "bare" and "model"; `gains`: what exposes them."""

    def photo(radiance: NDArray[np.float32], off: Params, seed: int) -> tuple[NDArray[np.uint8], int]:
        used = settings | off | {"seed": settings["seed"] + seed}
        return photographed(radiance, on_ground, used, gains)[0], used["jpeg_quality"]

    for name, off in (("untoned", UNTONED), ("linear", LINEAR)):
        yield f"bare_{name}", *photo(light["bare"], off, 0)
        yield f"model_{name}", *photo(light["model"], off, SEED_OF_MODEL)
    yield "model_noise", *photo(light["model"], {}, OTHER_NOISE)
    for shift in MOVED_PX:
        by = np.array([[1.0, 0.0, shift], [0.0, 1.0, 0.0]])
        size = light["model"].shape[1::-1]
        moved = cv2.warpAffine(light["model"], by, size, flags=cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
        yield f"model_moved_{round(100 * shift)}", *photo(np.maximum(moved, 0), {}, SEED_OF_MODEL)

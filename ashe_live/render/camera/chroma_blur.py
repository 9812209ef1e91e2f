"""How much more than brightness colours are blurred, by encoding and by the denoising of phones and webcams.

Where two surfaces meet, colours lie on a line (Omer and Werman, "Color lines: image specific color representation",
CVPR 2004): chroma is a linear function of brightness there, or, if it was blurred, of brightness blurred as much.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Image, lowest_on_parabola

# Sigmas in pixels that are tried. Half the resolution, with what JPEG and H.264 round off, has 1.3 to 2.5.
TRIED_PX = np.array([0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0])
WINDOW_PX = 17  # a side of the windows in which colours are to lie on a line
LEAST_LUMA, LEAST_CHROMA = 10.0, 2.0  # standard deviations in a window, levels, of two surfaces that differ
EXPLAINED = 0.8  # least share of a window's chroma variance that the best blur explains, if there are two surfaces
FEWEST_PX = 80  # number of such windows that are needed for an answer
LEAST_UNEXPLAINED = 1e-3  # share of the variance that rounding to whole levels always leaves


def chroma_blur_px(image_bgr: Image) -> float | None:
    """Sigma of the blur that colours have beyond brightness, in (h, w, 3) uint8; None where there is too little colour.

    0 where every pixel has its own colour; at most the largest of TRIED_PX.
    """
    ycc = cv2.cvtColor(image_bgr, cv2.COLOR_BGR2YCrCb).astype(np.float32)
    luma, chroma = ycc[..., 0], ycc[..., 1:] - 128
    mean_chroma = cv2.blur(chroma, (WINDOW_PX, WINDOW_PX))
    chroma_variance = cv2.blur(chroma**2, (WINDOW_PX, WINDOW_PX)) - mean_chroma**2
    explained = []
    for sigma in TRIED_PX:
        smooth = luma if sigma == 0 else cv2.GaussianBlur(luma, (0, 0), sigma)
        mean = cv2.blur(smooth, (WINDOW_PX, WINDOW_PX))
        variance = cv2.blur(smooth**2, (WINDOW_PX, WINDOW_PX)) - mean**2
        together = cv2.blur(smooth[..., None] * chroma, (WINDOW_PX, WINDOW_PX)) - mean[..., None] * mean_chroma
        explained.append(together**2 / np.maximum(variance[..., None] * chroma_variance, 1e-6))
        if sigma == 0:
            differ = (variance > LEAST_LUMA**2)[..., None] & (chroma_variance > LEAST_CHROMA**2)
    shares = np.clip(np.array(explained), 0.0, 1.0)
    is_explained = differ & (shares.max(axis=0) > EXPLAINED)
    if is_explained.sum() < FEWEST_PX:
        return None
    left = np.log(np.maximum(1 - shares[:, is_explained], LEAST_UNEXPLAINED)).mean(axis=1)
    best = int(left.argmin())
    if best in (0, len(TRIED_PX) - 1):
        return float(TRIED_PX[best])
    return lowest_on_parabola(TRIED_PX[best - 1 : best + 2], left[best - 1 : best + 2])

"""Whether the virtual object can be told from a real one: a small fixed classifier of edges, noise and sharpness.

It sees the same place of two photos, in one of which the object is virtual, and must say in which. Half of its answers
are right by chance.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask

CROP_PX = 24
STEP_PX = 12
LEAST_SHARE = 0.2  # least share of a crop that shows the object
RIDGE = 0.1  # share of its variance added to a feature's: with few scenes no weight may rest on a chance correlation


def crop_features(image: Image, is_object: Mask) -> Float:
    """(n, 7) of crops on a grid over the object: how strong edges, detail, noise and colours are; logarithms.

    The crops, and so the rows, depend on `is_object` (h, w) alone.
    """
    ycc = cv2.cvtColor(image, cv2.COLOR_BGR2YCrCb).astype(np.float32)
    luma, chroma = ycc[..., 0], ycc[..., 1:]
    slope = np.hypot(cv2.Sobel(luma, -1, 1, 0), cv2.Sobel(luma, -1, 0, 1))
    fine = np.abs(cv2.filter2D(luma, -1, np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)))
    fine_chroma = np.abs(chroma - cv2.GaussianBlur(chroma, (0, 0), 1.5)).sum(axis=2)
    middle = np.abs(cv2.GaussianBlur(luma, (0, 0), 1.0) - cv2.GaussianBlur(luma, (0, 0), 3.0))
    rows = []
    for top in range(0, image.shape[0] - CROP_PX + 1, STEP_PX):
        for left in range(0, image.shape[1] - CROP_PX + 1, STEP_PX):
            at = slice(top, top + CROP_PX), slice(left, left + CROP_PX)
            if is_object[at].mean() < LEAST_SHARE:
                continue
            steep = np.sort(slope[at].ravel())[-CROP_PX:].mean()
            noise = np.median(fine[at])
            rows.append([steep, slope[at].mean(), noise, fine[at].mean(), middle[at].mean(),
                         fine_chroma[at].mean(), chroma[at].std()])  # fmt: skip
    return np.log(np.array(rows, dtype=np.float64).reshape(-1, 7) + 0.5)


def forced_choice(virtual: list[Float], real: list[Float]) -> float:
    """Fraction of right answers; features (n, 7) a scene, row by row of the same place; NaN with fewer than two scenes.

    Fisher's linear discriminant of the differences, for each scene from all others.
    """
    differences = [a - b for a, b in zip(virtual, real, strict=True) if len(a)]
    if len(differences) < 2:
        return float("nan")
    right, count = 0.0, 0
    for number, own in enumerate(differences):
        others = np.concatenate(differences[:number] + differences[number + 1 :])
        covariance = others.T @ others / len(others)
        weights = np.linalg.solve(covariance + RIDGE * np.diag(np.diag(covariance) + 1e-9), others.mean(axis=0))
        score = own @ weights
        right += float((score > 0).sum() + 0.5 * (score == 0).sum())
        count += len(own)
    return right / count

"""The AShE paper's segmentation: shadow, object and virtual object as masks, each step a function of its own.

Source: "A Shadow Estimator for Augmented Reality Systems on Mobile Platforms" (AShE). Masks are (h, w) at the working
size. What the text leaves open is marked "Open:" with the decision taken here.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera, Size
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.transforms import transform_points

RANDOM_SEED = 1
CLUSTERS, ATTEMPTS, ITERATIONS = 8, 3, 20  # of K-means
DARK_SHARE = 0.5  # of the median luminance: a shadow has lost most of the light
GRABCUT_MARGIN_PX = 2  # on every side of the rectangle
SCORE_C_SHARE, SCORE_K = 0.15, 1.0  # c over the working width, about the size of an object; and k


def working_size(size: Size, published: Size) -> Size:
    """AShE, input: the picture is brought to 640x480.

    Open: other aspect ratios. They keep theirs and fit inside, as stretching would bend every direction.
    """
    scale = min(published[0] / size[0], published[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def resized(image_bgr: Image, size: Size) -> Image:
    """AShE, input: the picture at the working size, by area averages when that is smaller."""
    smaller = size[0] < image_bgr.shape[1]
    return np.asarray(cv2.resize(image_bgr, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR))


def lab_clusters(image_bgr: Image) -> Image:
    """AShE, shadow detection: K-means of the pixels in LAB; (h, w) uint8 labels.

    Open: how many clusters, attempts and iterations; and the seed, fixed here so that an estimate can be repeated.
    """
    lab = cv2.cvtColor(image_bgr.astype(np.float32) / 255, cv2.COLOR_BGR2LAB)
    stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, ITERATIONS, 0.5)
    # OpenCV has one random generator per thread: what ran before must not influence the result.
    cv2.setRNGSeed(RANDOM_SEED)
    _, labels, _ = cv2.kmeans(
        lab.reshape(-1, 3), CLUSTERS, np.empty(0, np.int32), stop, ATTEMPTS, cv2.KMEANS_PP_CENTERS
    )
    return np.asarray(labels.reshape(lab.shape[:2]), dtype=np.uint8)


def darkest_clusters(image_bgr: Image, labels: Image, ground: Mask) -> Mask:
    """AShE, shadow detection: the darkest clusters are shadow.

    Open: how many are "the darkest". A shadow has lost most of the light, so a cluster is dark if it has less than
    DARK_SHARE of the median linear luminance; of the clusters sorted by lightness up to the first that is not dark,
    those below the widest gap are shadow. `ground` leaves out the printed marker, whose ink is the darkest of all.
    """
    luminance = LINEAR_FROM_SRGB_8BIT[image_bgr] @ REC709_LUMINANCE[::-1]
    typical = float(np.median(luminance[ground])) if ground.any() else 0.0
    present = np.unique(labels[ground])
    means = np.array([luminance[ground & (labels == label)].mean() for label in present])
    order = np.argsort(means, kind="stable")
    dark = int(np.count_nonzero(means < DARK_SHARE * typical))
    if dark == 0 or dark == len(order):
        return np.zeros(labels.shape, dtype=np.bool_)
    lightness = np.cbrt(means[order[: dark + 1]])
    below_gap = int(np.argmax(np.diff(lightness))) + 1
    return np.isin(labels, present[order[:below_gap]]) & ground


def grabcut_foreground(image_bgr: Image, iterations: int) -> Mask:
    """AShE, object detection: GrabCut from an almost full rectangle, 25 iterations.

    Open: how much "almost" leaves.
    """
    height, width, margin_px = *image_bgr.shape[:2], GRABCUT_MARGIN_PX
    rectangle = (margin_px, margin_px, width - 2 * margin_px, height - 2 * margin_px)
    labels = np.zeros((height, width), dtype=np.uint8)
    cv2.setRNGSeed(RANDOM_SEED)
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(image_bgr, labels, rectangle, *models, iterations, cv2.GC_INIT_WITH_RECT)
    return np.isin(labels, (cv2.GC_FGD, cv2.GC_PR_FGD))


def hull_of_points(camera: Camera, T_cam_marker: Float, points_marker: Float) -> Float | None:
    """(n, 2) pixels, convex hull of (m, 3) points in the marker frame; None when one is behind the camera.

    The lens's distortion is applied, as masks are compared with the picture as it was taken.
    """
    points_cam = transform_points(T_cam_marker, points_marker)
    if (points_cam[:, 2] <= 1e-6 * np.abs(points_cam).max()).any():
        return None
    pixels, _ = cv2.projectPoints(points_cam, np.zeros(3), np.zeros(3), camera.K, camera.dist)
    hull = cv2.convexHull(pixels.reshape(-1, 2).astype(np.float32)).reshape(-1, 2)
    return np.asarray(hull, dtype=np.float64)


def filled(hull_px: Float, size: Size) -> Mask:
    """(h, w) mask of a convex polygon, as far as it lies in the picture."""
    width, height = size
    mask = np.zeros((height, width), dtype=np.uint8)
    # Far outside the picture the drawing's fixed-point numbers would overflow.
    limit = 20 * max(size)
    cv2.fillConvexPoly(mask, np.round(np.clip(hull_px, -limit, limit)).astype(np.int32), 1)
    return mask > 0


def largest_object(foreground: Mask, shadow: Mask, virtual: Mask, smallest_px: float) -> Mask | None:
    """AShE, object detection: foreground without shadow and virtual object; of that, the largest region.

    Open: specks. A region of less than `smallest_px` is none.
    """
    regions = _regions(foreground & ~shadow & ~virtual, smallest_px)
    return max(regions, key=lambda region: int(region.sum()), default=None)


def shadow_of(object_mask: Mask, shadow: Mask, smallest_px: float) -> Mask | None:
    """AShE, association: of the shadow's regions, the object's own, which has the lowest score.

    Open: c, k, and specks as in `largest_object`.
    """
    centre, c_px = centre_of_mass(object_mask), SCORE_C_SHARE * object_mask.shape[1]

    def score(region: Mask) -> float:
        distance_px = float(np.linalg.norm(centre_of_mass(region) - centre))
        return association_score(distance_px, float(region.sum()), c_px)

    return min(_regions(shadow & ~object_mask, smallest_px), key=score, default=None)


def association_score(distance_px: float, area_px: float, c_px: float) -> float:
    """AShE, association: s = d / (a / (e^(d/c) + k) + 1); the lower the nearer and larger."""
    # e^709 is the largest double; the region's area is negligible long before.
    growth = np.exp(min(distance_px / c_px, 700.0))
    return float(distance_px / (area_px / (growth + SCORE_K) + 1))


def centre_of_mass(mask: Mask) -> Float:
    """AShE, centres of mass: (2,) pixels, x and y; the mask must not be empty."""
    rows, columns = np.nonzero(mask)
    return np.array([columns.mean(), rows.mean()])


def _regions(mask: Mask, smallest_px: float) -> list[Mask]:
    """The 8-connected regions of at least `smallest_px`."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    return [labels == i for i in range(1, count) if stats[i, cv2.CC_STAT_AREA] >= smallest_px]

"""Markers whose cells spell a number: ArUco and AprilTag, found by OpenCV's detector."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.tracking.quads import MIN_SIDE_PX

THRESHOLD_WINDOW_PX = 23

# OpenCV has some names twice, in upper and in lower case, for one dictionary.
DICTIONARIES: dict[str, int] = {
    name.removeprefix("DICT_").removeprefix("ARUCO_").lower(): getattr(cv2.aruco, name)
    for name in sorted(dir(cv2.aruco))
    if name.startswith("DICT_")
}
APRILTAG_FAMILIES: dict[str, int] = {
    name.removeprefix("apriltag_"): number for name, number in DICTIONARIES.items() if name.startswith("apriltag_")
}


class DictionaryMarker:
    """One marker of a predefined dictionary."""

    def __init__(self, spec: str, dictionary: int, marker_id: int) -> None:
        self.spec = spec
        self.marker_id = marker_id
        self._dictionary = cv2.aruco.getPredefinedDictionary(dictionary)
        self._parameters = cv2.aruco.DetectorParameters()
        # One window finds what the default three find, in a third of the time.
        self._parameters.adaptiveThreshWinSizeMin = self._parameters.adaptiveThreshWinSizeMax = THRESHOLD_WINDOW_PX
        # The tracker refines at full resolution.
        self._parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE
        self._detector = cv2.aruco.ArucoDetector(self._dictionary, self._parameters)

    @property
    def count(self) -> int:
        """How many markers its dictionary has."""
        return len(self._dictionary.bytesList)

    def find(self, grey: Image, min_side_px: float = MIN_SIDE_PX) -> Float | None:
        """See Marker.find; of several with this number, the largest."""
        self._parameters.minMarkerPerimeterRate = min(4 * min_side_px / max(grey.shape), 1.0)
        self._detector.setDetectorParameters(self._parameters)
        quads, ids, _ = self._detector.detectMarkers(grey)
        if ids is None:
            return None
        same = [quad.reshape(4, 2) for quad, number in zip(quads, ids.ravel(), strict=True) if number == self.marker_id]
        return np.asarray(max(same, key=cv2.contourArea), dtype=np.float64) if same else None

    def bitmap(self, side_px: int) -> Image:
        """See Marker.bitmap; one pixel a cell is the least."""
        cells = self._dictionary.markerSize + 2
        if side_px < cells:
            raise ValueError(f"{side_px} pixels cannot show {cells} cells")
        return np.asarray(cv2.aruco.generateImageMarker(self._dictionary, self.marker_id, side_px), dtype=np.uint8)

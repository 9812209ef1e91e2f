"""Markers whose cells spell a number: ArUco and AprilTag, found by OpenCV's detector and read by `cells`."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.corners import refined_corners
from ashe_live.tracking.edges.print_alignment import PrintAlignment
from ashe_live.tracking.edges.quads import (
    MIN_SIDE_PX,
    dark_quads,
    half_seen_quads,
    ink_quads,
    on_lighter,
    without_repeats,
)
from ashe_live.tracking.edges.squares import is_front_of_square
from ashe_live.tracking.families.cells import reader_of

# Least and largest window of the detector's adaptive threshold: one window finds most of the markers that three find,
# in a third of the time.
QUICK_WINDOWS_PX, THOROUGH_WINDOWS_PX = (23, 23), (3, 23)
EDGE_SAMPLES = 12
# Samples along a cell's side at which the print is compared with the picture.
SAMPLES_A_CELL = 6
# Coarse corners suffice for a first look at markers of at least this size.
SURE_SIDE_PX = 25.0

# OpenCV has some names twice, in upper and in lower case, for one dictionary.
DICTIONARIES: dict[str, int] = {
    name.removeprefix("DICT_").removeprefix("ARUCO_").lower(): getattr(cv2.aruco, name)
    for name in sorted(dir(cv2.aruco))
    if name.startswith("DICT_")
}
APRILTAG_FAMILIES: dict[str, int] = {
    name.removeprefix("apriltag_"): number for name, number in DICTIONARIES.items() if name.startswith("apriltag_")
}


def marker_count(dictionary: int) -> int:
    """How many markers one of OpenCV's predefined dictionaries has, by its number."""
    return len(cv2.aruco.getPredefinedDictionary(dictionary).bytesList)


class DictionaryMarker:
    """One marker of a predefined dictionary."""

    def __init__(self, spec: str, dictionary: int, marker_id: int) -> None:
        """`marker_id`: below the `marker_count` of that dictionary."""
        self.spec = spec
        self.marker_id = marker_id
        self._number = dictionary
        self._dictionary = cv2.aruco.getPredefinedDictionary(dictionary)
        self._reader = reader_of(dictionary)
        cells = self._dictionary.markerSize + 2
        self.alignment = PrintAlignment(self.bitmap(SAMPLES_A_CELL * cells), 1 / cells)
        self._parameters = cv2.aruco.DetectorParameters()
        # The tracker refines at full resolution.
        self._parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE
        self._detector = cv2.aruco.ArucoDetector(self._dictionary, self._parameters)

    def is_of_dictionary(self, other: object) -> bool:
        """Whether `other` is a marker of the same dictionary."""
        return isinstance(other, DictionaryMarker) and other._number == self._number

    def find(self, grey: Image, min_side_px: float = MIN_SIDE_PX, thorough: bool = True) -> list[Float]:
        """See Marker.find; the largest first."""
        (found,) = self.find_several([self], grey, min_side_px, thorough)
        return found

    def find_several(
        self, wanted: Sequence["DictionaryMarker"], grey: Image, min_side_px: float, thorough: bool
    ) -> list[list[Float]]:
        """As `find`, for each of some markers of this one's dictionary, for little more than the cost of one."""
        self._parameters.minMarkerPerimeterRate = min(4 * min_side_px / max(grey.shape), 1.0)
        windows = THOROUGH_WINDOWS_PX if thorough else QUICK_WINDOWS_PX
        self._parameters.adaptiveThreshWinSizeMin, self._parameters.adaptiveThreshWinSizeMax = windows
        self._detector.setDetectorParameters(self._parameters)
        quads, ids, rejected = self._detector.detectMarkers(grey)
        by_number: dict[int, list[Float]] = {marker.marker_id: [] for marker in wanted}
        for quad, number in zip(quads, () if ids is None else ids.ravel().astype(int), strict=True):
            if int(number) in by_number:
                by_number[int(number)].append(_corners(quad))
        if thorough or not any(by_number.values()):
            doubtful = [_corners(quad) for quad in rejected]
            if thorough:
                doubtful += [*dark_quads(grey, min_side_px), *ink_quads(grey, min_side_px)]
            self._add_read(by_number, wanted, grey, on_lighter(grey, doubtful))
            if thorough and not any(by_number.values()):
                half_seen = half_seen_quads(grey, min_side_px)
                unread = [*on_lighter(grey, half_seen), *on_lighter(grey, [*doubtful, *half_seen], is_clipped=True)]
                self._add_read(by_number, wanted, grey, unread)
        found = (sorted(by_number[marker.marker_id], key=_area, reverse=True) for marker in wanted)
        return [without_repeats(each) for each in found]

    @staticmethod
    def _add_read(
        by_number: dict[int, list[Float]], wanted: Sequence["DictionaryMarker"], grey: Image, quads: list[Float]
    ) -> None:
        """Adds to the corners found of each marker, by its number, those of `quads` that show it."""
        for quad in quads:
            for marker in wanted:
                corners = marker._read(grey, quad)
                if corners is not None:
                    by_number[marker.marker_id].append(corners)
                    break

    def bitmap(self, side_px: int) -> Image:
        """See Marker.bitmap; one pixel a cell is the least."""
        cells = self._dictionary.markerSize + 2
        if side_px < cells:
            raise ValueError(f"{side_px} pixels cannot show {cells} cells")
        return np.asarray(cv2.aruco.generateImageMarker(self._dictionary, self.marker_id, side_px), dtype=np.uint8)

    def _read(self, grey: Image, quad: Float) -> Float | None:
        """The corners in the print's order, if the quadrilateral shows the marker."""
        if not is_front_of_square(quad):
            return None
        is_small = side_lengths_px(quad).min() < SURE_SIDE_PX
        if not is_small and not self._reader.may_be(grey, quad, self.marker_id):
            return None
        # Coarse corners of a small marker are off by a cell; but refinement may have caught another edge.
        for corners in (refined_corners(grey, quad, EDGE_SAMPLES), quad):
            turns = self._reader.turns(grey, corners, self.marker_id)
            if turns is not None:
                # Turned counter-clockwise, the print's top-left corner lies `turns` places before the quad's first one.
                return np.roll(corners, turns, axis=0)
        return None


def _corners(quad: ArrayLike) -> Float:
    return np.asarray(quad, dtype=np.float64).reshape(4, 2)


def _area(corners_px: Float) -> float:
    return float(cv2.contourArea(corners_px.astype(np.float32)))

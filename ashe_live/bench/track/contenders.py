"""The contenders of the tracking bench: OpenCV's detector on single frames, and our tracker."""

import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np

from ashe_live.bench.track.takes import SIDE_M, SPEC, Take
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker

REFERENCE_ID = int(SPEC.rpartition(":")[2])


@dataclass(frozen=True, slots=True)
class Answer:
    """A contender's answer to one frame."""

    truth: Float  # (4, 4) T_cam_marker
    T_cam_marker: Float | None  # (4, 4)
    ms: float
    cpu_ms: float  # of this thread, hardly affected by other load on the machine
    pose: MarkerPose | None = None  # the full answer of our tracker


class Contender(Protocol):
    """A pose estimator that is given frames in order."""

    def look(self, frame: Frame) -> Float | MarkerPose | None:
        """The pose, or T_cam_marker (4, 4) alone; None when it finds no marker."""


class OpencvReference:
    """ArucoDetector on the full frame, with sub-pixel corners or without; the IPPE solution of smaller error."""

    def __init__(self, camera: Camera, subpixel: bool = True) -> None:
        parameters = cv2.aruco.DetectorParameters()
        if subpixel:
            parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        self._detector = cv2.aruco.ArucoDetector(dictionary, parameters)
        self._camera = camera

    def look(self, frame: Frame) -> Float | None:
        """See Contender."""
        quads, ids, _ = self._detector.detectMarkers(frame.image_bgr)
        at = np.flatnonzero(np.asarray([] if ids is None else ids) == REFERENCE_ID)
        if not len(at):
            return None
        corners = np.asarray(quads[at[0]], dtype=np.float64).reshape(4, 2)
        _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
            square_corners(SIDE_M), corners, self._camera.K, self._camera.dist, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        return rigid(cv2.Rodrigues(rvecs[0])[0], tvecs[0])


class Ours:
    """Our tracker; with `cold`, it is reset before each frame."""

    def __init__(self, camera: Camera, preset: TrackingPreset, cold: bool = False, spec: str = SPEC) -> None:
        self._tracker = MarkerTracker(parse_marker(spec), camera, SIDE_M, preset)
        self._cold = cold

    def look(self, frame: Frame) -> MarkerPose | None:
        """See Contender."""
        if self._cold:
            self._tracker.reset()
        return self._tracker.track(frame).marker


def answers(take: Take, contenders: dict[str, Contender]) -> dict[str, list[Answer]]:
    """Every contender's answers to the same frames, each frame given to all in turn."""
    given: dict[str, list[Answer]] = {name: [] for name in contenders}
    for frame, truth in take.film():
        for name, contender in contenders.items():
            start, cpu_start = time.perf_counter(), time.thread_time()
            found = contender.look(frame)
            ms, cpu_ms = (time.perf_counter() - start) * 1e3, (time.thread_time() - cpu_start) * 1e3
            pose = found if isinstance(found, MarkerPose) else None
            T_cam_marker = found.T_cam_marker if isinstance(found, MarkerPose) else found
            given[name].append(Answer(truth, T_cam_marker, ms, cpu_ms, pose))
    return given


def found_share(given: Iterable[Answer]) -> float:
    """The fraction of frames with an answer."""
    return float(np.mean([answer.T_cam_marker is not None for answer in given]))

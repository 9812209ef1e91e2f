"""The estimator `proxy`: fits a simple body and a light to the outlines of a real object and its shadow.

segment -> associate -> fit -> judge, each a file of pure functions: `ground` finds what the lit ground does not
explain, `associate` proposes which of it is shadow of which object, `fit` finds the light that explains both outlines,
`judge` says how far to believe it, or that there is nothing to believe.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project
from ashe_live.core.types import DirectionalLight, LightEstimate, TrackedFrame
from ashe_live.light import fit as fitting
from ashe_live.light.associate import AssociateSteps, Split, classified, splits
from ashe_live.light.ground import GroundSteps, LitGround, fit_lit_ground, ground_colours, lit_rgb, unlit_mask
from ashe_live.light.judge import Candidate, confidence_in, judged
from ashe_live.light.shift import shadow_ratio
from ashe_live.light.stages import StageClock

# The printed sheet is wider than the black square, and its own edge is neither object nor shadow.
SHEET_SIDES = 1.45
# Ground farther away than this many times the marker's distance is too coarse to tell anything.
FARTHEST = 4.0
UNRELIABLE_PX = 5
EDGE_SIGMA_PX = 0.7
# Of the coarse picture: smaller things are specks.
LEAST_SHARE = 0.0005


@dataclass(frozen=True, slots=True)
class ProxySteps:
    """How much work the estimator spends: the numbers that the presets differ in."""

    coarse_width_px: int  # at which ground, objects and shadows are found
    fine_width_px: int  # at which the best explanation's outlines are drawn once more
    ground: GroundSteps
    associate: AssociateSteps
    coarse_fit: fitting.FitPreset
    refined: int  # how many explanations go on to the finer picture
    fine_fit: fitting.FitPreset


BALANCED = ProxySteps(320, 640, GroundSteps(), AssociateSteps(), fitting.FAST, 3, fitting.BALANCED)


class ProxyEstimator:
    """Answers with one light, its covariance and confidence, or with a reason."""

    name = "proxy"

    def __init__(self, steps: ProxySteps = BALANCED) -> None:
        self._steps = steps

    def estimate(self, tracked: TrackedFrame) -> LightEstimate:
        """As Estimator.estimate; the masks have the coarse picture's size."""
        if tracked.marker is None:
            raise ValueError("a frame without a marker has no marker frame to answer in")
        clock = StageClock()
        steps = self._steps
        coarse = _View.of(tracked, steps.coarse_width_px)

        def answer(reason: str | None, *lights: DirectionalLight, split: Split | None = None) -> LightEstimate:
            body, shadow = (split.object_mask, split.shadow_mask) if split is not None else (None, None)
            index = tracked.frame.index
            return LightEstimate(self.name, index, lights, reason, body, shadow, clock.timing_ms())

        ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, steps.ground)
        if ground is None:
            clock.end("segment")
            return answer("too little lit ground around the marker")
        unlit = unlit_mask(ground, coarse.is_ground, round(LEAST_SHARE * coarse.is_ground.size))
        clock.end("segment")
        if not unlit.any():
            return answer("nothing stands on the ground: put something that casts a shadow beside the marker")

        explanations = splits(ground, unlit, coarse.is_ground, steps.associate)
        clock.end("associate")
        candidates = [
            Candidate(split, fitted, rank)
            for rank, split in enumerate(explanations)
            if (fitted := _fitted(split, coarse, steps.coarse_fit)) is not None
        ]
        promising = sorted(candidates, key=confidence_in, reverse=True)[: steps.refined]
        refined = self._refined(tracked, ground, promising) if promising else []
        clock.end("fit")
        if not refined:
            return answer("no shadow found: the light may be diffuse, or the shadow out of view")
        best, rough = max(refined, key=lambda pair: confidence_in(pair[0]))
        verdict = judged(best)
        clock.end("judge")
        if isinstance(verdict, str):
            return answer(verdict, split=rough)
        ratio = shadow_ratio(ground, best.split.shift)
        found = answer(None, replace(verdict, shadow_rgb_ratio=ratio), split=rough)
        return replace(found, caster=best.fit.proxy, ambient_rgb_ratio=ratio, ground_rgb=lit_rgb(ground))

    def _refined(
        self, tracked: TrackedFrame, ground: LitGround, rough: list[Candidate]
    ) -> list[tuple[Candidate, Split]]:
        """The explanations once more, with outlines from the finer picture around them; each with the coarse split."""
        view = _View.of(tracked, self._steps.fine_width_px)
        refined = []
        for candidate in rough:
            scale = view.camera.size[0] / candidate.split.object_mask.shape[1]
            covered = candidate.split.object_mask | candidate.split.shadow_mask
            window = _window_around(covered, scale, view.is_ground.shape)
            split = _magnified(candidate.split, view.is_ground.shape, window)
            colours = ground_colours(view.image_bgr, ground, window)
            split = classified(colours, ground, split, view.is_ground[window], self._steps.associate.rounds)
            fitted = _fitted(split, view.cut(window), self._steps.fine_fit) if split.is_large_enough else None
            if fitted is not None:
                refined.append((Candidate(split, fitted, candidate.rank), candidate.split))
        return refined


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """The frame at a working size, or a window of it."""

    image_bgr: Image  # (h, w, 3)
    camera: Camera  # of that size, without distortion
    T_cam_marker: Float  # (4, 4)
    is_ground: Mask  # (h, w) where the marker's plane is seen, beside the sheet

    @staticmethod
    def of(tracked: TrackedFrame, width_px: int) -> "_View":
        """The frame scaled down to `width_px`, if it is wider, and freed from the lens's distortion."""
        assert tracked.marker is not None
        width, height = tracked.frame.size
        scale = min(1.0, width_px / width)
        size = max(1, round(width * scale)), max(1, round(height * scale))
        image = np.asarray(tracked.frame.image_bgr)
        if size != (width, height):
            image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        camera = tracked.camera.resized(size)
        if camera.is_distorted:
            image = np.asarray(cv2.undistort(image, camera.K, camera.dist), dtype=np.uint8)
            camera = Camera(size, camera.K, np.zeros(5), camera.source)
        T_cam_marker = tracked.marker.T_cam_marker
        return _View(image, camera, T_cam_marker, _ground_mask(camera, T_cam_marker, tracked.marker.side_m))

    def cut(self, window: tuple[slice, slice]) -> "_View":
        """The part of the frame in `window` (rows, columns), seen by a camera whose principal point moves along."""
        rows, columns = window
        K = self.camera.K.copy()
        K[:2, 2] -= columns.start, rows.start
        size = columns.stop - columns.start, rows.stop - rows.start
        camera = Camera(size, K, self.camera.dist, self.camera.source)
        return _View(self.image_bgr[window], camera, self.T_cam_marker, self.is_ground[window])


def _ground_mask(camera: Camera, T_cam_marker: Float, side_m: float) -> Mask:
    """(h, w): where the ray meets the marker's plane, not too far away, outside the printed sheet."""
    width, height = camera.size
    mask = _depth_of_plane(camera, T_cam_marker) < FARTHEST * float(np.linalg.norm(T_cam_marker[:3, 3]))
    half = SHEET_SIDES * side_m / 2
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    outline = project(camera, T_cam_marker, square)
    if np.isfinite(outline).all():
        sheet = np.zeros((height, width), np.uint8)
        cv2.fillConvexPoly(sheet, np.round(np.clip(outline, -1e6, 1e6) * 16).astype(np.int32), 1, shift=4)
        mask &= sheet == 0
    return mask


def _depth_of_plane(camera: Camera, T_cam_marker: Float) -> Float:
    """(h, w) metres along the optical axis to the marker's plane; inf where a pixel's ray does not meet it."""
    width, height = camera.size
    normal = T_cam_marker[:3, 2]
    row = normal @ np.linalg.inv(camera.K)
    facing = row[0] * np.arange(width) + (row[1] * np.arange(height) + row[2])[:, None]
    offset = float(normal @ T_cam_marker[:3, 3])
    meets = facing * np.sign(offset) > 1e-9
    return np.where(meets, offset / np.where(meets, facing, 1.0), np.inf)


def _fitted(split: Split, view: _View, preset: fitting.FitPreset) -> fitting.Fit | None:
    kernel = np.ones((UNRELIABLE_PX, UNRELIABLE_PX), np.uint8)
    unreliable = cv2.dilate((~view.is_ground).astype(np.uint8), kernel).astype(bool)
    found = fitting.fit_light(
        split.object_mask, [split.shadow_mask], view.camera, view.T_cam_marker, unreliable, EDGE_SIGMA_PX, preset
    )
    return None if isinstance(found, fitting.FitFailure) else found


def _window_around(mask: Mask, scale: float, shape: tuple[int, ...], margin_px: int = 12) -> tuple[slice, slice]:
    """Rows and columns of the finer picture that hold `mask` of the coarser one, with a margin."""
    y, x = np.nonzero(mask)
    starts = (max(0, int(values.min() * scale) - margin_px) for values in (y, x))
    stops = (min(n, int((v.max() + 1) * scale) + margin_px) for v, n in zip((y, x), shape, strict=True))
    rows, columns = (slice(start, stop) for start, stop in zip(starts, stops, strict=True))
    return rows, columns


def _magnified(split: Split, shape: tuple[int, ...], window: tuple[slice, slice]) -> Split:
    size = shape[1], shape[0]
    body, shadow = (
        cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)[window].astype(bool)
        for mask in (split.object_mask, split.shadow_mask)
    )
    return Split(body, shadow, split.shift)

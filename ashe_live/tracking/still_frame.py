"""A frame in which the marker lay still, by which later frames show whether the marker was moved, or the camera.

What is near the marker, ground and the things on it, is followed by optical flow (Lucas and Kanade). If it has moved
along the epipolar lines of the marker's two poses, the camera has moved; if it has stayed where it is in the picture,
the marker has; and if a camera that trembles, or another homography of the ground, explains it, both have.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask, frozen_floats, unit_circle
from ashe_live.core.camera import Camera, scaled_pixels
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import camera_centre, inverse_rigid, project, raycast_to_plane, rigid
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.tracking.edges.lens import ideal_from_source, source_from_ideal
from ashe_live.tracking.followed_points import FEWEST_POINTS, FollowedPoints, beside, followed

WIDTH_PX = 320  # of the pictures that are compared
COARSE_PX = 31  # what is coarser is left out of them
MOST_POINTS, APART_PX, LEAST_QUALITY = 80, 6, 0.01
# In the marker's sides from its centre: beyond the sheet, and near enough to lie on the same table.
FROM_SIDES, TO_SIDES = 0.85, 5.0
# A point that moves with the camera does so along its epipolar line, as it may stand above the plane, or be mirrored
# below it: so many of the marker's sides, and no farther than this share of the way up to the camera.
HIGHEST_SIDES, DEEPEST_SIDES, MOST_OF_WAY = 2.0, 1.5, 0.7
# How far it may be off; as the marker's pose has errors, more by this share of the point's distance from the marker.
NEAR_PX, POSE_ERROR = 1.2, 0.02
SURER = 3.0  # as many points must say so for each that says the opposite
EXPLAINED = 0.5  # share of the points found from which an unmoved marker explains what is seen, if nothing else does
# Least share of all points that a motion of both explains: of a camera that trembles, or of any.
TREMBLING, AGREEING = 0.35, 0.6
RANSAC_PX = 1.0
# Root mean square distance of the ground's points from a line through them, in sides: one line leaves a turn open.
NARROWEST_SIDES = 0.3
MOST_TREMBLE_RAD = math.radians(4.0)
FAR_PX = 1e4  # outside of any picture
UNMOVED: Float = frozen_floats(np.eye(4), (4, 4), "UNMOVED")


@dataclass(frozen=True, slots=True, eq=False)
class StillFrame:
    """A frame that later ones are compared with."""

    fine: Image  # (h, w) the picture, scaled, without what is coarse in it
    points_px: Float  # (n, 2) in it, near the marker, none on its sheet
    corners_px: Float  # (4, 2) in it, of the marker
    T_cam_marker: Float  # (4, 4)
    T_room_marker: Float  # (4, 4) as TrackedFrame's
    camera: Camera  # of the frame
    scaled: Camera  # of the scaled picture
    scale: float  # of the scaled picture over the frame
    side_m: float  # of the marker
    time_s: float  # of the frame

    def is_comparable(self, tracked: TrackedFrame) -> bool:
        """Whether the frame, which must have a marker, shows the same marker by the same camera."""
        return self.camera is tracked.camera and self.side_m == tracked.pose.side_m

    @staticmethod
    def of(tracked: TrackedFrame, T_room_marker: Float) -> "StillFrame":
        """The frame, which must have a marker, with the points by which later ones are compared with it."""
        marker = tracked.pose
        fine, scaled = _scaled(tracked)
        points = cv2.goodFeaturesToTrack(fine, MOST_POINTS, LEAST_QUALITY, APART_PX, mask=_around(marker, scaled))
        scale = scaled.size[0] / tracked.frame.size[0]
        return StillFrame(
            fine=fine,
            points_px=np.zeros((0, 2)) if points is None else np.asarray(points[:, 0], np.float64),
            corners_px=scaled_pixels(marker.corners_px, scale),
            T_cam_marker=marker.T_cam_marker,
            T_room_marker=T_room_marker,
            camera=tracked.camera,
            scaled=scaled,
            scale=scale,
            side_m=marker.side_m,
            time_s=tracked.frame.time_s,
        )

    def motion(self, tracked: TrackedFrame) -> Float | None:
        """(4, 4) from the marker's frame now to that before, `UNMOVED` if it was not moved; None if that is unclear."""
        if len(self.points_px) < FEWEST_POINTS:
            return None
        now = tracked.pose.T_cam_marker
        seen = self._followed_points(tracked, now)
        # Points that both motions lead to the same place say nothing.
        with_camera, with_marker = (seen.count(way & seen.is_clear) for way in (seen.near_path, seen.stays))
        if with_camera >= seen.least and with_camera > SURER * with_marker:
            return UNMOVED
        if with_marker >= seen.least and with_marker > SURER * with_camera:
            return np.asarray(inverse_rigid(self.T_cam_marker) @ now)
        near_count = seen.count(seen.near_path)
        if near_count >= max(FEWEST_POINTS, EXPLAINED * seen.is_there.sum()):
            # A marker that has hardly moved yet before a camera that stands still looks like one that has not.
            return UNMOVED if near_count > seen.count(seen.stays) else None
        return self._of_both(seen.there_px, seen.is_there, now)

    def _followed_points(self, tracked: TrackedFrame, T_cam_marker: Float) -> FollowedPoints:
        """Where the points are in a frame with that pose, and which motions that agrees with."""
        points = self.points_px.astype(np.float32)[:, None]
        low, level, high = (self._seen_at(height, T_cam_marker) for height in (-DEEPEST_SIDES, 0.0, HIGHEST_SIDES))
        fine, _ = _scaled(tracked)
        # Plain ground hardly pulls a point away from where it is looked for first, so that both places are tried.
        expected = np.where(np.isfinite(level), level, self.points_px).astype(np.float32)[:, None]
        there, is_there = followed(self.fine, fine, points, (points, expected))
        from_marker_px = np.linalg.norm(self.points_px - self.corners_px.mean(axis=0), axis=1)
        near_px = NEAR_PX + POSE_ERROR * from_marker_px
        return FollowedPoints(
            there,
            is_there,
            near_path=beside(there, low, high) < near_px,
            stays=np.linalg.norm(there - self.points_px, axis=1) < NEAR_PX,
            is_clear=beside(self.points_px, low, high) > NEAR_PX + near_px,
        )

    def _seen_at(self, height_sides: float, T_cam_marker: Float) -> Float:
        """(n, 2) where the points would be seen by this pose, if they stood so high above the plane of the marker."""
        ideal = ideal_from_source(self.scaled, self.points_px)
        eye = camera_centre(self.T_cam_marker)
        on_plane = raycast_to_plane(self.scaled, self.T_cam_marker, ideal)
        share = min(height_sides * self.side_m / max(float(eye[2]), 1e-9), MOST_OF_WAY)
        return source_from_ideal(self.scaled, project(self.scaled, T_cam_marker, on_plane + share * (eye - on_plane)))

    def _of_both(self, there: Float, is_there: Mask, now: Float) -> Float | None:
        """As `motion`, where camera and marker may both have moved."""
        both = np.hstack([ideal_from_source(self.scaled, px[is_there]) for px in (self.points_px, there)])
        both = both[np.isfinite(both).all(axis=1)]
        before, after = both[:, :2].copy(), both[:, 2:].copy()  # as OpenCV takes no slices
        if len(before) < FEWEST_POINTS:
            return None
        T_cam_old = self._by_tremble(before, after)
        if T_cam_old is None:
            T_cam_old = self._by_ground(before, after)
        # A homography of few points may be degenerate, and its pose no number.
        return (
            np.asarray(inverse_rigid(T_cam_old) @ now)
            if T_cam_old is not None and np.isfinite(T_cam_old).all()
            else None
        )

    def _by_tremble(self, before: Float, after: Float) -> Float | None:
        """(4, 4) the old marker seen by a camera that has only turned a little, by points (n, 2) in both pictures."""
        motion, agreeing = cv2.estimateAffinePartial2D(before, after, ransacReprojThreshold=RANSAC_PX)
        if motion is None or agreeing.sum() < max(FEWEST_POINTS, TREMBLING * len(self.points_px)):
            return None
        K = self.scaled.K
        x, y = (motion[:, :2] @ K[:2, 2] + motion[:, 2] - K[:2, 2]) / (K[0, 0], K[1, 1])
        roll, growth = np.arctan2(motion[1, 0], motion[0, 0]), np.hypot(motion[1, 0], motion[0, 0])
        turn = np.array([-y, x, roll])
        if np.linalg.norm(turn) > MOST_TREMBLE_RAD or abs(np.log(growth)) > MOST_TREMBLE_RAD:
            return None
        return rigid(cv2.Rodrigues(turn)[0], np.zeros(3)) @ self.T_cam_marker

    def _by_ground(self, before: Float, after: Float) -> Float | None:
        """(4, 4) the old marker as the ground's homography shows it; None if few points of the ground agree on one."""
        if len(before) < AGREEING * len(self.points_px):
            return None
        _, agreeing = cv2.findHomography(before, after, cv2.RANSAC, RANSAC_PX)
        if agreeing is None or agreeing.sum() < max(2 * FEWEST_POINTS, AGREEING * len(self.points_px)):
            return None
        chosen = agreeing.ravel() > 0
        on_plane = raycast_to_plane(self.scaled, self.T_cam_marker, before[chosen])
        if not np.isfinite(on_plane).all() or _breadth(on_plane) < NARROWEST_SIDES * self.side_m:
            return None
        is_solved, turn, shift = cv2.solvePnP(on_plane, after[chosen], self.scaled.K, None, flags=cv2.SOLVEPNP_IPPE)
        return rigid(cv2.Rodrigues(turn)[0], shift[:, 0]) if is_solved else None


def _breadth(points: Float) -> float:
    """Root mean square of the distances of points (n, 3) of a plane from the line that is nearest to them."""
    return float(np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]) / math.sqrt(len(points))


def _scaled(tracked: TrackedFrame) -> tuple[Image, Camera]:
    """The picture (h, w) without what is coarse in it, as exposure changes, and its camera."""
    image, (width, height) = np.asarray(tracked.frame.image_bgr), tracked.frame.size
    scale = min(1.0, WIDTH_PX / width)
    size = round(width * scale), round(height * scale)
    step = max(1, width // (2 * WIDTH_PX))  # of large pictures every pixel would take longer than the rest
    small = cv2.resize(np.ascontiguousarray(image[::step, ::step]), size, interpolation=cv2.INTER_AREA)
    grey = cv2.cvtColor(small, cv2.COLOR_BGR2GRAY)
    fine = cv2.addWeighted(grey, 1.0, cv2.blur(grey, (COARSE_PX, COARSE_PX)), -1.0, 128.0)
    return np.asarray(fine, np.uint8), tracked.camera.resized(size)


def _around(marker: MarkerPose, camera: Camera) -> Image:
    """(h, w) 255 where the plane near the marker is seen, beside its sheet or the body that it is printed on."""
    circle = np.column_stack([unit_circle(48), np.zeros(48)]) * TO_SIDES * marker.side_m
    printed = square_corners(2 * FROM_SIDES * marker.side_m)
    if marker.body is not None:
        printed = np.concatenate([printed, marker.body.points_marker()])
    mask = np.zeros(camera.size[::-1], np.uint8)
    for outline, value in ((circle, 255), (printed, 0)):
        seen = project(camera, marker.T_cam_marker, outline)
        seen = seen[np.isfinite(seen).all(axis=1)].clip(-FAR_PX, FAR_PX)
        if len(seen) > 2:
            cv2.fillConvexPoly(mask, cv2.convexHull(np.round(seen).astype(np.int32)), value)
    return mask

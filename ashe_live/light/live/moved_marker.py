"""The light of a room in the frame of a marker that is moved there, turned on the table or taken into the hand."""

import math
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.square import PlaneMarker, square_corners
from ashe_live.core.transforms import motion_between, transform_points
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.light.views.moved_frame import moved_body, moved_light, with_moved_marker

# A marker that is tilted by more than this, or lifted by more than this share of its side, is no longer on the table.
LEVEL_COS = math.cos(math.radians(5.0))
LIFTED_SIDES = 0.15
GRAZING, DARKEST = 0.05, 1e-3  # least sine of a light's elevation, and least light, by which anything is divided
WHERE_IT_LAY = "where it lay"  # stands for the sheet's former place in a frame from before it was moved


class FixedInRoom:
    """An illumination that stays in the room while the marker is moved in it."""

    def __init__(self, illumination: Illumination, T_room_marker: Float | None) -> None:
        """`illumination`: in the frame of the marker as it lay at `T_room_marker` (4, 4); None: it never moves."""
        self.illumination, self._T_room_marker = illumination, T_room_marker
        # As seen from the marker's last place: nothing that follows is made anew while the marker lies still.
        self._seen_at, self._seen = T_room_marker, illumination

    def seen_by(self, tracked: TrackedFrame | None) -> Illumination:
        """In the frame of the marker as it lies in `tracked`; as it was seen last where there is no marker in it."""
        if tracked is None or tracked.marker is None:
            return self._seen
        if self._seen_at is not tracked.T_room_marker:
            motion = motion_between(self._T_room_marker, tracked.T_room_marker)
            still = self.illumination
            self._seen_at = tracked.T_room_marker
            self._seen = still if motion is None else moved_illumination(still, motion, tracked.marker)
        return self._seen


def stays_on_plane(T_new_old: Float, side_m: float) -> bool:
    """Whether a marker that was moved by `T_new_old` (4, 4) lies on the plane on which it lay before."""
    return bool(T_new_old[2, 2] > LEVEL_COS and abs(T_new_old[2, 3]) < LIFTED_SIDES * side_m)


def moved_estimate(estimate: LightEstimate, T_new_old: Float, marker: MarkerPose) -> LightEstimate:
    """As `moved_illumination`; masks, views and all else stay those of the frames that the answer rests on."""
    return replace(estimate, illumination=moved_illumination(estimate.illumination, T_new_old, marker))


def moved_illumination(illumination: Illumination, T_new_old: Float, marker: MarkerPose) -> Illumination:
    """The same light in the marker's new frame.

    T_new_old (4, 4): rigid, metres, from the marker's frame before it was moved to that after. The real object stays
    where it is, unless the marker is printed on it. It is left out where a sheet no longer lies on its plane, as bodies
    stand upright on that.
    """
    body, slope, seen_in = illumination.real_object, illumination.sky_slope_rgb, illumination.seen_in
    is_level = stays_on_plane(T_new_old, marker.side_m)
    lights = tuple(moved_light(light, T_new_old) for light in illumination.lights)
    ambient = illumination.ambient_rgb_ratio
    if not is_level or any(light.inverse_distance > 0 for light in lights):
        lights, ambient = _shared_there(lights, illumination)
    if body is not None and marker.body is None:
        body = moved_body(body, T_new_old) if is_level else None
    return replace(
        illumination,
        lights=lights,
        ambient_rgb_ratio=ambient,
        real_object=body,
        seen_in=seen_in and with_moved_marker(seen_in, T_new_old),
        sky_slope_rgb=None if slope is None else T_new_old[:2, :2] @ slope,
        as_read=None if seen_in is None else illumination.as_read or illumination,
    )


def _shared_there(lights: tuple[Light, ...], before: Illumination) -> tuple[tuple[Light, ...], Float | None]:
    """The moved lights and the ambient light, with their shares of what the sheet receives where it lies now.

    What a light gives to the sheet goes by the cosine to its normal, which was the sine of the light's elevation
    before, and for a lamp by the inverse square of its distance; the sky gives about as much as before.
    """
    left = [light.ground_rgb_ratio for light in lights]
    if not lights or any(ratio is None for ratio in left):
        return lights, before.ambient_rgb_ratio
    shares = np.array([1 - ratio for ratio in left if ratio is not None])
    # A lamp's intensity, which was measured at the marker's centre, takes precedence over the ambient light.
    ambient = None if any(light.intensity_rgb_ratio is not None for light in lights) else before.ambient_rgb_ratio
    sky = np.clip(1 - shares.sum(axis=0), 0, 1) if ambient is None else ambient
    gains = np.array([_gain(now, was) for now, was in zip(lights, before.lights, strict=True)])
    received = shares * gains[:, None]
    total = np.maximum(sky + received.sum(axis=0), DARKEST)
    shared = (light.with_ground_share(one / total) for light, one in zip(lights, received, strict=True))
    return tuple(shared), None if before.ambient_rgb_ratio is None else np.asarray(sky / total)


def _gain(now: Light, was: Light) -> float:
    """How much more a light gives to the sheet than where that lay before: Lambert's cosine, and a lamp's distance."""
    nearer = 1.0 if was.inverse_distance == 0 else now.inverse_distance / was.inverse_distance
    return nearer**2 * max(float(now.to_light_marker[2]), 0.0) / max(float(was.to_light_marker[2]), GRAZING)


def seen_before_move(tracked: TrackedFrame, T_room_marker: Float) -> TrackedFrame | None:
    """A frame from before the marker's sheet was moved, as if the marker had lain where it lies now: `T_room_marker`.

    The sheet that is seen in it then counts as another printed sheet. None where the marker no longer lies on that
    plane, or is printed on a body, which has moved itself.
    """
    marker = tracked.pose
    motion = motion_between(tracked.T_room_marker, T_room_marker)
    if motion is None or marker.body is not None or not stays_on_plane(motion, marker.side_m):
        return None
    seen = with_moved_marker(tracked, motion)
    T_cam_marker, camera = seen.pose.T_cam_marker, tracked.camera
    corners = square_corners(marker.side_m)
    if (transform_points(T_cam_marker, corners)[:, 2] <= 0).any():
        return None
    corners_px, _ = cv2.projectPoints(
        corners, cv2.Rodrigues(T_cam_marker[:3, :3])[0], T_cam_marker[:3, 3], camera.K, camera.dist
    )
    turn_rad = math.atan2(motion[1, 0], motion[0, 0])
    was = PlaneMarker(WHERE_IT_LAY, motion[:2, 3], turn_rad, marker.side_m)
    others = tuple(
        replace(each, centre_m=was.on_plane(np.append(each.centre_m, 0.0))[:2], turn_rad=each.turn_rad + turn_rad)
        for each in tracked.others
    )
    if all(each.spec != WHERE_IT_LAY for each in others):  # else it was moved again, and lay there in no such frame
        others = (*others, was)
    return replace(
        seen,
        marker=replace(seen.pose, corners_px=np.asarray(corners_px[:, 0], np.float64), unfiltered_T_cam_marker=None),
        others=others,
        T_room_marker=T_room_marker,
    )

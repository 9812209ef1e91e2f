"""The undistorted frame at a working size, or a window of it, with the mask of the ground."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Image, Mask, fixed_point
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import PlaneMarker
from ashe_live.core.transforms import image_from_plane, project
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.light.pixels.areas import resized
from ashe_live.light.pixels.clean_plate.plain_ground import over_plain_ground
from ashe_live.light.pixels.near_plane import before_camera
from ashe_live.light.pixels.page import PageAround, page_around
from ashe_live.light.pixels.page_lines import PageLines
from ashe_live.light.pixels.screen import screen_around
from ashe_live.light.pixels.shaded_sheet import shaded_sheet_as_ground
from ashe_live.light.pixels.sheet import USUAL_SHEET, MarkerPicture, Sheet, measured_sheet
from ashe_live.light.pixels.shown_as_ground import page_shown_as_ground

# Ground farther away than this many times the marker's distance is resolved too coarsely to be of use.
FARTHEST = 4.0
# Poses differ by more than noise between views: shutters and breathing lenses bend the marker, too. On clips with both,
# rotations are off by five times the noise in the median.
OVER_NOISE = 5.0
ALL_SHOWN = 1 - 1e-4  # share of a pixel that the lens shows, but for rounding
# Grey levels, 0 to 255: all of a row or column that belongs to a black bar are below it, as a codec leaves bars nearly
# black, and not all of one that belongs to a picture.
BAR = 16
BLENDED_PX = 2  # rows or columns beside a bar that scaling and a codec mix with it

Window = tuple[slice, slice]  # rows and columns


@dataclass(frozen=True, slots=True, eq=False)
class View(MarkerPicture):
    """A picture without distortion, and what of it is ground."""

    is_ground: Mask  # (h, w) where the marker's plane is visible, outside of the printed sheet or body
    sheet: Sheet = USUAL_SHEET
    body: Proxy | None = None  # that the marker is printed on, if it is no sheet
    beside: tuple[PlaneMarker, ...] = ()  # other printed sheets on the plane
    page: PageAround | None = None  # that the marker is printed on, if it is shown as ground beyond the sheet
    # (h, w) of the whole picture: paper that is ground. Of a page's border what something crosses; a sheet in a shadow.
    paper_as_ground: Mask | None = None
    # (h, w) of the whole picture: what the lens shows; None: all. Of one that bends lines inwards there is a blank rim,
    # and beside a clip in a frame of other proportions there are black bars.
    shown: Mask | None = None
    measured: MarkerPose | None = None  # the pose that it was given, about which T_cam_marker may be moved
    plate_bgr: Image | None = None  # (h, w, 3) the same without the object (clean_plate), where it is known
    # The view as the camera took it, where this one shows things over plain ground, by that plate.
    taken: "View | None" = None

    @staticmethod
    def of(tracked: TrackedFrame, width_px: int) -> "View":
        """The frame scaled down to `width_px`, if it is wider, and undistorted. It must have a marker."""
        image, camera, shown = _straight(np.asarray(tracked.frame.image_bgr), tracked.camera, width_px)
        given, plate = tracked.clean_plate_bgr, None
        if given is not None:
            plate, _, _ = _straight(np.asarray(given), tracked.camera, width_px)
        marker, unknown = tracked.pose, np.zeros(image.shape[:2], np.bool_)
        view = View(image, camera, marker.T_cam_marker, marker.side_m, unknown, measured=marker, shown=shown)
        sheet = measured_sheet(view) if marker.body is None else USUAL_SHEET
        return replace(view, sheet=sheet, body=marker.body, beside=tracked.others, plate_bgr=plate)._with_ground()

    def with_paper_as_ground(self) -> "View":
        """This view, in which paper that things or shadows fall onto is ground, and shown in its colour: a whole page
        that the marker is printed on, and a sheet that a shadow falls onto. By a clean plate all that lies there is.

        A device whose screen shows the marker is no ground.
        """
        if self.body is not None:
            return self
        if self.plate_bgr is not None:
            alone, plain = replace(self, plate_bgr=None), over_plain_ground(self.image_bgr, self.plate_bgr)
            return replace(alone, image_bgr=plain, taken=alone.with_paper_as_ground())._with_ground()
        lines = PageLines.of(self)
        screen = screen_around(lines)
        if screen is not None:
            return replace(self, sheet=screen)._with_ground()
        view, page = self, page_around(lines, self)
        if page is not None:
            image, as_ground = page_shown_as_ground(page, self)
            view = replace(self, image_bgr=image, sheet=USUAL_SHEET, page=page, paper_as_ground=as_ground)
        shaded = shaded_sheet_as_ground(view, view.sheet)
        if shaded is not None:
            image, as_ground = shaded
            both = as_ground if view.paper_as_ground is None else view.paper_as_ground | as_ground
            view = replace(view, image_bgr=image, paper_as_ground=both)
        return view if view is self else view._with_ground()

    @property
    def size(self) -> tuple[int, int]:
        return self.camera.size

    @property
    def pose_covariance(self) -> Float | None:
        """(6, 6) of (w, v), as MarkerPose.covariance, by which poses differ from view to view; None for an exact pose.

        What all poses are off by alike, as by a curled marker or a wrong focal length, is no part of it.
        """
        noise = None if self.measured is None else self.measured.noise_covariance
        return None if noise is None else np.asarray(OVER_NOISE**2 * noise)

    def shows(self, marker: MarkerPose | None) -> bool:
        """Whether the picture is the one in which this pose was measured."""
        return self.measured is not None and self.measured is marker

    def seen_from(self, views: Sequence["View"]) -> "View":
        """This view with the pose of that one of the views which is of the same picture; as it is where none is."""
        same = next((view for view in views if view.shows(self.measured)), None)
        return self if same is None else replace(self, T_cam_marker=same.T_cam_marker)

    def scaled(self, width_px: int) -> "View":
        """This view scaled down to `width_px`, if it is wider."""
        if width_px >= self.size[0]:
            return self
        image, camera = scaled_down(self.image_bgr, self.camera, width_px)
        taken = None if self.taken is None else self.taken.scaled(width_px)
        return replace(self, image_bgr=image, camera=camera, taken=taken)._with_ground()

    def cut(self, window: Window) -> "View":
        """The part of the frame in `window`, seen by a camera whose principal point moves along."""
        rows, columns = window
        K = self.camera.K.copy()
        K[:2, 2] -= columns.start, rows.start
        size = columns.stop - columns.start, rows.stop - rows.start
        camera = replace(self.camera, size=size, K=K)
        taken = None if self.taken is None else self.taken.cut(window)
        image, is_ground = self.image_bgr[window], self.is_ground[window]
        return replace(self, image_bgr=image, camera=camera, is_ground=is_ground, taken=taken)

    def _with_ground(self) -> "View":
        """This view with the ground as all else in it has it."""
        printed: list[Float] = []
        if self.taken is None:  # over plain ground there is no print
            printed.append(self.sheet.corners(self.side_m) if self.body is None else self.body.points_marker())
            printed += [one.on_plane(USUAL_SHEET.corners(one.side_m)) for one in self.beside]
            printed += [] if self.page is None else self.page.between(self.side_m)
        is_ground, size = _ground_mask(self.camera, self.T_cam_marker, printed), self.size
        if self.paper_as_ground is not None:
            is_ground |= resized(self.paper_as_ground, size)
        if self.shown is not None:
            # Only pixels of which the lens shows all.
            is_ground &= cv2.resize(self.shown.astype(np.float32), size, interpolation=cv2.INTER_AREA) > ALL_SHOWN
        return replace(self, is_ground=is_ground)


def plane_homography(of: MarkerPicture, to: MarkerPicture) -> Float:
    """(3, 3) homography from the pixels of one picture to those of another, through the marker's plane."""
    onto_of, onto_to = (image_from_plane(each.camera, each.T_cam_marker) for each in (of, to))
    return np.asarray(onto_to @ np.linalg.inv(onto_of))


def scaled_down(image: Image, camera: Camera, width_px: int) -> tuple[Image, Camera]:
    """The picture (h, w, 3) scaled down to `width_px`, if it is wider, and its camera."""
    width, height = camera.size
    scale = min(1.0, width_px / width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    if size != (width, height):
        image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    return image, camera.resized(size)


def _straight(image: Image, camera: Camera, width_px: int) -> tuple[Image, Camera, Mask | None]:
    """The picture scaled down to `width_px`, if it is wider, without distortion; its camera; and View.shown."""
    image, camera = scaled_down(image, camera, width_px)
    shown = _between_bars(image)
    if not camera.is_distorted:
        return image, camera, shown
    straight = np.asarray(cv2.undistort(image, camera.K, camera.dist), dtype=np.uint8)
    white = np.full(image.shape[:2], 255, np.uint8) if shown is None else 255 * shown.view(np.uint8)
    return straight, camera.without_distortion(), np.asarray(cv2.undistort(white, camera.K, camera.dist) == 255)


def _between_bars(image: Image) -> Mask | None:
    """(h, w) the picture (h, w, 3) without black bars at its borders; None if there are none, or nothing else."""
    if min(side.max() for side in (image[0], image[-1], image[:, 0], image[:, -1])) >= BAR:
        return None
    bright = image.max(axis=-1) >= BAR
    rows, columns = np.flatnonzero(bright.any(axis=1)), np.flatnonzero(bright.any(axis=0))
    if not len(rows):
        return None
    shown = np.zeros(bright.shape, np.bool_)
    shown[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] = True
    blended = np.ones((2 * BLENDED_PX + 1,) * 2, np.uint8)
    return np.asarray(cv2.erode(shown.view(np.uint8), blended)).view(np.bool_)


def _ground_mask(camera: Camera, T_cam_marker: Float, printed_marker: Sequence[Float]) -> Mask:
    """(h, w) pixels whose ray meets the marker's plane, not too far away, outside of each hull of points (n, 3)."""
    width, height = camera.size
    line = ground_line(camera, T_cam_marker)
    mask = np.ones((height, width), np.uint8)
    corners = np.array([(x, y, 1) for x in (0, width - 1) for y in (0, height - 1)])
    if not (corners @ line > 0).all():
        mask[:] = line[0] * np.arange(width) + (line[1] * np.arange(height) + line[2])[:, None] > 0
    for points in printed_marker:
        outline = project(camera, T_cam_marker, before_camera(points, T_cam_marker))
        if len(outline):
            hull = cv2.convexHull(np.clip(outline, -1e6, 1e6).astype(np.float32))[:, 0]
            cv2.fillConvexPoly(mask, fixed_point(hull), 0, shift=FRACTION_BITS)
    return mask.view(np.bool_)


def ground_line(camera: Camera, T_cam_marker: Float) -> Float:
    """(3,) the line in the picture that ends the ground: its product with a pixel (x, y, 1) is the distance in pixels.

    That is positive where the pixel's ray meets the marker's plane, and not too far away; where the plane is seen from
    straight above, all pixels' are positive, and no distances.
    """
    normal, place = T_cam_marker[:3, 2], T_cam_marker[:3, 3]
    # The depth of the plane along a pixel's ray is `offset` over how much the ray faces it.
    row, offset = normal @ np.linalg.inv(camera.K), float(normal @ place)
    line = np.sign(offset) * row
    line[2] -= max(abs(offset) / (FARTHEST * float(np.linalg.norm(place))), 1e-9)
    return np.asarray(line / max(float(np.hypot(*line[:2])), 1e-9))

"""For programs that embed this one: plain pictures in, poses and light out (docs/api.md)."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from ashe_live.capture.photo import PhotoSource
from ashe_live.core import arguments
from ashe_live.core.arrays import GivenImage, Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.ranges import MARKER_SIDE, TIME
from ashe_live.core.square import side_lengths_px, square_corners
from ashe_live.core.transforms import camera_centre, project
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators import estimator as estimators
from ashe_live.light.live.clean_plates import over_empty_table, refuse_unused
from ashe_live.light.live.same_scene import first_of_most, of_one_scene
from ashe_live.models.caster import read_caster
from ashe_live.quality import quality_named
from ashe_live.tracking import tracker
from ashe_live.tracking.edges.lens import source_from_ideal
from ashe_live.tracking.families import in_view
from ashe_live.tracking.families.layout import parse_target, usual_side_m

MARKER = "aruco:4x4_50:0"
ASSUMED_FPS = 30.0
# A camera that is lower over the marker's plane, for its distance or in metres, is in it.
LEAST_SINE, LEAST_HEIGHT_M = 1e-6, 1e-100
# Corners that are farther from where their pose has them, by the longest side, are none of its marker: filters and
# wrong focal lengths part them by far less.
MOST_OFF_SIDES, MOST_OFF_PX = 0.5, 2.0


def read_photo(path: str | Path) -> Image:
    """(h, w, 3) uint8 sRGB in OpenCV's channel order, upright as its EXIF data says, read-only.

    Raises UserError when the file is missing, damaged, too large or of an unknown format.
    """
    with PhotoSource(arguments.path(path, "path")) as source:
        frame = source.read()
    assert frame is not None
    return frame.image_bgr


def camera_of_photo(path: str | Path) -> Camera:
    """The camera by the focal length that a photo's EXIF data state; where they state none, `Camera.assumed`.

    Raises UserError as `read_photo`.
    """
    with PhotoSource(arguments.path(path, "path")) as source:
        if source.focal_px is None:
            return Camera.assumed(source.size)
        return Camera.from_focal(source.size, source.focal_px, "exif")


def markers_in_view(image_bgr: GivenImage) -> tuple[str, ...]:
    """Which markers a picture (h, w, 3) uint8 BGR shows, as `marker` takes them, the largest first: for one that is
    not known beforehand.

    ArUco markers and AprilTags, and "cube" for the paper cube; patterns, pictures and grids are found by name only.
    ValueError or TypeError for what is no such picture.
    """
    return in_view.markers_in_view(arguments.picture(image_bgr, "image_bgr"))


def estimate_light(
    image_bgr: GivenImage | Sequence[GivenImage],
    camera: Camera,
    marker: str = MARKER,
    side_m: float | None = None,
    quality: str = "balanced",
    estimator: str = "proxy",
    light: str = "auto",
    caster: str | Path | None = None,
    empty_bgr: GivenImage | None = None,
) -> LightEstimate:
    """Where the light is in a picture (h, w, 3) uint8 BGR, in the frame of the marker that lies in it.

    image_bgr: one picture, or several of one scene from different sides, in which nothing has moved. The answer is then
    for the first that shows the marker and the same as most of them (in another, a hand may be in the way).
    camera: of the pictures, to whose size it is scaled.
    marker: as `--marker` takes it, such as "apriltag:36h11:5" or "cube"; no other one is looked for.
    side_m: the black square's side (None: 0.08) or the cube's edge (None: 0.06), metres.
    quality: "fast", "balanced" or "accurate".
    estimator: "proxy", or "paper" for the AShE paper's method.
    light: "sun"; "auto": a lamp where the picture shows its distance; "lamp": where it tells anything of its distance.
    caster: the object that casts the shadow, where its shape and size are known: "box:WxDxH", "cylinder:RxH" or
    "sphere:R" in metres, or the path of a model, whose convex hull it is.
    empty_bgr: the same view without the object, of the same size, by a camera that hardly moved: the ground's pattern,
    paint and other things do not count then. For one picture.

    Without a marker, or without a light, the estimate has no lights and says why. Raises UserError when the marker's,
    the estimator's or the caster's name or file cannot be used, the camera has another aspect ratio, `empty_bgr` shows
    another view, or the estimator makes no use of it; ValueError for any other wrong value, TypeError for an argument
    of another kind.
    """
    chosen = make_estimator(arguments.text(estimator, "estimator"), quality, light, caster)
    tracker = Tracker(camera, marker, side_m, quality)
    pictures = image_bgr if isinstance(image_bgr, (list, tuple)) else (image_bgr,)
    if not pictures:
        raise ValueError("there is no picture to look at")
    views = []
    for picture in pictures:
        tracker.reset()
        views.append(tracker.track(picture))
    if empty_bgr is not None:
        refuse_unused(chosen.name, "empty_bgr")
        if len(pictures) > 1:
            raise ValueError("empty_bgr is for one picture, and not for several")
        if arguments.picture(empty_bgr, "empty_bgr").shape != views[0].frame.image_bgr.shape:
            raise ValueError(f"empty_bgr has the shape {empty_bgr.shape}, and not {views[0].frame.image_bgr.shape}")
    with_marker = [view for view in views if view.marker is not None]
    if not with_marker:
        return chosen.estimate(views[0])
    first = first_of_most(with_marker)
    if empty_bgr is not None:
        tracker.reset()
        first = over_empty_table(first, tracker.track(empty_bgr), "empty_bgr")
    return chosen.estimate(first, of_one_scene(first, [view for view in with_marker if view is not first]))


def make_estimator(
    name: str = "proxy", quality: str = "balanced", light: str = "auto", caster: str | Path | None = None
) -> "LightEstimator":
    """An estimator to keep for one frame after another; `estimate_light` makes a new one each time.

    `name` is what `estimate_light` calls `estimator`; `quality`, `light` and `caster` are as there. Frames of the paper
    cube are estimated by the cube, whatever the caster. Raises UserError for an unknown estimator or a caster that
    cannot be read, ValueError for an unknown quality or light, TypeError for an argument of another kind.
    """
    return LightEstimator(arguments.text(name, "name"), quality, light, caster)


class LightEstimator:
    """Where the light is in tracked frames. For use by one thread at a time; another process may get a copy of it."""

    def __init__(self, name: str, quality: str, light: str, caster: str | Path | None = None) -> None:
        """As `make_estimator`."""
        self._made_by = name, quality, light, caster
        known = None if caster is None else read_caster(arguments.text_or_path(caster, "caster"))
        self._estimator = estimators.make_estimator(name, quality_named(quality).light.assuming(light, known))

    def __reduce__(self) -> tuple[type["LightEstimator"], tuple[str, str, str, str | Path | None]]:
        return LightEstimator, self._made_by  # the copy is made anew, in a process that has a caster's file as well

    @property
    def name(self) -> str:
        """As given to `make_estimator`."""
        return self._estimator.name

    def estimate(self, tracked: TrackedFrame, others: Iterable[TrackedFrame] = ()) -> LightEstimate:
        """In the frame of the marker. Without one, or without a light, there are no lights and `reason` says why.

        `others` are views of the same scene from other sides, with nothing moved in between; those without a marker,
        or by whose pose the camera is not above its plane, are left out. Its `views` and `span_rad` say what the answer
        rests on. Raises ValueError for a pose that has the marker elsewhere in the picture than its `corners_px`,
        TypeError for an argument of another kind.
        """
        for other in (others := tuple(arguments.instance(others, Iterable, "others"))):
            arguments.instance(other, TrackedFrame, "each of others")
        reason = _why_not_seen(arguments.instance(tracked, TrackedFrame, "tracked"))
        for each, name in ((tracked, "tracked"), *((other, "each of others") for other in others)):
            _check_corners(each, name)
        if reason is not None:
            return LightEstimate(self.name, tracked.frame.index, Illumination(), reason)
        return self._estimator.estimate(tracked, tuple(other for other in others if _why_not_seen(other) is None))


def _why_not_seen(tracked: TrackedFrame) -> str | None:
    """Why a frame cannot show the light, as its marker is not seen, or from nowhere above it."""
    if tracked.marker is None:
        return "no marker found"
    centre = camera_centre(tracked.marker.T_cam_marker)
    if centre[2] <= max(LEAST_SINE * np.linalg.norm(centre), LEAST_HEIGHT_M):
        return "by the marker's pose the camera is not above its plane: z points out of the surface"
    return None


def _check_corners(tracked: TrackedFrame, name: str) -> None:
    """Raises ValueError for a pose, such as an inverted one, that contradicts the corners: its light would be wrong."""
    if tracked.marker is None:
        return
    seen_px, camera = tracked.marker.corners_px, tracked.camera
    posed_px = project(camera, tracked.marker.T_cam_marker, square_corners(tracked.marker.side_m))
    if not np.isfinite(posed_px).all():  # a frame of the caller's own may begin behind the camera
        return
    off_px = np.hypot(*(source_from_ideal(camera, posed_px) - seen_px).T).max()
    if off_px > MOST_OFF_PX + MOST_OFF_SIDES * side_lengths_px(seen_px).max():
        raise ValueError(
            f"{name} has a marker whose corners_px are up to {off_px:.0f} px beside those by T_cam_marker and side_m"
        )


class Tracker:
    """Finds the marker in one picture after another. For use by one thread at a time (docs/tracking.md)."""

    def __init__(
        self, camera: Camera, marker: str = MARKER, side_m: float | None = None, quality: str = "balanced"
    ) -> None:
        """The arguments are those of `estimate_light`.

        Raises UserError when `marker` names none or its file cannot be read, ValueError or TypeError for a wrong side,
        quality or camera.
        """
        arguments.instance(camera, Camera, "camera")
        target = parse_target(arguments.text(marker, "marker"))
        side_m = usual_side_m(marker) if side_m is None else MARKER_SIDE.checked(side_m, "side_m")
        self._tracker = tracker.MarkerTracker(target, camera, side_m, quality_named(quality).tracking)
        self._next_index = 0
        self._time_s = -1 / ASSUMED_FPS

    def track(self, image_bgr: GivenImage, time_s: float | None = None) -> TrackedFrame:
        """The picture (h, w, 3) uint8 BGR with the pose measured in it, or with marker None when there is none.

        `time_s` counts from the first picture; by default it is a thirtieth of a second after the one before. Until
        the next call the picture must stay as it is. Raises UserError when the camera has another aspect ratio than the
        picture, ValueError or TypeError for what is no such picture or time.
        """
        arguments.picture(image_bgr, "image_bgr")
        self._time_s = self._time_s + 1 / ASSUMED_FPS if time_s is None else TIME.checked(time_s, "time_s")
        tracked = self._tracker.track(Frame(image_bgr, self._next_index, self._time_s))
        self._next_index += 1
        return tracked

    def reset(self) -> None:
        """Forgets the last pose: the next picture has nothing to do with it."""
        self._tracker.reset()

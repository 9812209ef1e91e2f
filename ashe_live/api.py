"""For programs that embed this one: plain pictures in, poses, light and pictures out (docs/api.md)."""

import os
import threading
import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from ashe_live.capture.photo import PhotoSource
from ashe_live.core import arguments
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.ranges import DRAWN, MARKER_SIDE, Range
from ashe_live.core.types import Frame, Illumination, LightEstimate, TrackedFrame
from ashe_live.errors import ModelWarning
from ashe_live.light.estimators import estimator as estimators
from ashe_live.models.caster import read_caster
from ashe_live.models.placement import PlacedModel
from ashe_live.models.reading import read_model
from ashe_live.quality import QUALITIES, Quality
from ashe_live.tracking import tracker
from ashe_live.tracking.families.layout import parse_target, usual_side_m

MARKER = "aruco:4x4_50:0"
ASSUMED_FPS = 30.0
TIME = Range(-1e9, 1e9, "s")


def read_photo(path: str | Path) -> Image:
    """(h, w, 3) uint8 sRGB in OpenCV's channel order, upright as its EXIF data says, read-only.

    Raises UserError when the file is missing, damaged, too large or of an unknown format.
    """
    with PhotoSource(arguments.path(path, "path")) as source:
        frame = source.read()
    assert frame is not None
    return frame.image_bgr


def estimate_light(
    image_bgr: Image | Sequence[Image],
    camera: Camera,
    marker: str = MARKER,
    side_m: float | None = None,
    quality: str = "balanced",
    estimator: str = "proxy",
    light: str = "auto",
    caster: str | None = None,
) -> LightEstimate:
    """Where the light is in a picture (h, w, 3) uint8 BGR, in the frame of the marker that lies in it.

    A list or tuple of pictures is of one scene in which nothing has moved, from several sides; the answer is for the
    first of them that shows the marker. `camera` is scaled to the picture; `side_m` is the black square's side (None:
    0.08) or the cube's edge (None: 0.06). A `light` that is "auto" is a lamp where the picture tells its distance;
    "sun" and "lamp" are always the one or the other. `caster` is the object that casts the shadow where its shape and
    size are known: "box:WxDxH", "cylinder:RxH" or "sphere:R" in metres, or the path of a model whose convex hull it is.
    Without a marker, or without a light, the estimate has no lights and says why. Raises UserError when the marker's or
    the caster's name or file cannot be used, or the camera is of another shape; ValueError for wrong use.
    """
    chosen, tracker = make_estimator(estimator, quality, light, caster), Tracker(camera, marker, side_m, quality)
    pictures = image_bgr if isinstance(image_bgr, (list, tuple)) else (image_bgr,)
    if not pictures:
        raise ValueError("there is no picture to look at")
    views = []
    for picture in pictures:
        tracker.reset()
        views.append(tracker.track(picture))
    with_marker = [view for view in views if view.marker is not None]
    first, *others = with_marker or views[:1]
    return chosen.estimate(first, others)


def make_estimator(
    name: str = "proxy", quality: str = "balanced", light: str = "auto", caster: str | None = None
) -> "LightEstimator":
    """An estimator for one frame after another, which `estimate_light` makes anew each time.

    Raises UserError for an estimator that is not there or a caster that is none, ValueError for such a quality or
    light. Frames of the paper cube are estimated by the cube, whatever the caster.
    """
    return LightEstimator(arguments.text(name, "name"), quality, light, caster)


class LightEstimator:
    """Where the light is in tracked frames. For use by one thread at a time."""

    def __init__(self, name: str, quality: str, light: str, caster: str | None = None) -> None:
        """As `make_estimator`."""
        steps = replace(_quality(quality).light, light=light)
        if caster is not None:
            steps = steps.with_caster(read_caster(arguments.text(caster, "caster")))
        self._estimator = estimators.make_estimator(name, steps)

    @property
    def name(self) -> str:
        return self._estimator.name

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        """In the frame of the marker. Without one, or without a light, there are no lights and `reason` says why.

        `others` are views of the same scene from other sides, with nothing moved in between; those without a marker
        are left out. What the answer rests on is in its `views` and `span_rad`.
        """
        for other in others:
            arguments.instance(other, TrackedFrame, "each of others")
        if arguments.instance(tracked, TrackedFrame, "tracked").marker is None:
            return LightEstimate(self.name, tracked.frame.index, Illumination(), "no marker found")
        return self._estimator.estimate(tracked, tuple(other for other in others if other.marker is not None))


class Tracker:
    """Finds the marker in one picture after another. For use by one thread at a time."""

    def __init__(
        self, camera: Camera, marker: str = MARKER, side_m: float | None = None, quality: str = "balanced"
    ) -> None:
        """As `estimate_light`."""
        arguments.instance(camera, Camera, "camera")
        target = parse_target(arguments.text(marker, "marker"))
        side_m = usual_side_m(marker) if side_m is None else MARKER_SIDE.checked(side_m, "side_m")
        self._tracker = tracker.MarkerTracker(target, camera, side_m, _quality(quality).tracking)
        self._next_index = 0
        self._time_s = -1 / ASSUMED_FPS

    def track(self, image_bgr: Image, time_s: float | None = None) -> TrackedFrame:
        """The picture (h, w, 3) uint8 BGR with the pose measured in it, or with marker None when there is none.

        `time_s` counts from the first picture; by default it is a thirtieth of a second after the one before. Until
        the next call the picture must stay as it is.
        """
        arguments.picture(image_bgr, "image_bgr")
        self._time_s = self._time_s + 1 / ASSUMED_FPS if time_s is None else TIME.checked(time_s, "time_s")
        tracked = self._tracker.track(Frame(image_bgr, self._next_index, self._time_s))
        self._next_index += 1
        return tracked

    def reset(self) -> None:
        """Forgets the last pose: the next picture has nothing to do with it."""
        self._tracker.reset()


class Renderer:
    """Draws models into pictures, without a window. For use by the thread that made it; a context manager.

    Elsewhere, in a forked process, and after `release`, its methods raise ValueError: OpenGL would hang or crash there.
    """

    def __init__(self, size: Size, quality: str = "balanced") -> None:
        """`size` is the width and height of the pictures to come, into which the video's are fitted.

        Raises UserError when there is no OpenGL 3.3.
        """
        # Only here, so that estimating and tracking do without OpenGL.
        from ashe_live.render.gl.offscreen import offscreen_context
        from ashe_live.render.renderer import SceneRenderer

        size = arguments.picture_size(size, "size")
        DRAWN.checked(size[0] * size[1], "the number of pixels in size")
        preset = _quality(quality).render
        self._maker = os.getpid(), threading.get_ident()
        self._is_released = False
        self._context = offscreen_context()
        with self._context:
            self._renderer = SceneRenderer(self._context, preset, size)
        self._placed: dict[tuple[str, float], PlacedModel] = {}

    def render(
        self,
        tracked: TrackedFrame,
        model: str,
        illumination: Illumination | None = None,
        shows_light: bool = False,
        time_s: float = 0.0,
        is_cut_out: bool = False,
    ) -> Image:
        """(h, w, 3) uint8 BGR: the picture with a lit model on its marker, and the shadow that the model casts.

        `time_s`: of a model that moves, since its motion began; it is looped. `is_cut_out`: model and shadow alone,
        (h, w, 4) uint8 BGRA with straight alpha, so that they give the same picture when put over the frame.

        `model` is a shipped model's name (`model_names()`) or the path of a glTF, GLB, OBJ, PLY or STL file.
        `illumination` is an estimate's (`LightEstimate.illumination`) or one of your own; without it, or without a
        light in it, the sky alone gives light. Polished surfaces mirror the frame that it was seen in, whichever is
        drawn. Without a marker there is no model. What of a model is drawn otherwise than its file says is a
        ModelWarning, once. Raises UserError for a model that is not there or cannot be read.
        """
        from ashe_live.render.scene import Scene

        self._check_usable()
        arguments.instance(tracked, TrackedFrame, "tracked")
        arguments.text(model, "model")
        if illumination is not None:
            arguments.instance(illumination, Illumination, "illumination")
        placed = None if tracked.marker is None else self._model(model, tracked.marker.side_m)
        time_s = TIME.checked(time_s, "time_s")
        lit_by = illumination or Illumination()
        scene = Scene(tracked, placed, lit_by, shows_light, time_s=time_s, is_cut_out=is_cut_out)
        with self._context:
            self._renderer.render(scene)
            return self._renderer.read_bgra() if is_cut_out else self._renderer.read_bgr()

    def release(self) -> None:
        """Gives everything back to OpenGL; the renderer is of no use afterwards. May be called twice."""
        if self._is_released:
            return
        self._check_usable()
        self._is_released = True
        with self._context:
            self._renderer.release()
        self._context.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.release()

    def _check_usable(self) -> None:
        if self._is_released:
            raise ValueError("this renderer has been released: make a new one")
        if self._maker != (os.getpid(), threading.get_ident()):
            raise ValueError("a renderer is for the process and thread that made it: make one there")

    def _model(self, name: str, side_m: float) -> PlacedModel:
        """The same object again for the same name: it is uploaded once."""
        if (name, side_m) not in self._placed:
            placed = self._placed[name, side_m] = read_model(name, side_m)
            for note in placed.model.notes:
                warnings.warn(f"{name}: {note}", ModelWarning, stacklevel=3)
        return self._placed[name, side_m]


def _quality(name: str) -> Quality:
    return QUALITIES[arguments.one_of(name, QUALITIES, "quality")]

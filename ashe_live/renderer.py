"""For programs that embed this one: models drawn into their pictures, without a window (docs/api.md)."""

import os
import threading
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Self

from ashe_live.core import arguments
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.core.light import Illumination, Light
from ashe_live.core.ranges import DRAWN, TIME
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import ModelWarning, UserError
from ashe_live.files.reading import opened
from ashe_live.models.assembly.up import UPS
from ashe_live.models.catalogue import MOST_MODELS, model_file
from ashe_live.models.placement import PlacedModel, Placement
from ashe_live.models.reading import read_model
from ashe_live.process.signals import signals_held
from ashe_live.quality import quality_named
from ashe_live.render.beside import FirstPlaces, first_places

Name = str | os.PathLike[str]  # a shipped model's, or the path of a file
Standing = Name | tuple[Name, Placement]  # a model, by itself or moved from where it stands first
Stamp = tuple[int, int]  # of a file: when it was written, and its size
MOST_KEPT = 2 * MOST_MODELS  # models: those of a picture, and as many that may come back


class Renderer:
    """Draws models into pictures, without a window. For use by the thread that made it; a context manager.

    Elsewhere, in a forked process, and after `release`, its methods raise ValueError: OpenGL would hang or crash there.
    So does making one in a process that was forked from one with a renderer: `multiprocessing` has to "spawn" it.
    What signals raise, as Ctrl-C does or a notebook's button, waits until the picture is drawn. One that is never
    released keeps its memory, and is a ResourceWarning, as an open file is.
    """

    _is_released = True  # until it is made

    def __init__(self, size: Size, quality: str = "balanced") -> None:
        """`size` is the width and height of the pictures to come, in pixels, into which the video's are fitted.

        Raises UserError when there is no OpenGL 3.3, ValueError for a size that is too large to be drawn, an unknown
        quality or a forked process, TypeError for what is no size.
        """
        # Only here, so that estimating and tracking do without OpenGL.
        from ashe_live.render.gl.offscreen import offscreen_context
        from ashe_live.render.renderer import SceneRenderer

        size = arguments.picture_size(size, "size")
        DRAWN.checked(size[0] * size[1], "the number of pixels in size")
        preset = quality_named(quality).render.offline
        self._maker = os.getpid(), threading.get_ident()
        self._context = offscreen_context()
        with self._context:
            self._renderer = SceneRenderer(self._context, preset, size)
        self._is_released = False
        self._placed: dict[tuple[str, float, str | None], tuple[Stamp | None, PlacedModel]] = {}  # drawn last: last
        self._places = FirstPlaces()
        self._chosen_for: tuple[Light | None, bool] | None = None  # light, and whether there is a body that is seen
        self._frame: Frame | None = None  # drawn last

    def render(
        self,
        tracked: TrackedFrame,
        model: Standing | Sequence[Standing],
        illumination: Illumination | None = None,
        shows_light: bool = False,
        time_s: float = 0.0,
        is_cut_out: bool = False,
        up: str | None = None,
        hides_marker: bool = False,
    ) -> Image:
        """(h, w, 3) uint8 BGR: the picture with a lit model on its marker, and the shadow that the model casts.

        tracked: the frame that is drawn into. Without a marker in it there is no model. One that is not later than the
        frame before begins another video, of which nothing is known from the last one.
        model: a shipped model's name (`model_names()`), or the path of a glTF, GLB, OBJ, PLY or STL file; either of
        them with a Placement, (name, placement), which says how it is scaled, turned and shifted on the marker's plane;
        or a list of up to nine of these. A file is read anew where it has changed, and after many others. The list's
        models shade each other, and those without a placement stand side by side: the first over the marker, the second
        to its right, the third to its left, and so on; with the paper cube in a row beside it, out of its shadow, which
        stays there until another light is given.
        illumination: an estimate's (`LightEstimate.illumination`) or one of your own; None, or one without a light: the
        sky alone gives light. Polished surfaces mirror the frame that it was seen in, whichever frame is drawn.
        shows_light: also draws an arrow that comes from each light, or a bulb where a lamp is in view.
        time_s: the time within a moving model's animation, seconds; it is looped.
        is_cut_out: only model and shadow, (h, w, 4) uint8 BGRA with straight alpha; put over the frame, they give the
        same picture as without it.
        up: which axis of the first model's file is up: "y", "z", "x", "-y", "-z" or "-x". None: as the file says, or a
        guess where it does not say.
        hides_marker: the marker's sheet, or the paper cube with its shadow, is covered by ground like that around it,
        and the models stand there. The first picture waits for the cover, a second or more.

        Whatever is drawn differently from what a model's file says is a ModelWarning, once. Raises UserError for a
        model that is not there or cannot be read, ValueError or TypeError for any other wrong argument.
        """
        from ashe_live.render.scene import Scene

        self._check_usable()
        arguments.instance(tracked, TrackedFrame, "tracked")
        standing = _standings(model)
        if illumination is not None:
            arguments.instance(illumination, Illumination, "illumination")
        if up is not None:
            arguments.one_of(up, UPS, "up")
        self._check_there(name for name, _ in standing)
        self._follow(tracked.frame)
        placed: list[tuple[PlacedModel, Placement]] = []
        if tracked.marker is not None:
            side_m = tracked.marker.side_m
            places = self._places_on(tracked, illumination, hides_marker)
            for seat, (name, placement) in enumerate(standing):
                model_there = self._model(name, side_m, None if seat else up)
                placed.append((model_there, placement or places.on_marker(seat, side_m)))
        time_s = TIME.checked(time_s, "time_s")
        lit_by = illumination or Illumination()
        scene = Scene(tracked, None, lit_by, shows_light, time_s=time_s, is_cut_out=is_cut_out)
        scene = replace(scene, covers_marker=hides_marker)
        if placed:
            (first, placement), *others = placed
            scene = replace(scene, model=first, placement=placement, others=tuple(others))
        # What is half drawn, or half prepared, would be taken for whole the next time.
        with signals_held(), self._context:
            self._renderer.render(scene)
            return self._renderer.read_bgra() if is_cut_out else self._renderer.read_bgr()

    def release(self) -> None:
        """Gives everything back to OpenGL; the renderer is of no use afterwards. May be called twice."""
        if self._is_released:
            return
        self._check_usable()
        with signals_held():
            self._is_released = True
            with self._context:
                self._renderer.release()
            self._context.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def __del__(self) -> None:
        # Not released here, which may be in another thread, or within another renderer's drawing: that would fail.
        if not self._is_released and self._maker[0] == os.getpid():
            said = "a renderer was never released: its memory stays taken until the program ends (use it by `with`)"
            warnings.warn(said, ResourceWarning, stacklevel=2, source=self)

    def _check_usable(self) -> None:
        if self._is_released:
            raise ValueError("this renderer has been released: make a new one")
        if self._maker != (os.getpid(), threading.get_ident()):
            raise ValueError("a renderer is for the process and thread that made it: make one there")

    def _follow(self, frame: Frame) -> None:
        """Forgets the last video, as the ground over its marker and its noise, where another one begins."""
        if self._frame is not None and frame is not self._frame and frame.time_s <= self._frame.time_s:
            self._renderer.begin_anew()
            self._chosen_for = None
        self._frame = frame

    def _places_on(self, tracked: TrackedFrame, lit_by: Illumination | None, hides_marker: bool) -> FirstPlaces:
        """Where models stand that have no placement: beside a body they stay while the camera goes around it."""
        light = None if lit_by is None else lit_by.light
        has_body = not hides_marker and tracked.marker is not None and tracked.marker.body is not None
        if self._chosen_for is None or self._chosen_for[0] is not light or self._chosen_for[1] != has_body:
            self._places, self._chosen_for = first_places(tracked, light, hides_marker), (light, has_body)
        return self._places

    def _check_there(self, names: Iterable[str]) -> None:
        """Raises UserError for a model without a file, also in a frame without a marker, for which none is read."""
        known = {name for name, _, _ in self._placed}
        for name in names:
            if name not in known:
                opened(model_file(name)).close()

    def _model(self, name: str, side_m: float, up: str | None) -> PlacedModel:
        """The same object again for the same name, as it is uploaded once, until its file changes.

        What was read before is drawn on while another program writes the file, which is not whole then.
        """
        key, stamp = (name, side_m, up), _stamp(name)
        known = self._placed.get(key)
        if known is None or stamp not in (None, known[0]):
            try:
                placed = read_model(name, side_m, up)
                notes = placed.model.notes
            except UserError as error:
                if known is None:
                    raise
                placed, notes = known[1], (f"{error}; the model that was read before is drawn",)
            known = stamp, placed
            for note in notes:
                warnings.warn(f"{name}: {note}", ModelWarning, stacklevel=3)
        self._placed.pop(key, None)
        self._placed[key] = known
        while len(self._placed) > MOST_KEPT:
            del self._placed[next(iter(self._placed))]
        return known[1]


def _stamp(name: str) -> Stamp | None:
    """None for a file that is gone: a model that was read from it is drawn on."""
    try:
        found = model_file(name).stat()
    except (OSError, UserError):
        return None
    return found.st_mtime_ns, found.st_size


def _standings(model: Standing | Sequence[Standing]) -> list[tuple[str, Placement | None]]:
    """Names with placements; None for those that stand side by side. Raises TypeError or ValueError for others."""
    chosen: Sequence[Any] = model if isinstance(model, list | tuple) and not _is_moved(model) else [model]
    if not 0 < len(chosen) <= MOST_MODELS:
        raise ValueError(f"model is a list of {len(chosen)}, and must name 1 to {MOST_MODELS}")
    found: list[tuple[str, Placement | None]] = []
    for one in chosen:
        name, placement = one if _is_moved(one) else (one, None)
        found.append((arguments.text_or_path(name, "model"), placement))
    return found


def _is_moved(one: object) -> bool:
    """Whether it is a name with a placement, and not, as what `model_names` gives, a tuple of names."""
    return isinstance(one, tuple) and len(one) == 2 and isinstance(one[1], Placement)

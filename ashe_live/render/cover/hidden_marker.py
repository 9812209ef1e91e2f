"""Keeps a cover of the marker's sheet on the graphics card, steady from frame to frame.

The cover is made once and then only drawn in perspective, its brightness following the camera's exposure. It is made
anew for another scene or light, and once the camera has come so much nearer, or moved so far around, that the old one
would show. Where pictures do not wait for it, a draft comes before the first.
"""

import math
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.square import side_lengths_px
from ashe_live.core.transforms import lies_elsewhere, view_direction
from ashe_live.core.types import Illumination, TrackedFrame
from ashe_live.render.cover.ground_cover import GroundCover, ground_cover
from ashe_live.render.cover.hidden_by_body import TURNED_RAD
from ashe_live.render.cover.lit_alike import is_other_light, is_same_scene
from ashe_live.render.cover.sheet_now import SheetNow
from ashe_live.render.gl.programs import set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF

NEARER = 1.5  # the cover is made anew once the marker appears this many times as large, as it then lacks detail
TURNED_COS = np.cos(np.radians(30.0))  # and once the camera has turned by this, as the ground's relief looks different
LEFT_ALONE_S = 0.6  # time of the video after which the hand that has moved the sheet has let it go
RETRIED_S = 1.0  # time of the video after which another attempt follows one that failed


class HiddenMarker:
    """The cover of the marker's sheet, which is made, replaced and adapted to the exposure."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.shown: HiddenMarker | None = None  # that of the window, for what is recorded or saved beside it
        self._ctx = ctx
        self._texture: moderngl.Texture | None = None
        self._cover: GroundCover | None = None
        self._made_from: tuple[TrackedFrame, Illumination] | None = None
        self._asked_for: tuple[TrackedFrame, Illumination] | None = None
        self._followed: TrackedFrame | None = None
        self._seen_lit_by: Illumination | None = None
        self._maker: ThreadPoolExecutor | None = None
        self._coming: Future[GroundCover | None] | None = None
        self._sheet: SheetNow | None = None  # the cover's
        self._failed_s: float | None = None
        self._moved_s = -math.inf  # time of the video at which the sheet was moved last

    @property
    def is_settled(self) -> bool:
        return self._coming is None

    @property
    def corners(self) -> Float:
        """(4, 2) metres, marker frame, of what is covered; (0, 2) while there is no cover."""
        if self._cover is None:
            return np.zeros((0, 2))
        left, bottom, right, top = self._cover.extent_m
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])

    def follow(self, tracked: TrackedFrame, illumination: Illumination, waits: bool) -> None:
        """Takes a cover that is ready, has another made where that is called for, and follows the exposure.

        `waits`: for that one, as a picture without a window does; else another thread makes it. Beside a window that
        one's covers are taken, whether they fit or not; where the picture `waits`, only those that do.
        """
        if self._followed is not None and self._followed.T_room_marker is not tracked.T_room_marker:
            self._moved_s = tracked.frame.time_s
        self._followed = tracked
        self._take()
        if self.shown is not None:
            self._take_shown(self.shown, tracked, illumination, waits)
        self._follow_sheet(tracked)
        if self.shown is not None and not waits:
            return
        steady = self._seen_lit_by is not None and is_same_scene(illumination, self._seen_lit_by)
        self._seen_lit_by = illumination
        # While a light eases to another one, or the sheet is moved, each frame has one of its own.
        lies_still = abs(tracked.frame.time_s - self._moved_s) >= LEFT_ALONE_S
        is_time = self._cover is None or (lies_still and (steady or waits))
        if self._coming is None and is_time and self._is_due(tracked, illumination):
            self._asked_for = tracked, illumination
            if waits:
                self._accept(ground_cover(tracked, illumination))
                self._follow_sheet(tracked)
            else:
                self._maker = self._maker or ThreadPoolExecutor(1, "ground cover")
                is_draft = self._cover is None or self._is_elsewhere(tracked)
                self._coming = self._maker.submit(ground_cover, tracked, illumination, is_draft)

    def bind(self, program: moderngl.Program) -> None:
        """For a program that was built with `covers`."""
        assert self._texture is not None
        assert self._sheet is not None
        self._texture.use(UNIT_OF["cover"])
        self._sheet.bind(program)

    def forget(self) -> None:
        """Nothing is covered until another cover is made: one that is still being made is not taken."""
        self._release_cover()
        self._coming = None
        self._cover = self._made_from = self._seen_lit_by = self._failed_s = None

    def release(self) -> None:
        if self._maker is not None:
            self._maker.shutdown(wait=True, cancel_futures=True)
        self._maker = None
        self.forget()

    def _take(self) -> None:
        if self._coming is not None and self._coming.done():
            coming, self._coming = self._coming, None
            self._accept(coming.result())

    def _take_shown(
        self, shown: "HiddenMarker", tracked: TrackedFrame, illumination: Illumination, waits: bool
    ) -> None:
        """Takes the window's cover, or its being without one; `waits`: only a cover that fits better than its own."""
        if shown._followed is not tracked:  # the window is minimised
            shown.follow(tracked, illumination, waits=False)
        asked_for = shown._asked_for
        if waits and shown._coming and asked_for and is_same_scene(illumination, asked_for[1]):
            wait([shown._coming])  # it is there sooner than another one would be
            shown._take()
        if waits and (shown._is_due(tracked, illumination) or not self._is_due(tracked, illumination)):
            return
        if shown._cover is None:
            self.forget()
        elif shown._cover is not self._cover:
            self._asked_for = shown._made_from
            self._accept(shown._cover)

    def _accept(self, cover: GroundCover | None) -> None:
        assert self._asked_for is not None
        if cover is None:
            self._failed_s = self._asked_for[0].frame.time_s
            return
        self._release_cover()
        size = len(cover.image_rgba)
        self._texture = self._ctx.texture((size, size), 4, np.ascontiguousarray(cover.image_rgba[::-1]))
        self._texture.repeat_x = self._texture.repeat_y = False
        # From farther away than it was made from, a lookup is the mean of the texels that a pixel shows.
        self._texture.build_mipmaps()
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        self._cover, self._made_from, self._failed_s = cover, self._asked_for, None
        self._sheet = SheetNow(self._ctx, cover)

    def _is_elsewhere(self, tracked: TrackedFrame) -> bool:
        """Whether the sheet has been moved since the cover was made, so that other ground is around it."""
        if self._made_from is None:
            return False
        was, now = self._made_from[0], tracked
        assert now.marker is not None
        return lies_elsewhere(was.T_room_marker, now.T_room_marker, now.marker.side_m)

    def _is_in_other_light(self, tracked: TrackedFrame, illumination: Illumination) -> bool:
        """Whether the sheet lies in another light than the cover's, which is not told from things before it."""
        is_elsewhere = self._is_elsewhere(tracked)
        return self._made_from is not None and not is_elsewhere and is_other_light(illumination, self._made_from[1])

    def _is_due(self, tracked: TrackedFrame, illumination: Illumination) -> bool:
        is_touched = self._sheet is not None and self._sheet.is_touched(tracked.frame.time_s)
        if is_touched and not self._is_in_other_light(tracked, illumination):
            return False
        if self._failed_s is not None and 0 <= tracked.frame.time_s - self._failed_s < RETRIED_S:
            return False
        if self._made_from is None or self._cover is None or self._cover.is_draft:
            return True
        made_from, lit_by = self._made_from
        was, now = made_from.marker, tracked.marker
        assert was is not None
        assert now is not None
        if was.side_m != now.side_m or self._is_elsewhere(tracked) or not is_same_scene(illumination, lit_by):
            return True
        is_nearer = side_lengths_px(now.corners_px).max() > NEARER * side_lengths_px(was.corners_px).max()
        least_cos = TURNED_COS if now.body is None else np.cos(TURNED_RAD)
        turned = view_direction(was.T_cam_marker) @ view_direction(now.T_cam_marker) < least_cos
        return bool(is_nearer or turned)

    def _follow_sheet(self, tracked: TrackedFrame) -> None:
        if self._sheet is not None:
            self._sheet.follow(tracked, self._is_elsewhere(tracked))

    def _release_cover(self) -> None:
        for held in (self._texture, self._sheet):
            if held is not None:
                held.release()
        self._texture = self._sheet = None


@dataclass(frozen=True, slots=True, eq=False)
class SeenCover:
    """A cover in one picture, as the composite needs it."""

    hidden: HiddenMarker
    ground_from_pixel: Float  # (3, 3) as `Framing.ground_from_pixel`

    def bind(self, program: moderngl.Program) -> None:
        """For programs that were built with `covers`."""
        self.hidden.bind(program)
        set_uniforms(program, ground_from_pixel=self.ground_from_pixel)

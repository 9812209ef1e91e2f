"""Keeps a cover of the marker's sheet on the graphics card, steady from frame to frame.

A cover is only drawn in perspective, its brightness following the camera's exposure, until the maker has another one.
"""

from dataclasses import dataclass

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination
from ashe_live.core.types import TrackedFrame
from ashe_live.render.cover.cover_maker import CoverMaker, MadeCover
from ashe_live.render.cover.sheet_now import SheetNow
from ashe_live.render.gl.programs import set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF


class MarkerCover:
    """What covers the marker's sheet, in a window and in what is recorded or saved beside it."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._maker = CoverMaker()
        self._shown: MadeCover | None = None  # in the texture
        self._texture: moderngl.Texture | None = None
        self._sheet: SheetNow | None = None  # the cover's

    @property
    def is_settled(self) -> bool:
        return self._maker.is_settled

    @property
    def corners(self) -> Float:
        """(4, 2) metres, marker frame, of what is covered; (0, 2) while there is no cover."""
        if self._shown is None:
            return np.zeros((0, 2))
        left, bottom, right, top = self._shown.cover.extent_m
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])

    def follow(self, tracked: TrackedFrame, illumination: Illumination, waits: bool) -> None:
        """Takes a cover that is ready, has another made where that is called for, and follows the exposure.

        `waits`: for that one, as a picture without a window does; else another thread makes it.
        """
        self._maker.take(tracked, illumination, waits)
        self._follow_sheet(tracked)
        is_touched = self._sheet is not None and self._sheet.is_touched(tracked.frame.time_s)
        self._maker.make(tracked, illumination, waits, is_touched)
        self._follow_sheet(tracked)

    def follow_beside(self, tracked: TrackedFrame, illumination: Illumination, waits: bool) -> None:
        """As `follow`, for a picture beside the window's: where it does not wait, it is covered as that one is."""
        if waits or self._maker.followed is not tracked:  # which a minimised window has not followed
            self.follow(tracked, illumination, waits)

    def bind(self, program: moderngl.Program) -> None:
        """For a program that was built with `covers`."""
        assert self._texture is not None
        assert self._sheet is not None
        self._texture.use(UNIT_OF["cover"])
        self._sheet.bind(program)

    def forget(self) -> None:
        """Nothing is covered until another cover is made."""
        self._maker.forget()
        self._release_shown()

    def release(self) -> None:
        self._maker.release()
        self._release_shown()

    def _follow_sheet(self, tracked: TrackedFrame) -> None:
        made = self._maker.made
        if made is None:
            return
        if self._shown is not made:
            self._show(made)
        assert self._sheet is not None
        self._sheet.follow(tracked, made.is_elsewhere(tracked))

    def _show(self, made: MadeCover) -> None:
        self._release_shown()
        size = len(made.cover.image_rgba)
        self._texture = self._ctx.texture((size, size), 4, np.ascontiguousarray(made.cover.image_rgba[::-1]))
        self._texture.repeat_x = self._texture.repeat_y = False
        # From farther away than it was made from, a lookup is the mean of the texels that a pixel shows.
        self._texture.build_mipmaps()
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        self._sheet = SheetNow(self._ctx, made.cover)
        self._shown = made

    def _release_shown(self) -> None:
        for held in (self._texture, self._sheet):
            if held is not None:
                held.release()
        self._shown = self._texture = self._sheet = None


@dataclass(frozen=True, slots=True, eq=False)
class SeenCover:
    """A cover in one picture, as the composite needs it."""

    cover: MarkerCover
    ground_from_pixel: Float  # (3, 3) as `Framing.ground_from_pixel`

    def bind(self, program: moderngl.Program) -> None:
        """For programs that were built with `covers`."""
        self.cover.bind(program)
        set_uniforms(program, ground_from_pixel=self.ground_from_pixel)

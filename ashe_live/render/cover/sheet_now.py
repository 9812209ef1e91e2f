"""The covered sheet as it is now, beside the frame that its cover was made from: its exposure, and what is over it."""

import math

import moderngl
import numpy as np

from ashe_live.core.arrays import Float32
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.camera.exposure import followed, gain_and_slope
from ashe_live.render.cover.ground_cover import GroundCover
from ashe_live.render.cover.over_sheet import over_sheet
from ashe_live.render.gl.programs import set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF

MUCH = 0.02  # share of the sheet: what hides more of it is a hand or a thing for as long as it does
# Time of the video after which what hides less is taken for what another light has left, as a cloud does or a lamp that
# is moved, and for no finger.
FINGER_STAYS_S = 10.0


class SheetNow:
    """One cover's sheet, from frame to frame."""

    def __init__(self, ctx: moderngl.Context, cover: GroundCover) -> None:
        self.gain, self._slope = np.ones(3), np.zeros(2)  # as of `gain_and_slope`
        self._ctx = ctx
        self._cover = cover
        self._exposed_in: Frame | None = None
        self._compared_in: Frame | None = None
        self._hidden_share = 0.0
        self._hidden_since_s = math.inf  # time of the video
        self._over = self._shown(None, None)

    def follow(self, tracked: TrackedFrame, lies_elsewhere: bool) -> None:
        """Compares the frame's sheet with the cover's.

        `lies_elsewhere`: on other ground than in the cover's frame, by which no exposure can be compared.
        """
        if tracked.frame is self._compared_in:
            return
        self._compared_in = tracked.frame
        if not lies_elsewhere:
            self._follow_exposure(tracked)
        sheet = self._cover.sheet
        over = None if sheet is None else over_sheet(tracked, sheet, self.gain, self._slope)
        self._hidden_share = 0.0 if over is None else float(over[..., 0].mean())
        self._hidden_since_s = min(self._hidden_since_s, tracked.frame.time_s) if self._hidden_share > 0 else math.inf
        self._over = self._shown(over, self._over)

    def is_touched(self, time_s: float) -> bool:
        """Whether a hand or a thing is before it, which would become a part of a cover made from this frame."""
        return self._hidden_share > MUCH or 0 <= time_s - self._hidden_since_s < FINGER_STAYS_S

    def bind(self, program: moderngl.Program) -> None:
        """For a program that was built with `covers`."""
        sheet = self._cover.sheet
        self._over.use(UNIT_OF["over_sheet"])
        set_uniforms(
            program,
            cover_half_m=self._cover.half_m,
            cover_gain=tuple(self.gain),
            cover_slope=tuple(self._slope),
            sheet_bounds=self._cover.extent_m if sheet is None else sheet.bounds_m,
            sheet_shadow=(1.0, 1.0, 1.0) if sheet is None else tuple(sheet.shadow / (sheet.shadow @ REC709_LUMINANCE)),
        )

    def release(self) -> None:
        self._over.release()

    def _follow_exposure(self, tracked: TrackedFrame) -> None:
        measured = gain_and_slope(tracked, self._cover.around, self._cover.around_rgb)
        if measured is None:
            return
        gain, slope = measured
        if self._exposed_in is not None:
            size = self._cover.half_m
            shown, found = (np.append(np.log(g), size * s) for g, s in ((self.gain, self._slope), (gain, slope)))
            next_shown = followed(shown, found)
            gain, slope = np.exp(next_shown[:3]), next_shown[3:] / size
        self.gain, self._slope, self._exposed_in = gain, slope, tracked.frame

    def _shown(self, over: Float32 | None, former: moderngl.Texture | None) -> moderngl.Texture:
        """The texture of (h, w, 2) as of `over_sheet`, or of nothing; the `former` one where that has its size."""
        values = np.zeros((1, 1, 2), np.float32) if over is None else np.ascontiguousarray(over[::-1])
        height, width = values.shape[:2]
        if former is not None and former.size == (width, height):
            former.write(values)
            return former
        if former is not None:
            former.release()
        texture = self._ctx.texture((width, height), 2, values, dtype="f4")
        texture.repeat_x = texture.repeat_y = False
        return texture

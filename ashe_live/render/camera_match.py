"""Gives the rendered model the blur, the resolution and the noise of the video's camera."""

import math

import moderngl

from ashe_live.core.types import Frame
from ashe_live.render.canvas import Canvas
from ashe_live.render.framing import Rectangle
from ashe_live.render.programs import build_program, set_uniforms
from ashe_live.render.texture_units import UNIT_OF
from ashe_live.render.video_look import BOX_VARIANCE_PX2, VideoLook

LEAST_BLUR_PX = 0.15
LEAST_NOISE = 0.25 / 255


class CameraMatch:
    """Works on a finished picture whose alpha channel is 1 where the video is and 0 where the model is."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "camera_match")
        self._rectangle = ctx.vertex_array(self._program, [])
        self._copy = Canvas(ctx)

    def draw(
        self, target: moderngl.Framebuffer, region: Rectangle, viewport: Rectangle, frame: Frame, look: VideoLook
    ) -> None:
        """In `region` of `target`, a single-sample framebuffer whose `viewport` shows the frame."""
        if min(region[2:]) <= 0:
            return
        scale = viewport[2] / frame.size[0]
        # A pixel of the video is a box of `scale` pixels, and the model's own pixels are boxes already.
        variance = scale**2 * (look.blur_sigma_px**2 + BOX_VARIANCE_PX2) - BOX_VARIANCE_PX2
        blur = math.sqrt(max(variance, 0.0)) if look.blur_sigma_px > 0 else 0.0
        if blur < LEAST_BLUR_PX and look.noise_sigma < LEAST_NOISE:
            return
        left, bottom, width, height = region
        reach = math.ceil(2 * blur) + 1
        copy, framebuffer = self._copy.of_size(target.size)
        framebuffer.scissor = (left - 2 * reach, bottom - 2 * reach, width + 4 * reach, height + 4 * reach)
        self._ctx.copy_framebuffer(framebuffer, target)
        copy.use(UNIT_OF["picture"])
        # Binomial weights 1/4, 1/2, 1/4 at a distance d have the variance d^2 / 2.
        step = math.sqrt(2) * blur
        set_uniforms(
            self._program,
            blur_step=(step / target.size[0], step / target.size[1]),
            noise_sigma=look.noise_sigma,
            grain_px=(scale, viewport[3] / frame.size[1]),
            origin_px=(float(viewport[0]), float(viewport[1])),
            seed=frame.index,
        )
        target.scissor = (left - reach, bottom - reach, width + 2 * reach, height + 2 * reach)
        target.use()
        self._ctx.viewport = (0, 0, *target.size)
        self._ctx.enable_only(moderngl.NOTHING)
        self._rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
        target.scissor = None  # type: ignore[assignment]  # moderngl's stub knows no "none"
        target.use()

    def release(self) -> None:
        self._copy.release()
        self._rectangle.release()
        self._program.release()

"""The environment maps that polished surfaces mirror, and how much of it they do, as textures."""

from dataclasses import dataclass

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, same_objects
from ashe_live.core.light import Illumination
from ashe_live.core.types import TrackedFrame
from ashe_live.render.gl.programs import set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.lighting import GROUND_ALBEDO, RGB
from ashe_live.render.reflections.reflectance import share_texture
from ashe_live.render.reflections.surroundings import (
    LinearPicture,
    blurred_levels,
    even_surroundings,
    level_count,
    surroundings_of,
)

LEAST_CHANGE = 0.02  # of the video's white, relative, by which even ground is filled anew where no frame was seen


@dataclass(frozen=True, slots=True, eq=False)
class _Content:
    """What the maps show."""

    seen_in: TrackedFrame | None  # None: even ground
    ground_rgb: Float | None
    covered: bytes  # of the covered sheet's corners

    def is_that_of(self, other: "_Content") -> bool:
        mine, others = ((each.seen_in, each.ground_rgb) for each in (self, other))
        return same_objects(mine, others) and self.covered == other.covered


class Environment:
    """Two maps of `size` texels a side, a power of two; refilled only when what they show has changed."""

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        self._size = size
        self._ground, self._sky = (_blank(ctx, size) for _ in range(2))
        self._shares = share_texture(ctx)
        self._half_radius_m = 1.0
        self._shown: _Content | None = None
        self._asked_for: TrackedFrame | None = None  # the frame that was to be shown last
        self._white_rgb: RGB = (1.0, 1.0, 1.0)  # in the picture that the maps were filled from

    def show(self, illumination: Illumination, white_rgb: RGB, covered: Float) -> None:
        """Fills the maps from the frame that the illumination was seen in, or with even ground where there is none.

        `white_rgb`: of a fully lit white surface in that frame, or else in the video, linear. `covered`: (n, 2) metres,
        corners of the sheet where it is hidden.
        """
        wanted = _Content(illumination.seen_in, illumination.ground_rgb, covered.tobytes())
        seen_in, shown = wanted.seen_in, self._shown
        is_asked_again, self._asked_for = seen_in is self._asked_for, seen_in
        if seen_in is not None:
            self._white_rgb = white_rgb  # it becomes another one with the light, by which no map changes
        is_same_white = seen_in is not None or np.allclose(white_rgb, self._white_rgb, rtol=LEAST_CHANGE, atol=0.0)
        if shown is not None and is_same_white and wanted.is_that_of(shown):
            return
        # While the marker is moved, each frame has the same picture from another place: filled once the marker rests.
        if shown is not None and _is_same_picture(shown.seen_in, seen_in) and not is_asked_again:
            return
        if seen_in is not None:
            surroundings = surroundings_of(seen_in, self._size, wanted.ground_rgb, covered)
        else:
            assumed = GROUND_ALBEDO * np.array(white_rgb)
            surroundings = even_surroundings(self._size, assumed if wanted.ground_rgb is None else wanted.ground_rgb)
        _fill(self._ground, surroundings.ground)
        _fill(self._sky, surroundings.sky)
        self._half_radius_m = surroundings.half_radius_m
        self._shown, self._white_rgb = wanted, white_rgb

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program` what environment.glsl and brdf.glsl read."""
        self._ground.use(UNIT_OF["ground_map"])
        self._sky.use(UNIT_OF["sky_map"])
        self._shares.use(UNIT_OF["mirrored_shares"])
        set_uniforms(
            program,
            half_radius_m=self._half_radius_m,
            ground_white=self._white_rgb,
            environment_size=float(self._size),
        )

    def release(self) -> None:
        self._shown = None
        self._ground.release()
        self._sky.release()
        self._shares.release()


def _is_same_picture(one: TrackedFrame | None, other: TrackedFrame | None) -> bool:
    return one is not None and other is not None and one.frame is other.frame


def _blank(ctx: moderngl.Context, size: int) -> moderngl.Texture:
    texture = ctx.texture((size, size), 4, dtype="f2")
    texture.build_mipmaps(0, level_count(size) - 1)
    texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = False
    return texture


def _fill(texture: moderngl.Texture, picture: LinearPicture) -> None:
    for level, blurred in enumerate(blurred_levels(picture)):
        opaque = np.ones((*blurred.shape[:2], 1), np.float32)
        texture.write(np.dstack([blurred, opaque]).astype(np.float16), level=level)

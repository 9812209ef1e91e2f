"""The surroundings as textures: what polished surfaces mirror."""

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import TrackedFrame
from ashe_live.render.programs import set_uniforms
from ashe_live.render.surroundings import Picture, blurred_levels, level_count, surroundings_of

# Texture units that no other pass binds.
GROUND_UNIT, SKY_UNIT = 10, 11


class Environment:
    """Two maps of `size` texels a side, a power of two; made anew only for another picture."""

    def __init__(self, ctx: moderngl.Context, size: int) -> None:
        self._size = size
        self._ground, self._sky = (_blank(ctx, size) for _ in range(2))
        self._half_radius_m = 1.0
        self._shown: tuple[TrackedFrame, Float | None] | None = None

    def show(self, tracked: TrackedFrame, ground_rgb: Float | None) -> None:
        """The surroundings that `tracked`, which has a marker, was taken in."""
        if self._shown is not None and self._shown[0] is tracked and self._shown[1] is ground_rgb:
            return
        surroundings = surroundings_of(tracked, self._size, ground_rgb)
        _fill(self._ground, surroundings.ground)
        _fill(self._sky, surroundings.sky)
        self._half_radius_m = surroundings.half_radius_m
        self._shown = tracked, ground_rgb

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program` what environment.glsl reads."""
        self._ground.use(GROUND_UNIT)
        self._sky.use(SKY_UNIT)
        set_uniforms(
            program,
            ground_map=GROUND_UNIT,
            sky_map=SKY_UNIT,
            half_radius_m=self._half_radius_m,
            environment_size=float(self._size),
        )

    def release(self) -> None:
        self._shown = None
        self._ground.release()
        self._sky.release()


def _blank(ctx: moderngl.Context, size: int) -> moderngl.Texture:
    texture = ctx.texture((size, size), 4, dtype="f2")
    texture.build_mipmaps(0, level_count(size) - 1)
    texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = False
    return texture


def _fill(texture: moderngl.Texture, picture: Picture) -> None:
    for level, blurred in enumerate(blurred_levels(picture)):
        opaque = np.ones((*blurred.shape[:2], 1), np.float32)
        texture.write(np.dstack([blurred, opaque]).astype(np.float16), level=level)

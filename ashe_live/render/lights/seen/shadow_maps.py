"""The real object's shadows as a picture shows them, on the graphics card."""

from typing import NamedTuple

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.lights.seen.shadow import SeenShadow


class SeenShadowMap(NamedTuple):
    """One light's."""

    shadow: SeenShadow
    texture: moderngl.Texture  # two channels, rows by y; with a rim in which nothing is told
    lit_ground: moderngl.Texture | None  # four channels of linear light, as `LitGround`


class SeenShadowMaps:
    """Those of one real object."""

    def __init__(self, ctx: moderngl.Context, shadows: tuple[SeenShadow, ...]) -> None:
        self._maps = tuple(SeenShadowMap(shadow, _texture(ctx, shadow), _lit_ground(ctx, shadow)) for shadow in shadows)

    def of(self, light: Float) -> SeenShadowMap | None:
        """That of a light (4,), homogeneous; None where it was not seen, as of one that is elsewhere since."""
        return next((each for each in self._maps if np.array_equal(each.shadow.light, light)), None)

    def release(self) -> None:
        for each in self._maps:
            each.texture.release()
            if each.lit_ground is not None:
                each.lit_ground.release()
        self._maps = ()


def _texture(ctx: moderngl.Context, shadow: SeenShadow) -> moderngl.Texture:
    height, width = shadow.share.shape[:2]
    texture = ctx.texture((width, height), 2, np.ascontiguousarray(shadow.share), alignment=1)
    texture.repeat_x = texture.repeat_y = False
    return texture


def _lit_ground(ctx: moderngl.Context, shadow: SeenShadow) -> moderngl.Texture | None:
    if shadow.ground is None:
        return None
    height, width = shadow.ground.rgba.shape[:2]
    texture = ctx.texture((width, height), 4, np.ascontiguousarray(shadow.ground.rgba), dtype="f2")
    texture.repeat_x = texture.repeat_y = False
    return texture

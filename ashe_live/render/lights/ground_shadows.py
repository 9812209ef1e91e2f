"""The shadows on the ground, filtered once: they depend on casters and lights only, so that a frame just looks them up.

Each caster and light has a tile that shows the ground as that light sees it, so that it is as fine as the depth map
even where the ground is lit at a grazing angle.
"""

import math
from typing import Any

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import translated_and_scaled
from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.lighting import Lighting
from ashe_live.render.lights.shadow_maps import NOTHING_SEEN, LightBox, ShadowMaps, tile_corners

# A penumbra wider than this share of the caster is cut off, but a narrow one's tile may be as wide as it is long.
WIDEST_PENUMBRA = 1.0
# Of a wide penumbra's variance, what averaging neighbouring texels adds at most; it is drawn narrower by as much.
SMOOTHED_SHARE = 0.2
COARSEST = 4  # texels a side of a tile in the last level of its pyramid


class GroundShadows:
    """Tiles of `preset.ground_shadow_size` texels a side in one texture, in the order of the depth maps'."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, preset: RenderPreset) -> None:
        self._ctx = ctx
        self._programs = programs
        self._preset = preset
        self._size = preset.ground_shadow_size
        self._levels = round(math.log2(self._size / COARSEST))
        self._canvas = Canvas(ctx, 1, "f4")  # a software rasteriser interpolates this twice as fast as half precision
        self._noisy = Canvas(ctx, 2, "f4")  # one tile, before its texels are averaged
        self._texture: moderngl.Texture | None = None
        self._rectangle, self._averaging = WholeRectangle(ctx), WholeRectangle(ctx)
        self._drawn = 0
        self.group_count = 1  # of the casters that its texture holds, those that are models
        self._uniforms: dict[str, Float] = {}

    def render(self, shadows: ShadowMaps, lighting: Lighting) -> None:
        """Filters the depth maps if these have changed."""
        if self._drawn == shadows.renders or not lighting.lights:
            return
        self._drawn, self.group_count = shadows.renders, shadows.group_count
        boxes = shadows.boxes
        corners = tile_corners(len(boxes)) * self._size
        width, height = corners.max(axis=0) + self._size
        self._texture, framebuffer = self._canvas.of_size((int(width), int(height)))
        texture_size = np.array(framebuffer.size, dtype=np.float64)
        program = self._programs.get(
            "lights/ground_shadow",
            **shadows.constants
            | {"casters": len(boxes) // len(lighting.lights), "blocker_taps": self._preset.blocker_taps},
        )
        shadows.bind(program)
        framebuffer.clear(1.0)
        self._ctx.enable_only(moderngl.NOTHING)
        texture_from_marker = []
        for number, (box, corner) in enumerate(zip(boxes, corners, strict=True)):
            caster, light = divmod(number, len(lighting.lights))
            beyond = (_penumbra_shares(box) + 2 / self._size) / (1 - 4 / self._size)  # and a rim of two lit texels
            tile_from_unit = translated_and_scaled((*beyond, 0), (*(1 / (1 + 2 * beyond)), 1))
            tile_from_marker = tile_from_unit @ box.unit_from_marker
            if box.unit_from_marker is not NOTHING_SEEN:
                ground = _ground_from_tile(tile_from_marker)
                smoothing = {
                    "texels_per_m": self._size / (box.extent[:2] * (1 + 2 * beyond)),
                    "smoothed_share": SMOOTHED_SHARE if _is_wide(box, self._preset) else 0.0,
                }
                set_uniforms(program, marker_from_tile=ground, caster=caster, light=light, **smoothing)
                self._draw_tile(program, framebuffer, (int(corner[0]), int(corner[1])), smoothing)
            texture_from_tile = translated_and_scaled((*(corner / self._size), 0), (*(self._size / texture_size), 1))
            texture_from_marker.append(texture_from_tile @ tile_from_marker)
        # A wall gets light from shaded and lit ground at once.
        self._texture.build_mipmaps(0, self._levels)
        self._uniforms = {
            "ground_shadow_from_marker": np.array(texture_from_marker),
            "ground_shadow_texels_per_m": np.array([_per_metre(each, texture_size) for each in texture_from_marker]),
            "ground_shadow_levels": np.array(float(self._levels)),
            "ground_shadow_lower": (corners + 0.5) / texture_size,
            "ground_shadow_upper": (corners + self._size - 0.5) / texture_size,
            "light_point": lighting.light_points,
        }

    def _draw_tile(
        self, program: moderngl.Program, onto: moderngl.Framebuffer, corner: tuple[int, int], smoothing: dict[str, Any]
    ) -> None:
        """A tile at `corner`, in texels; one with a `smoothed_share` is drawn beside, and averaged into its place.

        smoothing: uniforms of both programs.
        """
        there = (*corner, self._size, self._size)
        if not smoothing["smoothed_share"]:
            onto.use()
            self._ctx.viewport = there
            self._rectangle.draw(program)
            return
        noisy, beside = self._noisy.of_size((self._size, self._size))
        beside.use()
        self._ctx.viewport = (0, 0, self._size, self._size)
        self._rectangle.draw(program)
        averaging = self._programs.get("lights/smoothed_shadow")
        set_uniforms(averaging, corner=corner, **smoothing)
        noisy.use(UNIT_OF["noisy_shadow"])
        onto.use()
        self._ctx.viewport = there
        self._averaging.draw(averaging)

    @property
    def content(self) -> object:
        """A token that is another object whenever the shadows were drawn again."""
        return self._uniforms

    def bind(self, program: moderngl.Program) -> None:
        if self._texture is not None:
            self._texture.use(UNIT_OF["ground_shadows"])
            set_uniforms(program, **self._uniforms)

    def release(self) -> None:
        self._rectangle.release()
        self._averaging.release()
        self._noisy.release()
        self._canvas.release()


def _penumbra_shares(box: LightBox) -> Float:
    """(2,) by how much a tile is larger on each side than its box, as a share of that."""
    # Of a caster that is a tenth higher.
    wanted = 1.1 * box.penumbra_m / box.extent[:2]
    longest = (box.extent[:2] * (1 + 2 * np.minimum(wanted, WIDEST_PENUMBRA))).max()
    return np.minimum(wanted, np.maximum(WIDEST_PENUMBRA, (longest / box.extent[:2] - 1) / 2))


def _is_wide(box: LightBox, preset: RenderPreset) -> bool:
    """Whether the widest penumbra has more texels of the depth map than its samples see, each of them two by two."""
    radius = box.penumbra_m * preset.shadow_map_size / box.extent[:2]
    return bool(math.pi * radius.prod() > 4 * preset.soft_taps)


def _ground_from_tile(tile_from_marker: Float) -> Float:
    """(4, 4): from a tile's coordinates to where the light's ray there meets the marker plane, homogeneous."""
    on_plane = np.ix_((0, 1, 3), (0, 1, 3))
    found = np.zeros((4, 4))
    found[on_plane] = np.linalg.inv(tile_from_marker[on_plane])
    return found


def _per_metre(texture_from_marker: Float, texture_size: Float) -> float:
    """Texels of the texture a metre of the plane has at the marker's centre; 0 where a lamp does not see it."""
    (x, y), w = texture_from_marker[:2, 3], texture_from_marker[3, 3]
    if w <= 0:
        return 0.0
    moves = (texture_from_marker[:2, :2] - np.outer((x / w, y / w), texture_from_marker[3, :2])) / w
    return math.sqrt(abs(float(np.linalg.det(moves * texture_size[:, None]))))

"""The shadows on the ground, filtered once: they depend on casters and lights only, so that a frame just looks them up.

Each caster and light has a tile that shows the ground as that light sees it, so that it is as fine as the depth map
even where the ground is lit at a grazing angle.
"""

import math
from collections.abc import Sequence

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
from ashe_live.render.lights.seen.shadow_maps import SeenShadowMap, SeenShadowMaps
from ashe_live.render.lights.shadow_maps import NOTHING_SEEN, LightBox, ShadowMaps, tile_corners

# A penumbra wider than this share of the caster is cut off, but a narrow one's tile may be as wide as it is long.
WIDEST_PENUMBRA = 1.0
# Of a wide penumbra's variance, what averaging neighbouring texels adds at most; it is drawn narrower by as much.
SMOOTHED_SHARE = 0.2
COARSEST = 4  # texels a side of a tile in the last level of its pyramid
RIM_TEXELS = 2  # lit texels around the penumbra in a tile
PENUMBRA_SPARE = 1.1  # the penumbra that a tile has room for over its box's: that of a caster a tenth higher
OUTLINE_ERROR = 0.012  # of the real object's shadow as its body casts it, as a share of the picture's width


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
        self._rectangle = WholeRectangle(ctx)
        self._drawn = 0
        self.group_count = 1  # of the casters that its texture holds, those that are models
        self._uniforms: dict[str, Float] = {}
        # (lights,) how far the real object's shadow may end elsewhere, as a share of the picture's width.
        self.outline_errors: Float = np.zeros(0)
        # Where a picture shows the real object's shadow in the only light.
        self.seen_of_real: SeenShadowMap | None = None

    def render(self, shadows: ShadowMaps, lighting: Lighting, seen: SeenShadowMaps | None = None) -> None:
        """Filters the depth maps if these have changed. `seen`: where a picture shows the real object's shadows."""
        if self._drawn == shadows.renders or not lighting.lights:
            return
        self._drawn, self.group_count = shadows.renders, shadows.group_count
        boxes = shadows.boxes
        seen_maps = self._seen_maps(len(boxes), lighting, seen)
        spares = [0.0 if each is None else each.shadow.reach_m for each in seen_maps]
        tiles_from_marker = [
            _tile_from_marker(box, self._size, spare) for box, spare in zip(boxes, spares, strict=True)
        ]
        corners = tile_corners(len(boxes)) * self._size
        width, height = corners.max(axis=0) + self._size
        framebuffer = self._canvas.of_size((int(width), int(height)))
        casters = {"casters": len(boxes) // len(lighting.lights), "blocker_taps": self._preset.blocker_taps}
        framebuffer.clear(1.0)
        self._ctx.enable_only(moderngl.NOTHING)
        for number, (box, corner, tile_from_marker) in enumerate(zip(boxes, corners, tiles_from_marker, strict=True)):
            if box.unit_from_marker is not NOTHING_SEEN:
                seen_map = seen_maps[number]
                program = self._programs.get(
                    "lights/ground_shadow", **shadows.constants | casters | {"seen": seen_map is not None}
                )
                shadows.bind(program)
                if seen_map is not None:
                    seen_map.texture.use(UNIT_OF["seen_shadow"])
                    set_uniforms(program, seen_bounds=tuple(map(float, seen_map.shadow.bounds)))
                caster, light = divmod(number, len(lighting.lights))
                ground = _ground_from_tile(tile_from_marker)
                set_uniforms(program, marker_from_tile=ground, caster=caster, light=light)
                self._draw_tile(program, framebuffer, (int(corner[0]), int(corner[1])), box, spares[number])
        # A wall gets light from shaded and lit ground at once.
        self._canvas.textures[0].build_mipmaps(0, self._levels)
        self._uniforms = self._places(tiles_from_marker, corners, np.array(framebuffer.size, dtype=np.float64))
        self._uniforms["light_point"] = lighting.light_points
        self.seen_of_real = seen_maps[-1] if len(lighting.lights) == 1 else None
        is_seen = [each is not None for each in seen_maps[-len(lighting.lights) :]]
        self.outline_errors = np.where(is_seen, 0.0, OUTLINE_ERROR)

    def _seen_maps(self, count: int, lighting: Lighting, seen: SeenShadowMaps | None) -> list[SeenShadowMap | None]:
        """For each of `count` tiles: those of the real object, if there is one, are the last."""
        real = [None if seen is None else seen.of(light.homogeneous) for light in lighting.lights]
        of_models = self.group_count * len(real)
        return [None] * of_models + real[: count - of_models]

    def _places(self, tiles_from_marker: Sequence[Float], corners: Float, texture_size: Float) -> dict[str, Float]:
        """The uniforms by which shaders look up the tiles at corners (n, 2), in texels of a texture of a size (2,)."""
        texture_from_marker = [
            translated_and_scaled((*(corner / self._size), 0), (*(self._size / texture_size), 1)) @ tile_from_marker
            for tile_from_marker, corner in zip(tiles_from_marker, corners, strict=True)
        ]
        return {
            "ground_shadow_from_marker": np.array(texture_from_marker),
            "ground_shadow_levels": np.array(float(self._levels)),
            "ground_shadow_lower": (corners + 0.5) / texture_size,
            "ground_shadow_upper": (corners + self._size - 0.5) / texture_size,
        }

    def _draw_tile(
        self,
        program: moderngl.Program,
        onto: moderngl.Framebuffer,
        corner: tuple[int, int],
        box: LightBox,
        spare_m: float,
    ) -> None:
        """The tile of a box, at `corner` in texels; with a wide penumbra it is drawn apart, then averaged there."""
        is_averaged = _is_wide(box, self._preset)
        smoothing = {
            "texels_per_m": self._size / (box.extent[:2] * (1 + 2 * _beyond(box, self._size, spare_m))),
            "smoothed_share": SMOOTHED_SHARE if is_averaged else 0.0,
        }
        set_uniforms(program, **smoothing)
        there = (*corner, self._size, self._size)
        if not is_averaged:
            onto.use()
            self._ctx.viewport = there
            self._rectangle.draw(program)
            return
        self._noisy.of_size((self._size, self._size)).use()
        self._ctx.viewport = (0, 0, self._size, self._size)
        self._rectangle.draw(program)
        averaging = self._programs.get("lights/smoothed_shadow")
        set_uniforms(averaging, corner=corner, **smoothing)
        self._noisy.bind("noisy_shadow")
        onto.use()
        self._ctx.viewport = there
        self._rectangle.draw(averaging)

    @property
    def content(self) -> object:
        """A token that is another object whenever the shadows were drawn again."""
        return self._uniforms

    def bind(self, program: moderngl.Program) -> None:
        self._canvas.bind("ground_shadows")
        set_uniforms(program, **self._uniforms)

    def release(self) -> None:
        self._rectangle.release()
        self._noisy.release()
        self._canvas.release()


def _tile_from_marker(box: LightBox, size: int, spare_m: float = 0.0) -> Float:
    """(4, 4) projective: from the marker frame to the tile of a box, [0, 1], of `size` texels a side."""
    beyond = _beyond(box, size, spare_m)
    return np.asarray(translated_and_scaled((*beyond, 0), (*(1 / (1 + 2 * beyond)), 1)) @ box.unit_from_marker)


def _beyond(box: LightBox, size: int, spare_m: float = 0.0) -> Float:
    """(2,) by how much a tile of `size` texels a side is larger than its box on each side, as a share of that.

    Besides the penumbra, and what a shadow may reach beyond its body's, it has a rim of RIM_TEXELS lit texels.
    """
    reaches = _penumbra_shares(box) + spare_m / box.extent[:2]
    return np.asarray((reaches + RIM_TEXELS / size) / (1 - 2 * RIM_TEXELS / size))


def _penumbra_shares(box: LightBox) -> Float:
    """(2,) how far the penumbra reaches beyond each side of a box, as a share of that, as far as it is drawn."""
    wanted = PENUMBRA_SPARE * box.penumbra_m / box.extent[:2]
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

"""Shadow maps: depth as the lights see it, one map for each caster and light, redrawn only when one of them changes.

Lance Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978. A map's frustum encloses its caster alone
and depends on caster and light alone: it is as tight as can be, and the shadow's edges stand still on the ground while
the camera moves.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Protocol

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, same_objects
from ashe_live.core.transforms import orthographic, translated_and_scaled
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.light_view import LightView, view_of
from ashe_live.render.lights.lighting import Lighting, ShadingLight

# No side of a map is shorter than this share of the longest, so that a flat model seen edge on still has one.
MIN_EXTENT_RATIO = 1e-3
# Penumbrae on a model that are wider than this share of its width are filtered by their width (5 pixels of 150);
# narrower ones by a fixed filter, which makes 2 to 3 pixels.
SEEN_PENUMBRA = 0.03
CLIP_FROM_UNIT: Float = translated_and_scaled((-0.5, -0.5, -0.5), (2, 2, 2))
UNIT_FROM_CLIP: Float = translated_and_scaled((1, 1, 1), (0.5, 0.5, 0.5))


class ShadowCaster(Protocol):
    """Whatever casts shadows; the same object always casts the same ones."""

    @property
    def points(self) -> Float: ...  # (n, 3) metres, marker frame; its hull encloses the caster

    @property
    def is_clear(self) -> bool: ...  # whether parts of it stop only a share of the light

    def render_depth(self, clip_from_marker: Float) -> None: ...


@dataclass(frozen=True, slots=True, eq=False)
class LightBox:
    """The part of a light's view that one map shows."""

    unit_from_marker: Float  # (4, 4) projective, to the map's coordinates and depth, all in [0, 1]
    extent: Float  # (3,) metres in the light's view, across and along the light
    tan_half_size: float  # the light's radius over its distance from the caster
    penumbra_m: float  # the widest on the ground, in the light's view


# For a lamp inside its caster: every point counts as nearer to the light than anything else.
NOTHING_SEEN = np.zeros((4, 4))
NOTHING_SEEN[:, 3] = 0.5, 0.5, -1.0, 1.0


class ShadowMaps:
    """Tiles of `preset.shadow_map_size` texels a side in one texture, in the order of casters, then lights."""

    def __init__(self, ctx: moderngl.Context, preset: RenderPreset) -> None:
        self.renders = 0
        self.texel_m = 0.0  # the largest side of a texel across a light, metres
        self.boxes: tuple[LightBox, ...] = ()
        self.group_count = 1  # casters that are models
        self.shadows_meet = self.real_shades_model = self.model_shades_real = False
        self._is_soft_on_model = self._is_dithered = False
        self._ctx = ctx
        self._preset = preset
        # Empty texels at a tile's border: what lies outside it is lit.
        self._margin = preset.pcf_radius + 2
        self._depths = ctx.sampler(repeat_x=False, repeat_y=False, filter=(moderngl.NEAREST, moderngl.NEAREST))
        self._depths.compare_func = ""
        self._texture: moderngl.Texture | None = None
        self._framebuffer: moderngl.Framebuffer | None = None
        self._lights = Lighting((), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)).constants
        self._content: tuple[tuple[ShadowCaster, ...], bytes] | None = None
        self._uniforms: dict[str, Float] = {}

    @property
    def constants(self) -> dict[str, float]:
        """Macros for a shader that includes shadow.glsl, and is drawn on the model or the real object."""
        is_soft = self._preset.soft_on_model or self._is_soft_on_model or self._is_dithered
        return {
            **self._lights,
            "dithered": self._is_dithered,
            "groups": self.group_count,
            "casters": self.group_count + self.real_shades_model,
            "pcf_radius": self._preset.pcf_radius,
            "blocker_taps": self._preset.blocker_taps if is_soft else 0,
            "soft_taps": self._preset.soft_taps,
        }

    @property
    def blur_texels(self) -> int:
        """How far the filter blurs a hard edge, at most; the penumbra comes on top."""
        return 2 * (self._preset.pcf_radius + 1)

    def render(self, groups: Sequence[ShadowCaster], lighting: Lighting, real: ShadowCaster | None = None) -> None:
        """Draws the maps of groups of models and then of the real object, unless they hold that already."""
        lights, casters = lighting.lights, (*groups, *([] if real is None else [real]))
        drawn_for = np.array([[*light.homogeneous, light.angular_size_rad] for light in lights]).tobytes()
        if self._content is not None and self._content[1] == drawn_for and same_objects(self._content[0], casters):
            return
        self._content = casters, drawn_for
        self._lights, self.group_count = lighting.constants, len(groups)
        self._find_overlaps(casters, lights)
        self.renders += 1
        if lights:
            self._draw(casters, lighting)

    def _find_overlaps(self, casters: Sequence[ShadowCaster], lights: Sequence[ShadingLight]) -> None:
        """Which shadows may meet or lie on the other caster, conservatively by boxes, and which are seen to be soft."""
        models, real = casters[: self.group_count], casters[self.group_count :]
        pairs = [(_overlaps(a, b, light), _overlaps(b, a, light)) for a, b, light in product(real, models, lights)]
        self.shadows_meet = any(onto_model[0] for onto_model, _ in pairs)
        self.real_shades_model = any(onto_model[1] for onto_model, _ in pairs)
        self.model_shades_real = any(onto_real[1] for _, onto_real in pairs)
        shading = casters if self.real_shades_model else models
        self._is_soft_on_model = any(_is_seen_soft(*shaded) for shaded in product(shading, models, lights))
        self._is_dithered = any(caster.is_clear for caster in casters)

    def _draw(self, casters: Sequence[ShadowCaster], lighting: Lighting) -> None:
        """A tile for each caster and light, and the uniforms by which shaders look them up."""
        lights, size = lighting.lights, self._preset.shadow_map_size
        tiles = tile_corners(len(lights) * len(casters)) * size
        framebuffer = self._allocated(tiles.max(axis=0) + size)
        self.boxes = tuple(
            _fitted(view_of(light, caster.points), caster.points, size, self._margin)
            for caster in casters
            for light in lights
        )
        framebuffer.viewport = (0, 0, *framebuffer.size)
        framebuffer.use()
        framebuffer.clear(depth=1.0)
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        for number, (box, corner) in enumerate(zip(self.boxes, tiles, strict=True)):
            self._ctx.viewport = (int(corner[0]), int(corner[1]), size, size)
            if box.unit_from_marker is not NOTHING_SEEN:
                casters[number // len(lights)].render_depth(CLIP_FROM_UNIT @ box.unit_from_marker)
        self.texel_m = float(max(box.extent[:2].max() for box in self.boxes)) / size
        self._uniforms = {
            "shadow_texture_size": np.array(framebuffer.size, dtype=np.float64),
            "shadow_tile": tiles.astype(np.float64),
            "shadow_from_marker": np.array([box.unit_from_marker for box in self.boxes]),
            "shadow_extent": np.array([box.extent for box in self.boxes]),
            "shadow_planes_from_marker": np.array([_plane_transform(box.unit_from_marker) for box in self.boxes]),
            "tan_half_size": np.array([box.tan_half_size for box in self.boxes]),
            "light_point": lighting.light_points,
        }

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program`, built with `constants`, what shadow.glsl reads."""
        if self._texture is None or not self._uniforms:
            return
        self._texture.use(UNIT_OF["shadow_maps"])
        self._texture.use(UNIT_OF["shadow_depths"])
        self._depths.use(UNIT_OF["shadow_depths"])
        set_uniforms(program, shadow_map_size=float(self._preset.shadow_map_size), **self._uniforms)

    def forget(self) -> None:
        """Drops the references to what was drawn last."""
        self._content = None

    def release(self) -> None:
        self.forget()
        self._release_texture()
        self._depths.release()

    def _allocated(self, size: Float) -> moderngl.Framebuffer:
        if self._framebuffer is not None and self._framebuffer.size == tuple(size):
            return self._framebuffer
        self._release_texture()
        self._texture = self._ctx.depth_texture((int(size[0]), int(size[1])))
        self._texture.compare_func = "<="
        self._texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = self._ctx.framebuffer(depth_attachment=self._texture)
        return self._framebuffer

    def _release_texture(self) -> None:
        if self._texture is not None and self._framebuffer is not None:
            self._framebuffer.release()
            self._texture.release()
        self._texture = self._framebuffer = None


def _overlaps(caster: ShadowCaster, receiver: ShadowCaster, light: ShadingLight) -> tuple[bool, bool]:
    """Whether their shadows may meet on the ground, and whether the caster may shade the receiver; by their boxes."""
    points = np.concatenate([caster.points, receiver.points])
    view = view_of(light, points)
    if view is None:
        return True, True
    seen, seen_receiver = view.seen(caster.points), view.seen(receiver.points)
    low, high = seen.min(axis=0), seen.max(axis=0)
    receiver_low, receiver_high = seen_receiver.min(axis=0), seen_receiver.max(axis=0)
    wider = max(view.penumbra_m(points), view.tan_half_size * (high[2] - receiver_low[2]))
    meets = not ((low - 2 * wider > receiver_high) | (high + 2 * wider < receiver_low))[:2].any()
    return bool(meets), bool(meets and high[2] > receiver_low[2])


def _is_seen_soft(caster: ShadowCaster, receiver: ShadowCaster, light: ShadingLight) -> bool:
    """Whether the caster's shadow on the receiver, which may be itself, has a penumbra that is seen as one."""
    view = view_of(light, np.concatenate([caster.points, receiver.points])) if light.angular_size_rad > 0 else None
    if view is None:
        return False
    shaded = view.seen(receiver.points)
    deep = view.seen(caster.points)[:, 2].max() - shaded[:, 2].min()
    return bool(2 * view.tan_half_size * deep > SEEN_PENUMBRA * np.ptp(shaded[:, :2], axis=0).max())


def tile_corners(count: int) -> Float:
    """(count, 2) columns and rows of a nearly square arrangement."""
    columns = int(np.ceil(np.sqrt(count)))
    return np.array([(number % columns, number // columns) for number in range(count)])


def _fitted(view: LightView | None, points: Float, size: int, margin: int) -> LightBox:
    """The box around points (n, 3), marker frame, in a light's view, as tight as the margin (in texels) allows.

    A texel's side is rounded up to five significant bits, and the box's corner is on the grid of texels: a caster that
    changes a little keeps its texels where they were.
    """
    if view is None:
        return LightBox(NOTHING_SEEN, np.ones(3), 0.0, 0.0)
    seen = view.seen(points)
    lower, upper = seen.min(axis=0), seen.max(axis=0)
    extent = np.maximum(upper - lower, MIN_EXTENT_RATIO * (upper - lower).max())
    texel = _rounded_up(extent[:2] / (size - 2 * margin - 1))
    corner = np.floor(((lower + upper)[:2] - size * texel) / 2 / texel) * texel
    middle, depth = (lower + upper)[2] / 2, 1.01 * extent[2]
    box_lower = np.array([*corner, middle - depth / 2])
    box_extent = np.array([*(size * texel), depth])
    clip_from_marker = orthographic(box_lower, box_lower + box_extent) @ view.from_marker
    return LightBox(UNIT_FROM_CLIP @ clip_from_marker, box_extent, view.tan_half_size, view.penumbra_m(points))


def _plane_transform(unit_from_marker: Float) -> Float:
    """(4, 4) for planes as rows (normal, offset): the inverse transpose."""
    if unit_from_marker is NOTHING_SEEN:
        return np.zeros((4, 4))
    return np.asarray(np.linalg.inv(unit_from_marker).T)


def _rounded_up(lengths: Float) -> Float:
    """To five significant bits: at most 1/16 more."""
    unit = 2.0 ** (np.floor(np.log2(lengths)) - 4)
    return np.asarray(np.ceil(lengths / unit) * unit)

"""Draws a scene: video, model, the shadow it casts on the video, the light's arrow, overlays."""

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Size
from ashe_live.core.quality import RenderPreset
from ashe_live.models.placement import PlacedModel
from ashe_live.render.arrow import LightArrow, arrow_extent, arrow_placement
from ashe_live.render.contact import ContactPatch
from ashe_live.render.framing import Framing, box_corners, framing, letterbox
from ashe_live.render.geometry import GpuModel
from ashe_live.render.ground import ShadowCatcher
from ashe_live.render.lighting import Lighting, lighting_of
from ashe_live.render.model_pass import ModelPass
from ashe_live.render.overlays import OverlayPass
from ashe_live.render.programs import build_program
from ashe_live.render.scene import Scene
from ashe_live.render.shadow_map import ShadowMap
from ashe_live.render.surface import Surface
from ashe_live.render.video import Video


class Renderer:
    """Renders scenes of `size` pixels into its own framebuffer; from there to a window, or to an array.

    Every call belongs to the thread that made `ctx`, with `ctx` current.
    """

    def __init__(self, ctx: moderngl.Context, preset: RenderPreset, size: Size) -> None:
        self._ctx = ctx
        self._preset = preset
        self.video = Video(ctx)
        self.overlays = OverlayPass(ctx)
        self._arrow = LightArrow(ctx)
        self._depth_program = build_program(ctx, "depth")
        self._contact = ContactPatch(ctx, self._depth_program)
        self._model: GpuModel | None = None
        self._surface = Surface(ctx, size, preset.msaa_samples)
        self._build_passes()

    @property
    def size(self) -> Size:
        return self._surface.size

    @property
    def shadow_map_renders(self) -> int:
        """How often the shadow map was drawn since the preset was set."""
        return self._shadow.renders

    @property
    def gl_renderer(self) -> str:
        return str(self._ctx.info["GL_RENDERER"])

    @property
    def gl_version(self) -> str:
        return str(self._ctx.info["GL_VERSION"])

    @property
    def preset(self) -> RenderPreset:
        return self._preset

    @preset.setter
    def preset(self, preset: RenderPreset) -> None:
        """Changes the quality between two pictures."""
        if preset == self._preset:
            return
        self._preset = preset
        self._release_passes()
        self._build_passes()
        self.resize(self.size)

    def resize(self, size: Size) -> None:
        """Follows the window's framebuffer; sides of 0 (a minimised window) count as 1."""
        former = self._surface
        self._surface = Surface(self._ctx, (max(1, size[0]), max(1, size[1])), self._preset.msaa_samples)
        # moderngl binds again what was bound before, which must not have been released by then.
        self._surface.colour.use()
        former.release()

    def render(self, scene: Scene) -> None:
        """Draws the scene into the renderer's own framebuffer."""
        self._follow_model(scene.model)
        if scene.tracked is None:
            self._surface.colour.clear()
        else:
            viewport = letterbox(scene.tracked.frame.size, self.size)
            self.video.show(scene.tracked, viewport)
            self.video.copy_or_draw(self._surface.colour, viewport)
            if self._model is not None and scene.tracked.marker is not None:
                self._draw_model(self._model, scene)
        self._surface.colour.use()
        self.overlays.draw(scene.overlays, self.size)

    def present(self, target: moderngl.Framebuffer) -> None:
        """Copies the last picture to a framebuffer of the same size, as a rule `ctx.screen`."""
        self._ctx.copy_framebuffer(target, self._surface.colour)

    def finish(self) -> None:
        """Waits until the last picture is drawn."""
        self._ctx.finish()

    def read_bgr(self) -> Image:
        """(h, w, 3) uint8 sRGB of the last picture in OpenCV's order, top row first; waits until it is drawn."""
        return self._surface.read_bgr()

    def release(self) -> None:
        """Gives every object back to OpenGL; the renderer is of no use afterwards."""
        self._release_passes()
        self._ctx.detect_framebuffer(0).use()
        for held in (self.video, self.overlays, self._arrow, self._contact, self._surface, self._depth_program):
            held.release()

    def _draw_model(self, model: GpuModel, scene: Scene) -> None:
        assert scene.tracked is not None
        assert scene.tracked.marker is not None
        lighting = lighting_of(scene.light)
        self._contact.render(model)
        self._shadow.render(model, lighting.to_light)
        self._catcher.fit(model, lighting, self._shadow, self._contact)
        arrow = None
        if scene.shows_light and scene.light is not None:
            arrow = arrow_placement(model.placed.bounds, scene.light.to_light_marker)
        viewport = letterbox(scene.tracked.frame.size, self.size)
        points = self._drawn_points(model, arrow)
        frame = framing(scene.tracked.camera, scene.tracked.marker.T_cam_marker, points, viewport)
        if frame is not None:
            self._draw_framed(model, frame, lighting, arrow)

    def _draw_framed(self, model: GpuModel, frame: Framing, lighting: Lighting, arrow: Float | None) -> None:
        """Works within the framing's region only: a software rasteriser pays for every pixel."""
        with self._surface.drawing(frame.region) as multisampled:
            self._ctx.viewport = frame.viewport
            if multisampled:
                self.video.draw()
            self._ctx.enable_only(moderngl.DEPTH_TEST)
            self._ctx.viewport = frame.viewport
            self._model_pass.draw(model, frame, lighting, self._shadow)
            if arrow is not None:
                self._arrow.draw(frame, arrow)
            self._catcher.draw(frame, self.video, lighting, self._shadow, self._contact)

    def _drawn_points(self, model: GpuModel, arrow: Float | None) -> Float:
        """(n, 3) points of the marker frame whose convex hull holds everything that is drawn."""
        points = [box_corners(model.placed.bounds), self._catcher.polygon]
        if arrow is not None:
            points.append(arrow_extent(arrow))
        return np.concatenate(points)

    def _follow_model(self, placed: PlacedModel | None) -> None:
        if self._model is not None and self._model.placed is not placed:
            for holder in (self._shadow, self._catcher, self._contact):
                holder.forget()
            self._model.release()
            self._model = None
        if self._model is None and placed is not None:
            self._model = GpuModel(self._ctx, placed, self._model_pass.program, self._depth_program)

    def _build_passes(self) -> None:
        """What depends on the preset."""
        radius = self._preset.pcf_radius
        self._shadow = ShadowMap(self._ctx, self._depth_program, self._preset.shadow_map_size, radius)
        self._catcher = ShadowCatcher(self._ctx, radius)
        self._model_pass = ModelPass(self._ctx, radius)

    def _release_passes(self) -> None:
        # The model's vertex arrays belong to the program that shades it.
        self._follow_model(None)
        for held in (self._shadow, self._catcher, self._model_pass):
            held.release()

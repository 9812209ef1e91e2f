"""Draws a scene: the video, the model and its shadow on the video, the lights' signs, and overlays."""

from collections.abc import Iterator, Sequence

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Size
from ashe_live.models.placement import PlacedModel
from ashe_live.render.gl.framing import framing, grown, letterbox
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.mirror import Mirror
from ashe_live.render.gl.offscreen import check_graphics
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import Programs
from ashe_live.render.layers import LayerPasses
from ashe_live.render.lights.environment import Environment
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.photometry import Photometry
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.occlusion import Known
from ashe_live.render.passes.composite import Composite
from ashe_live.render.passes.lens import Lens
from ashe_live.render.passes.light_sign import LightSign, light_sign
from ashe_live.render.passes.model_pass import LookedUp, ShadingInputs
from ashe_live.render.passes.outlines import Outlines
from ashe_live.render.passes.overlays import OverlayPass
from ashe_live.render.passes.prepared import ModelSwitches
from ashe_live.render.passes.standing import StandingGroup
from ashe_live.render.passes.surface import Surface
from ashe_live.render.passes.video import Video
from ashe_live.render.scene import Scene


class SceneRenderer:
    """Renders scenes of `size` pixels into its own framebuffer; from there to a window, or to an array.

    Every call belongs to the thread that made `ctx`, with `ctx` current.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        preset: RenderPreset,
        size: Size,
        switches_at_once: bool = True,
        known: Known | None = None,
    ) -> None:
        """`switches_at_once`: a new model is in the very next picture, however long that takes; else when ready.

        `known`: what another renderer has found out of its models, and is told of this one's.
        """
        self._known = Known() if known is None else known
        self._ctx = ctx
        self._preset = preset
        self.video = Video(ctx)
        self._straight_video = Video(ctx)
        self.overlays = OverlayPass(ctx)
        self._lens = Lens(ctx)
        self._mirror = Mirror(ctx)
        self._programs = Programs(ctx)
        self._outlines = Outlines(ctx, self._programs)
        self._composite = Composite(ctx, self._programs)
        self._environment = Environment(ctx, preset.environment_size)
        self._layers = LayerPasses(ctx, self._programs)
        self._shadows = ShadowMaps(ctx, preset)
        self._ground_shadows = GroundShadows(ctx, self._programs, preset)
        self._models = ModelSwitches(ctx, self._programs, self._build_shaders, switches_at_once, self._known)
        self._photometry = Photometry(preset)
        self._surface = Surface(ctx, size, preset.msaa_samples)

    def beside(self, preset: RenderPreset, size: Size) -> "SceneRenderer":
        """Another renderer of the same context, for other pictures."""
        return SceneRenderer(self._ctx, preset, size, known=self._known)

    @property
    def size(self) -> Size:
        return self._surface.size

    @property
    def shown_models(self) -> tuple[PlacedModel, ...]:
        """What was drawn last, which may be the former ones for some pictures."""
        return self._models.shown

    @property
    def switches_at_once(self) -> bool:
        """Whether a new model is shown in the very next picture, however long that takes, or when it is ready."""
        return self._models.at_once

    @switches_at_once.setter
    def switches_at_once(self, at_once: bool) -> None:
        self._models.at_once = at_once

    @property
    def shadow_map_renders(self) -> int:
        """How often the shadow maps were drawn since the preset was set."""
        return self._shadows.renders

    @property
    def gl_renderer(self) -> str:
        return str(self._ctx.info["GL_RENDERER"])

    @property
    def gl_version(self) -> str:
        return str(self._ctx.info["GL_VERSION"])

    @property
    def is_settled(self) -> bool:
        """Whether the same scene would be the same picture again: nothing is being prepared for the next ones."""
        return self._models.is_settled and self._layers.hidden_marker.is_settled

    @property
    def preset(self) -> RenderPreset:
        return self._preset

    @preset.setter
    def preset(self, preset: RenderPreset) -> None:
        """Changes the quality between two pictures."""
        if preset == self._preset:
            return
        self._preset = preset
        self._layers.catcher.forget()
        self._shadows.release()
        self._ground_shadows.release()
        self._shadows = ShadowMaps(self._ctx, preset)
        self._ground_shadows = GroundShadows(self._ctx, self._programs, preset)
        self._photometry = Photometry(preset)
        self._environment.release()
        self._environment = Environment(self._ctx, preset.environment_size)
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
        self._follow_models([model for model, _ in scene.models])
        if self._layers.follow_real_object(scene.real_object):
            self._shadows.forget()
        if scene.tracked is None:
            self._surface.colour.clear()
        else:
            viewport = letterbox(scene.tracked.frame.size, self.size)
            bends = self._preset.matches_lens and scene.tracked.camera.is_distorted
            self.video.show(scene.tracked, viewport, None if bends else scene.tracked.camera)
            if scene.is_cut_out:
                self._surface.colour.clear()
            else:
                self.video.copy_or_draw(self._surface.colour, viewport)
            standing = self._models.standing([placement for _, placement in scene.models], scene.time_s)
            if standing is not None and scene.tracked.marker is not None:
                self._draw_models(standing, scene, bends)
            if scene.is_mirrored:
                self._mirror.turn(self._surface.colour)
        self._surface.colour.use()
        self.overlays.draw(scene.overlays, self.size)

    def present(self, target: moderngl.Framebuffer) -> None:
        """Copies the last picture to a framebuffer of the same size, as a rule `ctx.screen`.

        Raises moderngl.Error when OpenGL has failed for good.
        """
        self._ctx.copy_framebuffer(target, self._surface.colour)
        check_graphics(self._ctx)

    def finish(self) -> None:
        """Waits until the last picture is drawn. Raises moderngl.Error as `present` does."""
        self._ctx.finish()
        check_graphics(self._ctx)

    def read_bgr(self) -> Image:
        """(h, w, 3) uint8 sRGB of the last picture in OpenCV's order, top row first; waits until it is drawn."""
        return self._surface.read_bgr()

    def read_bgra(self) -> Image:
        """(h, w, 4) uint8 sRGB with straight alpha, as `read_bgr`: of a scene that is cut out, what there is of it."""
        return self._surface.read_bgra()

    def release(self) -> None:
        """Gives every object back to OpenGL; the renderer is of no use afterwards."""
        self._follow_models(())
        self._layers.follow_real_object(None)
        self._ctx.detect_framebuffer(0).use()
        for held in (
            self.video,
            self.overlays,
            self._layers,
            self._straight_video,
            self._outlines,
            self._composite,
            self._lens,
            self._mirror,
            self._shadows,
            self._ground_shadows,
            self._environment,
            self._surface,
            self._programs,
        ):
            held.release()

    def _draw_models(self, models: StandingGroup, scene: Scene, bends: bool) -> None:
        """`bends`: the picture is that of the camera's own lens; else that of a pinhole camera."""
        tracked = scene.tracked
        assert tracked is not None
        assert tracked.marker is not None
        lighting = self._photometry.lighting(scene.illumination)
        self._shadows.render((models,) if self._layers.real is None else (models, self._layers.real), lighting)
        self._ground_shadows.render(self._shadows, lighting)
        hidden = self._layers.follow_sheet(scene, self.switches_at_once)
        covered = np.zeros((0, 2)) if hidden is None else hidden.corners
        self._layers.catcher.fit(models, lighting, self._shadows, covered)
        viewport = letterbox(tracked.frame.size, self.size)
        camera = self._lens.pinhole_of(tracked.camera) if bends else tracked.camera
        T_cam_marker = tracked.marker.T_cam_marker
        signed = scene.illumination.lights if scene.shows_light else ()
        signs = [light_sign(models.members[0].corners, light, camera, T_cam_marker) for light in signed]
        frame = framing(camera, T_cam_marker, self._drawn_points(models, signs), viewport)
        if frame is None:
            return
        look = self._photometry.look(tracked, scene.illumination)
        self._environment.show(scene.illumination, look.white_rgb, covered)
        straight = self.video
        if bends and self._shadows.shadows_meet:
            straight = self._straight_video
            straight.show(tracked, viewport, camera)
        reach = self._composite.reach_px(viewport, tracked.frame, look)
        with self._surface.drawing(grown(frame.region, 2 * reach + 1, self.size)):
            inputs = ShadingInputs(frame, lighting, self._looked_up, look.white_rgb)
            self._layers.draw(models, inputs, signs, scene, straight, hidden, self._photometry)
        if scene.shows_model and not self._surface.samples:
            model = framing(camera, T_cam_marker, models.corners, viewport)
            if model is not None:
                self._outlines.smooth(self._surface, grown(model.region, 1, self.size))
        lens = self._lens if bends else None
        self._composite.draw(
            self._surface, frame.region, viewport, self.video, tracked, look, lens, scene.is_split, scene.is_cut_out
        )

    def _drawn_points(self, models: StandingGroup, signs: list[LightSign]) -> Float:
        """(n, 3) points of the marker frame whose convex hull holds everything that is drawn."""
        return np.concatenate([models.corners, self._layers.catcher.polygon, *(sign.corners for sign in signs)])

    @property
    def _looked_up(self) -> LookedUp:
        return LookedUp(self._shadows, self._ground_shadows, self._environment)

    def _follow_models(self, placed: Sequence[PlacedModel]) -> None:
        if self._models.follow(placed):
            for holder in (self._shadows, self._layers.catcher):
                holder.forget()

    def _build_shaders(self, model: GpuModel) -> Iterator[None]:
        """In steps, with the variants that are known before the model is drawn."""
        building = self._layers.model_pass.build_for(model, self._looked_up)
        while True:
            with self._surface.drawing((0, 0, 1, 1)):
                if next(building, building) is building:
                    return
            yield

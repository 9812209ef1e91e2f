"""Draws a scene: the video, the models and their shadows on it, signs of the lights, and overlays."""

from collections.abc import Iterator, Sequence
from weakref import WeakSet

import moderngl

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.models.placement import PlacedModel
from ashe_live.render.cover.marker_cover import MarkerCover
from ashe_live.render.gl.driver import is_software
from ashe_live.render.gl.framing import letterbox
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.mirror import Mirror
from ashe_live.render.gl.offscreen import check_graphics
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import Programs
from ashe_live.render.models_on_video import ModelsOnVideo
from ashe_live.render.occlusion.occlusion import Known
from ashe_live.render.passes.overlays import OverlayPass
from ashe_live.render.passes.prepared import ModelSwitches
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
        known: Known | None = None,
        cover: MarkerCover | None = None,
    ) -> None:
        """Shared with other renderers: `known`, what each model hides of sky and ground, and the marker's `cover`."""
        self._known = Known() if known is None else known
        self._ctx = ctx
        self._preset = preset
        self.video = Video(ctx)
        self.overlays = OverlayPass(ctx)
        self._mirror = Mirror(ctx)
        self._programs = Programs(ctx)
        self._models_on_video = ModelsOnVideo(ctx, self._programs, preset, self.video, cover)
        self._models = ModelSwitches(ctx, self._programs, self._build_shaders, self._known)
        self._surface = self._new_surface(size)
        self._beside = WeakSet[SceneRenderer]()  # which begin anew with this one

    def beside(self, size: Size) -> "SceneRenderer":
        """Another renderer of the same context and preset, for other pictures of what this one shows."""
        made = SceneRenderer(self._ctx, self._preset, size, self._known, self._models_on_video.layers.cover)
        self._beside.add(made)
        return made

    @property
    def size(self) -> Size:
        return self._surface.size

    @property
    def shown_models(self) -> tuple[PlacedModel, ...]:
        """The models drawn last: for some pictures after a switch, the former ones."""
        return self._models.shown

    @property
    def gl_renderer(self) -> str:
        return str(self._ctx.info["GL_RENDERER"])

    @property
    def gl_version(self) -> str:
        return str(self._ctx.info["GL_VERSION"])

    @property
    def is_settled(self) -> bool:
        """Whether the same scene would give the same picture again, as nothing is being prepared for later ones."""
        return self._models.is_settled and self._models_on_video.layers.cover.is_settled

    @property
    def covers_marker(self) -> bool:
        """Whether ground was painted over the marker in the last picture, which has to be made first."""
        return len(self._models_on_video.layers.cover.corners) > 0

    @property
    def preset(self) -> RenderPreset:
        return self._preset

    @preset.setter
    def preset(self, preset: RenderPreset) -> None:
        """Changes the quality between two pictures."""
        if preset == self._preset:
            return
        self._preset = preset
        self._models_on_video.use_preset(preset)
        self.resize(self.size)

    def begin_anew(self) -> None:
        """Another video or marker follows: nothing of the last one, as the ground over the marker, is drawn into it."""
        self._models_on_video.begin_anew()
        for each in self._beside:
            each.begin_anew()

    def resize(self, size: Size) -> None:
        """Follows the window's framebuffer; sides of 0 (a minimised window) count as 1."""
        former = self._surface
        self._surface = self._new_surface((max(1, size[0]), max(1, size[1])))
        # moderngl binds again what was bound before, which must not have been released by then.
        self._surface.colour.use()
        former.release()

    def render(self, scene: Scene, waits: bool = True) -> None:
        """Draws the scene into the renderer's own framebuffer.

        `waits`: for new models, the marker's cover and the real object's outline, however long they take; else they
        appear in a later picture, once they are ready.
        """
        self._follow_models([model for model, _ in scene.models], waits)
        if scene.tracked is None:
            self._surface.colour.clear()
        else:
            viewport = letterbox(scene.tracked.frame.size, self.size)
            self.video.show(scene.tracked, viewport)
            if scene.is_cut_out:
                self._surface.colour.clear()
            else:
                self.video.copy_or_draw(self._surface.colour, viewport)
            standing = self._models.standing([placement for _, placement in scene.models], scene.time_s)
            if standing is not None and scene.tracked.marker is not None:
                self._models_on_video.draw(self._surface, standing, scene, waits)
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
        """(h, w, 4) uint8 sRGB with straight alpha, otherwise as `read_bgr`: for a scene that is cut out."""
        return self._surface.read_bgra()

    def release(self) -> None:
        """Releases all OpenGL objects; the renderer cannot be used afterwards."""
        self._follow_models((), waits=True)
        self._ctx.detect_framebuffer(0).use()
        for held in (self.video, self.overlays, self._models_on_video, self._mirror, self._surface, self._programs):
            held.release()

    def _new_surface(self, size: Size) -> Surface:
        preset = self._preset
        samples = preset.software_msaa_samples if is_software(self._ctx.info) else preset.msaa_samples
        return Surface(self._ctx, size, samples)

    def _follow_models(self, placed: Sequence[PlacedModel], waits: bool) -> None:
        if self._models.follow(placed, waits):
            self._models_on_video.forget_models()

    def _build_shaders(self, model: GpuModel) -> Iterator[None]:
        """In steps, with the variants that are known before the model is drawn."""
        drawing = self._models_on_video
        building = drawing.layers.model_pass.build_for(model, lambda: drawing.looked_up)
        while True:
            with self._surface.drawing((0, 0, 1, 1), several_samples=True):
                if next(building, building) is building:
                    return
            yield

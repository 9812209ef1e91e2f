"""Draws a scene's models onto the video: calls the passes for light, shadows, layers and composite in their order."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera, Size
from ashe_live.core.types import TrackedFrame
from ashe_live.render.compositing.composite import Composite, Footage
from ashe_live.render.compositing.lens import Lens
from ashe_live.render.compositing.outlines import OutlineSmoothing
from ashe_live.render.compositing.silhouette import SeenOutline, Silhouette
from ashe_live.render.cover.marker_cover import MarkerCover, SeenCover
from ashe_live.render.gl.framing import EMPTY, Framing, Rectangle, common, disjoint, framing, grown, letterbox
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import Programs
from ashe_live.render.layers import LayerContent, LayerPasses
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import Lighting
from ashe_live.render.lights.photometry import Photometry
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.passes.ground import CatchingGround
from ashe_live.render.passes.light_sign import LightSign, light_sign
from ashe_live.render.passes.model_pass import LookedUp, ShadingInputs
from ashe_live.render.passes.standing import StandingGroup
from ashe_live.render.passes.surface import Surface
from ashe_live.render.passes.video import Video
from ashe_live.render.reflections.environment import Environment
from ashe_live.render.scene import Scene

Framed = Callable[[Float], Framing | None]  # points (n, 3) of the marker frame by the picture's camera and viewport


class ModelsOnVideo:
    """All passes between the bare video and the overlays, for one renderer."""

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: Programs,
        preset: RenderPreset,
        video: Video,
        cover: MarkerCover | None,
    ) -> None:
        """`video`: what is shown behind the models. `cover`: as of LayerPasses."""
        self._ctx = ctx
        self._programs = programs
        self._preset = preset
        self._video = video
        self._straight_video = Video(ctx)
        self._lens = Lens(ctx)
        self._outlines = OutlineSmoothing(ctx, programs)
        self._silhouette = Silhouette(ctx, programs)
        self._composite = Composite(ctx, programs)
        self.layers = LayerPasses(ctx, programs, cover)
        self._make_for_preset()

    def use_preset(self, preset: RenderPreset) -> None:
        """Changes the quality between two pictures."""
        self.layers.catcher.forget()
        self._release_for_preset()
        self._preset = preset
        self._make_for_preset()

    @property
    def looked_up(self) -> LookedUp:
        return LookedUp(self.shadows, self._ground_shadows, self._environment)

    def forget_models(self) -> None:
        """Drops the references to what was drawn last."""
        self.shadows.forget()
        self.layers.catcher.forget()

    def begin_anew(self) -> None:
        """Forgets what was seen of the video: the next one shows another table by another camera."""
        self.layers.cover.forget()
        self.photometry = Photometry(self._preset)

    def draw(self, surface: Surface, models: StandingGroup, scene: Scene, waits: bool) -> None:
        """Draws onto the video in `surface`; the scene must have a marker.

        `waits`: for the cover that hides the marker, however long it takes.
        """
        tracked = scene.tracked
        assert tracked is not None
        bends = tracked.camera.is_distorted
        lighting = self.photometry.lighting(scene.illumination)
        cover = self._prepared(models, scene, lighting, waits)
        viewport = letterbox(tracked.frame.size, surface.size)
        camera = self._lens.pinhole_of(tracked.camera) if bends else tracked.camera
        framed = partial(framing, camera, tracked.pose.T_cam_marker, viewport=viewport)
        signs = _signs(models, scene, bends) if scene.shows_light else ()
        frame = framed(np.concatenate([_corners(models, signs), self.layers.catcher.polygon]))
        if frame is None:
            return
        look = self.photometry.look(tracked, scene.lit_in_video or scene.illumination)
        white_rgb = self.photometry.white_seen_in(scene.illumination) or look.white_rgb
        self._environment.show(scene.illumination, white_rgb, _covered(cover))
        inputs = ShadingInputs(frame, lighting, self.looked_up, look.white_rgb)
        straight = self._straight(tracked, viewport, camera) if bends and self.shadows.shadows_meet else self._video
        ground = self._ground(scene, straight, cover, viewport)
        content = LayerContent(models, inputs, scene.shows_model, scene.casts_shadow, signs, ground)
        is_from_above = frame.eye_marker[2] > 0  # from below, the plane is not drawn
        footage = Footage(
            viewport,
            self._video,
            tracked,
            look,
            relief=self.photometry.relief(scene.illumination),
            cover=SeenCover(cover, frame.ground_from_pixel) if cover is not None and is_from_above else None,
            lens=self._lens if bends else None,
            is_split=scene.is_split,
            shadows_meet=self.shadows.shadows_meet,
        )
        with surface.drawing(grown(frame.region, 2 * footage.blurs.farthest + 1, surface.size)):
            self.layers.draw(content, with_models=surface.samples == 0)
        if surface.samples:
            self._sample_edges(surface, content, framed)
        elif scene.shows_model:
            self._smooth_edges(surface, models, framed, viewport)
        outline = self._seen_outline(footage, frame.region, framed, surface.size)
        self._composite.draw(surface, frame.region, replace(footage, outline=outline), scene.is_cut_out)

    def _seen_outline(self, footage: Footage, region: Rectangle, framed: Framed, size: Size) -> SeenOutline | None:
        """The real object's outline within `region` of the layers and its blur's reach; None if it is not matched."""
        real, blurs = self.layers.real, footage.blurs
        if real is None or not self._preset.matches_outline or blurs.variance == 0:
            return None
        frame = framed(real.drawn_points)
        if frame is None:
            return None
        within = grown(region, blurs.farthest, size)
        return self._silhouette.draw(real, frame, within, footage.outline_reach, size)

    def _smooth_edges(self, surface: Surface, models: StandingGroup, framed: Framed, viewport: Rectangle) -> None:
        """Smooths outlines where one sample a pixel was drawn: the models', and the real object's where shadows end."""

        def around(points: Float) -> Rectangle:
            frame = framed(points)
            return EMPTY if frame is None else grown(frame.region, 1, surface.size)

        real = self.layers.real
        at_shadows = EMPTY
        if real is not None:
            shadowed = self.layers.catcher.polygon
            if self.shadows.model_shades_real:
                shadowed = np.concatenate([models.corners, shadowed])
            at_shadows = common(around(real.drawn_points), around(shadowed))
        for within in disjoint(around(models.corners), at_shadows):
            if min(within[2:]) > 0:
                self._outlines.smooth(surface, within, viewport)

    def _sample_edges(self, surface: Surface, content: LayerContent, framed: Framed) -> None:
        """Draws again with several samples a pixel, which are expensive, where there are edges.

        The ground looks the same with one sample: it is only drawn where the real object's border ends it.
        """
        real = self.layers.real
        if not (content.shows_model or content.signs or real is not None):
            return
        standing = _corners(content.models, content.signs)
        edged = framed(standing if real is None else np.concatenate([standing, real.drawn_points]))
        if edged is None:
            return
        within = common(grown(edged.region, 1, surface.size), content.inputs.framing.region)
        if min(within[2:]) > 0:
            with surface.drawing(within, several_samples=True, over_drawn=real is None):
                self.layers.draw(content, with_ground=real is not None)

    def _prepared(self, models: StandingGroup, scene: Scene, lighting: Lighting, waits: bool) -> MarkerCover | None:
        """Prepares real object, shadows and the ground that catches them; returns what covers the marker's sheet."""
        cover = self.layers.follow_sheet(scene, waits)
        real_object = scene.real_object(cover is not None)
        if self.layers.follow_real_object(real_object, scene.object_seen_in, scene.object_lit_by, waits):
            self.shadows.forget()
        casters = models.casters(lighting, self.layers.real is not None)
        self.shadows.render(casters, lighting, self.layers.real)
        real = self.layers.real
        self._ground_shadows.render(self.shadows, lighting, None if real is None else real.seen_shadows)
        self.layers.catcher.fit(models, lighting, self.shadows, _covered(cover))
        self.layers.catcher.follow(models, lighting, self._ground_shadows)
        return cover

    def _straight(self, tracked: TrackedFrame, viewport: Rectangle, camera: Camera) -> Video:
        """The video as this pinhole camera would show it."""
        self._straight_video.show(tracked, viewport, camera)
        return self._straight_video

    def _ground(
        self, scene: Scene, straight: Video, cover: MarkerCover | None, viewport: Rectangle
    ) -> CatchingGround | None:
        """The ground of `straight`, a pinhole camera's video; None where nothing is drawn on it."""
        if cover is None and not scene.casts_shadow:
            return None
        border_px = self.photometry.border_share(scene.illumination) * viewport[2]
        return CatchingGround(straight, scene.illumination.ground_rgb, cover, scene.casts_shadow, border_px)

    def release(self) -> None:
        for held in (
            self.layers,
            self._straight_video,
            self._outlines,
            self._silhouette,
            self._composite,
            self._lens,
        ):
            held.release()
        self._release_for_preset()

    def _make_for_preset(self) -> None:
        self._environment = Environment(self._ctx, self._preset.environment_size)
        self.shadows = ShadowMaps(self._ctx, self._preset)
        self._ground_shadows = GroundShadows(self._ctx, self._programs, self._preset)
        self.photometry = Photometry(self._preset)

    def _release_for_preset(self) -> None:
        self.shadows.release()
        self._ground_shadows.release()
        self._environment.release()


def _signs(models: StandingGroup, scene: Scene, bends: bool) -> tuple[LightSign, ...]:
    """Where the lights are: an arrow or a bulb for each, beside the first model; `bends` as of `draw`."""
    tracked = scene.tracked
    assert tracked is not None
    shown_by = tracked.camera if bends else tracked.camera.without_distortion()
    corners, T_cam_marker = models.members[0].corners, tracked.pose.T_cam_marker
    return tuple(light_sign(corners, light, shown_by, T_cam_marker) for light in scene.illumination.lights)


def _corners(models: StandingGroup, signs: Sequence[LightSign]) -> Float:
    """(n, 3) metres, corners around all that stands on the plane."""
    return np.concatenate([models.corners, *(sign.corners for sign in signs)])


def _covered(cover: MarkerCover | None) -> Float:
    """(n, 2) metres, corners of what is covered on the plane."""
    return np.zeros((0, 2)) if cover is None else cover.corners

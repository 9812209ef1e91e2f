"""The look of a video: its exposure in each frame, and now and then its sharpness and its noise."""

import math
from dataclasses import replace
from enum import Enum, auto

import numpy as np

from ashe_live.core.proxy import Proxy
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.camera.edges import INTERPOLATION_VARIANCE_PX2
from ashe_live.render.camera.exposure import followed
from ashe_live.render.camera.video_look import UNSEEN, VideoLook, chroma_blur_of, noise_of, sharpness_of
from ashe_live.render.camera.white import ASSUMED_RGB, LightOnPrint, light_on_print, measured_white
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.lights.lighting import Lighting

LOOK_HELD_S = 0.2  # of the video's time
CUT_S = 2 * LOOK_HELD_S  # between two frames, from which on the later one may show another scene
CHROMA_HELD_S = 10.0  # that a camera's colours count as blurred as they were found to be


class _Part(Enum):
    SHARPNESS = auto()
    NOISE = auto()


class HeldLook:
    """Measures the exposure in every frame, and what else the preset matches of a video's look every LOOK_HELD_S."""

    def __init__(self, preset: RenderPreset) -> None:
        self._preset = preset
        self._look = UNSEEN
        self._seen: TrackedFrame | None = None  # last
        self._exposed_in: Frame | None = None
        self._light: LightOnPrint | None = None  # by which the exposure was measured in it
        self._measured_in: dict[_Part, TrackedFrame] = {}
        self._chroma_in: TrackedFrame | None = None

    def at(self, tracked: TrackedFrame, lighting: Lighting, real_object: Proxy | None) -> VideoLook:
        """The look of a frame with a marker; the same object while nothing was measured.

        After a cut, which the first frame is as well, all of it is measured in that frame. Otherwise it is one part a
        call at most beside the exposure, as all together take a third of a picture's time.
        """
        is_cut = self._seen is None or _is_cut(self._seen, tracked)
        self._seen = tracked
        self._expose(tracked, lighting, real_object, is_cut)
        if is_cut:
            for part in _Part:
                self._measure(part, tracked)
        oldest = min(_Part, key=lambda part: self._measured_in[part].frame.time_s)
        if tracked.frame.time_s - self._measured_in[oldest].frame.time_s >= LOOK_HELD_S:
            self._measure(oldest, tracked)
        return self._look

    def _expose(self, tracked: TrackedFrame, lighting: Lighting, real_object: Proxy | None, is_cut: bool) -> None:
        light, is_comparable = self._light, not is_cut
        if light is None or light.lighting is not lighting:
            light, is_comparable = light_on_print(tracked, lighting, real_object), False
        elif tracked.frame is self._exposed_in:
            return
        white = measured_white(tracked, light)
        if white is None:  # as where a hand lies on the paper: the exposure of a moment before is nearer than grey
            white = ASSUMED_RGB if is_cut else self._look.white_rgb
        elif is_comparable:
            red, green, blue = np.exp(followed(np.log(self._look.white_rgb), np.log(white))).tolist()
            white = red, green, blue
        self._look, self._light, self._exposed_in = replace(self._look, white_rgb=white), light, tracked.frame

    def _measure(self, part: _Part, tracked: TrackedFrame) -> None:
        self._measured_in[part] = tracked
        if part is _Part.SHARPNESS and self._preset.matches_blur:
            sigma_px, sharpening = sharpness_of(tracked, self._look.white_rgb)
            if tracked.camera.is_distorted:
                # The composite interpolates then, which blurs as well.
                sigma_px = math.sqrt(max(0.0, sigma_px**2 - INTERPOLATION_VARIANCE_PX2))
            if not self._knows_chroma_blur(tracked):
                self._look = replace(self._look, chroma_blur_px=chroma_blur_of(tracked))
                self._chroma_in = tracked
            self._look = replace(self._look, blur_sigma_px=sigma_px, sharpening=sharpening)
        elif part is _Part.NOISE and self._preset.matches_noise:
            self._look = replace(self._look, noise_sigmas=noise_of(tracked))

    def _knows_chroma_blur(self, tracked: TrackedFrame) -> bool:
        """Whether it was measured not long ago in a frame of the same camera, as it takes as long as all else."""
        seen = self._chroma_in
        return (
            seen is not None
            and seen.camera is tracked.camera
            and abs(seen.frame.time_s - tracked.frame.time_s) < CHROMA_HELD_S
        )


def _is_cut(former: TrackedFrame, tracked: TrackedFrame) -> bool:
    """Whether `tracked` may show another scene; two frames of one time are two photos."""
    return former is not tracked and not 0 < tracked.frame.time_s - former.frame.time_s < CUT_S

"""The scene's irradiances and the video's exposure, blur and noise, measured again only when they may have changed."""

from collections import deque
from typing import NamedTuple

from ashe_live.core.arrays import same_objects
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.held_look import HeldLook
from ashe_live.render.camera.relief import Relief, relief_of
from ashe_live.render.camera.shadow_border import unexplained_border_px
from ashe_live.render.camera.video_look import VideoLook
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.lights.lighting import RGB, Lighting
from ashe_live.render.lights.seen_light import SeenLight


class _MeasuredRelief(NamedTuple):
    """The ground's relief, and what it was measured by."""

    shown_by: tuple[TrackedFrame, Proxy]  # the frame, and the real object whose shadow is in it
    lighting: Lighting
    relief: Relief | None


class Photometry:
    """A cache of all of these; every frame must have a marker."""

    def __init__(self, preset: RenderPreset) -> None:
        self._preset = preset
        self._look = HeldLook(preset)
        # Of the last illuminations that are not as their picture was: the drawn one, and that of the video.
        self._lightings: deque[tuple[tuple[object, ...], Lighting]] = deque(maxlen=2)
        self._read: tuple[tuple[object, ...], SeenLight] | None = None
        self._border: tuple[Lighting, float] | None = None
        self._relief: _MeasuredRelief | None = None
        self._relief_asked_by: Lighting | None = None

    def lighting(self, illumination: Illumination) -> Lighting:
        """The irradiances; the same object for the same illumination."""
        if illumination.as_read is None:
            return self._seen_light(illumination).lighting
        known = _known(illumination)
        found = next((lighting for key, lighting in self._lightings if same_objects(key, known)), None)
        if found is None:
            found = self._seen_light(illumination.as_read).lighting_now(illumination)
            self._lightings.append((known, found))
        return found

    def _seen_light(self, illumination: Illumination) -> SeenLight:
        """What is read in the picture, in the frame of the marker as it lay there and in the lights of then."""
        known = _known(illumination)
        if self._read is None or not same_objects(self._read[0], known):
            self._read = known, SeenLight.of(illumination)
        return self._read[1]

    def white_seen_in(self, illumination: Illumination) -> RGB | None:
        """What white, fully lit, has in the frame that the illumination was seen in; None where there is no frame."""
        return self._seen_light(illumination.as_read or illumination).white_rgb

    def border_share(self, illumination: Illumination) -> float:
        """Standard deviation of the real shadow's border beyond that by lens and light, over the picture's width."""
        read = illumination.as_read or illumination
        lighting, seen_in, body = self._seen_light(read).lighting, read.seen_in, read.real_object
        if self._border is None or self._border[0] is not lighting:
            share = 0.0
            if self._preset.matches_blur and seen_in is not None and body is not None and lighting.lights:
                share = unexplained_border_px(seen_in, body, lighting.lights[0]) / seen_in.frame.size[0]
            self._border = lighting, share
        return self._border[1]

    def relief(self, illumination: Illumination) -> Relief | None:
        """How much flatter the ground is in the real object's shadow than in the light; None where it is not.

        It belongs to the frame in which the light was estimated, and to that light, whatever is set by hand. While one
        light eases to another it is not measured anew for each picture.
        """
        read = illumination.as_read or illumination
        lighting = self._seen_light(read).lighting
        is_steady, self._relief_asked_by = lighting is self._relief_asked_by, lighting
        if read.seen_in is None or read.real_object is None or not lighting.lights:
            return None
        known = read.seen_in, read.real_object
        if self._relief is None or not same_objects(self._relief.shown_by, known):
            self._relief = _MeasuredRelief(known, lighting, relief_of(*known, lighting))
        elif is_steady and self._relief.lighting is not lighting:
            self._relief = _MeasuredRelief(known, lighting, relief_of(*known, lighting) or self._relief.relief)
        return self._relief.relief

    def look(self, tracked: TrackedFrame, illumination: Illumination) -> VideoLook:
        """The look that the preset matches of the video, which is lit by the illumination."""
        return self._look.at(tracked, self.lighting(illumination), illumination.real_object)


def _known(illumination: Illumination) -> tuple[object, ...]:
    """What the irradiances depend on."""
    return (
        *illumination.lights,
        illumination.ambient_rgb_ratio,
        illumination.sky_slope_rgb,
        illumination.ground_rgb,
        illumination.seen_in,
        illumination.real_object,
    )

"""Opens files and cameras that are dropped on a window or asked for by a key, with the flags of its start."""

import argparse
from pathlib import Path

from ashe_live.capture.cameras import connected, name_of
from ashe_live.capture.opening import open_source
from ashe_live.capture.sources import Source
from ashe_live.capture.webcam import WebcamSource
from ashe_live.commands.flags.marker_choice import tracker_maker, with_marker_in
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.errors import UserError
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.viewer.sources.pipeline import Pipeline


class LaterSources:
    """An Opener, called in a thread of its own, one call at a time."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._camera: str | None = getattr(options, "camera", None)  # the camera that was opened last

    def __call__(self, path: Path | None) -> Pipeline:
        """A pipeline that plays the file, or the next camera. Raises UserError where there is none.

        Its camera model is its own: that of the flags, or else an assumed one.
        """
        if path is not None:
            return self._playing(open_source(path), None)
        number = self._next_camera()
        memory = FocalMemory(name_of(number, connected()))
        source = WebcamSource(number, self._options.size)
        self._camera = str(number)
        return self._playing(source, memory)

    def _playing(self, source: Source, memory: FocalMemory | None) -> Pipeline:
        try:
            chosen = with_marker_in(source, self._options)
            tracker = make_tracker(chosen, memory=memory, source=source)
            pipeline = Pipeline(source, tracker, chosen.loop, tracker_maker(chosen, memory, source))
        except BaseException:
            source.close()  # a camera would stay busy
            raise
        pipeline.start()
        return pipeline

    def _next_camera(self) -> int:
        devices, last = connected(), -1
        if self._camera is not None:  # a number, or the path of a device
            by_path = (device.number for device in devices if device.path == self._camera)
            last = int(self._camera) if self._camera.isdecimal() else next(by_path, -1)
        others = [device.number for device in devices if device.number != last]
        if not others:
            raise UserError("no other camera is connected", "plug one in, and press N again")
        return next((number for number in others if number > last), others[0])

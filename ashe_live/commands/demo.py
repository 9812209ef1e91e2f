"""`ashe-live demo`: the shipped clip, whose light is known, in a window or in files."""

import argparse
from datetime import datetime
from pathlib import Path

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.capture.snapshot import write_png
from ashe_live.commands.flags.model_choice import with_markers_spelled
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.commands.viewing.headless import show_without_window
from ashe_live.commands.viewing.setup import ViewerSetup, check_outputs, has_display
from ashe_live.commands.viewing.window import show_in_window
from ashe_live.core.arrays import Image
from ashe_live.drawing.contact_sheet import contact_sheet
from ashe_live.files.writing import unused_name
from ashe_live.process.messages import print_answer
from ashe_live.render.scene import Scene
from ashe_live.render.screen import Screen
from ashe_live.viewer.display import Display, Readings, bare_scene
from ashe_live.viewer.session import Session

THUMBNAIL_COUNT = 12


def run(options: argparse.Namespace) -> int:
    options.headless = options.headless or not has_display()
    clip = shipped_clip()
    check_outputs(options, clip.path)
    options.takes_any_marker = False
    options.marker, options.marker_size = clip.marker_spec, clip.marker_side_m
    options = with_markers_spelled(options)
    options.takes_any_marker = True  # in files that are opened later; the clip's own marker is known
    tracker = make_tracker(options, clip.camera.resized)
    # Layers, and what was recorded in a window, are shown without text.
    is_bare = options.layers is not None or options.as_shown is not None
    setup = ViewerSetup(ClipSource(clip.path), tracker, options, clip.to_light_marker, shows_light=not is_bare)
    if options.headless:
        return _into_files(setup, is_bare)
    options.loop = True
    return show_in_window(setup)


def _into_files(setup: ViewerSetup, is_bare: bool) -> int:
    """Writes a video, into the current folder unless another is named, and a contact sheet beside it.

    is_bare: without text.
    """
    now = datetime.now()
    options = setup.options
    if options.out is None:
        options.out = unused_name(Path.cwd(), "ashe-live-demo", ".mp4", now)
    sheet = unused_name(options.out.parent, "ashe-live-demo", ".png", now)
    display = Display()
    thumbnails = Thumbnails(THUMBNAIL_COUNT)

    def scene(session: Session) -> Scene:
        if is_bare:
            return bare_scene(session)
        now_s = session.tracked.frame.time_s if session.tracked is not None else 0.0
        return display.scene(session, Screen(setup.size), Readings(options.quality), now_s)

    played = show_without_window(setup, scene, thumbnails.add)
    sheet = write_png(sheet, contact_sheet(*thumbnails.spread()), beside=True)
    print_answer(f"see {played.recording} and {sheet}")
    return played.status


class Thumbnails:
    """Pictures spread evenly over a clip of unknown length, of which it never holds more than twice as many."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._every = 1
        self._seen = 0
        self._kept: list[tuple[Image, float]] = []

    def add(self, picture: Image, time_s: float) -> None:
        if self._seen % self._every == 0:
            self._kept.append((picture, time_s))
        self._seen += 1
        if len(self._kept) > 2 * self._count:
            self._kept = self._kept[::2]
            self._every *= 2

    def spread(self) -> tuple[list[Image], list[str]]:
        """Up to `count` pictures and their times, in order."""
        last = len(self._kept) - 1
        places = {round(last * place / max(1, self._count - 1)) for place in range(self._count)}
        chosen = [self._kept[place] for place in sorted(places)]
        return [picture for picture, _ in chosen], [f"{time_s:.1f} s" for _, time_s in chosen]

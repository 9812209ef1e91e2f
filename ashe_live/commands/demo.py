"""`ashe-live demo`: the shipped clip, whose light is known, in a window or in files."""

import argparse
import json
from datetime import datetime
from pathlib import Path

import numpy as np

from ashe_live.capture.clip import ClipSource
from ashe_live.capture.contact_sheet import contact_sheet
from ashe_live.capture.output_files import unused_name
from ashe_live.capture.snapshot import write_png
from ashe_live.commands.setup import make_tracker
from ashe_live.commands.view import View, check_outputs, show_in_window, show_without_window
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.resources import resource
from ashe_live.render.scene import Scene
from ashe_live.viewer.display import Display
from ashe_live.viewer.session import Session
from ashe_live.viewer.window import has_display

THUMBNAILS = 12


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    camera, true_to_light_marker = _ground_truth(options)
    source = ClipSource(resource("assets", "clips", "table.mp4"))
    view = View(source, make_tracker(options, lambda size: camera.resized(size)), options, true_to_light_marker, True)
    if has_display() and not options.headless:
        options.loop = True
        return show_in_window(view)
    return _into_files(view)


def _ground_truth(options: argparse.Namespace) -> tuple[Camera, Float]:
    """The clip's camera and light; fills in the marker's options."""
    truth = json.loads(resource("assets", "clips", "table.json").read_text(encoding="utf-8"))
    family = truth["marker"]["dictionary"].removeprefix("DICT_").lower()
    options.marker = f"aruco:{family}:{truth['marker']['id']}"
    options.marker_size = truth["marker"]["side_m"]
    width, height = truth["size"]
    camera = Camera((width, height), np.array(truth["K"]), np.array(truth["dist"], dtype=np.float64), "file")
    return camera, np.array(truth["lights"][0]["dir_to_light"])


def _into_files(view: View) -> int:
    """A video and a contact sheet in the current folder, for those without a display."""
    now = datetime.now()
    options = view.options
    if options.out is None:
        options.out = unused_name(Path.cwd(), "ashe-live-demo", ".mp4", now)
    sheet = unused_name(Path.cwd(), "ashe-live-demo", ".png", now)
    display = Display()
    pictures: list[tuple[Image, float]] = []

    def scene(session: Session) -> Scene:
        return display.scene(session, view.size, options.quality, now_s=0.0)

    status = show_without_window(view, scene, lambda picture, time_s: pictures.append((picture, time_s)))
    chosen = pictures[:: max(1, len(pictures) // THUMBNAILS)][:THUMBNAILS]
    write_png(sheet, contact_sheet([picture for picture, _ in chosen], [f"{time_s:.1f} s" for _, time_s in chosen]))
    print(f"no display here, so see {options.out} and {sheet}")
    return status

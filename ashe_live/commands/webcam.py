"""`ashe-live webcam`: a connected camera, in a window."""

import argparse

from ashe_live.capture.cameras import connected, name_of
from ashe_live.capture.webcam import WebcamSource
from ashe_live.commands.flags.marker_choice import tracker_maker
from ashe_live.commands.flags.model_choice import with_markers_spelled
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.commands.viewing.setup import ViewerSetup, check_outputs
from ashe_live.commands.viewing.window import show
from ashe_live.process.messages import print_message
from ashe_live.tracking.focal.focal_memory import FocalMemory


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    options = with_markers_spelled(options)
    camera = int(options.camera) if options.camera.isdecimal() else options.camera
    memory = FocalMemory(name_of(camera, connected()))
    tracker = make_tracker(options, memory=memory)
    source = WebcamSource(camera, options.size)
    if source.note is not None:
        print_message(source.note)
    return show(ViewerSetup(source, tracker, options, tracker_for=tracker_maker(options, memory)))

"""`ashe-live webcam`: a camera, a printed marker, a sunny table."""

import argparse

from ashe_live.capture.webcam import WebcamSource
from ashe_live.commands.setup import make_tracker
from ashe_live.commands.view import View, check_outputs, show


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    tracker = make_tracker(options)
    camera = int(options.camera) if options.camera.isdecimal() else options.camera
    return show(View(WebcamSource(camera, options.size), tracker, options))

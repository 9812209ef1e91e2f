"""`ashe-live` alone: the camera that is connected, or the demo where there is none."""

import argparse
import sys

from ashe_live.capture.cameras import connected
from ashe_live.commands import demo, webcam
from ashe_live.commands.view import check_outputs


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    if options.camera is None:
        devices = connected()
        if not devices:
            print("ashe-live: no camera is connected, so this is the demo (ashe-live --help has more)", file=sys.stderr)
            return demo.run(options)
        options.camera = str(devices[0].number)
    return webcam.run(options)

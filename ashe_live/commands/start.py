"""`ashe-live` alone: the camera that is connected, or the demo where there is none."""

import argparse

from ashe_live.capture.cameras import connected
from ashe_live.commands import demo, webcam
from ashe_live.commands.viewing.setup import check_outputs
from ashe_live.process.messages import print_message


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    if options.camera is None:
        devices = connected()
        if not devices:
            print_message("no camera is connected, so this is the demo (ashe-live --help has more)")
            return demo.run(options)
        options.camera = str(devices[0].number)
    return webcam.run(options)

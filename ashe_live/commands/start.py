"""`ashe-live` alone: the camera that is connected, or the demo where there is none."""

import argparse

from ashe_live.capture.cameras import connected
from ashe_live.commands import demo, webcam
from ashe_live.commands.viewing.setup import check_outputs
from ashe_live.process.messages import listed, print_message

# Beside the marker, what a person may say of a table and a camera: the demo's are known.
OF_OWN_TABLE = ("marker_size", "caster", "camera_file", "focal_px", "hfov")


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    if options.camera is None:
        devices = connected()
        if not devices:
            unused = _unused(options)
            options.caster = None
            left_out = f"; it makes no use of {listed(unused)}" if unused else ""
            print_message(f"no camera is connected, so this is the demo (ashe-live --help has more){left_out}")
            return demo.run(options)
        options.camera = str(devices[0].number)
    return webcam.run(options)


def _unused(options: argparse.Namespace) -> list[str]:
    """The flags that say something else of the table than holds for the demo's; not the settings, which always do."""
    settings = {key: str(value) for key, value in options.from_settings.items()}
    given = {name.replace("_", "-"): getattr(options, name) for name in OF_OWN_TABLE}
    given["marker"] = None if options.takes_any_marker else options.marker
    return [f"--{key}" for key, value in given.items() if value is not None and settings.get(key) != str(value)]

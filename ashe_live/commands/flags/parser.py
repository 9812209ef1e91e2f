"""The commands and their options. Nothing heavy is loaded, so that --help is instant."""

import argparse

from ashe_live.commands.flags import values
from ashe_live.commands.flags.bench_parser import add_benches
from ashe_live.commands.flags.command_parser import CommandParser, ShowVersion
from ashe_live.commands.flags.option_groups import (
    DEFAULT_MARKER,
    ESTIMATE_AT_HELP,
    MARKERS_HELP,
    add_command,
    add_quality_options,
    add_scene_options,
    add_view_options,
)

EPILOG = (
    "Without COMMAND your camera is opened, with the options of webcam; without a camera, the demo plays. "
    "Print a marker with `ashe-live marker --out marker.pdf`."
)
START = "start"
CAMERA_HELP = "number or path, as `ashe-live cameras` lists them"
PAGE_HELP = "the page to print"


def build_parser(parser_class: type[argparse.ArgumentParser] | None = None) -> argparse.ArgumentParser:
    """The parser of command lines that name a command."""
    parser = (parser_class or CommandParser)(
        prog="ashe-live", description="AR whose virtual objects are lit as the real ones are.", epilog=EPILOG
    )
    parser.add_argument("--version", action=ShowVersion, nargs=0, help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    demo = add_command(commands, "demo", "play the shipped clip (without a display: into a video file)")
    add_view_options(demo)
    demo.set_defaults(camera_file=None, focal_px=None, hfov=None, caster=None)

    webcam = add_command(commands, "webcam", "open a camera that looks at a printed marker")
    webcam.add_argument(
        "--camera", type=values.camera, default="0", metavar="N|PATH", help=f"{CAMERA_HELP} (default 0)"
    )
    add_scene_options(webcam)
    add_view_options(webcam)

    play = add_command(commands, "play", "play a recorded clip, or show a photo")
    play.add_argument("file", type=values.path, metavar="FILE", help="the clip or the photo")
    add_scene_options(play)
    add_view_options(play)

    _add_estimate_options(add_command(commands, "estimate", "tell where the light is in photos or clips"))
    _add_marker_options(add_command(commands, "marker", "make a marker to print at true size, or to show on a screen"))

    cameras = add_command(commands, "cameras", "list the connected cameras and their modes")
    cameras.add_argument("--fast", action="store_true", help="names only: no camera is opened")

    add_command(commands, "doctor", "check what works on this machine, and say how to mend what does not")
    add_command(commands, "settings", "say where your settings are, and which values apply (docs/settings.md)")

    _add_board_options(add_command(commands, "board", "make a board to print, by which `calibrate` measures a camera"))
    _add_calibrate_options(
        add_command(commands, "calibrate", "measure a camera's focal length and distortion with the board")
    )
    add_benches(add_command(commands, "bench", "measure speed and accuracy on this machine"))
    return parser


def build_start_parser(parser_class: type[argparse.ArgumentParser] | None = None) -> argparse.ArgumentParser:
    """The parser of command lines without a command, which open a camera or the demo."""
    start = (parser_class or CommandParser)(prog="ashe-live")
    start.set_defaults(command=START)
    start.add_argument("--camera", type=values.camera, metavar="N|PATH", help=f"{CAMERA_HELP} (default: the first one)")
    add_scene_options(start)
    add_view_options(start)
    return start


def _add_board_options(board: argparse.ArgumentParser) -> None:
    board.add_argument("--out", type=values.path, required=True, metavar="FILE.pdf|png", help=PAGE_HELP)
    board.add_argument(
        "--square-mm", type=values.millimetres, default=25.0, metavar="MM", help="side of a square (default 25)"
    )
    _add_paper(board)
    board.add_argument("--overwrite", action="store_true", help="replace an existing file")


def _add_calibrate_options(calibrate: argparse.ArgumentParser) -> None:
    calibrate.add_argument(
        "--camera",
        type=values.camera,
        default="0",
        metavar="N|CLIP|FOLDER",
        help="a camera, or a clip or a folder of photos of the board (default 0)",
    )
    calibrate.add_argument(
        "--out", type=values.path, required=True, metavar="FILE.json", help="the calibration, for --camera-file"
    )
    calibrate.add_argument("--size", type=values.size, metavar="WxH", help="size to ask the camera for")
    calibrate.add_argument(
        "--headless", action="store_true", help="print what to do next in the terminal, without a window"
    )
    calibrate.add_argument("--overwrite", action="store_true", help="replace an existing file")


def _add_estimate_options(estimate: argparse.ArgumentParser) -> None:
    estimate.add_argument(
        "files",
        type=values.path,
        nargs="+",
        metavar="FILE",
        help="photos and clips, also folders and patterns ('*.jpg')",
    )
    estimate.add_argument(
        "--json", action="store_true", help="one JSON object a line, one line a file (docs/contract.md)"
    )
    estimate.add_argument(
        "--repeat", type=values.count, metavar="N", help="warm up once, then give the median times of N runs"
    )
    estimate.add_argument(
        "--debug", type=values.path, metavar="DIR", help="write a sheet of each estimate's steps there"
    )
    estimate.add_argument(
        "--sheet", type=values.path, metavar="FILE.html", help="a page with the light drawn into thumbnails"
    )
    estimate.add_argument("--overwrite", action="store_true", help="replace an existing sheet")
    estimate.add_argument("--estimate-at", type=values.index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    estimate.add_argument(
        "--empty",
        type=values.path,
        metavar="PHOTO",
        help="the same view without the object, by a camera that stood still: what else is there does not count",
    )
    estimate.add_argument(
        "--together", action="store_true", help="one answer from all files: photos of one table, with nothing moved"
    )
    estimate.add_argument(
        "--views",
        type=values.views,
        default=12,
        metavar="N",
        help="most frames of a clip to answer from (default 12, of which fast uses 4 and balanced 8)",
    )
    estimate.add_argument(
        "--frames",
        type=values.frame_range,
        default=(0, None),
        metavar="FIRST:LAST",
        help="frames of a clip to choose them from (default: until ten seconds after the first steady one)",
    )
    add_scene_options(estimate)
    estimate.set_defaults(no_filter=False)
    add_quality_options(estimate)


def _add_marker_options(marker: argparse.ArgumentParser) -> None:
    target = marker.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", type=values.path, metavar="FILE.pdf|png", help=PAGE_HELP)
    target.add_argument("--show", action="store_true", help="show it in a window instead of printing it")
    marker.add_argument(
        "--marker", metavar="SPEC", help=f"{MARKERS_HELP} or cube, the paper one (default {DEFAULT_MARKER})"
    )
    marker.add_argument(
        "--size-mm", type=values.millimetres, metavar="MM", help="side of the black square (default 80)"
    )
    cube = marker.add_argument_group("a paper cube to fold")
    cube.add_argument(
        "--cube", action="store_true", help="print the paper cube, which is marker, caster and light probe in one"
    )
    cube.add_argument("--side", type=values.side_m, metavar="METRES", help="its edge (default 0.06)")
    _add_paper(marker)
    marker.add_argument("--overwrite", action="store_true", help="replace an existing file")


def _add_paper(printed: argparse.ArgumentParser) -> None:
    printed.add_argument(
        "--paper", choices=("a4", "letter", "a3"), default="a4", help="larger sheets are of its series (default a4)"
    )

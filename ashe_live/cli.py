"""The command line: what can be asked for. What is asked is loaded only then, so that --help is instant."""

import argparse
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from ashe_live import __version__
from ashe_live.core.messages import say_exactly, tell
from ashe_live.core.ranges import (
    CAMERA_NUMBER,
    COUNT,
    FIELD_OF_VIEW,
    FOCAL,
    INDEX,
    MARKER_SIDE,
    PRINTED_MM,
    SIDE,
    Range,
)
from ashe_live.errors import ExitStatus, UserError

EPILOG = (
    "Without COMMAND: your camera, with the options of webcam, or the demo where there is none. "
    "Print a marker with `ashe-live marker --out marker.pdf`."
)
START = "start"
DEFAULT_MARKER = "aruco:4x4_50:0"
DEFAULT_ESTIMATOR = "proxy"
MARKER_HELP = (
    f"aruco:DICT:ID, apriltag:36h11:ID, pattern:FILE.patt (ARToolKit), image:FILE.png or "
    f"grid:DICT:COLSxROWS (default {DEFAULT_MARKER})"
)
MEMORY_FRAMES_HELP = "pictures with model switches over which memory is watched (default 1000)"
ESTIMATE_AT_HELP = "estimate the light on this frame (default: the first one with a steady marker)"


def build_parser(parser_class: type[argparse.ArgumentParser] | None = None) -> argparse.ArgumentParser:
    parser = (parser_class or _Parser)(
        prog="ashe-live", description="AR whose virtual objects are lit as the real ones are.", epilog=EPILOG
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="say which version this is")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    demo = commands.add_parser("demo", help="play the shipped clip (without a display: into a video file)")
    _add_view_options(demo)
    demo.set_defaults(camera_file=None, focal_px=None, hfov=None)

    webcam = commands.add_parser("webcam", help="the real thing: a camera, a printed marker, a sunny table")
    webcam.add_argument("--camera", type=_camera, default="0", metavar="N|PATH", help="its number or path (default 0)")
    _add_scene_options(webcam)
    _add_view_options(webcam)

    # Without help it is not listed: nobody has to know its name.
    start = commands.add_parser(START, prog="ashe-live")
    start.add_argument("--camera", type=_camera, metavar="N|PATH", help="its number or path (default: the first one)")
    _add_scene_options(start)
    _add_view_options(start)

    play = commands.add_parser("play", help="a recorded clip, or a photo")
    play.add_argument("file", type=Path, metavar="FILE")
    _add_scene_options(play)
    _add_view_options(play)

    _add_estimate_options(commands.add_parser("estimate", help="where the light is, in photos or clips"))
    _add_marker_options(commands.add_parser("marker", help="a marker to print at true size, or to show on a screen"))

    cameras = commands.add_parser("cameras", help="the cameras that are connected, and their modes")
    cameras.add_argument("--fast", action="store_true", help="names only: no camera is opened")

    commands.add_parser("doctor", help="what works on this machine, and how to mend what does not")
    commands.add_parser("settings", help="where your settings are, and what holds (docs/settings.md)")

    board = commands.add_parser("board", help="a board to print, with which `calibrate` measures a camera")
    board.add_argument("--out", type=Path, required=True, metavar="FILE.pdf|png")
    board.add_argument("--square-mm", type=_mm, default=25.0, metavar="MM", help="a square's side (default 25)")
    board.add_argument("--overwrite", action="store_true", help="replace an existing file")

    calibrate = commands.add_parser("calibrate", help="measure a camera's focal length and distortion with the board")
    calibrate.add_argument(
        "--camera", type=_camera, default="0", metavar="N|CLIP", help="or a clip of the board (default 0)"
    )
    calibrate.add_argument("--out", type=Path, required=True, metavar="FILE.json", help="for --camera-file")
    calibrate.add_argument("--size", type=_size, metavar="WxH", help="size to ask the camera for")
    calibrate.add_argument("--headless", action="store_true", help="guide by lines, without a window")
    calibrate.add_argument("--overwrite", action="store_true", help="replace an existing file")

    _add_benches(commands.add_parser("bench", help="measure speed and accuracy on this machine"))
    return parser


def _add_estimate_options(estimate: argparse.ArgumentParser) -> None:
    estimate.add_argument("files", type=Path, nargs="+", metavar="FILE", help="also folders and patterns ('*.jpg')")
    estimate.add_argument(
        "--json", action="store_true", help="one JSON object a line, one line a file (docs/contract.md)"
    )
    estimate.add_argument(
        "--repeat", type=_count, metavar="N", help="warm up once, then give the median times of N runs"
    )
    estimate.add_argument("--debug", type=Path, metavar="DIR", help="write a sheet of each estimate's steps there")
    estimate.add_argument("--sheet", type=Path, metavar="FILE.html", help="a page with the light drawn into thumbnails")
    estimate.add_argument("--overwrite", action="store_true", help="replace an existing sheet")
    estimate.add_argument("--estimate-at", type=_index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    _add_scene_options(estimate)
    estimate.set_defaults(no_filter=False)
    _add_quality_options(estimate)


def _add_marker_options(marker: argparse.ArgumentParser) -> None:
    target = marker.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", type=Path, metavar="FILE.pdf|png")
    target.add_argument("--show", action="store_true", help="in a window, for want of a printer")
    marker.add_argument("--marker", default=DEFAULT_MARKER, metavar="SPEC", help=MARKER_HELP)
    marker.add_argument("--size-mm", type=_mm, default=80.0, metavar="MM", help="black square's side (default 80)")
    marker.add_argument("--overwrite", action="store_true", help="replace an existing file")


def _add_benches(bench: argparse.ArgumentParser) -> None:
    benches = bench.add_subparsers(dest="bench", metavar="WHAT", required=True)

    viewer = benches.add_parser("viewer", help="the viewer's loop: frames a second, and frame times while estimating")
    viewer.add_argument("--frames", type=_count, default=600, metavar="N", help="frames in each run (default 600)")
    viewer.add_argument("--size", type=_size, metavar="WxH", help="size of the picture (default: the clip's)")
    _add_results_folder(viewer)
    _add_quality_options(viewer, default="fast")

    render = benches.add_parser("render", help="what pictures cost, and how far they are from a path tracer's")
    render.add_argument("--frames", type=_count, default=100, metavar="N", help="frames of each loop (default 100)")
    render.add_argument("--memory-frames", type=_count, default=1000, metavar="N", help=MEMORY_FRAMES_HELP)
    _add_results_folder(render)

    soak = benches.add_parser("soak", help="very many frames: leaks, drift, and how old a picture is on the screen")
    soak.add_argument("--frames", type=_count, default=100_000, metavar="N", help="frames (default 100000)")
    _add_results_folder(soak)
    _add_quality_options(soak, default="fast")

    light = benches.add_parser("light", help="the estimators' errors on scenes whose light is known")
    light.add_argument("--scenes", type=Path, nargs="+", required=True, metavar="DIR")
    _add_results_folder(light)
    light.add_argument("--quick", action="store_true", help="in less than a minute: fewer scenes, balanced only")
    light.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME")
    light.add_argument("--limit", type=_count, metavar="N", help="the first N scenes of each folder only")

    tracking = benches.add_parser("track", help="the tracker beside OpenCV's detector, on frames with known poses")
    tracking.add_argument("--real", type=Path, metavar="DIR", help="also follow the real clips listed there")
    _add_results_folder(tracking)
    tracking.add_argument("--quick", action="store_true", help="fewer frames, and no trade of settings")
    tracking.add_argument("--quality", choices=("fast", "balanced", "accurate"), default="balanced")


def _add_results_folder(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--out", type=Path, metavar="DIR", help="where results.json and the plots go")
    bench.add_argument("--overwrite", action="store_true", help="replace existing files there")


def _add_scene_options(parser: argparse.ArgumentParser) -> None:
    scene = parser.add_argument_group("what the camera sees")
    scene.add_argument("--marker", default=DEFAULT_MARKER, metavar="SPEC", help=MARKER_HELP)
    scene.add_argument(
        "--marker-size",
        type=_side_m,
        default=0.08,
        metavar="METRES",
        help="black square's side (default 0.08)",
    )
    camera = scene.add_mutually_exclusive_group()
    camera.add_argument("--camera-file", type=Path, metavar="FILE.json", help='calibration: {"size", "K", "dist"}')
    camera.add_argument("--focal-px", type=_focal_px, metavar="F", help="focal length in pixels of the source")
    camera.add_argument(
        "--hfov",
        type=_angle,
        metavar="DEG",
        help="horizontal field of view (default: 60 is assumed)",
    )


def _add_view_options(parser: argparse.ArgumentParser) -> None:
    view = parser.add_argument_group("what is shown")
    view.add_argument(
        "--model", default="cube", metavar="NAME|FILE", help="shipped model, or glTF/GLB/OBJ/PLY/STL file"
    )
    view.add_argument("--size", type=_size, metavar="WxH", help="size of the window (default: the source's)")
    view.add_argument("--loop", action="store_true", help="start again at the end of the clip")
    view.add_argument("--estimate-at", type=_index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    view.add_argument("--auto", action="store_true", help="estimate whenever the marker is steady, and fuse (key A)")
    view.add_argument("--no-filter", action="store_true", help="show each frame's pose as measured, trembling and all")
    output = parser.add_argument_group("without a window")
    output.add_argument("--headless", action="store_true", help="render offscreen, every frame")
    output.add_argument("--frames", type=_count, metavar="N", help="stop after N frames")
    output.add_argument("--out", type=Path, metavar="VIDEO.mp4", help="record what is shown")
    output.add_argument(
        "--report", type=Path, metavar="REPORT.json", help="poses, estimates and times (docs/contract.md)"
    )
    output.add_argument("--overwrite", action="store_true", help="replace existing files")
    _add_quality_options(parser)


def _add_quality_options(parser: argparse.ArgumentParser, default: str = "balanced") -> None:
    trade = parser.add_argument_group("speed against accuracy")
    trade.add_argument("--quality", choices=("fast", "balanced", "accurate", "auto"), default=default)
    trade.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=f"(default {DEFAULT_ESTIMATOR})")


def _number_in(allowed: Range) -> Callable[[str], float]:
    def number(text: str) -> float:
        try:
            return allowed.checked(float(text), "it")
        except ValueError:
            # Argparse's own words would name the function here.
            raise argparse.ArgumentTypeError(f"{text!r} is not a number {allowed}") from None

    return number


def _whole_number_in(allowed: Range) -> Callable[[str], int]:
    def number(text: str) -> int:
        try:
            return int(allowed.checked(int(text), "it"))
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number {allowed}") from None

    return number


_side_m, _mm = _number_in(MARKER_SIDE), _number_in(PRINTED_MM)
_focal_px, _angle = _number_in(FOCAL), _number_in(FIELD_OF_VIEW)
_count, _index = _whole_number_in(COUNT), _whole_number_in(INDEX)


def _size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT."""
    width, _, height = text.lower().partition("x")
    if not all(side.isascii() and side.isdecimal() and len(side) < 9 and int(side) in SIDE for side in (width, height)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size like 1280x720, with sides {SIDE}")
    return int(width), int(height)


def _camera(text: str) -> str:
    """A number, or what may be a path."""
    if text.isdecimal() and not (len(text) < 9 and int(text) in CAMERA_NUMBER):
        raise argparse.ArgumentTypeError(f"{text!r} is not a camera's number {CAMERA_NUMBER}")
    return text


class _Version(argparse.Action):
    """As argparse's own, which is silent where the text cannot be written."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        say_exactly(f"ashe-live {__version__}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage that hides it."""

    def error(self, message: str) -> NoReturn:
        tell(f"{message} (see {self.prog} --help)")
        self.exit(ExitStatus.WRONG_USE)

    def print_help(self, _file: object = None) -> None:
        # Argparse's own is silent where the text cannot be written.
        say_exactly(self.format_help().rstrip("\n"))


class _SettingsParser(argparse.ArgumentParser):
    """Says that what is wrong is not on the command line."""

    def error(self, message: str) -> NoReturn:
        from ashe_live.core.settings import settings_path

        raise UserError(f"{settings_path()}: {message.removeprefix('argument --')}", "mend that line, or remove it")


def with_command(arguments: Sequence[str]) -> Sequence[str]:
    """START where there is none."""
    is_there = bool(arguments) and (not arguments[0].startswith("-") or arguments[0] in ("-h", "--help", "--version"))
    return arguments if is_there else [START, *arguments]


def parsed(arguments: Sequence[str]) -> argparse.Namespace:
    """The options, with the settings where no flag says otherwise. Raises UserError for settings that cannot be."""
    arguments = with_command(arguments)
    options = build_parser().parse_args(arguments)
    # Only here, as --help and wrong use do not come so far.
    from ashe_live.core.settings import COMMANDS, ONE_OF, flags_of, read_settings, settings_path

    if options.command not in COMMANDS:
        return options
    settings = read_settings(settings_path())
    if any(getattr(options, key.replace("-", "_")) is not None for key in ONE_OF):
        settings = {key: value for key, value in settings.items() if key not in ONE_OF}
    first, *rest = arguments
    return build_parser(_SettingsParser).parse_args([first, *flags_of(settings, options.command), *rest])


def run(arguments: Sequence[str], begins: Callable[[], None] | None = None) -> int:
    """Parses, runs the command, and returns its exit status; what a user can mend becomes one line on stderr.

    `begins` is called when all is loaded and the command itself is next.
    """
    try:
        options = parsed(arguments)
        command: Callable[[argparse.Namespace], int] = import_module(f"ashe_live.commands.{options.command}").run
        if begins is not None:
            begins()
        return int(command(options))
    except UserError as error:
        tell(error)
    except KeyboardInterrupt:
        return ExitStatus.INTERRUPTED
    except BrokenPipeError:  # the reader (`| head`) has what it wanted
        return ExitStatus.ANSWERED
    # What no command has foreseen, and a file, a name or the machine has brought about all the same.
    except MemoryError:
        tell("there is not enough memory for this: close other programs, or give something smaller")
    except RecursionError:
        tell("something is nested too deeply in one of the files: export or write it again")
    except UnicodeError as error:
        tell(f"a name or a text cannot be encoded ({error}): rename or convert it")
    except OSError as error:
        named = f" ({error.filename})" if error.filename is not None else ""
        tell(f"the system refuses: {error.strerror or error}{named}: check the files, folders and space that it needs")
    return ExitStatus.WRONG_USE

"""What can be asked for on the command line. Nothing heavy is loaded, so that --help is instant."""

import argparse
from pathlib import Path
from typing import Any, NoReturn

from ashe_live import __version__
from ashe_live.commands.flags import values
from ashe_live.errors import ExitStatus
from ashe_live.process.messages import say_exactly, tell

EPILOG = (
    "Without COMMAND your camera is opened, with the options of webcam; without a camera, the demo plays. "
    "Print a marker with `ashe-live marker --out marker.pdf`."
)
START = "start"
DEFAULT_MARKER = "aruco:4x4_50:0"
DEFAULT_ESTIMATOR = "proxy"
MARKER_HELP = (
    f"aruco:DICT:ID, apriltag:36h11:ID, pattern:FILE.patt (ARToolKit), image:FILE.png, "
    f"grid:DICT:COLSxROWS or cube (default: the one in view, or {DEFAULT_MARKER})"
)
LIGHTS = ("auto", "sun", "lamp")
LIGHT_HELP = "what it is taken for: a lamp where the picture tells its distance (auto), or always the one or the other"
UPS = ("x", "y", "z", "-x", "-y", "-z")
LAYERS = ("both", "model", "shadow")
MEMORY_FRAMES_HELP = "frames, with changes of the model, during which memory is watched (default 1000)"
ESTIMATE_AT_HELP = "estimate the light on this frame (default: the first one with a steady marker)"


def build_parser(parser_class: type[argparse.ArgumentParser] | None = None) -> argparse.ArgumentParser:
    parser = (parser_class or _Parser)(
        prog="ashe-live", description="AR whose virtual objects are lit as the real ones are.", epilog=EPILOG
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    demo = commands.add_parser("demo", help="play the shipped clip (without a display: into a video file)")
    _add_view_options(demo)
    demo.set_defaults(camera_file=None, focal_px=None, hfov=None)

    webcam = commands.add_parser("webcam", help="open a camera that looks at a printed marker")
    webcam.add_argument("--camera", type=values.camera, default="0", metavar="N|PATH", help="(default 0)")
    _add_scene_options(webcam)
    _add_view_options(webcam)

    # Without help it is not listed: nobody has to know its name.
    start = commands.add_parser(START, prog="ashe-live")
    start.add_argument("--camera", type=values.camera, metavar="N|PATH", help="(default: the first one)")
    _add_scene_options(start)
    _add_view_options(start)

    play = commands.add_parser("play", help="play a recorded clip, or show a photo")
    play.add_argument("file", type=Path, metavar="FILE")
    _add_scene_options(play)
    _add_view_options(play)

    _add_estimate_options(commands.add_parser("estimate", help="tell where the light is in photos or clips"))
    _add_marker_options(
        commands.add_parser("marker", help="make a marker to print at true size, or to show on a screen")
    )

    cameras = commands.add_parser("cameras", help="list the connected cameras and their modes")
    cameras.add_argument("--fast", action="store_true", help="names only: no camera is opened")

    commands.add_parser("doctor", help="check what works on this machine, and say how to mend what does not")
    commands.add_parser("settings", help="where your settings are, and which values apply (docs/settings.md)")

    board = commands.add_parser("board", help="make a board to print, with which `calibrate` measures a camera")
    board.add_argument("--out", type=Path, required=True, metavar="FILE.pdf|png")
    board.add_argument(
        "--square-mm", type=values.millimetres, default=25.0, metavar="MM", help="side of a square (default 25)"
    )
    _add_paper(board)
    board.add_argument("--overwrite", action="store_true", help="replace an existing file")

    calibrate = commands.add_parser("calibrate", help="measure a camera's focal length and distortion with the board")
    calibrate.add_argument(
        "--camera",
        type=values.camera,
        default="0",
        metavar="N|CLIP|FOLDER",
        help="a camera, or a clip or a folder of photos of the board (default 0)",
    )
    calibrate.add_argument(
        "--out", type=Path, required=True, metavar="FILE.json", help="the calibration, for --camera-file"
    )
    calibrate.add_argument("--size", type=values.size, metavar="WxH", help="size to ask the camera for")
    calibrate.add_argument(
        "--headless", action="store_true", help="print what to do next in the terminal, without a window"
    )
    calibrate.add_argument("--overwrite", action="store_true", help="replace an existing file")

    _add_benches(commands.add_parser("bench", help="measure speed and accuracy on this machine"))
    return parser


def _add_estimate_options(estimate: argparse.ArgumentParser) -> None:
    estimate.add_argument("files", type=Path, nargs="+", metavar="FILE", help="also folders and patterns ('*.jpg')")
    estimate.add_argument(
        "--json", action="store_true", help="one JSON object a line, one line a file (docs/contract.md)"
    )
    estimate.add_argument(
        "--repeat", type=values.count, metavar="N", help="warm up once, then give the median times of N runs"
    )
    estimate.add_argument("--debug", type=Path, metavar="DIR", help="write a sheet of each estimate's steps there")
    estimate.add_argument("--sheet", type=Path, metavar="FILE.html", help="a page with the light drawn into thumbnails")
    estimate.add_argument("--overwrite", action="store_true", help="replace an existing sheet")
    estimate.add_argument("--estimate-at", type=values.index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    estimate.add_argument(
        "--together", action="store_true", help="one answer from all files: photos of one table, with nothing moved"
    )
    estimate.add_argument(
        "--views", type=values.views, default=12, metavar="N", help="frames of a clip to answer from (default up to 12)"
    )
    estimate.add_argument(
        "--frames",
        type=values.frame_range,
        default=(0, None),
        metavar="FIRST:LAST",
        help="frames of a clip to choose them from (default: from the first usable one on, for ten seconds)",
    )
    _add_scene_options(estimate)
    estimate.set_defaults(no_filter=False)
    _add_quality_options(estimate)


def _add_marker_options(marker: argparse.ArgumentParser) -> None:
    target = marker.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", type=Path, metavar="FILE.pdf|png")
    target.add_argument("--show", action="store_true", help="show it in a window instead of printing it")
    marker.add_argument("--marker", default=DEFAULT_MARKER, metavar="SPEC", help=MARKER_HELP)
    marker.add_argument(
        "--size-mm", type=values.millimetres, default=80.0, metavar="MM", help="side of the black square (default 80)"
    )
    cube = marker.add_argument_group("a cube to fold")
    cube.add_argument(
        "--cube", action="store_true", help="print a cube, which is marker, caster and light probe in one"
    )
    cube.add_argument("--side", type=values.side_m, metavar="METRES", help="its edge (default 0.06)")
    _add_paper(marker)
    marker.add_argument("--overwrite", action="store_true", help="replace an existing file")


def _add_paper(printed: argparse.ArgumentParser) -> None:
    printed.add_argument(
        "--paper", choices=("a4", "letter", "a3"), default="a4", help="larger sheets are of its series (default a4)"
    )


def _add_benches(bench: argparse.ArgumentParser) -> None:
    benches = bench.add_subparsers(dest="bench", metavar="WHAT", required=True)

    viewer = benches.add_parser("viewer", help="the viewer's loop: frames a second, and frame times while estimating")
    viewer.add_argument(
        "--frames", type=values.count, default=600, metavar="N", help="frames of each run (default 600)"
    )
    viewer.add_argument("--size", type=values.size, metavar="WxH", help="size of the picture (default: the clip's)")
    _add_results_folder(viewer)
    _add_quality_options(viewer, default="fast")

    render = benches.add_parser(
        "render", help="the cost of rendering, and the difference from a path tracer's pictures"
    )
    render.add_argument(
        "--frames", type=values.count, default=100, metavar="N", help="frames of each measurement (default 100)"
    )
    render.add_argument("--memory-frames", type=values.count, default=1000, metavar="N", help=MEMORY_FRAMES_HELP)
    render.add_argument("--pairs", type=Path, metavar="DIR", help="also against photos of scenes with a model in them")
    _add_results_folder(render)

    soak = benches.add_parser("soak", help="a long run: leaks, drift, and the latency from the camera to the screen")
    soak.add_argument("--frames", type=values.count, default=100_000, metavar="N", help="frames (default 100000)")
    _add_results_folder(soak)
    _add_quality_options(soak, default="fast")

    light = benches.add_parser("light", help="the estimators' errors on scenes whose light is known")
    light.add_argument("--scenes", type=Path, nargs="+", required=True, metavar="DIR")
    _add_results_folder(light)
    light.add_argument("--quick", action="store_true", help="in less than a minute: fewer scenes, balanced only")
    light.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME")
    light.add_argument("--limit", type=values.count, metavar="N", help="the first N scenes of each folder only")

    judge = benches.add_parser("fit-judge", help="fits confidence to scenes whose light is known")
    judge.add_argument("--scenes", type=Path, nargs="+", required=True, metavar="DIR")
    _add_results_folder(judge)
    judge.add_argument("--limit", type=values.count, metavar="N", help="the first N scenes of each folder only")
    judge.add_argument("--every", type=values.count, default=1, metavar="N", help="of these, every Nth (default 1)")

    cube = benches.add_parser("cube", help="the paper cube's pose and light, on painted pictures with known truth")
    cube.add_argument("--count", type=values.count, default=40, metavar="N", help="pictures of each set (default 40)")
    _add_results_folder(cube)
    cube.add_argument("--quality", choices=("fast", "balanced", "accurate"), default="balanced")

    tracking = benches.add_parser("track", help="the tracker beside OpenCV's detector, on frames with known poses")
    tracking.add_argument("--real", type=Path, metavar="DIR", help="also follow the real clips listed there")
    tracking.add_argument("--photos", type=Path, metavar="DIR", help="also look for absent ids in the pictures there")
    tracking.add_argument(
        "--scenes", type=Path, nargs="+", default=(), metavar="DIR", help="also check, and fit, how certain poses are"
    )
    _add_results_folder(tracking)
    tracking.add_argument("--quick", action="store_true", help="fewer frames, and no comparison of settings")
    tracking.add_argument("--quality", choices=("fast", "balanced", "accurate"), default="balanced")


def _add_results_folder(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--out", type=Path, metavar="DIR", help="where results.json and the plots go")
    bench.add_argument("--overwrite", action="store_true", help="replace existing files there")


def _add_scene_options(parser: argparse.ArgumentParser) -> None:
    scene = parser.add_argument_group("what the camera sees")
    scene.add_argument("--marker", default=DEFAULT_MARKER, action=_Named, metavar="SPEC", help=MARKER_HELP)
    parser.set_defaults(takes_any_marker=True)
    scene.add_argument(
        "--marker-size",
        type=values.side_m,
        metavar="METRES",
        help="black square's side (default 0.08), or the cube's edge (default 0.06)",
    )
    camera = scene.add_mutually_exclusive_group()
    camera.add_argument("--camera-file", type=Path, metavar="FILE.json", help='calibration: {"size", "K", "dist"}')
    camera.add_argument("--focal-px", type=values.focal_px, metavar="F", help="focal length in pixels of the source")
    camera.add_argument(
        "--hfov",
        type=values.angle_deg,
        metavar="DEG",
        help="horizontal field of view (default: 60 is assumed)",
    )


def _add_view_options(parser: argparse.ArgumentParser) -> None:
    view = parser.add_argument_group("what is shown")
    view.add_argument(
        "--model", default="cube", metavar="NAME|FILE", help="shipped model, or glTF/GLB/OBJ/PLY/STL file"
    )
    view.add_argument("--up", choices=UPS, metavar="AXIS", help=f"of the model's file: {', '.join(UPS)} (key U)")
    view.add_argument("--size", type=values.size, metavar="WxH", help="size of the window (default: the source's)")
    view.add_argument("--loop", action="store_true", help="start again at the end of the clip")
    view.add_argument("--estimate-at", type=values.index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    view.add_argument(
        "--auto", action="store_true", help="watch the light, and estimate it anew when it changes (key A)"
    )
    view.add_argument(
        "--hide-marker", action="store_true", help="cover the marker's sheet with ground like that around it (key C)"
    )
    view.add_argument("--mirror", action="store_true", help="show the window as a mirror would (key W)")
    view.add_argument("--no-filter", action="store_true", help="show each frame's pose as measured, without smoothing")
    output = parser.add_argument_group("without a window")
    output.add_argument("--headless", action="store_true", help="render every frame offscreen")
    output.add_argument("--frames", type=values.count, metavar="N", help="stop after N frames")
    output.add_argument("--out", type=Path, metavar="VIDEO.mp4", help="record what is shown")
    output.add_argument(
        "--layers",
        choices=LAYERS,
        help="record what is drawn alone, with its transparency: --out FILE.mov (ProRes 4444) or FILE.webm (VP9)",
    )
    output.add_argument(
        "--report", type=Path, metavar="REPORT.json", help="poses, estimates and times (docs/contract.md)"
    )
    output.add_argument("--overwrite", action="store_true", help="replace existing files")
    _add_quality_options(parser)


def _add_quality_options(parser: argparse.ArgumentParser, default: str = "balanced") -> None:
    trade = parser.add_argument_group("speed against accuracy")
    trade.add_argument("--quality", choices=("fast", "balanced", "accurate", "auto"), default=default)
    trade.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=f"(default {DEFAULT_ESTIMATOR})")
    trade.add_argument("--light", choices=LIGHTS, default=LIGHTS[0], help=LIGHT_HELP)


class _Named(argparse.Action):
    """A marker that somebody has named: no other is taken in its place."""

    def __call__(self, _parser: object, options: argparse.Namespace, value: Any, _flag: object = None) -> None:
        options.marker, options.takes_any_marker = value, False


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

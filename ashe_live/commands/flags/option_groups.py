"""Groups of options that several commands have."""

import argparse
from typing import Any

from ashe_live.commands.flags import values

DEFAULT_MARKER = "aruco:4x4_50:0"
DEFAULT_ESTIMATOR = "proxy"
MARKERS_HELP = "aruco:DICT:ID, apriltag:36h11:ID, pattern:FILE.patt (ARToolKit), image:FILE.png, grid:DICT:COLSxROWS"
MARKER_HELP = f"{MARKERS_HELP}, cube (the paper one) or cube+SPEC (default: the one in view, or {DEFAULT_MARKER})"
CASTER_HELP = (
    "the object that casts the shadow, where its shape and size are known: box:WxDxH, cylinder:RxH or sphere:R in "
    "metres, or the file of a model (default: any object)"
)
DEFAULT_MODELS = ("cube",)
# The same as in the models' catalogue, whose imports --help must not wait for.
SHIPPED_MODELS = ("cube", "goblet", "lantern", "mug", "tree")
LIGHTS = ("auto", "sun", "lamp")
LIGHT_HELP = (
    "auto (default): a lamp where its distance is shown; lamp: wherever anything of its distance is told; sun: never"
)
QUALITY_HELP = (
    "of tracking, light and drawing; auto: the best at which the window keeps up with the display (without a window: "
    "balanced)"
)
ESTIMATOR_HELP = f"how the light is estimated; `paper` is the AShE paper's method (default {DEFAULT_ESTIMATOR})"
LAYERS = ("both", "model", "shadow")
UPS = ("x", "y", "z", "-x", "-y", "-z")
ESTIMATE_AT_HELP = "estimate the light on this frame (default: the first of a clip with a steady marker)"
# The same as in ashe_live.quality, whose imports --help must not wait for.
QUALITIES = ("fast", "balanced", "accurate")


def add_command(
    commands: "argparse._SubParsersAction[argparse.ArgumentParser]", name: str, what: str
) -> argparse.ArgumentParser:
    """The parser of a command that does `what`, as the list of commands says and its own help begins."""
    return commands.add_parser(name, help=what, description=f"{what[0].upper()}{what[1:]}.")


def add_scene_options(parser: argparse.ArgumentParser) -> None:
    scene = parser.add_argument_group("what the camera sees")
    scene.add_argument("--marker", default=DEFAULT_MARKER, action=_Named, metavar="SPEC", help=MARKER_HELP)
    parser.set_defaults(takes_any_marker=True)
    scene.add_argument(
        "--marker-size",
        type=values.side_m,
        metavar="METRES",
        help="black square's side (default 0.08), or the paper cube's edge (default 0.06)",
    )
    scene.add_argument("--caster", metavar="SHAPE|FILE", help=CASTER_HELP)
    camera = scene.add_mutually_exclusive_group()
    camera.add_argument(
        "--camera-file",
        type=values.path,
        metavar="FILE.json",
        help='what `ashe-live calibrate` wrote: {"size", "K", "dist"}',
    )
    camera.add_argument("--focal-px", type=values.focal_px, metavar="F", help="focal length in pixels of the source")
    camera.add_argument(
        "--hfov",
        type=values.angle_deg,
        metavar="DEG",
        help="horizontal field of view (default: 60 is assumed across the longer side, 65 if it stands upright)",
    )


def add_view_options(parser: argparse.ArgumentParser) -> None:
    view = parser.add_argument_group("what is shown")
    view.add_argument(
        "--model",
        action=_Several,
        type=values.model,
        default=DEFAULT_MODELS,
        metavar="[ID=]NAME|FILE",
        help=f"{', '.join(SHIPPED_MODELS)} (default {DEFAULT_MODELS[0]}), or a glTF/GLB/OBJ/PLY/STL file; several "
        "stand side by side, or one a marker (--model mug --model 7=tree.glb)",
    )
    view.add_argument("--up", choices=UPS, metavar="AXIS", help=f"of the first model's file: {', '.join(UPS)} (key U)")
    view.add_argument(
        "--size", type=values.size, metavar="WxH", help="of the window, and asked of a camera (default: the source's)"
    )
    view.add_argument("--loop", action="store_true", help="start again at the end of the clip")
    view.add_argument("--estimate-at", type=values.index, metavar="FRAME", help=ESTIMATE_AT_HELP)
    view.add_argument(
        "--auto", action="store_true", help="watch the light, and estimate it anew when it changes (key A)"
    )
    view.add_argument(
        "--hide-marker",
        action=argparse.BooleanOptionalAction,
        help="cover the marker's sheet, or the paper cube, with ground like that around it (default: the sheet "
        "alone; key C)",
    )
    mirrored = "show the window, not what is recorded, as a mirror would (key W)"
    view.add_argument("--mirror", action="store_true", help=mirrored)
    view.add_argument("--no-filter", action="store_true", help="show each frame's pose as measured, without smoothing")
    _add_output_options(parser)
    add_quality_options(parser)


def _add_output_options(parser: argparse.ArgumentParser) -> None:
    output = parser.add_argument_group("recording, and drawing without a window")
    output.add_argument("--headless", action="store_true", help="render every frame offscreen, without a window")
    output.add_argument("--frames", type=values.count, metavar="N", help="stop after N frames")
    output.add_argument(
        "--out",
        type=values.path,
        metavar="VIDEO.mp4",
        help="record what is shown; with --headless also FILE.png: the last picture, as of a photo",
    )
    output.add_argument(
        "--layers",
        choices=LAYERS,
        help="record what is drawn alone, with its transparency: --out FILE.mov (ProRes 4444), .webm (VP9) or .png",
    )
    output.add_argument(
        "--as-shown",
        type=values.path,
        metavar="FILE.json",
        help="as it was moved and lit by hand while it was recorded (V names the file when it stops)",
    )
    output.add_argument(
        "--report", type=values.path, metavar="REPORT.json", help="poses, estimates and times (docs/contract.md)"
    )
    output.add_argument("--overwrite", action="store_true", help="replace existing files")


def add_quality_options(parser: argparse.ArgumentParser) -> None:
    trade = parser.add_argument_group("speed against accuracy")
    trade.add_argument(
        "--quality", choices=(*QUALITIES, "auto"), default="balanced", help=f"{QUALITY_HELP} (default balanced)"
    )
    trade.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=ESTIMATOR_HELP)
    trade.add_argument("--light", choices=LIGHTS, default=LIGHTS[0], help=LIGHT_HELP)


class _Named(argparse.Action):
    """Notes that the marker was named, so that no other is followed instead."""

    def __call__(self, _parser: object, options: argparse.Namespace, value: Any, _flag: object = None) -> None:
        options.marker, options.takes_any_marker = value, False


class _Several(argparse.Action):
    """Collects the values of a repeated flag; the first replaces the default."""

    def __call__(self, _parser: object, options: argparse.Namespace, value: Any, _flag: object = None) -> None:
        given = getattr(options, self.dest)
        setattr(options, self.dest, (*(() if given is self.default else given), value))

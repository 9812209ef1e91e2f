"""`ashe-live marker`: a marker to print at true size, also as a cube to fold, or to show on a screen."""

import argparse
import shlex

from ashe_live.commands.flags.model_choice import marker_files
from ashe_live.commands.flags.option_groups import DEFAULT_MARKER
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files.writing import check_outputs
from ashe_live.process.messages import print_answer
from ashe_live.tracking.cube.faces import CUBE, USUAL_EDGE_M
from ashe_live.tracking.cube.sheet import write_cube_sheet
from ashe_live.tracking.families.layout import Layout, cube_layout, is_of_cube, parse_target
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.families.page import larger_than
from ashe_live.tracking.families.printing import write_marker_sheet

USUAL_MM = 80.0
SHOWN_PX = 960  # divisible by the usual numbers of cells, and larger than most windows show the marker
ON_PAPER = "give --out marker.pdf instead, and print it"


def run(options: argparse.Namespace) -> int:
    usual = CUBE if options.cube else DEFAULT_MARKER
    spec = usual if options.marker is None else options.marker
    marker = parse_target(spec)
    if spec != CUBE and (options.cube or is_of_cube(spec)):
        flat = spec.removeprefix(f"{CUBE}+")
        raise UserError(
            f"the cube's sheet has markers of its own, and none for {flat}",
            f"print the cube by --cube alone, and {flat} by another `marker --marker {flat}`",
        )
    if spec == CUBE:
        _print_cube(options)
        return ExitStatus.ANSWERED
    if options.side is not None:
        raise UserError("--side is a cube's edge", "give --cube with it, or --size-mm for a flat marker")
    flags = [] if spec == DEFAULT_MARKER else [f"--marker {shlex.quote(spec)}"]
    if options.show:
        _show(options, marker, flags)
    else:
        _print(options, marker, flags)
    return ExitStatus.ANSWERED


def _print_cube(options: argparse.Namespace) -> None:
    if options.show:
        raise UserError(
            "a screen cannot be folded: --show is of no use for a cube", "give --out cube.pdf, and print it"
        )
    if options.size_mm is not None:
        raise UserError("--size-mm is the side of a flat marker", "give a cube's edge in metres by --side")
    edge_m = USUAL_EDGE_M if options.side is None else options.side
    write_cube_sheet(options.out, cube_layout(), edge_m, options.paper, options.overwrite)
    flags = f"--marker {CUBE}" if edge_m == USUAL_EDGE_M else f"--marker {CUBE} --marker-size {edge_m:g}"
    print_answer(f"{options.out}: print it at 100 % on stiff matt paper, fold it, stand it on its plain face: {flags}")


def _show(options: argparse.Namespace, marker: Marker | Layout, flags: list[str]) -> None:
    """On the screen, until it is closed; `flags`: with which the viewer tracks it."""
    if options.size_mm is not None:
        raise UserError("--size-mm is for printing", "leave it out, and measure the marker on the screen")
    # Imported here, as printing must need neither GLFW nor OpenGL.
    from ashe_live.commands.viewing.setup import has_display
    from ashe_live.viewer.windows.marker_window import show_marker

    if not has_display():
        raise UserError("there is no display to show a marker on", ON_PAPER)
    if isinstance(marker, Layout):
        raise UserError("a grid of markers is for printing", "name one marker with --marker, or give --out")
    try:
        show_marker(marker.spec, marker.bitmap(SHOWN_PX), flags)
    except UserError as error:  # which advises the viewer's --headless
        raise UserError(error.message, ON_PAPER) from error


def _print(options: argparse.Namespace, marker: Marker | Layout, flags: list[str]) -> None:
    """Into a file to print; `flags`: as of `_show`."""
    check_outputs([options.out], marker_files(options), options.overwrite)
    size_mm = USUAL_MM if options.size_mm is None else options.size_mm
    page_mm = write_marker_sheet(options.out, marker, size_mm / 1000, options.overwrite, options.paper)
    if size_mm != USUAL_MM:
        flags = [*flags, f"--marker-size {size_mm / 1000:g}"]
    use = f"; use it with {' '.join(flags)}" if flags else ""
    print_answer(
        f"{options.out}: print it at 100 %{larger_than(options.paper, page_mm)}, then the ruler line on it is true{use}"
    )

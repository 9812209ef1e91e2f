"""The parser of `ashe-live bench`."""

import argparse

from ashe_live.commands.flags import values
from ashe_live.commands.flags.option_groups import DEFAULT_ESTIMATOR, ESTIMATOR_HELP, QUALITIES, add_command

SCENES_HELP = "folders of pictures with known lights, each with a ground_truth.json"


def add_benches(bench: argparse.ArgumentParser) -> None:
    benches = bench.add_subparsers(dest="bench", metavar="WHAT", required=True)
    for name, add, what in (
        ("viewer", _add_viewer, "the viewer's loop: frames a second, and frame times while estimating"),
        ("render", _add_render, "the cost of rendering, and the difference from a path tracer's pictures"),
        ("soak", _add_soak, "a long run: leaks, drift, and the latency from the camera to the screen"),
        ("light", _add_light, "the estimators' errors on scenes whose light is known"),
        ("fit-judge", _add_fit_judge, "fits confidence to scenes whose light is known"),
        ("fit-lamps", _add_fit_lamps, "how far the fall of light is believed, by lamps whose places are known"),
        ("fit-seconds", _add_fit_seconds, "how clear a second light's shadow has to be, by scenes with known lights"),
        ("cube", _add_cube, "the paper cube's pose and light, on pictures with known truth"),
        ("track", _add_track, "the tracker beside OpenCV's detector, on frames with known poses"),
    ):
        add(add_command(benches, name, what))


def _add_viewer(viewer: argparse.ArgumentParser) -> None:
    viewer.add_argument(
        "--frames", type=values.count, default=600, metavar="N", help="frames of each run (default 600)"
    )
    viewer.add_argument("--size", type=values.size, metavar="WxH", help="size of the picture (default: the clip's)")
    _add_results_folder(viewer)
    _add_preset(viewer, "fast")
    viewer.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=ESTIMATOR_HELP)


def _add_render(render: argparse.ArgumentParser) -> None:
    render.add_argument(
        "--frames", type=values.count, default=100, metavar="N", help="frames of each measurement (default 100)"
    )
    render.add_argument(
        "--pairs", type=values.path, metavar="DIR", help="also against photos of scenes with a model in them"
    )
    render.add_argument(
        "--budget",
        type=values.path,
        metavar="DIR",
        help="only what each cause of the difference from such photos costs",
    )
    _add_results_folder(render)


def _add_soak(soak: argparse.ArgumentParser) -> None:
    soak.add_argument("--frames", type=values.count, default=100_000, metavar="N", help="frames (default 100000)")
    _add_results_folder(soak)
    _add_preset(soak, "fast")
    soak.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=ESTIMATOR_HELP)


def _add_light(light: argparse.ArgumentParser) -> None:
    _add_scenes(light)
    _add_results_folder(light)
    light.add_argument("--quick", action="store_true", help="in less than a minute: fewer scenes, balanced only")
    light.add_argument("--estimator", default=DEFAULT_ESTIMATOR, metavar="NAME", help=ESTIMATOR_HELP)
    light.add_argument(
        "--casters", action="store_true", help="also with the scenes' own boxes, cylinders and spheres as --caster"
    )
    light.add_argument(
        "--empty",
        type=values.path,
        metavar="DIR",
        help="only scenes of which this folder has pictures of the same names without the object, and over these",
    )
    light.add_argument(
        "--tracked",
        action="store_true",
        help="takes by the tracker's own poses, and a focal length 1 %% too long, in place of the true ones",
    )
    _add_limit(light)


def _add_fit_judge(judge: argparse.ArgumentParser) -> None:
    _add_scenes(judge)
    _add_results_folder(judge)
    _add_limit(judge)
    _add_every(judge)
    only = judge.add_mutually_exclusive_group()
    only.add_argument(
        "--casters", action="store_true", help="only how known casters are judged, from the tables as they are"
    )
    only.add_argument(
        "--confidence", action="store_true", help="only how sure answers are, by the tables' curves as they are"
    )
    only.add_argument(
        "--sheets", action="store_true", help="only how the shadow of the marker's sheet counts, beside the tables"
    )
    judge.add_argument(
        "--jobs", type=values.count, default=1, metavar="N", help="processes beside each other (default 1)"
    )


def _add_fit_lamps(lamps: argparse.ArgumentParser) -> None:
    _add_scenes(lamps)
    _add_results_folder(lamps)
    _add_limit(lamps)


def _add_fit_seconds(seconds: argparse.ArgumentParser) -> None:
    _add_scenes(seconds)
    _add_results_folder(seconds)
    _add_limit(seconds)
    _add_every(seconds)


def _add_cube(cube: argparse.ArgumentParser) -> None:
    cube.add_argument("--count", type=values.count, default=40, metavar="N", help="pictures of each set (default 40)")
    cube.add_argument(
        "--seed", type=values.index, default=0, metavar="N", help="other pictures of these kinds (default 0)"
    )
    _add_scenes(cube, "the light on these pictures, not on painted ones")
    _add_results_folder(cube)
    _add_preset(cube, "balanced")


def _add_track(tracking: argparse.ArgumentParser) -> None:
    tracking.add_argument("--real", type=values.path, metavar="DIR", help="also follow the real clips listed there")
    tracking.add_argument(
        "--photos", type=values.path, metavar="DIR", help="also look for absent ids in the pictures there"
    )
    _add_scenes(tracking, "also check, and fit, how certain poses are")
    _add_results_folder(tracking)
    tracking.add_argument("--quick", action="store_true", help="fewer frames, and no comparison of settings")
    _add_preset(tracking, "balanced")


def _add_preset(bench: argparse.ArgumentParser, default: str) -> None:
    """Without `auto`, which changes as it runs."""
    said = f"the preset that is measured (default {default})"
    bench.add_argument("--quality", choices=QUALITIES, default=default, help=said)


def _add_scenes(bench: argparse.ArgumentParser, instead: str | None = None) -> None:
    """Folders of pictures with known lights; `instead`: what they are for in a bench that does without them."""
    said = SCENES_HELP if instead is None else f"{SCENES_HELP}: {instead}"
    bench.add_argument(
        "--scenes", type=values.path, nargs="+", required=instead is None, default=(), metavar="DIR", help=said
    )


def _add_limit(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--limit", type=values.count, metavar="N", help="the first N scenes of each folder only")


def _add_every(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--every", type=values.count, default=1, metavar="N", help="of these, every Nth (default 1)")


def _add_results_folder(bench: argparse.ArgumentParser) -> None:
    bench.add_argument("--out", type=values.path, metavar="DIR", help="where results.json and the plots go")
    bench.add_argument("--overwrite", action="store_true", help="replace existing files there")

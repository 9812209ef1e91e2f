"""Constants that the pages state are those of the code: each sentence here has its numbers filled in from there.

Whoever changes a constant finds here where it is written, and whoever rewords a sentence which constant it states.
"""

import math
import re

import pytest

from ashe_live.files.resources import resource
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.explanation.alignment import COST_PER_PARAMETER
from ashe_live.light.explanation.borders import PIXELS_PER_SAMPLE
from ashe_live.light.explanation.judgement.evidence import SIGNS
from ashe_live.light.explanation.light_covariance import MODEL_ERROR_SHARE
from ashe_live.light.explanation.searches.second_light import LEAST_GAIN
from ashe_live.light.lamps.companions import LEAST_PROBABILITY
from ashe_live.light.lamps.doubt import CHANCE_DEVIANCE, LAMPS_NEARNESS
from ashe_live.light.lamps.fall import fall_off, lit_samples
from ashe_live.light.lamps.lamp import OPEN_NEARNESS_SIGMA
from ashe_live.models.material import MATT_ROUGHNESS, MIRROR_ROUGHNESS
from ashe_live.quality import BALANCED, FAST, QUALITIES
from ashe_live.render.camera.held_look import LOOK_HELD_S
from ashe_live.render.camera.white import ASSUMED_WHITE, PAPER_ALBEDO
from ashe_live.render.lights.lighting import LAMP_RADIUS_M, SUN_ANGULAR_SIZE_RAD
from ashe_live.render.reflections.surroundings import HALF_RADIUS_SIDES, PATTERN_SIZE
from ashe_live.tracking.families.cells import MIN_CORRELATION, MIN_LEAD
from ashe_live.tracking.search import LARGEST_PX, SMALLEST_PX
from ashe_live.viewer.auto_quality import AMPLE, CALM_WINDOWS, SLOW_FRAMES, SLOW_MS, TOO_SLOW, WINDOW_FRAMES
from ashe_live.viewer.hands.hand import LARGEST, SMALLEST
from ashe_live.viewer.playback import SPEEDS
from tests.checkout import CHECKOUT


def in_shader(pattern: str, name: str) -> float:
    """The one number that `pattern` finds in a shader."""
    (found,) = set(re.findall(pattern, resource("shaders", name).read_text(encoding="utf-8")))
    return float(found)


STATED = {
    "the ground's map": (
        "docs/maths/drawing.md",
        "the map holds g at g / (|g| + {:g} sides of the marker)",
        (HALF_RADIUS_SIDES,),
    ),
    "the sky's pattern": ("docs/maths/drawing.md", "the picture, blurred to {} x {} texels", PATTERN_SIZE),
    "what mirrors": (
        "docs/maths/drawing.md",
        "Dielectrics rougher than {:g} take A instead, and those rougher than {:g} mirror nothing",
        (MIRROR_ROUGHNESS, MATT_ROUGHNESS),
    ),
    "dielectrics": (
        "docs/maths/drawing.md",
        "F0 = mix({:g}, c, m)",
        (in_shader(r"GLASS = (0\.\d+)", "model/glass.glsl"),),
    ),
    "worst unevenness": (
        "docs/maths/lamps.md",
        "worst unevenness with deviations D ({:g} / m, {:g} / m², and {:g} for the contrast)",
        (fall_off.WORST_GRADIENT, fall_off.WORST_CURVATURE, fall_off.WORST_CONTRAST),
    ),
    "what is fitted beside a lamp": (
        "docs/maths/lamps.md",
        "vignetting v ({:g}; rho = 1 in the corners), a gradient b ({:g} / m) and a curvature C ({:g} / m²)",
        (lit_samples.VIGNETTING, lit_samples.GRADIENT, lit_samples.CURVATURE),
    ),
    "cells of texture": ("docs/maths/lamps.md", "the design effect of {} x {} cells", lit_samples.CELLS),
    "another object's odds": ("docs/maths/lamps.md", "From {:g} on it counts", (LEAST_PROBABILITY,)),
    "the nearness of lamps": ("docs/maths/lamps.md", "A lamp has k ~ N(0, {:g}²/m²), positive", (LAMPS_NEARNESS,)),
    "a sun's direction stays": ("docs/maths/lamps.md", "Below D = {:g} (one in twenty by chance,", (CHANCE_DEVIANCE,)),
    "a second light": ("docs/maths/colours.md", "the region would cost {:g} more by (15)", (LEAST_GAIN,)),
    "where it is looked for": ("docs/maths/lamps.md", "or uncertain by more than {:g} / m", (OPEN_NEARNESS_SIGMA,)),
    "a picture's effective sample size": (
        "docs/maths/explanation.md",
        "the {:g} px (`PIXELS_PER_SAMPLE`)",
        (PIXELS_PER_SAMPLE,),
    ),
    "borders' effective sample size": (
        "docs/maths/explanation.md",
        "{:g} of them (`BORDERS_PER_SAMPLE`)",
        (BORDERS_PER_SAMPLE,),
    ),
    "a wrong body": (
        "docs/maths/explanation.md",
        "{:.1f} % of the object's size (`MODEL_ERROR_SHARE`)",
        (100 * MODEL_ERROR_SHARE,),
    ),
    "what a parameter costs": ("docs/maths/explanation.md", "(15) + {:g} q", (COST_PER_PARAMETER,)),
    "the sun": (
        "docs/rendering.md",
        "of a sun {:g} degrees unless it was measured, of a lamp by its radius, or else by that of a bulb, {:g} cm",
        (round(math.degrees(SUN_ANGULAR_SIZE_RAD), 6), 100 * LAMP_RADIUS_M),
    ),
    "exposure": (
        "docs/rendering/light.md",
        "divided by paper's albedo of {:g} and measured in each frame",
        (PAPER_ALBEDO,),
    ),
    "blur and noise": (
        "docs/rendering/light.md",
        "Blur and noise are measured every {:g} s of the video",
        (LOOK_HELD_S,),
    ),
    "exposure without paper": (
        "docs/rendering/light.md",
        "w stays as it was last, and is {:g} at the start",
        (ASSUMED_WHITE,),
    ),
    "the real shadow's rim": (
        "docs/rendering/shadows.md",
        "Within {:g} pixels of the real shadow's outline",
        (in_shader(r"RIM_PX = ([\d.]+)", "catchers/ground.frag"),),
    ),
    "the fixed filter": (
        "docs/rendering/shadows.md",
        "a fixed filter of {0} x {0} texels",
        (2 * FAST.render.pcf_radius + 1,),
    ),
    "the bias": (
        "docs/rendering/shadows.md",
        "moves no shadow aside, by {:g} texel at most",
        (in_shader(r"MOST_AHEAD = ([\d.]+)", "lights/shadow.glsl"),),
    ),
    "depth maps": (
        "docs/rendering.md",
        "| texels a side of a depth map | {} | {} | {} |",
        [quality.render.shadow_map_size for quality in QUALITIES.values()],
    ),
    "shadows on the ground": (
        "docs/rendering.md",
        "| texels a side of a shadow on the ground | {} | {} | {} |",
        [quality.render.ground_shadow_size for quality in QUALITIES.values()],
    ),
    "taps": (
        "docs/rendering.md",
        "over a penumbra | {}, {} | {}, {} | {}, {} |",
        [taps for quality in QUALITIES.values() for taps in (quality.render.blocker_taps, quality.render.soft_taps)],
    ),
    "samples a pixel": (
        "docs/rendering.md",
        "on a software rasteriser | {}, {} | {}, {} | {}, {} |",
        [
            max(1, samples)
            for quality in QUALITIES.values()
            for samples in (quality.render.msaa_samples, quality.render.software_msaa_samples)
        ],
    ),
    "what is mirrored": (
        "docs/rendering.md",
        "that polished surfaces mirror | {} | {} | {} |",
        [quality.render.environment_size for quality in QUALITIES.values()],
    ),
    "auto's way down": (
        "docs/rendering.md",
        "by the median time of {} frames, or of {} or more that took {:g} s together: down when it is above {:g}",
        (WINDOW_FRAMES, SLOW_FRAMES, SLOW_MS / 1000, TOO_SLOW),
    ),
    "auto's way up": (
        "docs/rendering.md",
        "up when that of {} frames was below {:g} of it {} times in a row",
        (WINDOW_FRAMES, AMPLE, CALM_WINDOWS),
    ),
    "the detector's region": (
        "docs/tracking.md",
        "so that the marker has {:g} to {:g} px there",
        (SMALLEST_PX, LARGEST_PX),
    ),
    "what a marker looks like": (
        "docs/tracking.md",
        "the marker must correlate with {:g} or more and lead by {:g} before any other",
        (MIN_CORRELATION, MIN_LEAD),
    ),
    "the pose filter's gate": (
        "docs/tracking.md",
        "{:g} σ holds 0.005 px with room",
        (BALANCED.tracking.filter_gate,),
    ),
    "size by hand": ("README.md", "from {:.0f} % to {:.0f} % of its size", (100 * SMALLEST, 100 * LARGEST)),
    "speed": ("README.md", "slower, faster: {:g} to {:g} times", (min(SPEEDS), max(SPEEDS))),
}


@pytest.mark.parametrize("name", STATED)
def test_a_page_states_the_constants_of_the_code(name: str) -> None:
    page, sentence, values = STATED[name]
    text = " ".join((CHECKOUT / page).read_text(encoding="utf-8").split())
    assert sentence.format(*values) in text


def test_the_signs_that_physics_gives_the_evidence_are_those_of_the_code() -> None:
    text = (CHECKOUT / "docs/maths/explanation.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([a-z ]+) \| ([+-]) \|", text.split("## Evidence")[1], re.MULTILINE)
    assert {name: int(sign + "1") for name, sign in rows} == SIGNS

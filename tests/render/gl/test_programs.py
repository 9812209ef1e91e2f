import math
import re
import string
import subprocess
import sys
from collections.abc import Iterator

import moderngl
import pytest

from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.render.gl import offscreen, programs
from ashe_live.render.gl.programs import shader_source, shaders_of
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.light_view import MOST_MAPS
from tests.render.uniform_audit import UniformError

ALLOWED = string.ascii_letters + string.digits + "_.+-/*%<>[](){}^|&~=!:;,?#" + " \t\n"
LEAST_UNITS = 16  # that OpenGL 3.3 has for fragment shaders
LEAST_VECTORS = 256  # of four numbers, for their uniforms
SHADERS = {path.relative_to(resource("shaders")).as_posix() for path in resource("shaders").rglob("*.*")}
PASSES = sorted(name.removesuffix(".frag") for name in SHADERS if name.endswith(".frag"))


def test_every_shader_is_used() -> None:
    of_passes = {name for each in PASSES for name in shaders_of(each)}
    texts = "".join(resource("shaders", name).read_text(encoding="utf-8") for name in of_passes)
    assert of_passes | set(re.findall(r'#include "(.*)"', texts)) == SHADERS


@pytest.mark.parametrize("name", sorted(SHADERS))
def test_shaders_have_the_characters_of_core_3_3_alone(name: str) -> None:
    r"""GLSL 3.30, 3.1. A line that goes on behind \ is one of 4.20: Mesa takes it, and macOS has no more than 4.10."""
    text = resource("shaders", name).read_bytes().decode("ascii")  # comments too: not every compiler skips the others
    code = re.sub(r"//.*", "", text)
    assert re.sub(r'#include "[a-z_./]+"', "", code).translate(dict.fromkeys(map(ord, ALLOWED))) == ""


@pytest.mark.parametrize("name", PASSES)
def test_shaders_are_core_3_3_and_compile(ctx: moderngl.Context, name: str) -> None:
    for file_name in shaders_of(name):
        assert shader_source(file_name).startswith("#version 330 core\n")
    for lights, groups, casters, blocker_taps in (
        (0, 1, 1, 0),
        (1, 1, 1, 0),
        (1, 1, 2, 8),
        (4, 1, 2, 16),
        (4, 2, 3, 16),
    ):
        constants = {
            "lights": lights,
            "groups": groups,
            "casters": casters,
            "blocker_taps": blocker_taps,
            "soft_taps": 16,
        }
        constants |= {
            "reach": casters,
            "taps": casters,
            "spread": casters - 1,
            **({"bends": 1, "coarse": 1, "relief": 1, "covers": 1} if casters > 1 else {}),
        }
        # These are drawn by a light alone, and the ground's shadow by its penumbrae.
        needs = {"occlusion/contact": lights, "occlusion/self_occlusion": lights, "lights/ground_shadow": blocker_taps}
        if needs.get(name, True):
            programs.build_program(ctx, name, pcf_radius=1, **constants).release()


@pytest.mark.parametrize("lights", [1, 2, 4])
def test_the_uniforms_of_most_shadow_maps_fit_into_opengl_3_3(ctx: moderngl.Context, lights: int) -> None:
    casters = MOST_MAPS // lights
    maps = {"lights": lights, "lamps": 1, "groups": casters - 1, "casters": casters}
    features = {"glossy": 1, "mirrors": 1, "coated": 1, "emits": 1, "laid_out": 1, "more_uvs": 1, "rounded": 1}
    for name in ("model/model", "catchers/ground"):
        program = programs.build_program(
            ctx, name, **maps, **features, blocker_taps=8, soft_taps=16, pcf_radius=1, min_roughness=0.06, covers=1
        )
        members = (program[member] for member in program)
        uniforms = [each for each in members if isinstance(each, moderngl.Uniform)]
        # Drivers store each element in vectors of four numbers; a matrix of four columns takes four.
        vectors = sum(each.array_length * math.ceil(each.dimension / 4) for each in uniforms)
        assert vectors > 80
        assert vectors <= LEAST_VECTORS
        program.release()


@pytest.mark.parametrize("name", PASSES)
def test_what_a_pass_samples_has_units_of_its_own(name: str) -> None:
    samplers = re.findall(r"uniform sampler\w+ (\w+)", "".join(map(shader_source, shaders_of(name))))
    units = [UNIT_OF[sampler] for sampler in samplers]
    assert len(set(units)) == len(units)
    assert all(0 <= unit < LEAST_UNITS for unit in units)


def test_no_other_sampler_is_read_from_where_the_depths_stay_bound() -> None:
    assert list(UNIT_OF.values()).count(UNIT_OF["shadow_depths"]) == 1


@pytest.fixture
def screen(ctx: moderngl.Context) -> Iterator[tuple[moderngl.Program, moderngl.VertexArray]]:
    """The simplest pass, ready to be drawn but for its uniforms."""
    program = programs.build_program(ctx, "screen/screen")
    array, target = ctx.vertex_array(program, []), ctx.simple_framebuffer((8, 8))
    target.use()
    yield program, array
    ctx.detect_framebuffer(0).use()  # moderngl binds again what was bound before
    for held in (array, program, target):
        held.release()


def test_a_uniform_that_no_shader_declares_is_an_error_in_tests(screen) -> None:
    program, _ = screen
    with pytest.raises(UniformError, match="'rectangel'"):
        programs.set_uniforms(program, rectangel=(-1.0, -1.0, 1.0, 1.0))


def test_a_uniform_that_nobody_has_set_is_an_error_in_tests(screen) -> None:
    program, array = screen
    with pytest.raises(UniformError, match="'rectangle'"):
        array.render(moderngl.TRIANGLE_STRIP, vertices=4)
    programs.set_uniforms(program, rectangle=(-1.0, -1.0, 1.0, 1.0))
    array.render(moderngl.TRIANGLE_STRIP, vertices=4)


INTERRUPTED = """
import signal, sys
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.gl.programs import build_program

def interrupt(frame, event, _argument):
    if event == "call" and frame.f_code.co_name == "make_uniform":
        sys.setprofile(None)
        signal.raise_signal(signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)
ctx = offscreen_context()
sys.setprofile(interrupt)
try:
    build_program(ctx, "model/model", lights=1, groups=1, casters=1, blocker_taps=0, soft_taps=16, pcf_radius=1)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_an_interrupt_while_a_program_is_made_is_an_interrupt_and_no_crash() -> None:
    run = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (0, "interrupted\n"), run.stderr


def test_include_and_constants_stand_after_the_version() -> None:
    lines = shader_source("model/model.frag", "#define PCF_RADIUS 2\n").splitlines()
    assert lines[:2] == ["#version 330 core", "#define PCF_RADIUS 2"]
    assert not any(line.startswith("#include") for line in lines)
    assert any("float shadow(int light, vec3 position" in line for line in lines)


def test_missing_opengl_ends_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_args: object, **_settings: object) -> None:
        raise Exception("libEGL.so.1 not found\nand more")

    monkeypatch.setattr(offscreen.moderngl, "create_context", refuse)
    with pytest.raises(UserError, match=r"no OpenGL 3.3.*libEGL.so.1 not found.*apt-get install") as caught:
        offscreen.offscreen_context()
    assert "\n" not in str(caught.value)

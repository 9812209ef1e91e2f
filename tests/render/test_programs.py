import subprocess
import sys

import moderngl
import pytest

from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.render import offscreen
from ashe_live.render.programs import build_program, shader_source

PASSES = sorted(path.stem for path in resource("shaders").glob("*.vert"))


def test_every_pass_has_a_pair_of_shaders() -> None:
    assert sorted(path.stem for path in resource("shaders").glob("*.frag")) == PASSES


@pytest.mark.parametrize("name", PASSES)
def test_shaders_are_core_3_3_and_compile(ctx: moderngl.Context, name: str) -> None:
    for suffix in (".vert", ".frag"):
        assert shader_source(name + suffix).startswith("#version 330 core\n")
    for lights, casters, blocker_taps in ((0, 1, 0), (1, 1, 0), (1, 2, 8), (4, 2, 16)):
        constants = {"lights": lights, "casters": casters, "blocker_taps": blocker_taps, "soft_taps": 16}
        if name not in ("contact", "ground_shadow") or lights:
            build_program(ctx, name, pcf_radius=1, contact_fade=0.3, **constants).release()


INTERRUPTED = """
import signal, sys
from ashe_live.render.offscreen import offscreen_context
from ashe_live.render.programs import build_program

def interrupt(frame, event, _argument):
    if event == "call" and frame.f_code.co_name == "make_uniform":
        sys.setprofile(None)
        signal.raise_signal(signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)
ctx = offscreen_context()
sys.setprofile(interrupt)
try:
    build_program(ctx, "model", lights=1, casters=1, blocker_taps=0, soft_taps=16, pcf_radius=1, contact_fade=0.3)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_an_interrupt_while_a_program_is_made_is_an_interrupt_and_no_crash() -> None:
    run = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (0, "interrupted\n"), run.stderr


def test_include_and_constants_stand_after_the_version() -> None:
    lines = shader_source("model.frag", "#define PCF_RADIUS 2\n").splitlines()
    assert lines[:2] == ["#version 330 core", "#define PCF_RADIUS 2"]
    assert not any(line.startswith("#include") for line in lines)
    assert any("float shadow(int light, vec3 position, vec3 normal)" in line for line in lines)


def test_missing_opengl_ends_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_args: object, **_settings: object) -> None:
        raise Exception("libEGL.so.1 not found\nand more")

    monkeypatch.setattr(offscreen.moderngl, "create_context", refuse)
    with pytest.raises(UserError, match=r"no OpenGL 3.3.*libEGL.so.1 not found.*apt-get install") as caught:
        offscreen.offscreen_context()
    assert "\n" not in str(caught.value)

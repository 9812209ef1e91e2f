"""Builds the shader programs from the files in `shaders`, with a small `#include` and constants as `#define`."""

from functools import cache
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from ashe_live.files.resources import resource
from ashe_live.process.signals import signals_held
from ashe_live.render.gl.texture_units import UNIT_OF

WHOLE_FRAMEBUFFER = "screen/whole.vert"


class Programs:
    """A cache of program variants, each built when it is first asked for."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._built: dict[tuple[str, tuple[tuple[str, float], ...]], moderngl.Program] = {}

    def get(self, name: str, **constants: float) -> moderngl.Program:
        """As `build_program`; the same program for the same constants."""
        key = name, tuple(sorted(_macros(constants).items()))
        if key not in self._built:
            self._built[key] = build_program(self._ctx, name, **constants)
        return self._built[key]

    def release(self) -> None:
        for program in self._built.values():
            program.release()
        self._built.clear()


def build_program(ctx: moderngl.Context, name: str, **constants: float) -> moderngl.Program:
    """The program of the pass `name`, as "lights/depth", its samplers on their units.

    `constants` become macros; one that is False is not defined.
    """
    defines = "".join(f"#define {key.upper()} {value}\n" for key, value in _macros(constants).items())
    vertex, fragment = (shader_source(file_name, defines) for file_name in shaders_of(name))
    # moderngl 5.13 calls Python for each uniform, and crashes when a signal's handler raises there.
    with signals_held():
        program = ctx.program(vertex_shader=vertex, fragment_shader=fragment)
    set_uniforms(program, **UNIT_OF)
    return program


def _macros(constants: dict[str, float]) -> dict[str, float]:
    return {name: 1 if value is True else value for name, value in constants.items() if value is not False}


@cache
def shaders_of(name: str) -> tuple[str, str]:
    """A pass's vertex and fragment shader; one without a vertex shader of its own covers the framebuffer."""
    own = f"{name}.vert"
    return own if (resource("shaders") / own).exists() else WHOLE_FRAMEBUFFER, f"{name}.frag"


def shader_source(file_name: str, defines: str = "") -> str:
    """The file's text, `defines` after its `#version`, each `#include "lights/shadow.glsl"` replaced by that file.

    Names of files are paths within `shaders`, wherever they stand.
    """
    lines: list[str] = []
    # Some drivers want #version before even a comment.
    for line in _read(file_name):
        if line.startswith("#version"):
            lines = [line, *defines.splitlines()]
        elif line.startswith("#include"):
            lines += _read(line.split('"')[1])
        else:
            lines.append(line)
    return "\n".join(lines) + "\n"


MATRICES = 9, 16  # how many numbers a matrix of three or four rows has


def set_uniforms(program: moderngl.Program, **values: Any) -> None:
    """Sets uniforms by name: numbers, tuples, matrices ([n,] k, k) for column vectors, other arrays as they are.

    Uniforms that the compiler has removed as unused, or the end of an array, are skipped, as that differs by driver.
    Names that the program's files do not declare, and uniforms that are never set, are errors in the tests.
    """
    for name, value in values.items():
        uniform = program.get(name, None)
        if isinstance(uniform, moderngl.Uniform):
            if isinstance(value, np.ndarray):
                # An array of four vectors has the shape of a matrix without being one.
                by_columns = value.swapaxes(-1, -2) if uniform.dimension in MATRICES else value
                used = 4 * uniform.dimension * uniform.array_length
                uniform.write(np.ascontiguousarray(by_columns, dtype=np.float32).tobytes()[:used])
            else:
                uniform.value = value


@cache  # most files are of many programs
def _read(file_name: str) -> tuple[str, ...]:
    path: Path = resource("shaders", file_name)
    return tuple(path.read_text(encoding="utf-8").splitlines())

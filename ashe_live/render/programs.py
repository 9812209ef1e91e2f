"""Builds the shader programs from the files in `shaders`, with a small `#include` and constants as `#define`."""

from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from ashe_live.core.resources import resource


def build_program(ctx: moderngl.Context, name: str, **constants: float) -> moderngl.Program:
    """The program of `shaders/<name>.vert` and `.frag`; `constants` become macros in upper case."""
    defines = "".join(f"#define {key.upper()} {value}\n" for key, value in constants.items())
    return ctx.program(
        vertex_shader=shader_source(f"{name}.vert", defines), fragment_shader=shader_source(f"{name}.frag", defines)
    )


def shader_source(file_name: str, defines: str = "") -> str:
    """The file's text, `defines` after its `#version`, each `#include "x.glsl"` replaced by that file."""
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


def set_uniforms(program: moderngl.Program, **values: Any) -> None:
    """Sets uniforms by name: numbers, tuples, or matrices (4, 4) for column vectors.

    What a compiler has found to be unused is left out, as each driver decides that for itself.
    """
    for name, value in values.items():
        uniform = program.get(name, None)
        if isinstance(uniform, moderngl.Uniform):
            if isinstance(value, np.ndarray):
                uniform.write(np.ascontiguousarray(value.T, dtype=np.float32))
            else:
                uniform.value = value


def _read(file_name: str) -> list[str]:
    path: Path = resource("shaders", file_name)
    return path.read_text(encoding="utf-8").splitlines()

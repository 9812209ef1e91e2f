"""Holds the passes to what their shaders declare; only in tests, so that a picture pays nothing for it.

`set_uniforms` itself leaves out what it does not find, because each driver drops other uniforms as unused. A name that
was mistyped, or a uniform that was forgotten, would go unnoticed: OpenGL takes 0 for what nobody sets.
"""

import importlib
import pkgutil
import re
from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

import moderngl
import numpy as np
import pytest

from ashe_live import render
from ashe_live.render.gl import programs
from ashe_live.render.gl.programs import shader_source, shaders_of

UNIFORM = re.compile(r"^uniform \w+ (\w+)", re.MULTILINE)


class UniformError(AssertionError):
    """A pass and its shader do not fit together."""


@cache
def declared_uniforms(name: str) -> frozenset[str]:
    """Of the pass `name`, whichever of its variants have them."""
    return frozenset(UNIFORM.findall("".join(map(shader_source, shaders_of(name)))))


class UniformAudit:
    """Hears of every program that is built, every value that is set and every draw."""

    def __init__(self) -> None:
        self.draws = 0
        self._declared: WeakKeyDictionary[moderngl.Program, frozenset[str]] = WeakKeyDictionary()
        self._unset: WeakKeyDictionary[moderngl.Program, set[str]] = WeakKeyDictionary()
        self._draws_nothing: WeakKeyDictionary[moderngl.Program, bool] = WeakKeyDictionary()

    def built(self, program: moderngl.Program, name: str) -> None:
        members = ((member, program[member]) for member in program)
        active = {member for member, kind in members if isinstance(kind, moderngl.Uniform)}
        self._declared[program] = declared_uniforms(name)
        self._unset[program] = active - programs.UNIT_OF.keys()

    def set(self, program: moderngl.Program, values: dict[str, Any]) -> None:
        if program not in self._declared:
            return  # it is being built, and told of every texture unit that there is
        if unknown := values.keys() - self._declared[program]:
            raise UniformError(f"{sorted(unknown)} are set and no shader of the pass declares them")
        if sampled := values.keys() & programs.UNIT_OF.keys():
            raise UniformError(f"{sorted(sampled)} have their units from texture_units.py")
        self._unset[program] -= values.keys()
        if "clip_from_marker" in values:
            self._draws_nothing[program] = not np.any(values["clip_from_marker"])

    def drawn(self, program: moderngl.Program) -> None:
        self.draws += 1
        # What puts every vertex in one place draws nothing: that is how a shader is compiled before it is needed.
        if not self._draws_nothing.get(program, False) and (unset := self._unset.get(program)):
            raise UniformError(f"{sorted(unset)} are drawn with and nobody has set them")


def begin_audit(patch: pytest.MonkeyPatch) -> UniformAudit:
    """Wherever the passes build programs, set uniforms or draw."""
    audit = UniformAudit()
    build_program, set_uniforms, draw = programs.build_program, programs.set_uniforms, moderngl.VertexArray.render

    def audited_build(ctx: moderngl.Context, name: str, **constants: float) -> moderngl.Program:
        program = build_program(ctx, name, **constants)
        audit.built(program, name)
        return program

    def audited_set(program: moderngl.Program, **values: Any) -> None:
        audit.set(program, values)
        set_uniforms(program, **values)

    def audited_draw(self: moderngl.VertexArray, *arguments: Any, **settings: Any) -> None:
        audit.drawn(self.program)
        draw(self, *arguments, **settings)

    for found in pkgutil.walk_packages(render.__path__, "ashe_live.render."):
        module = importlib.import_module(found.name)
        for name, audited in (("build_program", audited_build), ("set_uniforms", audited_set)):
            if hasattr(module, name):
                patch.setattr(module, name, audited)
    patch.setattr(moderngl.VertexArray, "render", audited_draw)
    return audit

"""An OpenGL context without a window, by EGL: what playing without a display and the tests draw with."""

import contextlib
import gc
import os
import sys
from collections.abc import Iterator
from typing import Any

import moderngl

from ashe_live.errors import UserError

Context = moderngl.Context
Framebuffer = moderngl.Framebuffer
GL_VERSION = 330
GL_TYPES = (
    moderngl.Buffer,
    moderngl.Texture,
    moderngl.Sampler,
    moderngl.Renderbuffer,
    moderngl.Framebuffer,
    moderngl.VertexArray,
    moderngl.Program,
)
# Only Linux has EGL; elsewhere moderngl's default is right.
STANDALONE: dict[str, Any] = {"standalone": True} | ({"backend": "egl"} if sys.platform.startswith("linux") else {})

# The latter is moderngl's name for all errors newer than OpenGL 3, GL_CONTEXT_LOST among them.
FATAL_ERRORS = ("GL_OUT_OF_MEMORY", "GL_UNKNOWN_ERROR")

_users: set[int] = set()  # this process, if it has had a context, and those it was forked from that had one


def offscreen_context() -> moderngl.Context:
    """A standalone context of OpenGL 3.3 core or later. Raises UserError when the machine has none.

    ValueError in a process that was forked from one that had a context: the driver's threads stayed behind, and what
    waits for them would wait for ever.
    """
    if _users and os.getpid() not in _users:
        raise ValueError('OpenGL is of no use in a process forked from one that used it: start it by "spawn"')
    try:
        made = moderngl.create_context(GL_VERSION, **STANDALONE)
    except Exception as error:  # glcontext raises whatever the loader of shared libraries tells it
        detail = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise UserError(
            f"no OpenGL 3.3 without a display ({detail})",
            "install Mesa: apt-get install libegl1 libgl1 libgl1-mesa-dri",
        ) from error
    _users.add(os.getpid())  # not before: a process without a context leaves nothing that its children could wait for
    return made


def window_context() -> moderngl.Context:
    """The context that a window has made current in this thread. Raises UserError when it is not OpenGL 3.3."""
    try:
        return moderngl.create_context(require=GL_VERSION)
    except Exception as error:  # moderngl raises ValueError, RuntimeError and bare Exception
        raise UserError(f"OpenGL 3.3 does not work here ({error})", "update the graphics driver") from error


@contextlib.contextmanager
def graphics_failures_reported() -> Iterator[None]:
    """Within this, what OpenGL fails at in mid-run (a lost context, no memory left) raises UserError."""
    try:
        yield
    except moderngl.Error as error:
        detail = " ".join(str(error).split()) or "no reason given"
        raise UserError(
            f"the graphics driver failed ({detail})", "start again; if that happens often, update the driver"
        ) from error


def check_graphics(ctx: Context) -> None:
    """Raises moderngl.Error if OpenGL has failed for good since the last check; it does not report that by itself."""
    error = ctx.error
    if error in FATAL_ERRORS:
        raise moderngl.Error(error)


def live_gl_objects() -> int:
    """Buffers, textures, framebuffers, programs and the like that this process holds, whatever other threads do.

    An object refers to its class. A list of all objects would hold tuples that other threads are filling, which CPython
    and OpenCV then cannot enlarge (SystemError).
    """
    gc.collect()
    return sum(isinstance(thing, GL_TYPES) for thing in gc.get_referrers(*GL_TYPES))

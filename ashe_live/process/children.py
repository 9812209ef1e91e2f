"""Child processes: the one place where they are started, so that all of them are started alike.

A child is spawned, never forked: a fork would inherit the window, its GL context and half-held locks. It imports
nothing from the current folder, where a file named like one of Python's modules may lie beside a clip. It ends when its
parent does, whatever ended that. Ctrl-C does not reach it, as the parent decides what comes of it.
"""

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import spawn
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

from ashe_live.process.module_path import safe_module_path

CONTEXT = multiprocessing.get_context("spawn")
# Read by the child's interpreter as it starts, and by its NumPy as it loads: the threads of that would take the cores
# that the viewer's loop needs.
ENVIRONMENT = {"PYTHONSAFEPATH": "1", "OPENBLAS_NUM_THREADS": "1"}
PR_SET_PDEATHSIG = 1  # linux/prctl.h


@dataclass(frozen=True, slots=True)
class Limits:
    """What a child may take, where the system can hold it to that."""

    niceness: int  # added to the parent's
    memory_bytes: int | None = None  # of address space: beyond it the child meets a MemoryError
    processor_s: int | None = None  # beyond it the child is killed
    silent: bool = False  # nothing of what it prints is seen


def started(
    target: Callable[..., None], arguments: tuple[object, ...], name: str, limits: Limits, far_end: Connection
) -> SpawnProcess:
    """A process of that name that calls `target(far_end, *arguments)`; its module must be importable, as in `-m`.

    `far_end` is closed here, so that the pipe ends when the child does.
    """
    # A daemon, so that leaving the interpreter in order ends it as well.
    process = CONTEXT.Process(target=_begin, args=(limits, target, far_end, *arguments), name=name, daemon=True)
    try:
        _launcher.submit(_start, process).result()
    finally:
        far_end.close()
    return process


def _new_launcher() -> ThreadPoolExecutor:
    # Linux tells a child of the end of the thread that started it: this one lives as long as the process.
    return ThreadPoolExecutor(1, "ashe-live launcher")


def _renew_launcher() -> None:
    global _launcher
    _launcher = _new_launcher()


_launcher = _new_launcher()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_launcher)  # a fork has no other thread than the one that forked


def _start(process: SpawnProcess) -> None:
    told = spawn.get_preparation_data

    def told_ours(name: str) -> dict[str, Any]:
        return _preparation(name) if name == process.name else told(name)

    with _environment(), _without_ctrl_c():
        spawn.get_preparation_data = told_ours
        try:
            process.start()
        finally:
            spawn.get_preparation_data = told


def _preparation(name: str) -> dict[str, Any]:
    """What multiprocessing tells a child before anything else; all of it may be left out (`spawn.prepare`).

    Left out are the main script, which would run once more (and start another child, where a program that embeds this
    one does not guard it), and the current folder, which a child has anyway and which may have been deleted.
    """
    return {
        "name": name,
        "authkey": multiprocessing.current_process().authkey,
        "sys_path": safe_module_path(),
        "sys_argv": sys.argv[:1],
        "start_method": "spawn",
    }


@contextmanager
def _environment() -> Iterator[None]:
    """Only while a child is started: what else an embedding program starts is its own affair."""
    before = {name: os.environ.get(name) for name in ENVIRONMENT}
    os.environ.update({name: value for name, value in ENVIRONMENT.items() if not before[name]})
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """A child inherits this until `_begin`, so that none is interrupted in its imports."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # else it is started within, and unblocks what it finds blocked
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(limits: Limits, target: Callable[..., None], far_end: Connection, *arguments: object) -> None:
    """In the child."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    _end_with_parent()
    if hasattr(os, "nice"):
        os.nice(limits.niceness)
    if limits.silent:
        _silence()
    _hold_to(limits)
    target(far_end, *arguments)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, name="ashe-live parent", daemon=True).start()
    if sys.platform == "linux":
        # The thread above waits while C code holds the interpreter's lock; the kernel does not.
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent.pid:  # it ended before
            os._exit(1)


def _silence() -> None:
    """Also what libraries in C print."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for number in (1, 2):
        os.dup2(nowhere, number)
    os.close(nowhere)


def _hold_to(limits: Limits) -> None:
    if sys.platform == "win32":
        return
    import resource

    def hold(kind: int, most: int | None) -> None:
        _, hard = resource.getrlimit(kind)
        if most is not None:
            with suppress(ValueError, OSError):
                resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))

    hold(resource.RLIMIT_CORE, 0)  # a crash leaves no file of all its memory behind
    hold(resource.RLIMIT_AS, limits.memory_bytes)
    hold(resource.RLIMIT_CPU, limits.processor_s)

"""Child processes: they are started here only, so that all of them are started alike.

A child is spawned, never forked: a fork would inherit the window, its GL context and half-held locks. It imports
nothing from the current folder, where a file named like one of Python's modules may lie beside a clip. It ends when its
parent does, for whatever reason. Ctrl-C does not reach it, as the parent decides what follows from that.
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

from ashe_live.process.module_path import safe_module_path, safe_search_paths
from ashe_live.process.signals import ctrl_c_blocked

CONTEXT = multiprocessing.get_context("spawn")
# Read by the child's interpreter as it starts, and by its NumPy as it loads, whose threads would otherwise take the
# cores that the viewer's loop needs.
ENVIRONMENT = {"PYTHONSAFEPATH": "1", "OPENBLAS_NUM_THREADS": "1"}
PR_SET_PDEATHSIG = 1  # linux/prctl.h


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a child process, as far as the system can enforce them."""

    niceness: int  # added to the parent's
    memory_bytes: int | None = None  # of address space: beyond that the child gets a MemoryError
    processor_s: int | None = None  # of processor time: beyond that the child is killed
    silent: bool = False  # whether what it prints is discarded


def started(
    target: Callable[..., None], arguments: tuple[object, ...], name: str, limits: Limits, far_end: Connection
) -> SpawnProcess:
    """Starts a process that calls `target(far_end, *arguments)`; the module of `target` must be importable, as in `-m`.

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
    # Linux ends a child with the thread that started it, so that thread must live as long as the process.
    return ThreadPoolExecutor(1, "ashe-live launcher")


def _renew_launcher() -> None:
    global _launcher
    _launcher = _new_launcher()


_launcher = _new_launcher()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_launcher)  # a fork only has the thread that forked


def _start(process: SpawnProcess) -> None:
    prepare = spawn.get_preparation_data

    def prepare_ours(name: str) -> dict[str, Any]:
        return _preparation(name) if name == process.name else prepare(name)

    with _environment(), _without_ctrl_c(), _as_no_daemon():
        spawn.get_preparation_data = prepare_ours
        try:
            process.start()
        finally:
            spawn.get_preparation_data = prepare


def _preparation(name: str) -> dict[str, Any]:
    """What multiprocessing sends a child before anything else, all of which is optional (`spawn.prepare`).

    Left out are the main script, which would run once more (and start another child, if a program that embeds this one
    does not guard it), and the current folder, which a child inherits anyway and which may have been deleted.
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
    """Sets ENVIRONMENT while a child is started only: other processes of an embedding program are its own affair."""
    searched = safe_search_paths()
    before = {name: os.environ.get(name) for name in (*ENVIRONMENT, *searched)}
    os.environ.update({name: value for name, value in ENVIRONMENT.items() if not before[name]} | searched)
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
    """Blocks Ctrl-C, which a child inherits until `_begin`, so that none is interrupted in its imports."""
    if hasattr(signal, "pthread_sigmask"):
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # started later, it would unblock the signal
    with ctrl_c_blocked():
        yield


@contextmanager
def _as_no_daemon() -> Iterator[None]:
    """Lets a worker of a pool of processes (`Pool` of multiprocessing), which is a daemon, have children.

    Those of daemons are refused as they might outlive them, which ours do not.
    """
    this = multiprocessing.current_process()
    was_daemon = this.daemon
    if was_daemon:
        this.daemon = False
    try:
        yield
    finally:
        if was_daemon:
            this.daemon = True


def _begin(limits: Limits, target: Callable[..., None], far_end: Connection, *arguments: object) -> None:
    """Runs in the child: applies the limits, then calls `target`."""
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
        # While C code holds the interpreter's lock the thread above cannot run, but the kernel can still end the child.
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent.pid:  # the parent ended before that
            os._exit(1)


def _silence() -> None:
    """Discards what this process prints, also from libraries in C."""
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

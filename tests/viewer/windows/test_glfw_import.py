"""GLFW is loaded by a package that has a library for each kind of display, and starts a process to look for it."""

import importlib
import signal
import sys
from importlib.machinery import ModuleSpec

import pytest

from ashe_live.viewer.windows.glfw_library import variant


class Looked:
    """An import hook that finds nothing, and notes which signals were blocked as a module was looked for."""

    def __init__(self) -> None:
        self.blocked: dict[str, set[signal.Signals]] = {}

    def find_spec(self, name: str, *_: object) -> ModuleSpec | None:
        self.blocked[name] = set(signal.pthread_sigmask(signal.SIG_BLOCK, ()))
        if name == "glfw":
            raise ImportError("not here")
        return None


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="the system blocks no signals")
def test_ctrl_c_does_not_reach_the_process_that_its_package_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """That would answer with a traceback."""
    looked, module = Looked(), "ashe_live.viewer.windows.glfw_library"
    for name in ("glfw", module):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "meta_path", [looked, *sys.meta_path])
    with pytest.raises(ImportError, match="not here"):
        importlib.import_module(module)
    assert signal.SIGINT not in looked.blocked[module]
    assert signal.SIGINT in looked.blocked["glfw"]
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


@pytest.mark.parametrize(
    ("displays", "library"),
    [
        ({"DISPLAY": ":1"}, "x11"),
        ({"WAYLAND_DISPLAY": "wayland-0"}, "wayland"),
        ({"DISPLAY": ":1", "WAYLAND_DISPLAY": ""}, "x11"),
        ({"DISPLAY": ":1", "WAYLAND_DISPLAY": "wayland-0"}, None),
        ({}, None),
    ],
)
def test_its_library_is_that_of_the_only_display(displays: dict[str, str], library: str | None) -> None:
    assert variant({"XDG_SESSION_TYPE": "tty", **displays}) == library

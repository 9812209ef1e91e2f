"""The header of every record: date, machine and versions, without which figures cannot be compared."""

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from ashe_live.core.contract import Json

LIBRARIES = {"opencv": "opencv-contrib-python-headless", "numpy": "numpy", "moderngl": "moderngl", "pyav": "av"}


def header_json(schema: int, with_opengl: bool) -> Json:
    """The header of a record. Raises UserError if `with_opengl` is set and there is no OpenGL."""
    return {
        "schema": schema,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": _machine_json() | (_opengl_json() if with_opengl else {}),
        "versions": _versions_json(),
    }


def _machine_json() -> Json:
    """The cores that this process may use, the system, the processor, and the load average (None: not available)."""
    affinity = getattr(os, "sched_getaffinity", None)
    return {
        "cpus": len(affinity(0)) if affinity is not None else os.cpu_count(),
        "system": platform.system(),
        "processor": platform.machine(),
        "load_average_1min": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def _opengl_json() -> Json:
    from ashe_live.render.gl.offscreen import offscreen_context

    ctx = offscreen_context()
    try:
        return {"gl_renderer": ctx.info["GL_RENDERER"], "gl_version": ctx.info["GL_VERSION"]}
    finally:
        ctx.release()


def _versions_json() -> Json:
    return {"python": platform.python_version(), **{name: _version(library) for name, library in LIBRARIES.items()}}


def measured_with(record: Json) -> str:
    """Date, machine and versions of a bench's record, in one line."""
    machine, versions = record["machine"], record["versions"]
    libraries = ", ".join(f"{name} {versions[name]}" for name in ("python", "opencv", "numpy"))
    load, graphics = machine["load_average_1min"], machine.get("gl_renderer")
    hardware = [f"{machine['cpus']} cores", machine["processor"]]
    hardware += [f"load {load:.1f}"] * (load is not None) + [graphics] * (graphics is not None)
    return f"{record['date'][:10]}; {', '.join(hardware)}; {libraries}"


def _version(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None

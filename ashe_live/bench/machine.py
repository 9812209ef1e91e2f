"""What a figure was measured with, so that it can be compared with another."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version

from ashe_live.core.contract import Json

LIBRARIES = {"opencv": "opencv-contrib-python-headless", "numpy": "numpy", "moderngl": "moderngl", "pyav": "av"}


def machine_json() -> Json:
    """Cores that this process may use, system, kind of processor, and how busy the machine is (None: not told)."""
    affinity = getattr(os, "sched_getaffinity", None)
    return {
        "cpus": len(affinity(0)) if affinity is not None else os.cpu_count(),
        "system": platform.system(),
        "processor": platform.machine(),
        "load_average_1min": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def versions_json() -> Json:
    return {"python": platform.python_version(), **{name: _version(library) for name, library in LIBRARIES.items()}}


def measured_with(record: Json) -> str:
    """Date, machine and versions of a bench's record, in one line."""
    machine, versions = record["machine"], record["versions"]
    libraries = ", ".join(f"{name} {versions[name]}" for name in ("python", "opencv", "numpy"))
    return f"{record['date'][:10]}; {machine['cpus']} cores, {machine['processor']}; {libraries}"


def _version(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None

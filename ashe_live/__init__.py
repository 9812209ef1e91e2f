"""Live desktop AR whose virtual objects are lit, and cast their shadows, as the real ones do.

The names in `__all__` are the programming interface (docs/api.md). Each is loaded when it is first asked for: importing
the package, which every start of the command line does, loads neither OpenCV nor OpenGL.
"""

TYPE_CHECKING = False  # as `typing` has it, which would be loaded at every start
if TYPE_CHECKING:
    from ashe_live.api import (
        LightEstimator,
        Tracker,
        camera_of_photo,
        estimate_light,
        make_estimator,
        markers_in_view,
        read_photo,
    )
    from ashe_live.capture.opening import open_source
    from ashe_live.capture.snapshot import write_png
    from ashe_live.core.camera import Camera, read_camera_file
    from ashe_live.core.light import Illumination, Light, LightEstimate
    from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
    from ashe_live.errors import ModelWarning, UserError
    from ashe_live.models.catalogue import model_names
    from ashe_live.models.placement import Placement
    from ashe_live.render.lights.light_map import write_light_map
    from ashe_live.renderer import Renderer

__version__ = "0.1.0"

__all__ = [
    "Camera",
    "Frame",
    "Illumination",
    "Light",
    "LightEstimate",
    "LightEstimator",
    "MarkerPose",
    "ModelWarning",
    "Placement",
    "Renderer",
    "TrackedFrame",
    "Tracker",
    "UserError",
    "camera_of_photo",
    "estimate_light",
    "make_estimator",
    "markers_in_view",
    "model_names",
    "open_source",
    "read_camera_file",
    "read_photo",
    "write_light_map",
    "write_png",
]

_HOMES = {
    "Camera": "core.camera",
    "Frame": "core.types",
    "Illumination": "core.light",
    "Light": "core.light",
    "LightEstimate": "core.light",
    "LightEstimator": "api",
    "MarkerPose": "core.types",
    "ModelWarning": "errors",
    "Placement": "models.placement",
    "Renderer": "renderer",
    "TrackedFrame": "core.types",
    "Tracker": "api",
    "UserError": "errors",
    "camera_of_photo": "api",
    "estimate_light": "api",
    "make_estimator": "api",
    "markers_in_view": "api",
    "model_names": "models.catalogue",
    "open_source": "capture.opening",
    "read_camera_file": "core.camera",
    "read_photo": "api",
    "write_light_map": "render.lights.light_map",
    "write_png": "capture.snapshot",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value: object = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value  # from now on found without coming here
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, "__version__"})

"""The interface of light estimators, and the names by which one is chosen."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.errors import UserError

if TYPE_CHECKING:
    from ashe_live.light.estimators.trace import Trace


class Estimator(Protocol):
    """Estimates the light from one frozen frame; deterministic to the bit."""

    @property
    def name(self) -> str: ...

    def estimate(self, tracked: TrackedFrame) -> LightEstimate:
        """The light in the marker frame; if none can be found, an estimate with no lights and a reason.

        Raises ValueError when the frame has no marker, as directions are given in the marker frame.
        """
        ...


@runtime_checkable
class TracingEstimator(Estimator, Protocol):
    """An estimator that can also return the intermediate results of an estimate."""

    def traced(self, tracked: TrackedFrame) -> "tuple[LightEstimate, Trace]":
        """As `estimate`, with the trace of intermediate results."""
        ...


def _proxy(preset: str) -> Estimator:
    from ashe_live.light.estimators.proxy import ProxyEstimator
    from ashe_live.light.estimators.steps import PRESETS

    return ProxyEstimator(PRESETS[preset])


def _paper(preset: str) -> Estimator:  # noqa: ARG001 - as published, it has no presets
    from ashe_live.light.paper.estimator import PaperEstimator

    return PaperEstimator()


# Factories that take a preset's name; modules are imported on use, as listing the names in --help must not load OpenCV.
ESTIMATORS: Mapping[str, Callable[[str], Estimator]] = {"proxy": _proxy, "paper": _paper}


def make_estimator(name: str, preset: str = "balanced") -> Estimator:
    """A new estimator of that name in ESTIMATORS, with the preset of that name (one of the qualities).

    Raises UserError for an unknown estimator.
    """
    if name not in ESTIMATORS:
        raise UserError(f"there is no light estimator {name!r}", f"choose one of {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name](preset)

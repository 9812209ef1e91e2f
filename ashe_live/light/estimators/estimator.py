"""What an estimator of the light is, and the names by which one is chosen."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.errors import UserError

if TYPE_CHECKING:
    from ashe_live.light.estimators.trace import Trace


class Estimator(Protocol):
    """Tells from one frozen frame where the light is; the same frame always gives the same bits."""

    @property
    def name(self) -> str: ...

    def estimate(self, tracked: TrackedFrame) -> LightEstimate:
        """The light in the marker frame; without an answer, an estimate with no lights and a reason.

        Raises ValueError when the frame has no marker: without one there is no frame to answer in.
        """
        ...


@runtime_checkable
class TracingEstimator(Estimator, Protocol):
    """One that can also tell what led to its answer."""

    def traced(self, tracked: TrackedFrame) -> "tuple[LightEstimate, Trace]":
        """As `estimate`, and the trace of it."""
        ...


def _proxy(preset: str) -> Estimator:
    from ashe_live.light.estimators.proxy import ProxyEstimator
    from ashe_live.light.estimators.steps import PRESETS

    return ProxyEstimator(PRESETS[preset])


def _paper(preset: str) -> Estimator:  # noqa: ARG001 - as published, it has one notch
    from ashe_live.light.paper.estimator import PaperEstimator

    return PaperEstimator()


# Factories by name, of a preset's name, as naming the estimators (in --help) must not load OpenCV.
ESTIMATORS: Mapping[str, Callable[[str], Estimator]] = {"proxy": _proxy, "paper": _paper}


def make_estimator(name: str, preset: str = "balanced") -> Estimator:
    """A new estimator by its name in ESTIMATORS and by the name of a quality.

    Raises UserError for an estimator that is not there.
    """
    if name not in ESTIMATORS:
        raise UserError(f"there is no light estimator {name!r}", f"choose one of {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name](preset)

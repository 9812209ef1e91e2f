"""The interface of light estimators, and the names by which one is chosen."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.estimators.preset import BALANCED, ProxyPreset

if TYPE_CHECKING:
    from ashe_live.light.estimators.view_search import Trace


class Estimator(Protocol):
    """Estimates the light from one frozen frame, or from several of an unmoved scene; deterministic to the bit."""

    @property
    def name(self) -> str: ...

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        """The light in the marker frame; if none can be found, an estimate with no lights and a reason.

        others: further views of the same unmoved scene; those without a marker are left out. Masks and body are those
        of `tracked`; `LightEstimate.views` says which views the answer rests on. Raises ValueError when `tracked` has
        no marker, as directions are given in the marker frame.
        """
        ...


@runtime_checkable
class TracingEstimator(Estimator, Protocol):
    """An estimator that can also return the intermediate results of an estimate."""

    def traced(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> "tuple[LightEstimate, Trace]":
        """As `estimate`, with the trace of intermediate results."""
        ...


def _proxy(preset: ProxyPreset) -> Estimator:
    from ashe_live.light.estimators.proxy import ProxyEstimator

    return ProxyEstimator(preset)


def _paper(preset: ProxyPreset) -> Estimator:  # as published, it has no presets
    from ashe_live.light.paper.estimator import PaperEstimator

    if preset.caster is not None:
        raise UserError("the estimator paper makes no use of a known caster", "choose proxy, or give no caster")
    return PaperEstimator()


# Factories that take a preset; modules are imported on use, as whoever only names an estimator need not load OpenCV.
ESTIMATORS: Mapping[str, Callable[[ProxyPreset], Estimator]] = {"proxy": _proxy, "paper": _paper}

OF_ONE_FRAME = frozenset({"paper"})  # those that ignore other views and clean plates
WITHOUT_TRACE = frozenset({"paper"})  # those that are no TracingEstimator


def shows_nothing(estimate: LightEstimate) -> bool:
    """Whether the estimate's frame shows an empty table, as far as can be seen: nothing stands on the ground."""
    from ashe_live.light.explanation.no_answer import NOTHING_THERE

    return estimate.reason == NOTHING_THERE


def make_estimator(name: str, preset: ProxyPreset = BALANCED) -> Estimator:
    """A new estimator of that name in ESTIMATORS; the estimator `paper`, as published, has no presets.

    Raises UserError for an unknown estimator, and for one that makes no use of the preset's caster.
    """
    if name not in ESTIMATORS:
        raise UserError(f"there is no light estimator {name!r}", f"choose one of {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name](preset)

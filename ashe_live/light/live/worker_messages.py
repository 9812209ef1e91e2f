"""What the viewer asks of the light worker's process, and what that answers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ashe_live.core.arrays import Image
    from ashe_live.core.light import LightEstimate
    from ashe_live.core.types import TrackedFrame
    from ashe_live.light.estimators.preset import ProxyPreset
    from ashe_live.light.estimators.view_search import Trace

Draw = Callable[["TrackedFrame", "LightEstimate", "Trace"], "Image"]  # a picture (h, w, 3), BGR, of an estimate's trace


@dataclass(frozen=True, slots=True)
class EstimateTask:
    """What is to be found out about the frames of a request, and how."""

    preset: "ProxyPreset"
    draw: Draw | None = None  # a function of a module that draws the trace, where the estimator keeps one
    is_awaited: bool = False  # by a person: made at normal priority, and in any case
    held: "LightEstimate | None" = None  # the answer that is shown
    # Whether nothing is to be estimated if the frame shows the other views' scene in the light of that answer.
    follows: bool = False


@dataclass(frozen=True, slots=True)
class EstimateRequest:
    """What is sent to the process, with the frames that it has not been sent before."""

    numbers: tuple[int, ...]  # of the frozen frame, then of the other views, which are kept for the next request
    doubted: int | None  # of a frame that showed a scene which none of the other views shows
    empty: int | None  # of a frame that shows the empty table
    new: "Mapping[int, TrackedFrame]"
    task: EstimateTask


@dataclass(frozen=True, slots=True, kw_only=True)
class Answered:
    """What all answers to a request say."""

    outdated: tuple[int, ...] = ()  # indices of the other views that show another scene, and were left out


class Unchanged(Answered):
    """The frame shows the scene of the others, in a light that cannot be followed and need not be estimated."""


class OtherScene(Answered):
    """The frame shows another scene than all others, and nothing was estimated: it may be a hand that passes."""


@dataclass(frozen=True, slots=True, eq=False)
class Followed(Answered):
    """The frame shows the scene of the others in the held light."""

    estimate: "LightEstimate"  # the held one, with its lights moved to what the frame shows


@dataclass(frozen=True, slots=True, eq=False)
class Estimated(Answered):
    """An estimate was made."""

    estimate: "LightEstimate"
    picture_bgr: "Image | None" = None  # of the trace; None where none was asked for, or the estimator keeps no trace
    is_of_changed_scene: bool = False  # all others show another one
    # Whether there is no light in a changed scene, and the shadows of the held answer's lights are gone from it.
    has_lost_shadows: bool = False
    shows_empty_table: bool = False  # nothing stands there
    is_over_empty_table: bool = False  # by the picture of that, as the frame's clean plate


Answer = Unchanged | OtherScene | Followed | Estimated


@dataclass(frozen=True, slots=True)
class WorkerFailure:
    """Why a request got no estimate."""

    frame_index: int
    message: str  # one line, for the user

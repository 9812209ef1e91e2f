"""Prepares a model for drawing: uploads it, computes its ambient occlusion, and compiles its shaders.

This takes longer than one picture, so it is done in small steps while the former model is still shown.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence

import moderngl

from ashe_live.core.arrays import same_objects
from ashe_live.models.placement import PlacedModel, Placement
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.programs import Programs
from ashe_live.render.occlusion.contact import ContactPatch
from ashe_live.render.occlusion.occlusion import Known, occlusion_steps
from ashe_live.render.passes.standing import StandingGroup, StandingModel

# Share of the time from one picture to the next that is spent on this. That time includes the work itself, so that a
# slow machine makes progress too.
SHARE = 1 / 3
# Limits of the time spent for one picture. A step that has begun is finished, for a few milliseconds more. The upper
# one is for the first picture after a long rest; it leaves two pictures a second, as of a phone's photo on a busy
# machine without a GPU, their whole share: with 0.05 s a goblet took 24 such pictures, with 0.2 s it takes 6.
LEAST_S, MOST_S = 0.003, 0.2


LastSteps = Callable[[GpuModel], Iterator[None]]


class PreparedModel:
    """Can be drawn once `advance` has returned True, or after `finish`."""

    def __init__(
        self, ctx: moderngl.Context, programs: Programs, placed: PlacedModel, last_steps: LastSteps, known: Known
    ) -> None:
        """`known`: what models hide, by other switches as well; this one's is added."""
        self.placed = placed
        self.model = GpuModel(ctx, placed, programs)
        self.contact = ContactPatch(ctx, programs, self.model)
        self._standing: StandingModel | None = None
        self._ctx = ctx
        self._occlusion = occlusion_steps(ctx, programs, self.model, self.contact, known)
        self._steps = itertools.chain(self.model.upload(), self._occlusion, last_steps(self.model))

    def advance(self, budget_s: float) -> bool:
        """Continues for about so long; returns whether the model can be drawn."""
        begun_s = time.perf_counter()
        for _ in self._steps:
            # Queued commands would otherwise all be executed during one picture.
            self._ctx.finish()
            if time.perf_counter() - begun_s > budget_s:
                return False
        return True

    def finish(self) -> None:
        """Takes all remaining steps."""
        for _ in self._steps:
            pass

    def standing(self, placement: Placement, time_s: float) -> StandingModel:
        """The same object for the same placement and moment, so that what depends on it is not drawn again."""
        pose_s = time_s if self.placed.model.duration_s else 0.0
        standing = self._standing
        if standing is None or (standing.placement, standing.pose_s) != (placement, pose_s):
            self._standing = standing = StandingModel(self.model, self.contact, placement, pose_s)
        return standing

    def release(self) -> None:
        # Which has textures of its own while it is at work.
        self._occlusion.close()
        self.contact.release()
        self.model.release()


class ModelSwitch:
    """The model that is shown, and the one being prepared to replace it."""

    def __init__(self, make: Callable[[PlacedModel], PreparedModel]) -> None:
        self.shown: PreparedModel | None = None
        self._coming: PreparedModel | None = None
        self._make = make
        self._followed_s = -math.inf
        self._placement: Placement | None = None  # of the one that is shown

    @property
    def is_settled(self) -> bool:
        """Whether no model is being prepared."""
        return self._coming is None

    def standing(self, placement: Placement | None, time_s: float) -> StandingModel | None:
        """The model that is shown, at the place of the wanted one; at its own last place while that is not ready."""
        if self.shown is None or placement is None:
            return None
        if self._coming is None or self._placement is None:
            self._placement = placement
        return self.shown.standing(self._placement, time_s)

    def is_among(self, wanted: Sequence[PlacedModel]) -> bool:
        """Whether the model that it shows is one of these."""
        return self.shown is not None and any(self.shown.placed is each for each in wanted)

    def follow(self, placed: PlacedModel | None, waits: bool) -> bool:
        """Shows `placed` once it is ready; `waits` for that, as it does where there is nothing to show until then.

        True when another model, or none, is shown than before.
        """
        now_s = time.perf_counter()
        budget_s, self._followed_s = min(MOST_S, max(LEAST_S, SHARE * (now_s - self._followed_s))), now_s
        if self._coming is not None and self._coming.placed is not placed:
            self._coming.release()
            self._coming = None
        if placed is None:
            return self._show(None)
        if self.shown is not None and self.shown.placed is placed:
            return False
        if self._coming is None:
            self._coming = self._make(placed)
        if waits or self.shown is None:
            self._coming.finish()
        elif not self._coming.advance(budget_s):
            return False
        self._coming, ready = None, self._coming
        return self._show(ready)

    def _show(self, ready: PreparedModel | None) -> bool:
        former, self.shown = self.shown, ready
        if former is not None:
            former.release()
        return former is not ready


class ModelSwitches:
    """The models that stand side by side: a switch for each place in the scene's order."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, last_steps: LastSteps, known: Known) -> None:
        self._make = lambda placed: PreparedModel(ctx, programs, placed, last_steps, known)
        self._switches: list[ModelSwitch] = []
        self._group: StandingGroup | None = None

    @property
    def is_settled(self) -> bool:
        """Whether no model is being prepared."""
        return all(switch.is_settled for switch in self._switches)

    @property
    def shown(self) -> tuple[PlacedModel, ...]:
        """The models that can be drawn, place by place."""
        return tuple(switch.shown.placed for switch in self._switches if switch.shown is not None)

    def follow(self, wanted: Sequence[PlacedModel], waits: bool) -> bool:
        """As ModelSwitch.follow for each place; one that is gone takes its place along. True when any changed."""
        changed = False
        while len(self._switches) > len(wanted):
            switch = next((each for each in self._switches if not each.is_among(wanted)), self._switches[-1])
            self._switches.remove(switch)
            changed |= switch.follow(None, waits)
        while len(self._switches) < len(wanted):
            self._switches.append(ModelSwitch(self._make))
        for switch, placed in zip(self._switches, wanted, strict=True):
            changed |= switch.follow(placed, waits)
        if changed:
            self._group = None
        return changed

    def standing(self, placements: Sequence[Placement | None], time_s: float) -> StandingGroup | None:
        """The models that can be drawn and have a placement, or None; the same object while they are the same."""
        pairs = zip(self._switches, placements, strict=True)
        standing = (switch.standing(placement, time_s) for switch, placement in pairs)
        members = tuple(each for each in standing if each is not None)
        if self._group is None or not same_objects(self._group.members, members):
            self._group = StandingGroup(members) if members else None
        return self._group

"""Prepares a model for drawing: uploads it, draws its contact shadow and compiles its shaders.

That takes longer than one picture, so it is done in small steps while the former model is still shown.
"""

import itertools
import time
from collections.abc import Callable, Iterator

import moderngl

from ashe_live.models.placement import PlacedModel, Placement
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.programs import Programs
from ashe_live.render.passes.contact import ContactPatch
from ashe_live.render.passes.standing import StandingModel

# Of each picture's time; a step that has begun is finished, which may take a few milliseconds more.
BUDGET_S = 0.003


LastSteps = Callable[[GpuModel], Iterator[None]]


class PreparedModel:
    """Can be drawn once `advance` has returned True, or after `finish`."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, placed: PlacedModel, last_steps: LastSteps) -> None:
        self.placed = placed
        self.model = GpuModel(ctx, placed, programs)
        self.contact = ContactPatch(ctx, programs, self.model)
        self._standing: StandingModel | None = None
        self._ctx = ctx
        self._steps = itertools.chain(self.model.upload(), self.contact.draw(), last_steps(self.model))

    def advance(self) -> bool:
        """Continues for about BUDGET_S; returns whether the model can be drawn."""
        begun_s = time.perf_counter()
        for _ in self._steps:
            # Queued commands would otherwise all be executed during one picture.
            self._ctx.finish()
            if time.perf_counter() - begun_s > BUDGET_S:
                return False
        return True

    def finish(self) -> None:
        """Takes all remaining steps."""
        for _ in self._steps:
            pass

    def standing(self, placement: Placement, time_s: float = 0.0) -> StandingModel:
        """The same object for the same placement and moment, so that what depends on it is not drawn again."""
        pose_s = time_s if self.placed.model.duration_s else 0.0
        standing = self._standing
        if standing is None or (standing.placement, standing.pose_s) != (placement, pose_s):
            self._standing = standing = StandingModel(self.model, self.contact, placement, pose_s)
        return standing

    def release(self) -> None:
        self.contact.release()
        self.model.release()


class ModelSwitch:
    """The model that is shown, and the one being prepared to replace it."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, last_steps: LastSteps, at_once: bool) -> None:
        self.shown: PreparedModel | None = None
        self._coming: PreparedModel | None = None
        self._ctx = ctx
        self._programs = programs
        self._last_steps = last_steps
        self.at_once = at_once

    @property
    def is_settled(self) -> bool:
        """Whether no model is being prepared."""
        return self._coming is None

    def follow(self, placed: PlacedModel | None) -> bool:
        """Shows `placed` as soon as it is ready, which is at once when there is nothing to show until then.

        True when another model, or none, is shown than before.
        """
        if self._coming is not None and self._coming.placed is not placed:
            self._coming.release()
            self._coming = None
        if placed is None:
            return self._show(None)
        if self.shown is not None and self.shown.placed is placed:
            return False
        if self._coming is None:
            self._coming = PreparedModel(self._ctx, self._programs, placed, self._last_steps)
        if self.at_once or self.shown is None:
            self._coming.finish()
        elif not self._coming.advance():
            return False
        self._coming, ready = None, self._coming
        return self._show(ready)

    def _show(self, ready: PreparedModel | None) -> bool:
        former, self.shown = self.shown, ready
        if former is not None:
            former.release()
        return former is not ready

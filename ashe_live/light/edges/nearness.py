"""The nearness of a light as a further parameter of an alignment with steps of light."""

from dataclasses import dataclass

from ashe_live.core.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class NearnessBySteps:
    """What steps of light tell of the first light as a lamp, whatever the shape, in the body frame."""

    offset: Float  # (3,) of displacement and nearness from those aligned with, that the steps ask for
    information: Float  # (3, 3) on it

    def over(self, count: float) -> "NearnessBySteps":
        """The same, of which so many tell as much as one."""
        return NearnessBySteps(self.offset, self.information / count)

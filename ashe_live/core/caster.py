"""A real object whose shape and size are given: only its place on the table is unknown."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.ranges import CASTER_SIZE
from ashe_live.errors import UserError

Spheroid = tuple[float, float, float, float, float]  # centre x, y, z, horizontal radius, half height
SIZES = {"box": 3, "cylinder": 2, "sphere": 1}  # the number of sizes that each kind has
FORMS = "box:WxDxH, cylinder:RxH or sphere:R"
# x and y of the corners of a box's foot, as multiples of half its sides, counter-clockwise.
CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


@dataclass(frozen=True, slots=True)
class Caster:
    """A body that stands upright on the plane, somewhere and turned somehow: the convex hull of upright spheroids.

    It can be compared, hashed, and sent to another process. Raises UserError where its breadth or its height is not
    within CASTER_SIZE.
    """

    kind: str  # box, cylinder, sphere or hull
    spheroids: tuple[Spheroid, ...]  # metres; the lowest point on z = 0, x and y about the middle of their extent
    period_rad: float  # a turn about the vertical that maps the body onto itself; 0: any turn does

    def __post_init__(self) -> None:
        if not (2 * self.radius_m in CASTER_SIZE and self.height_m in CASTER_SIZE):
            size = f"{2 * self.radius_m:.3g} m broad and {self.height_m:.3g} m high"
            raise UserError(
                f"a {self.kind} that is {size} casts no shadow that can be measured",
                f"sizes are metres, {CASTER_SIZE}",
            )

    @staticmethod
    def box(width_m: float, depth_m: float, height_m: float) -> "Caster":
        """A box that stands on the side `width_m` x `depth_m`."""
        x, y = width_m / 2, depth_m / 2
        corners = tuple((i * x, j * y, z, 0.0, 0.0) for z in (0.0, height_m) for i, j in CORNERS)
        return Caster("box", corners, math.pi / 2 if width_m == depth_m else math.pi)

    @staticmethod
    def cylinder(radius_m: float, height_m: float) -> "Caster":
        """An upright cylinder."""
        return Caster("cylinder", ((0.0, 0.0, 0.0, radius_m, 0.0), (0.0, 0.0, height_m, radius_m, 0.0)), 0.0)

    @staticmethod
    def sphere(radius_m: float) -> "Caster":
        return Caster("sphere", ((0.0, 0.0, radius_m, radius_m, radius_m),), 0.0)

    @staticmethod
    def hull(points_m: Float) -> "Caster":
        """The convex hull of points (n, 3), z up, which stands on the lowest of them."""
        lower, upper = points_m.min(axis=0), points_m.max(axis=0)
        standing = points_m - (*(lower[:2] + upper[:2]) / 2, lower[2])
        return Caster("hull", tuple((x, y, z, 0.0, 0.0) for x, y, z in standing.tolist()), 2 * math.pi)

    @property
    def radius_m(self) -> float:
        """Half of its breadth, averaged over the directions that it may be seen from."""
        x, y, _, radius, _ = np.array(self.spheroids).T
        angles = np.arange(16) * (math.pi / 8)
        return float((np.outer(np.cos(angles), x) + np.outer(np.sin(angles), y) + radius).max(axis=1).mean())

    @property
    def height_m(self) -> float:
        return max(z + half for _, _, z, _, half in self.spheroids)


def parsed_caster(spec: str) -> Caster:
    """The body that `spec` describes by its kind and sizes in metres, as in FORMS.

    Raises UserError when it names another kind, another number of sizes, or sizes that are not within CASTER_SIZE.
    """
    kind, _, sizes = spec.partition(":")
    if kind not in SIZES:
        raise UserError(f"there is no caster {spec!r}", f"give {FORMS}, in metres, or the file of a model")
    try:
        values = [float(size) for size in sizes.lower().split("x")]
    except ValueError:
        values = []
    if len(values) != SIZES[kind] or not all(value in CASTER_SIZE for value in values):
        form = next(form for form in FORMS.replace(" or", ",").split(", ") if form.startswith(kind))
        raise UserError(f"{spec!r} is no {kind}", f"write {form}, with sizes in metres, {CASTER_SIZE}")
    if kind == "box":
        return Caster.box(*values)
    return Caster.cylinder(*values) if kind == "cylinder" else Caster.sphere(*values)

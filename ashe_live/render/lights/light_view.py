"""How a light sees what casts its shadows: a projective frame in which its rays are parallel, for suns and lamps alike.

Rotated so that z points towards the lamp, points are divided by w = 1 - k (z - z_c), their distance from it along z
over that of the casters' middle; for a sun k is 0. There a plane is a plane, and the light's disc, seen from a
receiver, covers a disc whose radius is the distance along z from the receiver times one constant. So whatever holds
for the shadows of a sun holds for those of a lamp.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import light_view, normalised
from ashe_live.render.lights.lighting import ShadingLight, lighting_of

# Limit of a lamp's view: a wider cone does not fit into one projection, and the lamp is inside the casters or near
# them.
WIDEST_HALF_ANGLE_COSINE = 0.17
# The same of several bodies together. Far from a view's axis a lamp is seen aslant, which a view's disc is not, so that
# penumbrae away from the axis are too narrow: by this factor at most.
TOGETHER_COSINE = 0.6
NEAREST_RATIO = 1e-3  # of the nearest of the casters over the farthest: a depth map has 24 bits
# Depth maps of all lights and casters together that a shader looks up: of the 256 vectors that OpenGL 3.3 has for its
# uniforms, each takes 18.
MOST_MAPS = 12
CONE_STEPS = 24
LEAST_NEARER = 0.4  # of the light's elevation above its own radius; lower lights' penumbrae are cut off
LEVEL: Float = np.array([0.0, 0.0, 1.0, 0.0])  # the plane z = 0, homogeneous


@dataclass(frozen=True, slots=True, eq=False)
class LightView:
    """Coordinates in metres: across the light, where the casters' middle is, and towards it."""

    from_marker: Float  # (4, 4) projective, z towards the light
    tan_half_size: float  # the light's radius over its distance from the casters

    def seen(self, points: Float) -> Float:
        """(n, 3) points (n, 3) of the marker frame, in front of the light, in these coordinates."""
        homogeneous = points @ self.from_marker[:, :3].T + self.from_marker[:, 3]
        return np.asarray(homogeneous[:, :3] / homogeneous[:, 3:])

    def penumbra_m(self, points: Float) -> float:
        """Width, across the light, of the outer half of the widest penumbra on the ground of points (n, 3) above it."""
        # Planes are carried over by the inverse transpose.
        along_x, along_y, along_z, offset = np.linalg.solve(self.from_marker.T, LEVEL)
        seen = self.seen(points)
        ground = -(seen[:, :2] @ (along_x, along_y) + offset) / along_z
        below = seen[:, 2] - np.maximum(ground, self._farthest)
        # Outwards it falls on ground that is farther away; without end if the light's disc reaches down to the horizon.
        nearer = 1 - self.tan_half_size * np.hypot(along_x, along_y) / along_z
        return float(self.tan_half_size * max(below.max(), 0.0) / max(nearer, LEAST_NEARER))

    @property
    def _farthest(self) -> float:
        """The coordinate towards the light of what is infinitely far away from it."""
        along, divisor = self.from_marker[2:, :3]
        return float(along @ divisor / (divisor @ divisor)) if divisor.any() else -np.inf


def view_of(light: ShadingLight, points: Float) -> LightView | None:
    """How `light` sees a body whose hull is that of points (n, 3), marker frame; None from inside or too near it."""
    axis = light.to_light
    if light.inverse_distance > 0:
        away, cosine = _cone(light, points)
        if cosine < WIDEST_HALF_ANGLE_COSINE:
            return None
        axis = -away
    view = light_view(axis)
    x, y, z = view[:3, :3] @ light.to_light
    depths = points @ view[2, :3]
    middle = float(depths.min() + depths.max()) / 2
    # Of the lamp from there along z, over its distance from the marker's centre.
    distance = z - light.inverse_distance * middle
    shear_x, shear_y, k = np.array((x, y, light.inverse_distance)) / distance
    if light.inverse_distance == 0:
        shear_x = shear_y = 0.0
    # A point that is d above the plane z = middle is sheared along the lamp's slope by d, and divided by 1 - k d.
    projection = np.eye(4)
    projection[:, 2] = -shear_x, -shear_y, 1 - middle * k, -k
    projection[:, 3] = shear_x * middle, shear_y * middle, middle * middle * k, 1 + middle * k
    return LightView(projection @ view, light.tan_half_size / distance)


def sees(light: Light, points: Float) -> bool:
    """Whether the shadow of a body whose hull is that of points (n, 3), marker frame, can be drawn."""
    if light.to_light_marker[2] <= 0:
        return False
    centre = points.mean(axis=0)
    away = np.linalg.norm(light.to_light_marker - light.inverse_distance * centre)
    # Beyond a ball of twice its radius a body is within a narrow cone.
    if away > 2 * light.inverse_distance * np.linalg.norm(points - centre, axis=1).max():
        return True
    return all(view_of(each, points) is not None for each in lighting_of((light,)).lights)


def most_groups(light_count: int, beside_real: bool) -> int:
    """How many groups of models have depth maps of their own; `beside_real`: a real object has one for each light."""
    return MOST_MAPS // max(light_count, 1) - beside_real


def sees_all(lights: tuple[Light, ...], bodies: Sequence[Float], beside_real: bool) -> bool:
    """Whether the shadows of all `bodies`, points (n, 3) of each, can be drawn, if each of them alone can.

    beside_real: as of `most_groups`.
    """
    shading = lighting_of(lights).lights
    lamps = [light for light in shading if light.inverse_distance > 0]  # a sun sees all of them, wherever they stand
    most = most_groups(len(shading), beside_real)
    # Each may be a group of its own: this is asked for every frame, and dividing them takes milliseconds.
    if not lamps or len(bodies) <= max(most, 1) or all(sees(light, np.concatenate(bodies)) for light in lights):
        return True
    groups = seen_together(bodies, lamps, most)
    together = [np.concatenate([bodies[number] for number in group]) for group in groups]
    return all(view_of(lamp, points) is not None for lamp in lamps for points in together)


def seen_together(bodies: Sequence[Float], lights: Sequence[ShadingLight], most: int) -> list[list[int]]:
    """Numbers of `bodies`, points (n, 3) of each, in groups that every light sees well as one: all of them, if it does.

    In at most `most` groups. A body that a lamp does not see so is a group of its own. Where they do not suffice, they
    are as narrow as can be for the lamps, and what no view shows any more is in as few of them as possible.
    """
    lamps = [light for light in lights if light.inverse_distance > 0]

    def cosine(numbers: Sequence[int]) -> float:
        points = np.concatenate([bodies[number] for number in numbers])
        return min(_cone(lamp, points)[1] for lamp in lamps)

    if not lamps or len(bodies) == 1 or cosine(range(len(bodies))) >= TOGETHER_COSINE:
        return [list(range(len(bodies)))]
    groups: list[list[int]] = []
    for number in range(len(bodies)):
        joined = max(groups, key=lambda group: cosine([*group, number]), default=None)
        narrowest = -1.0 if joined is None else cosine([*joined, number])
        if joined is None or (narrowest < TOGETHER_COSINE and len(groups) < most):
            groups.append([number])
            continue
        if narrowest < WIDEST_HALF_ANGLE_COSINE:
            joined = min(groups, key=lambda group: (cosine(group) >= WIDEST_HALF_ANGLE_COSINE, len(group)))
        joined.append(number)
    return groups


def _cone(lamp: ShadingLight, points: Float) -> tuple[Float, float]:
    """Axis (3,), away from a lamp, of the cone in which it sees points (n, 3), and the cosine of its half angle.

    -1 where the lamp touches one of them.
    """
    rays = -lamp.towards(points)
    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    if lengths.min() <= NEAREST_RATIO * lengths.max():
        return -lamp.to_light, -1.0
    return _enclosing_cone(rays / lengths)


def _enclosing_cone(directions: Float) -> tuple[Float, float]:
    """Axis (3,) of the narrowest cone around unit vectors (n, 3), nearly, and the cosine of its half angle.

    Badoiu and Clarkson, "Smaller core-sets for balls", SODA 2003: the smallest ball around the vectors' ends.
    """
    centre = directions.mean(axis=0)
    for step in range(CONE_STEPS):
        farthest = directions[((directions - centre) ** 2).sum(axis=1).argmax()]
        centre = centre + (farthest - centre) / (step + 2)
    if np.linalg.norm(centre) < 1e-6:
        return directions[0], -1.0
    axis = normalised(centre)
    return axis, float((directions @ axis).min())

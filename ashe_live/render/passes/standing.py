"""Models on the graphics card at their places in the marker frame: moving one changes a matrix and uploads nothing."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import transform_points
from ashe_live.models.placement import Placement
from ashe_live.render.gl.framing import corners_of
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.lights.light_view import most_groups, seen_together
from ashe_live.render.lights.lighting import Lighting
from ashe_live.render.occlusion.contact import ContactPatch


class StandingModel:
    """A ShadowCaster; another object for another placement, or another moment of its motion."""

    def __init__(self, model: GpuModel, contact: ContactPatch, placement: Placement, pose_s: float = 0.0) -> None:
        self.model = model
        self.contact = contact  # in the model's own frame: what it hides of the sky does not depend on where it stands
        self.placement = placement
        self.pose_s = pose_s
        model.pose(pose_s)
        self.marker_from_placed: Float = placement.marker_from_placed
        self.placed_from_marker: Float = np.linalg.inv(self.marker_from_placed).astype(np.float64)
        # (n, 3) metres, marker frame; its hull encloses the model
        self.points = transform_points(self.marker_from_placed, model.points)
        # (8, 3) of the box around it, metres, marker frame
        self.corners = corners_of(model.placed, placement)

    @property
    def is_clear(self) -> bool:
        """Whether parts of it let light through."""
        return self.model.is_clear

    @property
    def contact_corners(self) -> Float:
        """(8, 2) metres, marker frame: around where the contact ends."""
        corners = np.column_stack([self.contact.corners, np.zeros(8)])
        return np.asarray(transform_points(self.marker_from_placed, corners)[:, :2])

    def render_depth(self, clip_from_marker: Float) -> None:
        self.model.render_depth(clip_from_marker @ self.marker_from_placed)


class StandingGroup:
    """All models of one picture, which cast their shadows together: a ShadowCaster; another object for another member.

    One shadow map holds them all, so that they shade each other as one model's parts do; several do where a lamp stands
    among them, which no single view from it shows.
    """

    def __init__(self, members: tuple[StandingModel, ...]) -> None:
        """At least one."""
        self.members = members
        self.points = np.concatenate([member.points for member in members])
        self.is_clear = any(member.is_clear for member in members)
        # (8 n, 3) of the boxes around them, metres, marker frame
        self.corners = np.concatenate([member.corners for member in members])
        self._divided: tuple[StandingGroup, ...] = ()  # unless they are one caster
        self._divided_for = b""

    def casters(self, lighting: Lighting, beside_real: bool) -> tuple["StandingGroup", ...]:
        """Groups that each light can see as one, itself where possible; the same objects for lights in the same places.

        A point is shaded by what all of them let through. `beside_real`: a real object casts shadows as well.
        """
        key = np.array([light.homogeneous for light in lighting.lights]).tobytes() + bytes([beside_real])
        if self._divided_for != key:
            most = most_groups(len(lighting.lights), beside_real)
            groups = seen_together([member.points for member in self.members], lighting.lights, most)
            divided = (StandingGroup(tuple(self.members[number] for number in group)) for group in groups)
            self._divided_for, self._divided = key, tuple(divided) if len(groups) > 1 else ()
        return self._divided or (self,)

    def render_depth(self, clip_from_marker: Float) -> None:
        for member in self.members:
            member.render_depth(clip_from_marker)

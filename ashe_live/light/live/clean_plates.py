"""Frames over a picture of the empty table that a person has taken."""

from dataclasses import replace

from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import OF_ONE_FRAME
from ashe_live.light.pixels.clean_plate.registration import registered


def refuse_unused(estimator: str, name: str) -> None:
    """Raises UserError if the estimator of that name makes no use of a clean plate; `name` is how that is called."""
    if estimator in OF_ONE_FRAME:
        raise UserError(f"the estimator {estimator} makes no use of {name}", "choose proxy, or leave it out")


def over_empty_table(tracked: TrackedFrame, empty: TrackedFrame, name: str) -> TrackedFrame:
    """A frame with a marker, with the picture of the empty table as its clean plate; `name` is how that is called.

    Raises UserError if that picture shows another view, or no marker.
    """
    if tracked.pose.body is not None:
        raise UserError("the paper cube's light is found without an empty table", f"leave {name} out")
    if empty.marker is None:
        raise UserError(f"{name} shows no marker", "leave it where it is, and take only the object away")
    plate = registered(tracked, empty)
    if plate is None:
        raise UserError(f"{name} shows another view", "keep the camera where it is, and move only the object")
    return replace(tracked, clean_plate_bgr=plate)

"""The error of a lamp's nearness estimated from the fall of light over the ground alone, with all else given."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.bench.metrics import angular_error_deg, squared_sigmas
from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.ground.lit_ground import unlit_mask
from ashe_live.light.ground.shadow_shift import shadow_ratio, shift_within
from ashe_live.light.lamps.fall.fall_off import FallOff
from ashe_live.light.lamps.fall.lit_samples import clear_of
from ashe_live.light.lamps.kinds import AUTO
from ashe_live.light.lamps.lit_by_lamp import LEAST_PX, lit_ground_of
from ashe_live.light.lamps.place import Place
from ashe_live.light.lamps.sources import anywhere_about, share_of, with_fall_off
from ashe_live.light.pixels.areas import resized
from ashe_live.light.pixels.view import View

KNOWN_M, OPEN = 0.01, 30.0  # sigmas: of the displacement at the object, which is given, and of the nearness (1/m)
WITHIN_SIGMA = 0.683  # of errors that are normal


@dataclass(frozen=True, slots=True)
class FallError:
    """What the fall of light says of one lamp's nearness, beside the truth."""

    deviance: float  # of even light, if unevenness is at its worst: how clearly the ground shows a lamp
    true: float  # nearness w / z (1/m)
    estimated: float
    sigma: float  # of `estimated`, by the ground's noise and unevenness
    direction_deg: float  # error at the marker by the fall of light alone: the direction is not given
    squared_sigmas: float  # of the same: squared Mahalanobis distance

    @property
    def share(self) -> float:
        """The further sigma, as a fraction of the nearness, with which this error would be one sigma."""
        return math.sqrt(max((self.estimated - self.true) ** 2 - self.sigma**2, 0.0)) / abs(self.estimated)


def fall_error(case: Case, preset: ProxyPreset) -> FallError | None:
    """None of what is no lamp, or shines beside another light; and where the true labels leave too little to see."""
    shadow, body = case.mask("shadow"), case.mask("object")
    if case.lamp_m is None or case.foot_m is None or shadow is None or body is None:
        return None
    if case.to_lights_marker is None or len(case.to_lights_marker) > 1:
        return None
    view = View.of(case.tracked(), preset.fine_width_px).with_paper_as_ground().scaled(preset.coarse_width_px)
    ground = lit_ground_of(view, preset.ground, AUTO)
    if ground is None:
        return None
    taken = [each for each in (body, shadow, case.mask("clutter")) if each is not None]
    unlit = np.logical_or.reduce([resized(mask, view.size) for mask in taken])
    fall_off = FallOff.of(view, ground, clear_of(unlit | unlit_mask(ground, view.is_ground, LEAST_PX)))
    dark = resized(shadow, view.size) & view.is_ground & ~resized(body, view.size)
    shift = shift_within(ground.colours[dark], ground) if dark.any() else None
    if fall_off is None or shift is None:
        return None
    share, reference = share_of(shadow_ratio(ground, shift)), _middle_of(dark, view)
    given = _at_object(case.lamp_m, case.foot_m)
    place = with_fall_off(given, fall_off, np.empty((0, 3)), [share], reference)
    pull = fall_off.pull(place.mean[None], [share], reference)
    even = fall_off.pull(np.zeros((1, 3)), [share], reference)
    line = np.append(case.foot_m, 1.0)
    information = float(line @ pull.information @ line)
    if information <= 0 or place.mean[2] <= 0:
        return None
    sigma = 1 / math.sqrt(information)
    true = np.append(case.lamp_m[:2], 1.0) / case.lamp_m[2]
    alone = with_fall_off(
        anywhere_about(Place(true, np.eye(3)), case.foot_m), fall_off, np.empty((0, 3)), [share], reference
    )
    to_lamp = case.lamp_m / np.linalg.norm(case.lamp_m)
    return FallError(
        deviance=even.worst_cost - pull.worst_cost,
        true=1 / float(case.lamp_m[2]),
        estimated=float(place.mean[2]),
        sigma=sigma,
        direction_deg=angular_error_deg(alone.light[:3], to_lamp),
        squared_sigmas=squared_sigmas(alone.light[:3], alone.lamp_covariance[:2, :2], to_lamp),
    )


def fitted_share(errors: Sequence[FallError]) -> float:
    """The further error of the nearness, as a fraction of it, with which 68 % of the errors lie within their sigma."""
    return float(np.quantile([each.share for each in errors], WITHIN_SIGMA))


def whole_share(errors: Sequence[FallError]) -> float:
    """The error of the nearness, as a fraction of the true one, within which 68 % lie."""
    return float(np.quantile([abs(each.estimated / each.true - 1) for each in errors], WITHIN_SIGMA))


def _at_object(lamp_m: Float, foot_m: Float) -> Place:
    """What the true direction at the object tells of the lamp."""
    line = np.column_stack([np.eye(2), -foot_m])
    information = line.T @ line / KNOWN_M**2
    information[2, 2] += 1 / OPEN**2
    return Place(np.append((lamp_m[:2] - foot_m) / lamp_m[2], 0.0), np.asarray(information))


def _middle_of(area: Mask, view: View) -> Float:
    """(2,) metres: the middle, on the plane, of an area (h, w) of the view."""
    pixels = np.argwhere(area)[:, ::-1]
    return np.asarray(raycast_to_plane(view.camera, view.T_cam_marker, pixels)[:, :2].mean(axis=0))

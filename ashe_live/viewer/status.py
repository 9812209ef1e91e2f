"""The text of the heads-up display."""

import math

from ashe_live.core.transforms import angle_between, transform_points
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.light_text import light_text
from ashe_live.render.gl.framing import corners_of, framing
from ashe_live.render.lights.light_view import sees, sees_all
from ashe_live.tracking.families.in_view import in_view_text, mirrored_text
from ashe_live.tracking.families.layout import in_words, the_marker
from ashe_live.viewer.session import Session

FIRST_STEP = "put something that casts a shadow next to the marker, press Space"
AWAITED = "estimated as soon as the marker is steady"
AFTER_NONE = "one upright thing in direct light, its whole shadow on a plain surface, clear of the marker; then Space"
SET_BY_HAND = "or set it by hand: drag in the picture, and the end of the model's shadow follows"
WITHOUT_IT = "or take the thing away, press Shift+Space, put it back and press Space: then nothing else counts"
KEYS = "H: keys"
VAGUE = 0.03  # relative standard deviation of a focal length from which on it is said that more views would help
BENT_PX = 1.0  # root mean square of the marker's corners about those of a flat square, from which on it is told
# An answer so sharp needs no advice, and where views over so wide an angle gave none, moving on will not.
SHARP_ENOUGH_RAD, WIDE_ENOUGH_RAD = math.radians(1.5), math.radians(12)
LAMP_BELOW = "the lamp is below the table: it gives no light"
OUT_OF_PICTURE = "the model stands outside the picture: Backspace puts it back"
LAMP_INSIDE = "the lamp is inside the model or touches it: it casts no shadow"
LAMP_AMONG_MANY = "so many models stand around the lamp that some of them cast no shadow in it"
MIRROR_KEY = "W mirrors what the window shows, and the marker is found all the same"
NO_MARKER = (
    "no marker yet: `ashe-live marker --out marker.pdf` makes one to print,",
    "`ashe-live marker --show` shows one on a screen; lay it flat, all of it in view",
    "or `ashe-live marker --cube --out cube.pdf`: a paper cube, which needs no other object beside it",
)
NOT_IN_FILE = (
    "is not found: if another one is there, name it with --marker,",
    "such as `--marker aruco:4x4_50:7`, or `--marker image:FILE.png` for a picture of your own",
)
NONE_IN_FILE = (
    "no marker is found here: it must be in view as a whole, with the white around it;",
    "a picture of your own is a marker only if it is named, such as `--marker image:FILE.png`;",
    "`ashe-live marker --out marker.pdf` makes one to print, for another photo or clip",
)


def light_line(session: Session) -> str:
    """The state of the light; an estimate under way does not hide the last answer, and says for how long it takes."""
    light, estimate = session.lit_by.light, session.estimate
    if light is None and estimate is None:
        if session.watch.is_estimating:
            return f"light: {_estimating(session)}"
        return f"light: {AWAITED if session.first.awaits_steady or session.automatic else FIRST_STEP}"
    if light is None:
        assert estimate is not None
        text = f"no clear light{_over_empty_table(session)}: {estimate.reason}"
    else:
        text = f"{'light' if session.hand.light is None else 'light by hand'}: {light_text(light)}"
        if session.hand.light is None:
            text += views_text(session)
        if (count := len(session.lit_by.lights)) > 1:
            text += f", first of {count}"
        if session.true_to_light_marker is not None:
            error = angle_between(light.to_light_marker, session.true_to_light_marker)
            text += f" ({math.degrees(error):.1f}° from the truth)"
    return f"{text}, {_estimating(session)}" if session.watch.is_awaited else text


def _estimating(session: Session) -> str:
    since_s = int(session.watch.waited_s)
    return f"estimating, {since_s} s" if since_s > 0 else "estimating…"


def views_text(session: Session) -> str:
    """How many views the estimate rests on, or what would make it sharper; empty where there is nothing to say."""
    estimate = session.estimate
    if estimate is None or estimate.light is None:
        return ""
    if estimate.span_rad is not None:
        return f", {len(estimate.views)} views over {math.degrees(estimate.span_rad):.0f}°"
    if over := _over_empty_table(session):
        return over
    sigma_rad = estimate.light.sigma_rad
    is_vague = sigma_rad is not None and sigma_rad > SHARP_ENOUGH_RAD
    may_gain = session.watch.camera_may_move and session.watch.sharpening.span_rad < WIDE_ENOUGH_RAD
    return ", move the camera a little" if is_vague and may_gain else ""


def _over_empty_table(session: Session) -> str:
    return ", over the empty table" if session.answer is not None and session.answer.is_over_empty_table else ""


def marker_line(tracked: TrackedFrame | None) -> str:
    if tracked is None:
        return "waiting for the first picture"
    if tracked.marker is None:
        return "marker: not in view"
    if tracked.marker.reprojection_rms_px < BENT_PX or tracked.marker.body is not None:
        return "marker: in view"
    or_lens = "" if tracked.camera.source == "file" else ", or measure the lens by `ashe-live calibrate`"
    return f"marker: in view, but bent: lay it flat{or_lens}"


def camera_line(tracked: TrackedFrame | None) -> str | None:
    """A line on the field of view of an uncalibrated camera; None for a calibrated one."""
    if tracked is None or tracked.camera.source not in ("assumed", "estimated"):
        return None
    camera = tracked.camera
    if camera.source == "assumed":
        return f"camera: {camera.hfov_deg:.0f}° wide, assumed until the marker is seen from several sides"
    relative_sigma = camera.focal_sigma_px / camera.K[0, 0]
    sigma_deg = math.degrees(math.sin(math.radians(camera.hfov_deg)) * relative_sigma)
    how = "estimated from the marker" if relative_sigma < VAGUE else "by few views of the marker"
    return f"camera: {camera.hfov_deg:.1f}° ± {sigma_deg:.1f}° wide, {how}"


def status_lines(
    session: Session,
    fps: float | None,
    quality: str,
    measured: TrackedFrame | None = None,
    model_name: str | None = None,
) -> list[str]:
    """The lines at the top left; `fps` is None where there is no display.

    The marker's numbers are those of `measured`, or else of the current frame; `model_name` is that of the model in the
    picture, which may not be the chosen one yet.
    """
    model = f"model: {model_name or session.table.in_hand_text}"
    first = "   ".join((model, quality) if fps is None else (_rate_text(fps), model, quality, KEYS))
    seen = measured or session.tracked
    marker = marker_line(seen)
    if seen is not None and seen.marker is not None:
        marker += "".join(f"; {spec}: not in view" for spec in session.arrangement.without_marker(seen))
    if _awaits_marker(session):  # of which the lines at the bottom speak: camera and light follow from it
        return [first, marker]
    camera = camera_line(session.tracked)
    return [first, marker, *([] if camera is None else [camera]), light_line(session)]


def _rate_text(fps: float) -> str:
    """A picture every few seconds is a slow one, and not none."""
    return "less than 1 fps" if round(fps) < 1 else f"{fps:.0f} fps"


def source_lines(session: Session, source_status: str | None, now_s: float) -> list[str]:
    """The lines at the bottom left: guidance, the source's status and the last message."""
    parts, said_now = session.view.parts_line, session.notice.shown(now_s)
    said = (*guidance(session), source_status, session.table.progress, parts, said_now)
    return [text for text in said if text]


def guidance(session: Session) -> tuple[str, ...]:
    """Hints while no marker or no light has been found, or while a lamp or the model stands where it is of no use."""
    if (note := lamp_note(session)) is not None:
        return (note,)
    if _is_moved_out_of_picture(session):
        return (OUT_OF_PICTURE,)
    instead = session.seen_instead
    if specs := instead.in_view:
        return (f"{in_view_text(specs)}: M follows {in_words(specs[0])}",)
    if instead.mirrored:
        return mirrored_text(instead.mirrored), MIRROR_KEY
    if instead.fault is not None:
        return (f"no marker is seen: {instead.fault}",)
    if _awaits_marker(session):
        if session.watch.camera_may_move:
            return NO_MARKER
        if not session.has_named_marker:
            return NONE_IN_FILE
        marker = session.arrangement.followed
        which = "the marker that is looked for" if marker is None else the_marker(marker)
        return (f"{which} {NOT_IN_FILE[0]}", *NOT_IN_FILE[1:])
    if session.estimate is not None and session.lit_by.light is None and not session.watch.is_estimating:
        without_it = [WITHOUT_IT] if session.watch.may_show_empty_table else []
        return f"what helps: {AFTER_NONE}", *without_it, SET_BY_HAND
    return ()


def lamp_note(session: Session) -> str | None:
    """Why a lamp is not drawn as others are, if any is not."""
    lamps = [light for light in session.lit_by.lights if light.kind == "lamp"]
    if any(lamp.to_light_marker[2] <= 0 for lamp in lamps):
        return LAMP_BELOW
    if not lamps:
        return None
    bodies = [
        transform_points(placement.marker_from_placed, model.outline)
        for _, model, placement in session.arrangement.models(session.tracked)
        if placement is not None
    ]
    if not all(sees(lamp, points) for lamp in lamps for points in bodies):
        return LAMP_INSIDE
    lit = session.lit_by
    return None if sees_all(lit.lights, bodies, lit.real_object is not None) else LAMP_AMONG_MANY


def _is_moved_out_of_picture(session: Session) -> bool:
    """Whether a person has left the model in the hand where none of it is seen, in this run or another."""
    tracked, models = session.tracked, session.arrangement
    if tracked is None or tracked.marker is None or not models.is_moved:
        return False
    _, model, placement = models.models(tracked)[models.in_hand]
    if placement is None:
        return False
    corners, viewport = corners_of(model, placement), (0, 0, *tracked.frame.size)
    return framing(tracked.camera, tracked.marker.T_cam_marker, corners, viewport) is None


def _awaits_marker(session: Session) -> bool:
    """Whether pictures come, and none has shown a marker, without which only a light by hand can be known."""
    return session.tracked is not None and not session.room_light.has_seen_marker and session.hand.light is None

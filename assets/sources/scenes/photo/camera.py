"""From linear radiance to the picture that a camera gives: lens, sensor, tone, denoising, sharpening (NumPy, OpenCV).

The stages stand in the order in which a camera has them. `camera_settings` draws a camera of a named family:

- plain: sRGB of linear light with some blur and noise, as renderers' pictures are developed;
- phone: a tone curve, more colour, sharpening, chroma denoising; phone_hdr adds strong local tone mapping;
  phone_old is softer, noisier, and its white balance is further off;
- webcam: a small lens and sensor: row noise, veiling glare, low JPEG quality.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.colour import REC709_LUMINANCE, srgb_from_linear

Rng = np.random.Generator
Floats = NDArray[np.float32]
Settings = dict[str, Any]
METERED = 0.30  # where an exposure of 1 puts the mean of what is metered, linear
LOCAL_LOG_GAINS = (-0.4, 0.75)  # local tone mapping brightens by no more than this, which is about 2
MOST_CLIPPED = 1.3  # how far over full scale the brightest hundredth of a picture may be exposed


def camera_settings(rng: Rng, family: str) -> Settings:
    u = lambda low, high: round(float(rng.uniform(low, high)), 5)  # noqa: E731
    phone, old, web = family.startswith("phone"), family == "phone_old", family == "webcam"
    off = 0.10 if old or web else 0.05
    return {
        "family": family,
        "exposure": round(float(np.exp(rng.normal(-0.05, 0.28))), 5),
        "white_balance": [
            round(float(np.exp(rng.normal(0, off))), 5),
            1.0,
            round(float(np.exp(rng.normal(0, off))), 5),
        ],
        "adaptation": u(0.5, 1.0),  # by how much of the light's colour the white balance takes away
        "blur_px": u(0.5, 1.1) if old or web else u(0.35, 0.7),
        "motion_px": u(0.5, 2.2) if rng.random() < (0.3 if phone or web else 0.1) else 0.0,
        "motion_deg": u(0, 180),
        "vignetting": u(0.05, 0.35) if phone or web else u(0, 0.12),
        "glare": u(0.005, 0.03) if phone else u(0.01, 0.06) if web else u(0, 0.008),
        "shot_noise": u(0.8e-4, 4e-4) * (2.5 if old or web else 1.0),
        "read_noise": u(0.0006, 0.003) * (2.0 if old or web else 1.0),
        "row_noise": u(0.0008, 0.004) if web or (old and rng.random() < 0.5) else 0.0,
        "chroma_denoise_px": u(1.2, 3.5) if phone else u(0.8, 2.0) if web else 0.0,
        "luma_denoise": u(0.2, 0.8) if phone or web else 0.0,
        "local_tone": u(0.25, 0.6) if family == "phone_hdr" else u(0.0, 0.2) if phone else 0.0,
        "contrast": u(0.15, 0.55) if phone else u(0.0, 0.4) if web else 0.0,
        "saturation": u(1.0, 1.3) if phone else u(0.8, 1.15) if web else 1.0,
        "sharpening": u(0.4, 1.5) if phone else u(0.3, 1.6) if web else 0.0,
        "sharpening_px": u(0.7, 1.5),
        "jpeg_quality": int(rng.integers(60, 88)) if web or old else int(rng.integers(75, 96)),
        "seed": int(rng.integers(1 << 30)),
    }


def through_lens(light: Floats, s: Settings) -> Floats:
    """Veiling glare, defocus, motion and vignetting of linear light (h, w, 3)."""
    h, w = light.shape[:2]
    if s["glare"]:
        near = cv2.GaussianBlur(np.minimum(light, 8 * light.mean()), (0, 0), 0.08 * w)
        light = (1 - s["glare"]) * light + s["glare"] * (0.5 * near + 0.5 * light.mean(axis=(0, 1)))
    light = cv2.GaussianBlur(light, (0, 0), s["blur_px"])
    if s["motion_px"]:
        light = cv2.filter2D(light, -1, streak(s["motion_px"], s["motion_deg"]))
    y, x = np.mgrid[:h, :w].astype(np.float32)
    far = ((x - (w - 1) / 2) ** 2 + (y - (h - 1) / 2) ** 2) / ((w / 2) ** 2 + (h / 2) ** 2)
    return np.asarray(light * (1 - s["vignetting"] * far)[..., None], np.float32)


def streak(length_px: float, angle_deg: float) -> Floats:
    """The kernel of a straight motion."""
    kernel = np.zeros((7, 7), np.float32)
    a = np.radians(angle_deg)
    for step in np.linspace(-0.5, 0.5, 15) * length_px:
        x, y = 3 + step * np.cos(a), 3 + step * np.sin(a)
        i, j = int(y), int(x)
        for di, dj in ((0, 0), (0, 1), (1, 0), (1, 1)):
            kernel[i + di, j + dj] += (1 - abs(y - i - di)) * (1 - abs(x - j - dj))
    return kernel / kernel.sum()


def gains(light: Floats, lamp_colour: NDArray[np.float64], s: Settings) -> NDArray[np.float64]:
    """(3,) what the camera multiplies linear light by: exposure from the metered middle, and white balance."""
    h, w = light.shape[:2]
    luminance = light @ REC709_LUMINANCE
    middle = luminance[h // 6 : -h // 6, w // 6 : -w // 6]
    metered = 0.5 * middle.mean() + 0.5 * luminance.mean()
    brightest = float(np.percentile(luminance, 99))
    exposure = min(METERED / max(metered, 1e-6) * s["exposure"], MOST_CLIPPED / max(brightest, 1e-6))
    neutral = (np.asarray(lamp_colour) / (np.asarray(lamp_colour) @ REC709_LUMINANCE)) ** -s["adaptation"]
    balance = neutral * s["white_balance"]
    return exposure * balance / (balance @ REC709_LUMINANCE)


def sensed(signal: Floats, s: Settings, rng: Rng) -> Floats:
    """Shot, read and row noise; what is over full scale is lost."""
    deviation = np.sqrt(s["read_noise"] ** 2 + s["shot_noise"] * np.maximum(signal, 0))
    noisy = signal + rng.normal(size=signal.shape) * deviation
    noisy += rng.normal(size=(signal.shape[0], 1, 1)) * s["row_noise"]
    return np.clip(noisy, 0, 1).astype(np.float32)


def toned(signal: Floats, s: Settings) -> Floats:
    """Local tone mapping, then a curve with a toe and a shoulder, then colour; values in [0, 1], still linear light."""
    luminance = np.maximum(signal @ REC709_LUMINANCE.astype(np.float32), 1e-4)
    if s["local_tone"]:
        log = np.log(luminance)
        base = edge_aware(log, int(0.06 * signal.shape[1]), 0.25)
        middle = np.log(0.22)
        mapped = log + np.clip(s["local_tone"] * (middle - base) * np.where(base < middle, 1.0, 0.5), *LOCAL_LOG_GAINS)
        signal = signal * np.exp(mapped - log)[..., None]
        luminance = np.exp(mapped)
    encoded = srgb_from_linear(np.clip(luminance, 0, 1)).astype(np.float32)
    bent = encoded + s["contrast"] * encoded * (1 - encoded) * (2 * encoded - 0.85)
    ratio = np.where(luminance > 1, 1.0, decoded(np.clip(bent, 0, 1)) / np.maximum(luminance, 1e-4))
    signal = signal * ratio[..., None]
    grey = (signal @ REC709_LUMINANCE.astype(np.float32))[..., None]
    return np.clip(grey + s["saturation"] * (signal - grey), 0, 1).astype(np.float32)


def decoded(encoded: Floats) -> Floats:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)


def edge_aware(values: Floats, radius: int, spread: float) -> Floats:
    """The guided filter of a picture by itself (He, Sun, Tang 2013): smooth, but for steps larger than `spread`."""
    size = (2 * radius + 1,) * 2
    mean = cv2.blur(values, size)
    variance = cv2.blur(values * values, size) - mean * mean
    slope = variance / (variance + spread**2)
    return np.asarray(cv2.blur(slope, size) * values + cv2.blur(mean * (1 - slope), size), np.float32)


def finished(encoded: Floats, s: Settings) -> Floats:
    """Denoising and sharpening of an encoded picture (h, w, 3) in [0, 1], as YCbCr."""
    ycc = cv2.cvtColor(np.float32(encoded), cv2.COLOR_RGB2YCrCb)
    luma, chroma = ycc[..., 0], ycc[..., 1:]
    if s["chroma_denoise_px"]:
        chroma = cv2.GaussianBlur(chroma, (0, 0), s["chroma_denoise_px"])
    if s["luma_denoise"]:
        luma = (1 - s["luma_denoise"]) * luma + s["luma_denoise"] * cv2.bilateralFilter(luma, 5, 0.04, 1.5)
    if s["sharpening"]:
        luma = luma + s["sharpening"] * (luma - cv2.GaussianBlur(luma, (0, 0), s["sharpening_px"]))
    return np.clip(cv2.cvtColor(np.dstack([luma, chroma]), cv2.COLOR_YCrCb2RGB), 0, 1)


def photographed(
    light: NDArray[Any], lamp_colour: NDArray[np.float64], s: Settings, gain: list[float] | None = None
) -> tuple[NDArray[np.uint8], list[float]]:
    """The picture (h, w, 3) BGR of linear light (h, w, 3) RGB, and the gains (3,) that exposed it.

    `lamp_colour`: (3,) linear, the colour of the light on the ground, which the white balance partly takes away.
    `gain`: exposure and white balance of another picture, instead of its own.
    """
    rng = np.random.default_rng(s["seed"])
    seen = through_lens(np.float32(light), s)
    used = gains(seen, lamp_colour, s) if gain is None else np.asarray(gain)
    signal = sensed(seen * np.float32(used), s, rng)
    encoded = srgb_from_linear(toned(signal, s)).astype(np.float32)
    picture = finished(encoded, s)
    return np.ascontiguousarray(np.uint8(np.round(picture[..., ::-1] * 255))), [float(g) for g in used]

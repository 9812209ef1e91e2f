"""Develops the rendered frames into the shipped clip: exposure, slight blur, sensor noise, H.264, ground truth.

    python develop_clip.py --frames /tmp/clip --bare /tmp/bare [--out ../clips]

`--frames` holds what `render_clip.py` wrote; `--bare` the reference frame (`REFERENCE`) rendered with `--no-caster` and
with `--irradiance`. Then the finished video is decoded again and the marker's detected corners are compared with the
truth. Needs numpy, opencv-contrib-python-headless, av.
"""

import argparse
import json
import math
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np

SEED = 915
REFERENCE = 84  # the frame in which the shading ratio is measured
WHITE_BALANCE, EXPOSURE = (1.0, 1.0, 1.0), 1.08
BLUR_SIGMA_PX = 0.5
SHOT_NOISE, READ_NOISE = 1.1e-4, 0.0012  # variance per linear signal; standard deviation in the dark
CRF, GOP = 18, 24


def radiance(path, white):
    """Linear RGB of a 16-bit PNG."""
    return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1].astype(np.float64) * (white / 65535)


def develop(linear, rng):
    """Exposure, blur and noise in linear light, then sRGB in 8 bits."""
    signal = cv2.GaussianBlur(linear * np.array(WHITE_BALANCE) * EXPOSURE, (0, 0), BLUR_SIGMA_PX)
    signal = signal + rng.normal(size=signal.shape) * np.sqrt(READ_NOISE**2 + SHOT_NOISE * signal)
    signal = np.clip(signal, 0, 1)
    encoded = np.where(signal <= 0.0031308, 12.92 * signal, 1.055 * signal ** (1 / 2.4) - 0.055)
    return np.round(encoded * 255).astype(np.uint8)


def write_video(path, pictures, fps):
    options = {"crf": str(CRF), "preset": "veryslow", "movflags": "+faststart", "bf": "2"}
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=fps, options=options)
        coder = stream.codec_context
        coder.height, coder.width = pictures[0].shape[:2]
        coder.pix_fmt, coder.gop_size, coder.time_base = "yuv420p", GOP, Fraction(1, fps)
        coder.color_primaries = coder.color_trc = coder.colorspace = 1  # BT.709
        coder.color_range = 1  # studio swing
        coder.thread_count = 1
        for picture in pictures:
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame = frame.reformat(format="yuv420p", dst_colorspace="ITU709", dst_color_range="MPEG")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


def read_video(path):
    """The clip as a viewer sees it, BGR."""
    with av.open(str(path)) as container:
        return [f.to_ndarray(format="bgr24") for f in container.decode(video=0)]


def project(truth, frame, points):
    camera = np.atleast_2d(points) @ np.array(frame["R"]).T + np.array(frame["t"])
    k = np.array(truth["K"])
    return camera[:, :2] / camera[:, 2:] * [k[0, 0], k[1, 1]] + k[:2, 2]


def marker_corners(truth, frame):
    half = truth["marker"]["side_m"] / 2
    return project(truth, frame, half * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]))


def caster_points(truth):
    r, z = np.array(truth["caster"]["profile_m"]).T
    a = np.linspace(0, 2 * math.pi, 128, endpoint=False)
    x, y = truth["caster"]["base_xy_m"]
    rings = np.stack([x + np.outer(r, np.cos(a)), y + np.outer(r, np.sin(a)), np.outer(z, np.ones_like(a))], -1)
    return rings.reshape(-1, 3)


def shadow_mask(truth, frame, shrink_px):
    """Ground pixels whose ray to the sun meets the cup (a convex outline), without the cup and a margin."""
    points, d = caster_points(truth), np.array(truth["light"]["dir_to_light"])
    masks = []
    for outline in (points - d * points[:, 2:] / d[2], points):
        hull = cv2.convexHull(np.float32(project(truth, frame, outline)))
        masks.append(cv2.fillConvexPoly(np.zeros(truth["size"][::-1], np.uint8), np.int32(np.round(hull)), 1))
    kernel = np.ones((2 * shrink_px + 1,) * 2, np.uint8)
    return (cv2.erode(masks[0], kernel) > 0) & (cv2.dilate(masks[1], kernel) == 0)


def light_figures(truth, frames, bare):
    """Irradiances (linear RGB, open sky) and the ratio of shadowed to lit ground in the reference frame."""
    white, name = truth["png_white"], f"{REFERENCE:04d}.png"
    everything, sky = (math.pi * radiance(bare / f"{kind}_{name}", white).mean((0, 1)) for kind in ("all", "sky"))
    mask = shadow_mask(truth, truth["frames"][REFERENCE], 5)
    measured = radiance(frames / name, white)[mask].mean(0) / radiance(bare / name, white)[mask].mean(0)
    return everything - sky, sky, sky / everything, measured


def rounded(values, digits):
    return np.round(np.asarray(values, float), digits).tolist()


def describe(truth, frames, bare, video):
    sun, sky, open_ratio, measured = light_figures(truth, frames, bare)
    elevation = math.radians(truth["light"]["elevation_deg"])
    caster = truth["caster"]
    tip, top = caster["shadow_tip_m"], caster["top_m"]
    return {
        "video": video, "size": truth["size"], "fps": float(truth["fps"]), "codec": "h264", "category": "clean",
        "seed": truth["seed"], "renderer": truth["renderer"], "renderer_version": truth["renderer_version"],
        "K": rounded(truth["K"], 6), "dist": [0, 0, 0, 0, 0], "hfov_deg": truth["hfov_deg"],
        "marker": truth["marker"], "directional": True,
        "lights": [{
            "dir_to_light": rounded(truth["light"]["dir_to_light"], 8),
            "azimuth_deg": round(truth["light"]["azimuth_deg"], 4),
            "elevation_deg": round(truth["light"]["elevation_deg"], 4),
            "angular_diameter_deg": round(truth["light"]["angular_diameter_deg"], 4),
            "color": truth["light"]["color"], "relative_strength": 1.0,
            "irradiance_perpendicular": rounded(sun / math.sin(elevation), 5), "irradiance_ground": rounded(sun, 5),
        }],
        "ambient": {"kind": "clear", "irradiance_ground": rounded(sky, 5)},
        "shading_ratio": {"all_blocked": rounded(open_ratio, 4), "one_blocked": [rounded(open_ratio, 4)],
                          "measured": [rounded(measured, 4)], "measured_in_frame": REFERENCE},
        "ground": {"texture": "wood", "dark": False},
        "caster": {
            "type": "paper cup", "tone": "dark", "textured": True, "glossy": True,
            "base_xy_m": rounded(caster["base_xy_m"], 6), "height_m": round(caster["height_m"], 5),
            "bbox_min_m": rounded(caster["bbox_min_m"], 6), "bbox_max_m": rounded(caster["bbox_max_m"], 6),
            "top_m": rounded(top, 6), "shadow_tip_m": [rounded(tip, 6)], "profile_m": rounded(caster["profile_m"], 6),
        },
        "clutter": [],
        "photo": {"white_balance": WHITE_BALANCE, "exposure_gain": EXPOSURE, "blur_sigma_px": BLUR_SIGMA_PX,
                  "shot_noise": SHOT_NOISE, "read_noise": READ_NOISE, "crf": CRF, "seed": SEED},
        "frames": [{
            "frame": i, "time_s": round(i / truth["fps"], 6), "R": rounded(f["R"], 8), "t": rounded(f["t"], 8),
            "marker_corners_px": rounded(marker_corners(truth, f), 3),
            "shadow_tip_px": rounded(project(truth, f, tip)[0], 2), "top_px": rounded(project(truth, f, top)[0], 2),
        } for i, f in enumerate(truth["frames"])],
    }  # fmt: skip


def check(record, pictures):
    """Detects the marker in the decoded video and notes in the record how far it is from the truth."""
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, record["marker"]["dictionary"]))
    detector = cv2.aruco.ArucoDetector(dictionary, settings)
    errors = []
    for entry, picture in zip(record["frames"], pictures, strict=True):
        corners, ids, _ = detector.detectMarkers(picture)
        found = ids is not None and np.ravel(ids).tolist() == [record["marker"]["id"]]
        entry["marker_detected"] = found
        if found:
            errors.extend(np.linalg.norm(corners[0][0] - entry["marker_corners_px"], axis=1))
    found = sum(entry["marker_detected"] for entry in record["frames"])
    print(f"marker found in {found} of {len(pictures)} frames; corner error: median {np.median(errors):.3f} px, "
          f"95 % {np.percentile(errors, 95):.3f} px, most {np.max(errors):.3f} px")  # fmt: skip


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--frames", type=Path, required=True)
    ask.add_argument("--bare", type=Path, required=True)
    ask.add_argument("--out", type=Path, default=Path(__file__).resolve().parents[1] / "clips")
    asked = ask.parse_args()
    truth = json.loads((asked.frames / "truth.json").read_text())
    rng = np.random.default_rng(SEED)
    count, white = len(truth["frames"]), truth["png_white"]
    pictures = [develop(radiance(asked.frames / f"{i:04d}.png", white), rng) for i in range(count)]
    asked.out.mkdir(parents=True, exist_ok=True)
    video = asked.out / "table.mp4"
    write_video(video, pictures, truth["fps"])
    record = describe(truth, asked.frames, asked.bare, video.name)
    check(record, read_video(video))
    text = json.dumps({k: v for k, v in record.items() if k != "frames"}, indent=1)
    rows = ",\n".join("  " + json.dumps(entry) for entry in record["frames"])
    video.with_suffix(".json").write_text(f'{text[:-2]},\n "frames": [\n{rows}\n ]\n}}\n')
    print(f"{video.name}: {video.stat().st_size / 1e6:.2f} MB; shading ratio {record['shading_ratio']}")


if __name__ == "__main__":
    main()

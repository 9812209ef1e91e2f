"""What cases are made of: small valid files, and clips that do what no camera does."""

import json
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import PIL.Image

from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.snapshot import write_png
from ashe_live.core.arrays import Image
from ashe_live.core.contract import light_by_hand_json
from ashe_live.core.light import Illumination, Light
from ashe_live.viewer.view_options import WHOLE

FPS = 30
FRAMES = 6
# As scanners, painting programs, editors and other cameras write them: each read as the plain one is, or refused.
ODD_PHOTOS = (
    *("inks.jpg", "palette.png", "deep.png", "moving.png", "progressive.jpg", "float.tif", "on-its-side.jpg"),
    "photo.webp",
)
ODD_CLIPS = ("deep.mkv", "transparent.mov", "moving.gif", "uneven.mkv", "single.mkv", "swift.mkv")
PICTURES = (
    *("clip.mp4", "blank.mp4", "jumps-back.ts", "grows.mkv", "cut.mp4", "foreign.mp4"),
    *("photo.png", "photo.jpg", "blank.png", "dot.png"),
)
GLTF = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
    ],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [
        {
            "byteLength": 36,
            "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
        }
    ],
}
# As settings and as a camera file.
LONG_TEXTS = {
    "deep": "[" * 100_000,
    "long": "x" * 70_000,
    "digits": "9" * 5000,
    "name": 'camera-file = "' + "a" * 300 + '"\n',
}
# How a recording was shown.
LAMP = Light((0.2, -0.3, 0.7), shadow_rgb_ratio=(0.5, 0.4, 0.3), inverse_distance=2.5, radius_m=0.02)
SHOWN = {
    "schema": 1,
    "shown": [
        {
            "frame": 3,
            "models": [
                {
                    "model": "mug",
                    "up": "y",
                    "marker": None,
                    "seat": 0,
                    "scale": 1.5,
                    "turn_rad": 0.7,
                    "shift_m": [0.02, 0.0],
                }
            ],
            "estimate": light_by_hand_json(Illumination((LAMP,), ambient_rgb_ratio=(0.5, 0.5, 0.5)), 3),
            "parts": WHOLE.value,
            "hides_marker": True,
        }
    ],
}
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def write_materials(folder: Path, film: Path, camera_file: Path) -> dict[str, Path]:
    """By the names that cases know them by. `film` shows a marker, `camera_file` is its camera's."""
    with av.open(str(film)) as clip:
        frames = [frame.to_ndarray(format="bgr24") for frame in clip.decode(video=0)][:FRAMES]
    blank = np.full((48, 64, 3), 90, np.uint8)
    materials = {
        name: folder / name
        for name in (
            *PICTURES,
            *ODD_PHOTOS,
            *ODD_CLIPS,
            "shown.json",
            "model.gltf",
            "model.obj",
            "wordy.gltf",
            "camera.json",
            "settings.toml",
        )
    }
    for name, pictures in (("clip.mp4", frames), ("blank.mp4", [blank] * 3)):
        with Recorder(materials[name], pictures[0].shape[1::-1], FPS) as recorder:
            for index, picture in enumerate(pictures):
                recorder.write(picture, index / FPS)
    whole = materials["clip.mp4"].read_bytes()
    materials["cut.mp4"].write_bytes(whole[: len(whole) * 3 // 4])
    _film(materials["foreign.mp4"], [blank] * 4, "mp4")
    _film(materials["jumps-back.ts"], frames, "mpegts")
    materials["jumps-back.ts"].write_bytes(materials["jumps-back.ts"].read_bytes() * 2)
    _grow(materials["grows.mkv"], frames)
    # Without a marker, as estimates of them all would take minutes.
    _write_odd_photos(materials, PIL.Image.fromarray(blank))
    _write_odd_clips(materials, [blank] * FRAMES)
    materials["shown.json"].write_text(json.dumps(SHOWN))
    write_png(materials["photo.png"], frames[0])
    cv2.imwrite(str(materials["photo.jpg"]), frames[0])
    write_png(materials["blank.png"], blank)
    PIL.Image.new("RGB", (1, 1)).save(materials["dot.png"])
    materials["model.gltf"].write_text(json.dumps(GLTF))
    words = [f"\x1b[31m{'word ' * 5}{index}" for index in range(2000)]
    materials["wordy.gltf"].write_text(json.dumps({**GLTF, "extensionsRequired": words, "extensionsUsed": words}))
    materials["model.obj"].write_text(OBJ)
    for name, text in LONG_TEXTS.items():
        materials[name] = folder / name
        materials[name].write_text(text)
    materials["camera.json"].write_bytes(camera_file.read_bytes())
    materials["settings.toml"].write_text('quality = "fast"\nhfov = 55\n')
    return materials


def _write_odd_photos(materials: dict[str, Path], photo: PIL.Image.Image) -> None:
    photo.convert("CMYK").save(materials["inks.jpg"])
    photo.convert("P").save(materials["palette.png"])
    PIL.Image.fromarray(np.asarray(photo.convert("L")).astype(np.uint16) * 257).save(materials["deep.png"])
    photo.save(materials["moving.png"], save_all=True, append_images=[photo.rotate(5)])
    photo.save(materials["progressive.jpg"], progressive=True)
    whole = materials["progressive.jpg"].read_bytes()
    materials["progressive.jpg"].write_bytes(whole[: len(whole) * 3 // 4])
    photo.convert("F").save(materials["float.tif"])
    photo.save(materials["photo.webp"])
    exif = photo.getexif()
    exif[0x112] = 6
    photo.save(materials["on-its-side.jpg"], exif=exif)


def _write_odd_clips(materials: dict[str, Path], frames: list[Image]) -> None:
    """By name: encoder, pixels, frames a second, when each frame is shown (ms; None: regularly)."""
    kinds: dict[str, tuple[str, str, int, list[int] | None]] = {
        "deep.mkv": ("ffv1", "gray16le", FPS, None),
        "transparent.mov": ("prores_ks", "yuva444p10le", FPS, None),
        "moving.gif": ("gif", "rgb8", 10, None),
        "uneven.mkv": ("ffv1", "yuv420p", FPS, [0, 1, 5, 2000, 2001, 9000]),
        "single.mkv": ("ffv1", "bgra", FPS, [0]),
        "swift.mkv": ("ffv1", "yuv444p", 10_000, None),
    }
    for name, (encoder, pixels, fps, times_ms) in kinds.items():
        with av.open(str(materials[name]), "w") as clip:
            stream = clip.add_stream(encoder, rate=fps)
            stream.height, stream.width = frames[0].shape[:2]
            stream.pix_fmt = pixels
            if times_ms is not None:
                stream.codec_context.time_base = Fraction(1, 1000)
            for index, picture in enumerate(frames[: None if times_ms is None else len(times_ms)]):
                frame = av.VideoFrame.from_ndarray(picture, "bgr24")
                if times_ms is not None:
                    frame.pts, frame.time_base = times_ms[index], Fraction(1, 1000)
                clip.mux(stream.encode(frame))
            clip.mux(stream.encode(None))


def _film(path: Path, pictures: list[Image], container: str) -> None:
    """Another program's: MPEG-4 Part 2."""
    with av.open(str(path), "w", format=container) as clip:
        stream = clip.add_stream("mpeg4", rate=FPS)
        stream.height, stream.width = pictures[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        for picture in pictures:
            clip.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "bgr24")))
        clip.mux(stream.encode(None))


def _grow(path: Path, frames: list[Image]) -> None:
    """MJPEG, whose pictures may each have a size of their own."""
    with av.open(str(path), "w") as clip:
        stream = clip.add_stream("mjpeg", rate=FPS)
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt = "yuvj420p"
        stream.time_base = Fraction(1, FPS)
        clip.start_encoding()
        for index, picture in enumerate(frames):
            larger = cv2.resize(picture, None, fx=1 + index // 3, fy=1 + index // 3)
            packet = av.Packet(cv2.imencode(".jpg", larger)[1].tobytes())
            packet.stream, packet.pts, packet.dts, packet.time_base = stream, index, index, Fraction(1, FPS)
            packet.is_keyframe = True
            clip.mux(packet)

"""glTF files made by hand, as small as they can be: one quad of 1 m in the x-y plane, whatever else a test wants."""

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

CORNERS = np.float32([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
NORMALS = np.float32([(0, 0, 1)] * 4)
UVS = np.float32([(0, 1), (1, 1), (1, 0), (0, 0)])
TRIANGLES = np.uint16([(0, 1, 2), (0, 2, 3)])
KINDS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def png(rgba: tuple[int, ...], size: tuple[int, int] = (4, 4)) -> bytes:
    encoded = io.BytesIO()
    Image.new("RGBA" if len(rgba) == 4 else "RGB", size, rgba).save(encoded, "PNG")
    return encoded.getvalue()


class Document:
    """A glTF document that grows; arrays go into one buffer."""

    def __init__(self) -> None:
        self.buffer = b""
        self.more_buffers: list[dict[str, Any]] = []
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "accessors": [],
            "bufferViews": [],
            "meshes": [],
            "nodes": [],
            "scenes": [{"nodes": []}],
            "scene": 0,
        }

    def view(self, content: bytes) -> int:
        self.buffer += b"\0" * (-len(self.buffer) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(content)})
        self.buffer += content
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: np.ndarray, normalised: bool = False) -> int:
        columns = 1 if values.ndim == 1 else values.shape[1]
        self.json["accessors"].append(
            {
                "bufferView": self.view(np.ascontiguousarray(values).tobytes()),
                "componentType": KINDS[values.dtype.str[1:]],
                "count": len(values),
                "type": SHAPES[columns],
                "normalized": normalised,
            }
        )
        return len(self.json["accessors"]) - 1

    def quad(
        self, node: dict[str, Any] | None = None, material: dict[str, Any] | None = None, **attributes: int
    ) -> None:
        """A node with a quad of its own; attributes by their glTF names."""
        primitive: dict[str, Any] = {
            "attributes": {"POSITION": self.accessor(CORNERS), "NORMAL": self.accessor(NORMALS), **attributes},
            "indices": self.accessor(TRIANGLES.ravel()),
        }
        if material is not None:
            self.json.setdefault("materials", []).append(material)
            primitive["material"] = len(self.json["materials"]) - 1
        self.json["meshes"].append({"primitives": [primitive]})
        self.json["nodes"].append({"mesh": len(self.json["meshes"]) - 1, **(node or {})})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def texture(self, image: dict[str, Any]) -> dict[str, int]:
        """A texture of an image as glTF describes it; returns the reference to it."""
        self.json.setdefault("images", []).append(image)
        self.json.setdefault("textures", []).append({"source": len(self.json["images"]) - 1})
        return {"index": len(self.json["textures"]) - 1}

    def embedded(self, picture: bytes) -> dict[str, int]:
        return self.texture({"bufferView": self.view(picture), "mimeType": "image/png"})

    def save(self, path: Path) -> Path:
        """As GLB or, with its buffer as a data URI, as .gltf."""
        if path.suffix == ".gltf":
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
            buffers = [{"byteLength": len(self.buffer), "uri": uri}, *self.more_buffers]
            path.write_text(json.dumps({**self.json, "buffers": buffers}))
            return path
        text = json.dumps({**self.json, "buffers": [{"byteLength": len(self.buffer)}, *self.more_buffers]}).encode()
        text += b" " * (-len(text) % 4)
        binary = self.buffer + b"\0" * (-len(self.buffer) % 4)
        chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(binary), 0x004E4942) + binary
        path.write_bytes(struct.pack("<3I", 0x46546C67, 2, 12 + len(chunks)) + chunks)
        return path

"""What a model file may read beside itself: files of its own folder, small enough together, never a network."""

import io
import os
from pathlib import Path, PureWindowsPath
from urllib.parse import unquote

import trimesh
from PIL import Image as PillowImage

from ashe_live.errors import UserError
from ashe_live.files.reading import read_bytes
from ashe_live.models.limits import MAX_MATERIALS, MAX_NAMED_FILES
from ashe_live.models.obj_text import as_utf8

MATERIALS = ".mtl"
WITH_PICTURES_ONLY = (".obj", ".ply")  # what else these name is a picture


class FolderResolver(trimesh.resolvers.Resolver):
    """Lets a model file read what lies in its own folder, and remembers why it was refused something."""

    def __init__(self, model: Path, most_bytes: int) -> None:
        self.refusal: UserError | None = None
        self._model = model
        self._folder = model.parent.resolve()
        self._bytes_left = most_bytes
        self._named = 0

    def get(self, name: str) -> bytes:
        try:
            return self._get(name)
        except UserError as refusal:
            # trimesh goes on without a texture that it cannot get.
            self.refusal = self.refusal or refusal
            raise

    def _get(self, name: str) -> bytes:
        self._named += 1
        if self._named > MAX_NAMED_FILES:
            raise UserError(
                f"the model file {self._model} names files more than {MAX_NAMED_FILES:,} times", "export it with fewer"
            )
        relative = unquote(name.strip()).replace("\\", "/")
        # Before it is looked at: on Windows that of another machine would be asked for.
        is_elsewhere = bool(PureWindowsPath(relative).anchor) or "\0" in relative
        path = self._folder if is_elsewhere else Path(os.path.realpath(self._folder / relative))
        if is_elsewhere or not path.is_relative_to(self._folder):
            raise UserError(
                f"the model file {self._model} names {name}, outside its own folder", "put what it needs beside it"
            )
        is_materials = relative.lower().endswith(MATERIALS)
        if not os.path.lexists(path):
            if is_materials:
                raise FileNotFoundError(path)  # it is drawn in plain plastic
            raise UserError(
                f"the model file {self._model} names {name}, which is missing", "put what it needs beside it"
            )
        content = read_bytes(path, self._bytes_left)
        self._bytes_left -= len(content)
        if is_materials:
            if content.count(b"newmtl") > MAX_MATERIALS:
                raise UserError(f"{path} holds more than {MAX_MATERIALS:,} materials", "export it with fewer")
            return as_utf8(content)
        if self._model.suffix.lower() in WITH_PICTURES_ONLY:
            self._check_picture(name, content)
        return content

    def _check_picture(self, name: str, content: bytes) -> None:
        try:
            PillowImage.open(io.BytesIO(content)).close()
        except (OSError, ValueError, SyntaxError, PillowImage.DecompressionBombError):
            raise UserError(
                f"the model file {self._model} names {name}, which is no picture that can be read",
                "save it as PNG or JPEG",
            ) from None

    def keys(self) -> list[str]:
        raise NotImplementedError("only what is named is read")

    def namespaced(self, namespace: str) -> "FolderResolver":
        raise NotImplementedError(f"a model has one folder: {namespace}")

    def write(self, name: str, data: bytes) -> None:
        raise NotImplementedError(f"a model is only read: {name}, {len(data)} bytes")

"""Recognises a file's format by its first bytes: its suffix may be wrong, or a download may be no model at all."""

from pathlib import Path

from ashe_live.errors import UserError

# First bytes of files and the kinds that they tell; for formats that are read, the suffix that belongs to them.
SIGNATURES = {
    b"glTF": ".glb",
    b"ply\n": ".ply",
    b"ply\r": ".ply",
    b"\x89PNG": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"PK\x03\x04": "a ZIP archive",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive",
    b"Rar!": "a RAR archive",
    b"\x1f\x8b": "a file compressed by gzip",
    b"\x28\xb5\x2f\xfd": "a file compressed by Zstandard",
    b"Kaydara FBX": "FBX",
    b"BLENDER": "a file of Blender's",
    b"%PDF": "a PDF",
    b"<!DOCTYPE": "a page of the web",
    b"<html": "a page of the web",
    b"<?xml": "XML",
    b"version https://git-lfs": "a pointer of Git LFS, and not the file that it stands for",
}
BYTE_ORDER_MARKS = {b"\xef\xbb\xbf": "utf-8", b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}


def check_kind(path: Path, content: bytes) -> None:
    """Raises UserError for a file that is empty, or begins as a file of another kind than its suffix says does."""
    if not content:
        raise UserError(f"the model file {path} is empty", "copy or export it again")
    start = content[:64].lstrip().lower()
    for signature, kind in SIGNATURES.items():
        if start.startswith(signature.lower()) and kind != path.suffix.lower():
            if kind == ".glb" and path.suffix.lower() == ".gltf":
                return  # read by what it holds
            if kind.startswith("."):
                raise UserError(f"the model file {path} holds {kind[1:].upper()}", f"rename it to end in {kind}")
            raise UserError(f"the model file {path} holds {kind}", "export the model as GLB, OBJ, PLY or STL")


def in_utf8(content: bytes) -> bytes:
    """Text without its byte order mark, in UTF-8 where the mark says that it is in UTF-16."""
    for mark, encoding in BYTE_ORDER_MARKS.items():
        # A binary file may begin with these bytes as well; all formats' text begins with a plain letter or sign.
        first = content[len(mark) : len(mark) + (1 if encoding == "utf-8" else 2)].decode(encoding, "replace")
        if content.startswith(mark) and first.isascii() and first.isprintable():
            rest = content[len(mark) :]
            return rest if encoding == "utf-8" else rest.decode(encoding, "replace").encode()
    return content

"""Whether a file that the program wrote is whole: it can be read to its end by somebody else's reader."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import av
import jsonschema
import PIL.Image

SCHEMA = json.loads((Path(__file__).parents[3] / "docs" / "contract.schema.json").read_text(encoding="utf-8"))


def picture_count(path: Path) -> int:
    """How many pictures of a clip can be decoded. Raises what the decoder does about one that is broken."""
    with av.open(str(path.absolute())) as clip:
        return sum(1 for _ in clip.decode(video=0))


def defect(path: Path) -> str | None:
    """What is wrong with a file of one of the kinds that the program writes, None when it is whole."""
    check = CHECKS.get(path.suffix.lower())
    if check is None:
        return None
    try:
        return check(path)
    except Exception as error:  # whatever a reader raises, the file is not whole
        return f"{type(error).__name__}: {error}"


def _clip(path: Path) -> str | None:
    return None if picture_count(path) else "no picture in it"


def _picture(path: Path) -> str | None:
    with PIL.Image.open(path) as picture:
        picture.load()
    return None


def _pdf(path: Path) -> str | None:
    content = path.read_bytes()
    return None if content.startswith(b"%PDF") and content.rstrip().endswith(b"%%EOF") else "no whole PDF"


def _page(path: Path) -> str | None:
    return None if path.read_text(encoding="utf-8").rstrip().endswith("</html>") else "no whole page"


def _json(path: Path) -> str | None:
    content = json.loads(path.read_text(encoding="utf-8"), parse_constant=_no_number)
    if "summary" in content:
        jsonschema.validate(content, SCHEMA)
    return None


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is not JSON")


CHECKS: Mapping[str, Callable[[Path], str | None]] = {
    ".mp4": _clip,
    ".png": _picture,
    ".pdf": _pdf,
    ".html": _page,
    ".json": _json,
}

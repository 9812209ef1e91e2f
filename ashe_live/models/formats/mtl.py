"""MTL: what an OBJ's surfaces look like, in Phong's terms.

http://paulbourke.net/dataformats/mtl/
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.formats.mtl_lines import numbers_of, picture_of, text_of, without_comment
from ashe_live.models.material import PLAIN_LAYOUT, UNKNOWN, Alpha, MapLayout, Material
from ashe_live.models.parsing.kinds import in_utf8
from ashe_live.models.parsing.limits import check_materials
from ashe_live.models.parsing.notes import NAME_CHARACTERS, Notes
from ashe_live.models.parsing.pictures import Pictures, at_one_size, filled_beyond
from ashe_live.process.messages import printable

# The format does not say whether its colours are linear, and names no roughness. Most programs write sRGB. In Blender's
# files, which begin with these words, colours are linear, the exponent is 1000 (1 - roughness)^2, and where the model
# of illumination is one of mirrors the ambient colour is how much of a metal it is.
BLENDERS_FIRST_WORDS, BLENDERS_SHININESS, MIRRORS = b"# Blender", 1000.0, (3, 6)
COLOURS = {"ka": "ambient", "kd": "diffuse", "ke": "emission"}
DRAWN = ("map_kd", "map_d", "map_aat")  # the last asks for smooth edges
# Maps other than the diffuse one, of which none is drawn, with words for the notes.
NOT_DRAWN = {
    "map_bump": "bump maps",
    "bump": "bump maps",
    "map_kn": "normal maps",
    "norm": "normal maps",
    "map_ke": "maps of emission",
    "map_pr": "maps of roughness",
    "map_pm": "maps of metal",
    "map_ks": "maps of highlights",
    "map_ns": "maps of shininess",
    "map_ka": "maps of ambient light",
    "disp": "maps of relief",
    "decal": "decals",
    "refl": "maps of what it mirrors",
    "map_refl": "maps of what it mirrors",
}


@dataclass(slots=True)
class _Described:
    """One material's lines so far."""

    diffuse: tuple[float, ...] | None = None
    emission: tuple[float, ...] = (0.0, 0.0, 0.0)
    dissolve: float | None = None  # how opaque
    transparency: float | None = None
    shininess: float = 0.0
    ambient: tuple[float, ...] = (0.0, 0.0, 0.0)
    illumination: int = 2  # of the format's models, from 0 to 10
    roughness: float | None = None  # by names that were added to the format
    metallic: float | None = None
    picture: str = ""
    layout: MapLayout = PLAIN_LAYOUT  # of the picture
    cut_out: str = ""
    cut_out_layout: MapLayout = PLAIN_LAYOUT  # without a picture; else it lies as that does

    @property
    def opacity(self) -> float:
        """From 0 to 1: `d`, or else `Tr`, which is not of the format.

        Most programs mean transparency by it, and MeshLab opacity: 1 alone is what that writes for all that is opaque.
        """
        if self.dissolve is None:
            said = 1.0 if self.transparency is None or self.transparency >= 1 else 1 - self.transparency
        else:
            said = 1.0 if self.dissolve == self.transparency == 0 else self.dissolve  # one of both shows it
        return min(max(said, 0.0), 1.0)


def read_mtl(model: Path, content: bytes, pictures: Pictures, beside: str, notes: Notes) -> dict[str, Material]:
    """Materials of the file `model` by their names. `beside`: the MTL's folder in that of the model.

    Raises UserError for more materials or texels than the limit, MalformedError for a line that is no MTL.
    """
    described: dict[str, _Described] = {}
    one = _Described()
    count = 0
    content = in_utf8(content)
    for line in content.splitlines():
        word, rest = (*line.split(None, 1), b"", b"")[:2]
        # Each by itself, as the OBJ's names are: a path may be of another encoding, whose bytes may end lines of text.
        key = text_of(word).lower()
        value = text_of((without_comment(rest) if key in ("map_kd", "map_d") else rest).strip())
        if key == "newmtl":
            one = described[value] = _Described()
            count += 1
            check_materials(model, count)
        elif value:
            _take(one, key, value)
            if key in NOT_DRAWN:
                notes.add(f"{NOT_DRAWN[key]} of its materials are left out")
            elif key.startswith("map_") and key not in DRAWN:
                notes.add(f"{printable(key, NAME_CHARACTERS)} of its materials is left out")
    is_blenders = content.lstrip().startswith(BLENDERS_FIRST_WORDS)
    texels = partial(pictures.named, covers=True, beside=beside)
    return {name: _material(one, texels, pictures.made, is_blenders, notes) for name, one in described.items()}


def _take(one: _Described, key: str, value: str) -> None:
    if key in COLOURS:
        numbers = numbers_of(value)
        if len(numbers) in (1, 2):
            numbers = numbers[:1] * 3
        if len(numbers) >= 3:
            setattr(one, COLOURS[key], numbers[:3])
    elif key in ("d", "tr"):
        (*_, last) = numbers_of(value.replace("-halo", "")) or (None,)
        if last is not None:
            setattr(one, "dissolve" if key == "d" else "transparency", last)
    elif key == "ns":
        one.shininess = next(iter(numbers_of(value)), 0.0)
    elif key == "illum":
        one.illumination = int(next(iter(numbers_of(value)), 2))
    elif key == "pr":
        one.roughness = next(iter(numbers_of(value)), None)
    elif key == "pm":
        one.metallic = next(iter(numbers_of(value)), None)
    elif key == "map_kd":
        one.picture, one.layout = picture_of(value)
    elif key == "map_d":
        one.cut_out, one.cut_out_layout = picture_of(value)


def _material(
    one: _Described,
    texels: Callable[[str], Image | None],
    made: Callable[..., Image],
    is_blenders: bool,
    notes: Notes,
) -> Material:
    colours = np.clip([one.diffuse or (0.8, 0.8, 0.8), one.emission], 0, 1)
    (red, green, blue), (glow_red, glow_green, glow_blue) = (
        colours if is_blenders else linear_from_srgb(colours)
    ).tolist()
    roughness = _roughness(one.shininess, is_blenders) if one.roughness is None else one.roughness
    metallic = float(np.mean(one.ambient)) if is_blenders and one.illumination in MIRRORS else 0.0
    plain = replace(
        UNKNOWN,
        base_colour=(red, green, blue, one.opacity),
        emissive=(glow_red, glow_green, glow_blue),
        metallic=float(np.clip(metallic if one.metallic is None else one.metallic, 0, 1)),
        roughness=float(np.clip(roughness, 0, 1)),
        alpha=Alpha.BLEND if one.opacity < 1 else Alpha.OPAQUE,
    )
    return _with_pictures(plain, one, texels, made, notes)


def _with_pictures(
    plain: Material, one: _Described, texels: Callable[[str], Image | None], made: Callable[..., Image], notes: Notes
) -> Material:
    """`plain` with its picture, as far as its mask leaves that; with a mask alone, its own colour cut out."""
    base_map = texels(one.picture) if one.picture else None
    mask = texels(one.cut_out) if one.cut_out else None
    if one.picture and not any(plain.base_colour[:3]):
        # Some programs write black beside a picture, which may be missing.
        plain = replace(plain, base_colour=(*UNKNOWN.base_colour[:3], plain.base_colour[3]))
    if mask is not None:
        colours = np.full_like(mask, 255) if base_map is None else base_map
        cut_out = made(("cut out", id(base_map), id(mask)), partial(_cut_out, colours, mask))
        if base_map is None:
            alone = pictured(replace(plain, layouts={"base_map": one.cut_out_layout}), cut_out)
            return replace(alone, base_colour=plain.base_colour)
        if one.cut_out_layout != one.layout and cut_out is not base_map:
            notes.add(
                "a mask of holes (map_d) is enlarged, shifted and clamped as its picture is, and not by its options"
            )
        base_map = cut_out
    return plain if base_map is None else pictured(replace(plain, layouts={"base_map": one.layout}), base_map)


def _roughness(shininess: float, is_blenders: bool) -> float:
    """Roughness of a material with the exponent `Ns`."""
    if shininess <= 0 and not is_blenders:
        return UNKNOWN.roughness
    if is_blenders:
        return 1 - math.sqrt(min(max(shininess, 0.0), BLENDERS_SHININESS) / BLENDERS_SHININESS)
    # Phong's lobe of that exponent is about as wide as this roughness's.
    return math.sqrt(math.sqrt(2 / (shininess + 2)))


def _cut_out(colours: Image, mask: Image) -> Image:
    """(h, w, 4) uint8 with the mask's red as alpha, or its alpha where it has some."""
    # Of one picture for both its alpha is meant, which it has already.
    if colours[..., 3].min() < 255 or np.array_equal(colours, mask):
        return colours
    colours, mask = at_one_size(colours, mask)
    has_alpha = mask[..., 3].min() < 255
    return filled_beyond(np.dstack([colours[..., :3], mask[..., 3] if has_alpha else mask[..., 0]]))


def pictured(plain: Material, base_map: Image) -> Material:
    """`plain` with a picture in the place of its colour."""
    has_holes = base_map[..., 3].min() < 255
    return replace(
        plain,
        # OBJ exporters write an arbitrary grey beside a texture.
        base_colour=(1.0, 1.0, 1.0, plain.base_colour[3]),
        base_map=base_map,
        alpha=Alpha.CUT_OUT if has_holes and plain.alpha is Alpha.OPAQUE else plain.alpha,
    )

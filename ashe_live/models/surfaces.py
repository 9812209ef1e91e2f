"""From trimesh's materials and pictures to ours."""

from dataclasses import replace
from typing import Any

import numpy as np
from PIL import Image as PillowImage
from trimesh.visual.material import PBRMaterial, SimpleMaterial

from ashe_live.core.arrays import Image
from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.gltf_header import MAPS_OF_MATERIAL, MaterialNotes
from ashe_live.models.limits import MAX_TEXTURE_PX, check_decoded, check_picture, check_texels
from ashe_live.models.malformed import MalformedError
from ashe_live.models.material import BLACK, WHITE, Alpha, LinearRGBA, Material

# What formats without materials look like, and glTF meshes that name none: matt plastic. Many of their files have
# holes, so both sides are seen.
UNKNOWN = Material(roughness=0.7)
ALPHAS = {None: Alpha.OPAQUE, "OPAQUE": Alpha.OPAQUE, "MASK": Alpha.CUT_OUT, "BLEND": Alpha.BLEND}


class Surfaces:
    """Converts one file's materials; what is used several times is one value."""

    def __init__(self, notes: tuple[MaterialNotes, ...] = ()) -> None:
        self._notes = notes
        self._texels: dict[int, tuple[PillowImage.Image, Image]] = {}
        self._decoded = 0  # texels, of all pictures so far

    def material(self, visual: Any) -> Material:
        """Of a trimesh visual. Raises UserError when its textures are too large, MalformedError when one is damaged."""
        material = getattr(visual, "material", None)
        if isinstance(material, PBRMaterial):
            return self._metallic_roughness(material)
        if isinstance(material, SimpleMaterial):
            return self._simple(material)
        return UNKNOWN

    def uv_set(self, visual: Any) -> int:
        """Which of a glTF mesh's sets of texture coordinates most of its material is laid out with."""
        notes = self._notes_of(getattr(visual, "material", None))
        return notes.uv_set if notes else 0

    def _metallic_roughness(self, material: PBRMaterial) -> Material:
        notes = self._notes_of(material)
        maps: dict[str, Any] = {}
        for key, name in MAPS_OF_MATERIAL.items():
            picture = getattr(material, key)
            if picture is not None:
                maps[name] = self._reduced(picture, key)
            elif notes is not None and name in notes.uv_sets:
                raise MalformedError(f"its {key} cannot be read")
        factor = material.baseColorFactor
        emissive = material.emissiveFactor
        converted = Material(
            base_colour=WHITE if factor is None else _rgba(np.asarray(factor, dtype=np.float64) / 255),
            metallic=_clipped(material.metallicFactor, 1.0),
            roughness=_clipped(material.roughnessFactor, 1.0),
            emissive=BLACK if emissive is None else (emissive[0], emissive[1], emissive[2]),
            alpha=ALPHAS[material.alphaMode],
            alpha_cutoff=0.5 if material.alphaCutoff is None else float(material.alphaCutoff),
            double_sided=bool(material.doubleSided),
            **maps,
        )
        if notes is None:
            return converted
        # A mesh has one set of texture coordinates here.
        elsewhere: dict[str, Any] = {name: None for name, uv_set in notes.uv_sets.items() if uv_set != notes.uv_set}
        red, green, blue = (notes.emissive_strength * float(value) for value in converted.emissive)
        return replace(
            converted,
            normal_scale=notes.normal_scale,
            occlusion_strength=_clipped(notes.occlusion_strength, 1.0),
            emissive=(red, green, blue),
            **elsewhere,
        )

    def _simple(self, material: SimpleMaterial) -> Material:
        # For texture coordinates without a material trimesh makes a picture of its own, which no file had.
        is_there = material.image is not None and material.image.format is not None
        base_map = self._reduced(material.image, "texture") if is_there else None
        has_holes = base_map is not None and base_map[..., 3].min() < 255
        diffuse = np.asarray(material.diffuse, dtype=np.float64) / 255
        # OBJ exporters write an arbitrary grey beside a texture.
        colour = WHITE if base_map is not None else _rgba(np.append(linear_from_srgb(diffuse[:3]), diffuse[3]))
        shininess = float(np.ravel(material.glossiness)[0]) if material.glossiness is not None else 0.0
        return replace(
            UNKNOWN,
            base_colour=colour,
            base_map=base_map,
            # Phong's lobe of that exponent is about as wide as this roughness's.
            roughness=float(np.sqrt(np.sqrt(2 / (shininess + 2)))) if shininess > 0 else UNKNOWN.roughness,
            alpha=Alpha.BLEND if colour[3] < 1 else Alpha.CUT_OUT if has_holes else Alpha.OPAQUE,
        )

    def _notes_of(self, material: Any) -> MaterialNotes | None:
        return self._notes[int(material.name)] if self._notes and material is not None else None

    def _reduced(self, picture: PillowImage.Image, name: str) -> Image:
        """(h, w, 4) uint8 as the file has it, no side longer than MAX_TEXTURE_PX."""
        if id(picture) not in self._texels:
            check_picture(picture)
            # Before the conversion, which would make four channels of the large one.
            if max(picture.size) > MAX_TEXTURE_PX and picture.mode == "RGB":
                picture.draft("RGB", (MAX_TEXTURE_PX, MAX_TEXTURE_PX))
            self._decoded += picture.width * picture.height
            check_decoded(self._decoded)
            try:
                reduced = picture.convert("RGBA")
            except (MemoryError, UserError):
                raise
            except Exception:  # Pillow's decoders raise anything
                raise MalformedError(f"its {name} is damaged") from None
            reduced.thumbnail((MAX_TEXTURE_PX, MAX_TEXTURE_PX), PillowImage.Resampling.LANCZOS)
            # The picture is kept, as its id is only its own while it lives, but not its texels.
            picture.close()
            self._texels[id(picture)] = picture, np.asarray(reduced, dtype=np.uint8)
            check_texels(sum(texels.size // 4 for _, texels in self._texels.values()))
        return self._texels[id(picture)][1]


def _clipped(value: float | None, default: float) -> float:
    return default if value is None else min(max(float(value), 0.0), 1.0)


def _rgba(values: Any) -> LinearRGBA:
    red, green, blue, alpha = (float(value) for value in values)
    return red, green, blue, alpha

"""glTF's materials as ours: factors, maps with their layouts, and the extensions that can be said in the same terms."""

from collections.abc import Hashable
from typing import Any

import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.gltf.container import is_data, named_content
from ashe_live.models.gltf.maps import Maps, layout_of
from ashe_live.models.gltf.specular import SpecularGlossiness
from ashe_live.models.material import BLACK, UNKNOWN, WHITE, Alpha, LinearRGBA, MapLayout, Material, in_one_place
from ashe_live.models.parsing import basis
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import WITHOUT_COORDINATES, Notes
from ashe_live.models.parsing.pictures import Pictures, cleared, opaque

ALPHAS = {"OPAQUE": Alpha.OPAQUE, "MASK": Alpha.CUT_OUT, "BLEND": Alpha.BLEND}
SPECULAR_GLOSSINESS = "KHR_materials_pbrSpecularGlossiness"
# Coverage with which a pane that transmits everything is still drawn.
LEAST_COVER = 0.15


class GltfMaterials:
    """The materials of one file. Their pictures are read when they are asked for."""

    def __init__(self, header: Json, arrays: Arrays, folder: Folder, notes: Notes) -> None:
        self._header = header
        self._arrays = arrays
        self._folder = folder
        self._notes = notes
        self._pictures = Pictures(folder, notes)
        self._made: dict[tuple[int, frozenset[int]], tuple[Material, tuple[int, ...]]] = {}

    def material(self, place: int | None, uv_sets: frozenset[int]) -> tuple[Material, tuple[int, ...]]:
        """For a mesh that has those sets of texture coordinates; with which of them, at most MAP_SETS, it is laid out.

        Raises UserError when its textures are too large or missing, MalformedError when one is damaged.
        """
        if place is None:
            return UNKNOWN, ()
        key = place, uv_sets
        if key not in self._made:
            self._made[key] = self._converted(self._header["materials"][place], uv_sets)
        return self._made[key]

    def _converted(self, given: Json, uv_sets: frozenset[int]) -> tuple[Material, tuple[int, ...]]:
        """The material, and the sets of texture coordinates by which its maps are laid out, by the file's numbers."""
        extensions = given.get("extensions", {})
        maps, alpha = Maps(uv_sets), ALPHAS[given.get("alphaMode", "OPAQUE")]
        covers = alpha is not Alpha.OPAQUE
        if SPECULAR_GLOSSINESS in extensions:
            surface = self._specular_glossiness(extensions[SPECULAR_GLOSSINESS], maps, covers)
        else:
            surface = self._metallic_roughness(given.get("pbrMetallicRoughness", {}), maps, covers)
        for kind in ("normal", "occlusion", "emissive"):
            self._add(maps, f"{kind}_map", given, f"{kind}Texture")
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        is_lost = "emissiveTexture" in given and "emissive_map" not in maps.texels | maps.unplaced
        emissive = tuple(strength * value for value in given.get("emissiveFactor", BLACK))
        # Without its map all of the surface would glow.
        surface |= {"emissive": BLACK if is_lost else emissive, "alpha": alpha}
        surface = in_one_place(surface, maps.unplaced)
        surface |= self._see_through(extensions, surface, maps) | _coat(extensions)
        if "KHR_materials_unlit" in extensions:
            surface |= _shining(surface, maps)
        if maps.lacks_coordinates:
            self._notes.add(WITHOUT_COORDINATES)
        if maps.has_third_set:
            self._notes.add("maps that are laid out by a third set of texture coordinates are left out")
        material = Material(
            normal_scale=given.get("normalTexture", {}).get("scale", 1.0),
            occlusion_strength=given.get("occlusionTexture", {}).get("strength", 1.0),
            alpha_cutoff=given.get("alphaCutoff", 0.5),
            double_sided=given.get("doubleSided", False),
            layouts=maps.layouts,
            **surface,
            **maps.texels,
        )
        return material, tuple(maps.sets)

    def _metallic_roughness(self, given: Json, maps: Maps, covers: bool) -> dict[str, Any]:
        self._add(maps, "base_map", given, "baseColorTexture", covers)
        self._add(maps, "metallic_roughness_map", given, "metallicRoughnessTexture")
        # Without its map all of the surface would be metal.
        is_lost = "metallicRoughnessTexture" in given and "metallic_roughness_map" not in maps.texels | maps.unplaced
        return {
            "base_colour": tuple(given.get("baseColorFactor", WHITE)),
            "metallic": 0.0 if is_lost else given.get("metallicFactor", 1.0),
            "roughness": given.get("roughnessFactor", 1.0),
        }

    def _specular_glossiness(self, given: Json, maps: Maps, covers: bool) -> dict[str, Any]:
        diffuse, shine = given.get("diffuseTexture", {}), given.get("specularGlossinessTexture", {})
        layouts = [self._layout(texture) for texture in (diffuse, shine) if texture]
        are_apart = len(set(layouts)) > 1
        if are_apart:
            self._notes.add("a specular-glossiness map is laid out otherwise than its diffuse map, and averaged")
        surface = SpecularGlossiness(
            tuple(given.get("diffuseFactor", WHITE)),
            tuple(given.get("specularFactor", WHITE[:3])),
            given.get("glossinessFactor", 1.0),
            self._texels(diffuse, "diffuseTexture", covers) if diffuse else None,
            self._texels(shine, "specularGlossinessTexture") if shine else None,
        )
        converted = (surface.with_mean_shine() if are_apart else surface).as_metal_rough()
        for name, texels in (("base_map", converted.base_map), ("metallic_roughness_map", converted.roughness_map)):
            if texels is not None:
                key = SPECULAR_GLOSSINESS, name, str(given), covers
                maps.add(name, layouts[0], self._mirrored(self._shared(key, texels), layouts[0]))
        return {"base_colour": converted.base_colour, "metallic": converted.metallic, "roughness": converted.roughness}

    def _shared(self, key: Hashable, texels: Image) -> Image:
        """The texels, or those that have come under the same key before."""
        return self._pictures.made(key, lambda: texels)

    def _see_through(self, extensions: Json, surface: dict[str, Any], maps: Maps) -> dict[str, Any]:
        given, alpha = extensions.get("KHR_materials_transmission", {}), surface["alpha"]
        share = given.get("transmissionFactor", 0.0) * (1 - LEAST_COVER)
        if "metallic_roughness_map" not in maps.texels:
            share *= 1 - surface["metallic"]  # metal transmits nothing
        if share <= 0:
            return {}
        if alpha is Alpha.CUT_OUT:
            self._notes.add("what is cut out of it transmits no light")
            return {}
        self._notes.add("what it transmits is drawn as plain transparency, without refraction")
        is_opaque = alpha is Alpha.OPAQUE
        texture = given.get("transmissionTexture", {})
        if texture and (texels := self._texels(texture, "transmissionTexture")) is not None:
            layout = self._layout(texture)
            if maps.takes_base_map(layout):
                colours, mask = maps.texels.get("base_map"), self._mirrored(texels, layout)
                key = "cleared", id(colours), id(mask), share, is_opaque
                maps.add("base_map", layout, self._pictures.made(key, lambda: cleared(colours, mask, share, is_opaque)))
                share = 0.0
            else:
                share *= texels[..., 0].mean() / 255
        base_map = maps.texels.get("base_map")
        if is_opaque and share and base_map is not None:  # whose alpha is to be ignored
            maps.texels["base_map"] = self._pictures.made(("opaque", id(base_map)), lambda: opaque(base_map))
        red, green, blue, opacity = surface["base_colour"]
        return {"base_colour": (red, green, blue, (1.0 if is_opaque else opacity) * (1 - share)), "alpha": Alpha.BLEND}

    def _add(self, maps: Maps, name: str, given: Json, key: str, covers: bool = False) -> None:
        """Adds the map of a material's texture, if `given` has one by that key."""
        if not (texture := given.get(key)):
            return
        layout = self._layout(texture)
        if maps.takes(layout) and (texels := self._texels(texture, key, covers)) is not None:
            maps.add(name, layout, self._mirrored(texels, layout))

    def _mirrored(self, texels: Image, layout: MapLayout) -> Image:
        """Followed by its mirror image to the right and upwards, where every other repetition is one."""
        if not any(layout.mirrors):
            return texels

        def doubled() -> Image:
            across, upwards = layout.mirrors
            wide = np.hstack([texels, texels[:, ::-1]]) if across else texels
            return np.vstack([wide[::-1], wide]) if upwards else wide

        return self._pictures.made(("mirrored", id(texels), layout.mirrors), doubled)

    def _layout(self, texture: Json) -> MapLayout:
        """With the set of texture coordinates by the file's number."""
        sampler = self._header["textures"][texture["index"]].get("sampler")
        return layout_of(texture, {} if sampler is None else self._header["samplers"][sampler])

    def _texels(self, texture: Json, name: str, covers: bool = False) -> Image | None:
        """(h, w, 4) uint8 of a texture; None, with a note, where it has no picture that can be read.

        `covers` as in Pictures.texels.
        """
        found = self._header["textures"][texture["index"]]
        extensions = found.get("extensions", {})
        source = extensions.get("EXT_texture_webp", {}).get("source", found.get("source"))
        if source is None:
            source = extensions.get("KHR_texture_basisu", {}).get("source")
            if source is None:
                self._notes.add(f"a {name} names no image")
                return None
            if not basis.is_readable():
                self._notes.add(basis.LEFT_OUT)
                return None
        uri = self._header["images"][source].get("uri")
        if uri is None or is_data(uri):
            return self._pictures.texels(source, lambda: self._image(source, name), name, covers)
        return self._pictures.named(uri, name, covers)

    def _image(self, source: int, name: str) -> bytes:
        image = self._header["images"][source]
        if "uri" in image:
            return named_content(image["uri"], self._folder)
        if "bufferView" not in image:
            raise MalformedError(f"images[{source}], its {name}, has neither a uri nor a bufferView")
        return bytes(self._arrays.view(image["bufferView"]))


def _coat(extensions: Json) -> dict[str, Any]:
    """The clear coat by its factors; no coat where a map says how much of it there is, as that is not drawn."""
    given = extensions.get("KHR_materials_clearcoat", {})
    if "clearcoatTexture" in given:
        return {}
    return {"coat": given.get("clearcoatFactor", 0.0), "coat_roughness": given.get("clearcoatRoughnessFactor", 0.0)}


def _shining(surface: dict[str, Any], maps: Maps) -> dict[str, Any]:
    """KHR_materials_unlit: the base colour, as it is, whatever light there is."""
    base: LinearRGBA = surface["base_colour"]
    texels = maps.texels.get("base_map")
    for name in ("metallic_roughness_map", "normal_map", "occlusion_map", "emissive_map"):
        maps.texels.pop(name, None)
        maps.layouts.pop(name, None)
    if texels is not None:
        maps.texels["emissive_map"], maps.layouts["emissive_map"] = texels, maps.layouts["base_map"]
    shines = {"emissive": base[:3], "base_colour": (0.0, 0.0, 0.0, base[3]), "is_unlit": True}
    return shines | {"metallic": 0.0, "roughness": 1.0, "coat": 0.0}

"""Notes on features of a glTF file that are not drawn as it says."""

from collections.abc import Callable, Mapping

from ashe_live.models.parsing.json_kinds import LARGEST, Json
from ashe_live.models.parsing.notes import Notes
from ashe_live.process.messages import listed

PLAIN = {
    "KHR_materials_sheen": "sheen",
    "KHR_materials_iridescence": "iridescence",
    "KHR_materials_anisotropy": "anisotropy",
    "KHR_materials_diffuse_transmission": "diffuse transmission",
}
# Reflectance at normal incidence: every dielectric is drawn with that of glass; a note is made of this difference or
# more.
USUAL_REFLECTANCE, VISIBLE_REFLECTANCE = 0.04, 0.02
VISIBLE_SHARE, VISIBLE_TINT = 0.5, 0.1


def _refracts_otherwise(extensions: Json) -> bool:
    index = _number(extensions, "KHR_materials_ior", "ior", 1.5)
    if index < 1:  # 0: as if infinite
        return True
    return abs(((index - 1) / (index + 1)) ** 2 - USUAL_REFLECTANCE) > VISIBLE_REFLECTANCE


def _shines_otherwise(extensions: Json) -> bool:
    given = extensions.get("KHR_materials_specular")
    if not isinstance(given, dict):
        return False
    share = _number(extensions, "KHR_materials_specular", "specularFactor", 1.0)
    colour = given.get("specularColorFactor", [])
    tints = [each for each in colour if isinstance(each, int | float)] if isinstance(colour, list) else []
    is_mapped = "specularTexture" in given or "specularColorTexture" in given
    return is_mapped or abs(share - 1) > VISIBLE_SHARE or any(abs(each - 1) > VISIBLE_TINT for each in tints)


def _coat_has(extensions: Json, *maps: str) -> bool:
    given = extensions.get("KHR_materials_clearcoat", {})
    return given.get("clearcoatFactor", 0.0) > 0 and any(name in given for name in maps)


def _number(extensions: Json, name: str, key: str, usual: float) -> float:
    given = extensions.get(name)
    value = given.get(key, usual) if isinstance(given, dict) else usual
    # Nothing else has looked at it, and JSON's integers may be beyond the largest float.
    return float(value) if isinstance(value, int | float) and abs(value) <= LARGEST else usual


# Exporters write these for every material, mostly with values that change nothing.
SEEN_BY_VALUE: Mapping[str, Callable[[Json], bool]] = {
    "clear coats that a map limits": lambda each: _coat_has(each, "clearcoatTexture"),
    "the relief of clear coats": lambda each: _coat_has(each, "clearcoatNormalTexture", "clearcoatRoughnessTexture"),
    "refractive indices": _refracts_otherwise,
    "specular factors": _shines_otherwise,
    "the thickness of glass": lambda each: _number(each, "KHR_materials_volume", "thicknessFactor", 0.0) > 0,
    "dispersion": lambda each: _number(each, "KHR_materials_dispersion", "dispersion", 0.0) > 0,
}


def note_what_is_missing(document: Json, header: Json, notes: Notes) -> None:
    """From the whole document and from the part of it that `checked` has passed."""
    used = [material.get("extensions", {}) for material in document.get("materials", [])]
    plain = [words for name, words in PLAIN.items() if any(name in extensions for extensions in used)]
    plain += [words for words, is_seen in SEEN_BY_VALUE.items() if any(map(is_seen, used))]
    if plain:
        notes.add(f"it is drawn without {listed(plain)}")
    channels = [channel for animation in header["animations"] for channel in animation["channels"]]
    if any(channel["target"]["path"] == "pointer" for channel in channels):
        notes.add("what its animation does beside moving things is left out")
    nodes = document.get("nodes", [])
    if any("KHR_lights_punctual" in (node.get("extensions") or ()) for node in nodes):
        notes.add("its own lights are left out")
    if len(header["scenes"]) > 1:
        notes.add(f"one of its {len(header['scenes'])} scenes is shown")

"""Materials beyond metallic-roughness as it is: moved maps, older and plainer models, deep pictures, wrapping."""

import io
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.gltf.maps import layout_of
from ashe_live.models.gltf.materials import LEAST_COVER
from ashe_live.models.gltf.specular import SpecularGlossiness
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import BLACK, Alpha, MapLayout, Material
from ashe_live.models.mesh import Model
from ashe_live.models.parsing.limits import MAX_TEXTURE_PX
from ashe_live.models.parsing.notes import WITHOUT_COORDINATES
from tests.models.gltf_files import UVS, Document, png

RED, GREEN, BLUE, WHITE = (255, 0, 0, 255), (0, 255, 0, 255), (0, 0, 255, 255), (255, 255, 255, 255)


def quarters() -> bytes:
    """A picture of 2 x 2 texels: red and green above, blue and white below."""
    encoded = io.BytesIO()
    Image.fromarray(np.array([[RED, GREEN], [BLUE, WHITE]], np.uint8)).save(encoded, "PNG")
    return encoded.getvalue()


def quad_of(tmp_path: Path, material: dict, document: Document | None = None, **extra) -> Model:
    document = document or Document()
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    document.json |= extra
    return load_model_file(document.save(tmp_path / "quad.glb"))


def colour_at(material: Material, uv_top_left: tuple[float, float], name: str = "base_map") -> tuple[int, ...]:
    """The texel that glTF coordinates, from the top left, lead to; looked up as a graphics card does."""
    layout, texels = material.layout(name), material.maps[name]
    u, v = np.array(layout.matrix).reshape(2, 3) @ (uv_top_left[0], 1 - uv_top_left[1], 1)
    height, width = texels.shape[:2]
    across, up = (
        (share % 1 if repeats else min(max(share, 0), 1 - 1e-9))
        for share, repeats in zip((u, v), layout.repeats, strict=True)
    )
    return tuple(texels[height - 1 - int(up * height), int(across * width)])


def moved(document: Document, transform: dict, sampler: dict | None = None) -> dict:
    texture = document.embedded(quarters())
    if sampler is not None:
        document.json["samplers"] = [sampler]
        document.json["textures"][0]["sampler"] = 0
    transformed = {**texture, "extensions": {"KHR_texture_transform": transform}}
    return {"pbrMetallicRoughness": {"baseColorTexture": transformed}}


def test_a_map_is_moved_turned_and_scaled(tmp_path: Path) -> None:
    """The extension's own example: the lower left quarter, turned by 90 degrees."""
    document = Document()
    transform = {"offset": [0, 1], "rotation": math.pi / 2, "scale": [0.5, 0.5]}
    material = (
        quad_of(tmp_path, moved(document, transform), document, extensionsRequired=["KHR_texture_transform"])
        .parts[0]
        .material
    )
    for uv in ((0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9)):
        assert colour_at(material, uv) == BLUE
    document = Document()
    material = quad_of(tmp_path, moved(document, {"offset": [0, 1], "scale": [1, -1]}), document).parts[0].material
    assert [colour_at(material, uv) for uv in ((0.2, 0.2), (0.8, 0.2), (0.2, 0.8))] == [BLUE, WHITE, RED]
    document = Document()
    material = quad_of(tmp_path, moved(document, {"rotation": math.pi / 2, "offset": [0, 1]}), document)
    # The picture is turned clockwise: what was at the bottom left is at the top left.
    assert colour_at(material.parts[0].material, (0.2, 0.2)) == BLUE
    assert colour_at(material.parts[0].material, (0.8, 0.2)) == RED


def test_a_map_is_scaled_then_turned_then_moved() -> None:
    """The extension's product of matrices, whose coordinates begin at the top left."""
    transform = {"offset": [0.3, -0.2], "rotation": 0.7, "scale": [2.0, 0.5]}
    cosine, sine = math.cos(0.7), math.sin(0.7)
    placed = np.array([[1, 0, 0.3], [0, 1, -0.2], [0, 0, 1]])
    turned = np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    upside_down = np.array([[1, 0, 0], [0, -1, 1], [0, 0, 1]])
    expected = upside_down @ placed @ turned @ np.diag((2.0, 0.5, 1.0)) @ upside_down
    layout = layout_of({"extensions": {"KHR_texture_transform": transform}}, {"wrapS": 33071})
    np.testing.assert_allclose(np.reshape(layout.matrix, (2, 3)), expected[:2], atol=1e-12)
    assert layout.repeats == (False, True)


def test_what_a_material_does_not_say_is_as_the_format_has_it(tmp_path: Path) -> None:
    material = quad_of(tmp_path, {"alphaMode": "MASK"}).parts[0].material
    assert (material.base_colour, material.metallic, material.roughness) == ((1, 1, 1, 1), 1, 1)
    assert (material.normal_scale, material.occlusion_strength, material.emissive) == (1, 1, (0, 0, 0))
    assert (material.alpha_cutoff, material.double_sided, material.coat) == (0.5, False, 0)


def test_what_glows_without_a_map_glows_by_its_factor_and_strength(tmp_path: Path) -> None:
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}
    material = quad_of(tmp_path, {"emissiveFactor": [0.5, 0.25, 1], "extensions": strength}).parts[0].material
    assert material.emissive == (2, 1, 4)


def test_a_picture_in_webp_is_read_and_not_the_one_that_stands_for_it(tmp_path: Path) -> None:
    """EXT_texture_webp: the texture's own source is for programs that do not know it."""
    document = Document()
    encoded = io.BytesIO()
    Image.new("RGB", (4, 4), (0, 0, 255)).save(encoded, "WEBP", lossless=True)
    texture, webp = document.embedded(png(RED)), document.embedded(encoded.getvalue())
    document.json["textures"][0]["extensions"] = {"EXT_texture_webp": {"source": webp["index"]}}
    material = quad_of(tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": texture}}, document).parts[0].material
    assert (material.base_map == BLUE).all()


def test_a_texture_without_an_image_is_said(tmp_path: Path) -> None:
    given = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    model = quad_of(tmp_path, given, textures=[{}])
    assert model.parts[0].material.base_map is None
    assert model.notes == ("a baseColorTexture names no image",)


@pytest.mark.parametrize(
    ("wrap", "beyond"), [(10497, (RED, GREEN)), (33071, (GREEN, GREEN)), (33648, (GREEN, RED)), (None, (RED, GREEN))]
)
def test_what_lies_beyond_a_map_is_as_its_sampler_says(tmp_path: Path, wrap: int | None, beyond: tuple) -> None:
    document = Document()
    sampler = {} if wrap is None else {"wrapS": wrap, "wrapT": wrap, "magFilter": 9728}
    material = quad_of(tmp_path, moved(document, {}, sampler), document).parts[0].material
    assert (colour_at(material, (0.2, 0.2)), colour_at(material, (0.8, 0.8))) == (RED, WHITE)
    assert (colour_at(material, (1.2, 0.2)), colour_at(material, (1.8, 0.2))) == beyond
    down = {10497: BLUE, 33071: BLUE, 33648: RED, None: BLUE}[wrap]
    assert colour_at(material, (0.2, 1.8 if wrap != 33071 else 5.0)) == down
    assert material.layout("base_map").is_sharp == (wrap is not None)


@pytest.mark.parametrize(("across", "down"), [(True, False), (False, True), (True, True)])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.5, 0.0), (0.5, -0.5), (-1.5, 2.5)])
def test_what_is_mirrored_and_moved_is_where_the_format_says(tmp_path: Path, across: bool, down: bool, offset) -> None:
    """The transform comes first, then what the sampler does beyond the picture."""
    texels = (RED, GREEN), (BLUE, WHITE)
    document = Document()
    sampler = {"wrapS": 33648 if across else 10497, "wrapT": 33648 if down else 10497}
    material = quad_of(tmp_path, moved(document, {"offset": list(offset)}, sampler), document).parts[0].material
    for u in np.arange(-1.75, 2, 0.5):
        for v in np.arange(-1.75, 2, 0.5):
            x, y = u + offset[0], v + offset[1]
            column = abs(x - 2 * round(x / 2)) if across else x % 1
            row = abs(y - 2 * round(y / 2)) if down else y % 1
            assert colour_at(material, (u, v)) == texels[int(row > 0.5)][int(column > 0.5)]


def test_a_map_as_it_is_has_the_plain_layout(tmp_path: Path) -> None:
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.embedded(quarters())}}
    layout = quad_of(tmp_path, material, document).parts[0].material.layout("base_map")
    assert layout == MapLayout()
    assert layout.is_plain


def metal_and_gloss(tmp_path: Path, **extension) -> Material:
    given = {"extensions": {"KHR_materials_pbrSpecularGlossiness": extension}}
    return quad_of(tmp_path, given).parts[0].material


def reflected(material: Material) -> tuple[np.ndarray, np.ndarray]:
    """Diffuse and specular colour of a metallic-roughness material: appendix B of the specification."""
    base = np.array(material.base_colour[:3])
    return base * (1 - material.metallic), 0.04 + (base - 0.04) * material.metallic


def test_gold_is_metal_and_red_plastic_is_none(tmp_path: Path) -> None:
    gold, red = (1.0, 0.77, 0.34), (0.8, 0.1, 0.05)
    material = metal_and_gloss(tmp_path, diffuseFactor=[0, 0, 0, 1], specularFactor=gold, glossinessFactor=0.7)
    diffuse, specular = reflected(material)
    np.testing.assert_allclose(diffuse, 0, atol=0.01)
    np.testing.assert_allclose(specular, gold, atol=0.02)
    assert material.roughness == pytest.approx(0.3)
    material = metal_and_gloss(tmp_path, diffuseFactor=[*red, 1], specularFactor=[0.04] * 3, glossinessFactor=0.2)
    diffuse, specular = reflected(material)
    np.testing.assert_allclose(diffuse, red, atol=0.01)
    np.testing.assert_allclose(specular, 0.04, atol=0.005)


@pytest.mark.parametrize("base", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("metal", [0.0, 0.25, 0.6, 1.0])
def test_grey_of_any_share_of_metal_is_the_same_in_either_kind(base: float, metal: float) -> None:
    """Appendix B's mixture in terms of the older kind, whose diffuse colour has what its specular one leaves."""
    specular = 0.04 + (base - 0.04) * metal
    diffuse = base * (1 - metal) * (1 - 0.04) / (1 - specular)
    made = SpecularGlossiness((*[diffuse] * 3, 1.0), (specular,) * 3, 0.25, None, None).as_metal_rough()
    assert (made.metallic, made.roughness) == pytest.approx((metal, 0.75), abs=2e-3)
    np.testing.assert_allclose(made.base_colour[:3], base, atol=2e-3)


def test_specular_glossiness_is_converted_texel_by_texel() -> None:
    """Half gold, half white plastic."""
    diffuse = np.full((2, 2, 4), 255, np.uint8)
    diffuse[:, 0, :3] = 0
    shine = np.full((2, 2, 4), 255, np.uint8)
    shine[:, 0], shine[:, 1] = (255, 200, 120, 204), (56, 56, 56, 51)
    made = SpecularGlossiness((1.0, 0.5, 1.0, 0.5), (1.0, 1.0, 1.0), 1.0, diffuse, shine).as_metal_rough()
    assert (made.metallic, made.roughness) == (1, 1)  # as both lie in the map
    np.testing.assert_array_equal(made.roughness_map[0, :, 1], (255 - 204, 255 - 51))
    np.testing.assert_allclose(made.roughness_map[0, :, 2], (255, 0), atol=1)
    np.testing.assert_allclose(
        linear_from_srgb(made.base_map[0, 0, :3] / 255), linear_from_srgb(np.array((255, 200, 120)) / 255), atol=0.01
    )
    assert made.base_map[0, 1, 0] > 250
    assert linear_from_srgb(made.base_map[0, 1, 1] / 255) == pytest.approx(0.5, abs=0.01)
    assert made.base_colour[3] == 0.5


def test_maps_of_the_older_kind_arrive(tmp_path: Path) -> None:
    document = Document()
    old = {
        "diffuseTexture": document.embedded(png(BLUE)),
        "specularFactor": [0.04] * 3,
        "specularGlossinessTexture": document.embedded(png((255, 255, 255, 128))),
    }
    material = (
        quad_of(tmp_path, {"extensions": {"KHR_materials_pbrSpecularGlossiness": old}}, document).parts[0].material
    )
    assert tuple(material.base_map[0, 0]) == pytest.approx(BLUE, abs=1)
    assert (material.metallic, material.roughness) == pytest.approx((0, 1 - 128 / 255), abs=0.01)
    half_glossy = io.BytesIO()
    Image.fromarray(np.uint8([[(255, 255, 255, 128), (255, 255, 255, 255)]])).save(half_glossy, "PNG")
    old["specularGlossinessTexture"] = document.embedded(half_glossy.getvalue())
    model = quad_of(tmp_path, {"extensions": {"KHR_materials_pbrSpecularGlossiness": old}}, document)
    assert model.notes == ()
    (shine,) = (
        part.material.metallic_roughness_map for part in model.parts if part.material.maps.keys() > {"base_map"}
    )
    np.testing.assert_array_equal(shine[0, [0, -1], 1], (127, 0))


def test_a_map_of_the_older_kind_that_is_laid_out_otherwise_is_averaged_and_said(tmp_path: Path) -> None:
    document = Document()
    encoded = io.BytesIO()
    Image.fromarray(np.uint8([[(188, 188, 188, 0), (188, 188, 188, 102)]])).save(encoded, "PNG")
    transform = {"KHR_texture_transform": {"scale": [2, 2]}}
    shine = {**document.embedded(encoded.getvalue()), "extensions": transform}
    old = {
        "diffuseTexture": document.embedded(png((0, 0, 0, 255))),
        "specularFactor": [1.0, 0.8, 0.4],
        "glossinessFactor": 0.5,
        "specularGlossinessTexture": shine,
    }
    model = quad_of(tmp_path, {"extensions": {"KHR_materials_pbrSpecularGlossiness": old}}, document)
    assert model.notes == ("a specular-glossiness map is laid out otherwise than its diffuse map, and averaged",)
    material = model.parts[0].material
    assert (material.metallic, material.roughness) == pytest.approx((1, 1 - 0.5 * 0.2), abs=0.01)
    seen = linear_from_srgb(material.base_map[0, 0, :3] / 255)
    np.testing.assert_allclose(seen, linear_from_srgb(188 / 255) * np.array((1.0, 0.8, 0.4)), atol=0.02)


def test_a_picture_that_is_nowhere_is_said(tmp_path: Path) -> None:
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.texture({"mimeType": "image/png"})}}
    with pytest.raises(UserError, match=r"images\[0\], its baseColorTexture, has neither a uri nor a bufferView"):
        quad_of(tmp_path, material, document)


def test_grey_of_16_bits_keeps_its_steps(tmp_path: Path) -> None:
    ramp = np.linspace(0, 65535, 16).astype(np.uint16).reshape(1, 16)
    encoded = io.BytesIO()
    Image.fromarray(ramp).save(encoded, "PNG")
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.embedded(encoded.getvalue())}}
    texels = quad_of(tmp_path, material, document).parts[0].material.base_map
    np.testing.assert_allclose(texels[0, :, 0], ramp[0] / 257, atol=0.51)
    assert (texels[..., 3] == 255).all()


@pytest.mark.parametrize("has_picture", [True, False])
def test_unlit_shines_in_its_own_colour_alone(tmp_path: Path, has_picture: bool) -> None:
    document = Document()
    red, blue = document.embedded(png(RED)), document.embedded(png(BLUE))
    surface = {"baseColorFactor": [0.5, 1, 0.25, 1], "metallicRoughnessTexture": blue}
    unlit = {
        "pbrMetallicRoughness": surface | ({"baseColorTexture": red} if has_picture else {}),
        **dict.fromkeys(("normalTexture", "occlusionTexture", "emissiveTexture"), blue),
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_clearcoat": {"clearcoatFactor": 1}},
    }
    material = quad_of(tmp_path, unlit, document).parts[0].material
    assert material.is_unlit
    assert material.emissive == (0.5, 1, 0.25)
    assert material.base_colour[:3] == BLACK
    assert (material.metallic, material.roughness, material.coat) == (0, 1, 0)
    assert set(material.maps) == ({"base_map", "emissive_map"} if has_picture else set())
    assert not has_picture or (material.emissive_map == RED).all()


NO_METAL = {"pbrMetallicRoughness": {"metallicFactor": 0}}
ALL_TRANSMITTED = {"KHR_materials_transmission": {"transmissionFactor": 1.0}}


def test_glass_lets_through_and_says_how_it_is_drawn(tmp_path: Path) -> None:
    model = quad_of(tmp_path, NO_METAL | {"extensions": ALL_TRANSMITTED})
    material = model.parts[0].material
    assert material.alpha is Alpha.BLEND
    assert material.base_colour[3] == pytest.approx(LEAST_COVER)
    assert model.notes == ("what it transmits is drawn as plain transparency, without refraction",)


def test_metal_transmits_nothing(tmp_path: Path) -> None:
    model = quad_of(tmp_path, {"pbrMetallicRoughness": {"metallicFactor": 1}, "extensions": ALL_TRANSMITTED})
    assert model.parts[0].material.alpha is Alpha.OPAQUE
    assert model.notes == ()


def test_glass_may_have_a_map_that_says_it_is_no_metal(tmp_path: Path) -> None:
    """The factor beside a map is 1 by rule."""
    document = Document()
    given = {"metallicRoughnessTexture": document.embedded(png((0, 51, 0)))}
    model = quad_of(tmp_path, {"pbrMetallicRoughness": given, "extensions": ALL_TRANSMITTED}, document)
    assert model.parts[0].material.alpha is Alpha.BLEND


@pytest.mark.parametrize(("mode", "opacity"), [("OPAQUE", LEAST_COVER), ("BLEND", LEAST_COVER * 0.4 * 100 / 255)])
def test_what_is_blended_transmits_as_well_and_what_is_opaque_ignores_its_pictures_alpha(tmp_path, mode, opacity):
    document = Document()
    faint = io.BytesIO()
    Image.new("RGBA", (4, 4), (200, 0, 0, 100)).save(faint, "PNG")
    surface = {
        "metallicFactor": 0,
        "baseColorTexture": document.embedded(faint.getvalue()),
        "baseColorFactor": [1, 1, 1, 0.4],
    }
    given = {"pbrMetallicRoughness": surface, "alphaMode": mode, "extensions": ALL_TRANSMITTED}
    material = quad_of(tmp_path, given, document).parts[0].material
    assert material.alpha is Alpha.BLEND
    assert material.base_colour[3] * material.base_map[0, 0, 3] / 255 == pytest.approx(opacity, rel=0.01)


def test_what_is_cut_out_of_glass_is_said_to_transmit_nothing(tmp_path: Path) -> None:
    model = quad_of(tmp_path, NO_METAL | {"alphaMode": "MASK", "extensions": ALL_TRANSMITTED})
    assert model.parts[0].material.alpha is Alpha.CUT_OUT
    assert model.notes == ("what is cut out of it transmits no light",)


@pytest.mark.parametrize("colours_px", [(4, 4), (1, 1), None])
def test_only_what_its_map_says_is_glass(tmp_path: Path, colours_px: tuple[int, int] | None) -> None:
    """KHR_materials_transmission: the factor times the map's red; the rest of the surface is opaque."""
    mask = np.zeros((2, 4, 3), np.uint8)
    mask[:, 2:, 0] = 255
    encoded = io.BytesIO()
    Image.fromarray(mask).save(encoded, "PNG")
    document = Document()
    glass = {"transmissionFactor": 1.0, "transmissionTexture": document.embedded(encoded.getvalue())}
    surface = {"metallicFactor": 0}
    if colours_px is not None:
        surface["baseColorTexture"] = document.embedded(png((200, 0, 0), colours_px))
    document.quad(
        material={"extensions": {"KHR_materials_transmission": glass}, "pbrMetallicRoughness": surface},
        TEXCOORD_0=document.accessor(UVS),
    )
    material = load_model_file(document.save(tmp_path / "window.glb")).parts[0].material
    assert material.alpha is Alpha.BLEND
    shares = material.base_colour[3] * material.base_map[..., 3] / 255
    width = material.base_map.shape[1]
    np.testing.assert_allclose(shares[:, 0], 1)
    np.testing.assert_allclose(shares[:, width - 1], LEAST_COVER, atol=0.01)
    assert tuple(material.base_map[0, 0, :3]) == ((255, 255, 255) if colours_px is None else (200, 0, 0))


@pytest.mark.parametrize(
    ("has_colours", "sets", "layout"),
    [
        (True, 1, {"extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}),
        (True, 2, {"texCoord": 1}),
        (True, 1, {"texCoord": 1}),  # which the mesh does not have
        (False, 1, {"texCoord": 1}),
    ],
)
def test_glass_whose_map_is_laid_out_otherwise_than_its_colours_is_as_clear_as_the_map_on_average(
    tmp_path: Path, has_colours: bool, sets: int, layout: dict
) -> None:
    document = Document()
    glass = {"transmissionFactor": 1.0, "transmissionTexture": {**document.embedded(png((51, 0, 0))), **layout}}
    surface = {"metallicFactor": 0}
    if has_colours:
        surface["baseColorTexture"] = document.embedded(png((200, 0, 0)))
    given = {"extensions": {"KHR_materials_transmission": glass}, "pbrMetallicRoughness": surface}
    document.quad(material=given, **{f"TEXCOORD_{number}": document.accessor(UVS) for number in range(sets)})
    material = load_model_file(document.save(tmp_path / "quad.glb")).parts[0].material
    assert material.base_map is None or (material.base_map[..., 3] == 255).all()
    assert material.base_colour[3] == pytest.approx(1 - 51 / 255 * (1 - LEAST_COVER))


def test_what_is_drawn_without_is_said_once(tmp_path: Path) -> None:
    plain = {"KHR_materials_iridescence": {}, "KHR_materials_sheen": {}, "KHR_materials_ior": {}}
    document = Document()
    document.quad(material={"extensions": plain})
    model = quad_of(tmp_path, {"extensions": plain}, document, extensionsRequired=["KHR_materials_sheen"])
    assert model.notes == ("it is drawn without sheen and iridescence",)


@pytest.mark.parametrize(
    ("maps", "coat", "notes"),
    [
        ((), 0.8, ()),
        (("clearcoatTexture",), 0.0, ("it is drawn without clear coats that a map limits",)),
        (("clearcoatNormalTexture",), 0.8, ("it is drawn without the relief of clear coats",)),
    ],
)
def test_clear_coats_are_read_and_what_maps_say_of_them_is_reported(
    tmp_path: Path, maps: tuple[str, ...], coat: float, notes: tuple[str, ...]
) -> None:
    document = Document()
    given = {"clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.3}
    given |= {name: document.embedded(png(RED)) for name in maps}
    model = quad_of(tmp_path, {"extensions": {"KHR_materials_clearcoat": given}}, document)
    material = model.parts[0].material
    assert material.coat == coat
    assert coat == 0 or material.coat_roughness == 0.3
    assert model.notes == notes


@pytest.mark.parametrize(
    ("extension", "given", "words"),
    [
        ("KHR_materials_ior", {"ior": 1.45}, None),
        ("KHR_materials_ior", {"ior": 2.42}, "refractive indices"),
        ("KHR_materials_ior", {"ior": 1}, "refractive indices"),
        ("KHR_materials_ior", {"ior": 0}, "refractive indices"),
        ("KHR_materials_ior", {"ior": 10**400}, None),
        ("KHR_materials_specular", {"specularColorFactor": [1.0, 1.0, 1.0]}, None),
        ("KHR_materials_specular", {"specularFactor": 0}, "specular factors"),
        ("KHR_materials_specular", {"specularColorFactor": [1.0, 0.2, 0.2]}, "specular factors"),
        ("KHR_materials_specular", {"specularTexture": {"index": 0}}, "specular factors"),
        ("KHR_materials_specular", {"specularColorTexture": {"index": 0}}, "specular factors"),
        ("KHR_materials_clearcoat", {"clearcoatFactor": 0, "clearcoatNormalTexture": {"index": 0}}, None),
        ("KHR_materials_volume", {"thicknessFactor": 0}, None),
        ("KHR_materials_volume", {"thicknessFactor": 0.02}, "the thickness of glass"),
        ("KHR_materials_dispersion", {"dispersion": 0.1}, "dispersion"),
    ],
)
def test_what_would_be_seen_is_said_and_what_would_not_is_not(tmp_path, extension, given, words):
    model = quad_of(tmp_path, {"extensions": {extension: given}})
    assert model.notes == (() if words is None else (f"it is drawn without {words}",))


@pytest.mark.parametrize("wrap", [10497, 33071])
def test_a_picture_without_texture_coordinates_is_one_colour_and_said(tmp_path: Path, wrap: int) -> None:
    """At (0, 0), as a card looks it up: repeated, that is between the picture's corners; clamped, the first of them."""
    document = Document()
    texture = document.embedded(quarters())
    document.json["samplers"] = [{"wrapS": wrap, "wrapT": wrap}]
    document.json["textures"][0]["sampler"] = 0
    document.quad(
        material={
            "pbrMetallicRoughness": {"baseColorTexture": texture, "metallicRoughnessTexture": texture},
            "emissiveTexture": texture,
            "emissiveFactor": [0.5, 1.0, 1.0],
        }
    )
    model = load_model_file(document.save(tmp_path / "bare.glb"))
    material = model.parts[0].material
    corners = np.array([RED, GREEN, BLUE, WHITE]) / 255
    expected = corners.mean(axis=0) if wrap == 10497 else corners[0]
    assert material.maps == {}
    np.testing.assert_allclose(material.base_colour, expected)
    np.testing.assert_allclose((material.roughness, material.metallic), expected[1:3])
    np.testing.assert_allclose(material.emissive, expected[:3] * (0.5, 1, 1))
    assert model.notes == (WITHOUT_COORDINATES,)


@pytest.mark.parametrize(("mode", "beyond"), [("MASK", (200, 40, 30)), ("BLEND", (200, 40, 30)), ("OPAQUE", (0, 0, 0))])
def test_texels_beyond_a_cut_out_have_its_colour(tmp_path: Path, mode: str, beyond: tuple[int, int, int]) -> None:
    """Filtering mixes them in: black ones would draw a dark line around it."""
    texels = np.zeros((21, 34, 4), np.uint8)
    texels[3:9, 5:8] = 200, 40, 30, 255
    encoded = io.BytesIO()
    Image.fromarray(texels).save(encoded, "PNG")
    document = Document()
    textured = {"baseColorTexture": document.embedded(encoded.getvalue())}
    part = quad_of(tmp_path, {"alphaMode": mode, "pbrMetallicRoughness": textured}, document).parts[0]
    assert part.material.base_map is not None
    np.testing.assert_array_equal(part.material.base_map[..., 3], texels[..., 3])
    np.testing.assert_array_equal(np.unique(part.material.base_map[texels[..., 3] == 0][:, :3], axis=0), [beyond])


@pytest.mark.parametrize("name", ["base_map", "metallic_roughness_map", "normal_map", "emissive_map"])
def test_large_pictures_keep_their_colours_where_alpha_is_nothing(tmp_path: Path, name: str) -> None:
    """3.9.2, 3.9.4: alpha is ignored where the material is opaque, and no other map has one."""
    document = Document()
    texture = document.embedded(png((200, 100, 50, 0), (2 * MAX_TEXTURE_PX, 2)))
    materials = {
        "base_map": {"pbrMetallicRoughness": {"baseColorTexture": texture}},
        "metallic_roughness_map": {"pbrMetallicRoughness": {"metallicRoughnessTexture": texture}},
        "normal_map": {"normalTexture": texture},
        "emissive_map": {"emissiveTexture": texture, "emissiveFactor": [1, 1, 1]},
    }
    texels = quad_of(tmp_path, materials[name], document).parts[0].material.maps[name]
    assert texels.shape[1] == MAX_TEXTURE_PX
    np.testing.assert_array_equal(np.unique(texels[..., :3].reshape(-1, 3), axis=0), [(200, 100, 50)])


def test_large_cut_outs_have_no_dark_rims(tmp_path: Path) -> None:
    """What nobody sees, which is black as a rule, is not averaged with what is seen."""
    texels = np.zeros((2, 2 * MAX_TEXTURE_PX, 4), np.uint8)
    texels[:, 1001:] = 200, 100, 50, 255
    encoded = io.BytesIO()
    Image.fromarray(texels).save(encoded, "PNG")
    document = Document()
    textured = {"baseColorTexture": document.embedded(encoded.getvalue())}
    material = quad_of(tmp_path, {"alphaMode": "MASK", "pbrMetallicRoughness": textured}, document).parts[0].material
    seen = material.base_map[material.base_map[..., 3] > 50]
    assert (seen[:, :3].min(axis=0) >= (190, 95, 45)).all()  # a sharp filter overshoots a little


def test_a_smaller_map_of_specular_colours_keeps_them_where_it_is_matt(tmp_path: Path) -> None:
    """Its alpha is the glossiness: rough silver, whose map has another size than the diffuse one."""
    document = Document()
    old = {
        "diffuseTexture": document.embedded(png((0, 0, 0, 255), (8, 8))),
        "specularGlossinessTexture": document.embedded(png((250, 250, 250, 0), (4, 4))),
    }
    material = (
        quad_of(tmp_path, {"extensions": {"KHR_materials_pbrSpecularGlossiness": old}}, document).parts[0].material
    )
    assert (material.metallic, material.roughness) == pytest.approx((1, 1), abs=0.01)
    assert material.base_map[..., :3].min() > 240

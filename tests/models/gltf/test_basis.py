"""Textures in Basis Universal: read where the decoder is installed, else left out with a line."""

import base64
import zlib
from pathlib import Path

import numpy as np
import pytest

from ashe_live.errors import UserError
from ashe_live.models.loading import load_model_file
from ashe_live.models.mesh import Model
from ashe_live.models.parsing import basis, limits
from tests.models.gltf_files import UVS, Document

# 16 by 16 texels with all smaller levels, above red and blue, below green; made by BinomialLLC's encoder.
FILES = {
    "ETC1S": (
        "eNpb7R0SoWBksJuXS4qLAQgYgVgAimEAJMYKpU8AsQ4QfwFiFSCWYISo4YPSekwQmosBFWhBxVnQxDWZEHYgA3WoOBOauBoO9ToM"
        "MPUaDIsZmRiYmRkYOOCy9nDWfyCQB9JAb5cXZZakFjE4JRZnFiuE5mWWpRYVJ+YoGOkZGoDcz8lgC1SnCsQmaHah+w2bv7C5EZt/"
        "0NWJOrSAKEeBrw6CLB3SDgwMBiw+ImkLfmxm9OEEybQkcpbZcDiIgNgOHpIWNnOW372yV/rXgpZsLhaNigoOCQkJkFzA6lVgsAkI"
        "gkLX/goPDQ21BQJWhoMuDeBYPnbhU/peJgN2oB0MHA0PA5IZ71kIMDiwzFl9i6PlzwEuBjWIkwQcGJx2Maj9s2Vnvr2XW6XIpDV8"
        "BhMATIZJXw=="
    ),
    "UASTC": (
        "eNpb7R0SoWBksJuXS4qLAQgYgVgAimEAJMYKZZ8AYh0g/gKl0cEERiRNSHQAlHZgQKOh4jD7YLQBDnEFHOIwtzAxaDAsY2RiYGZG"
        "9kM9nPUfCOSBNNDb5UWZJalFDE6JxZnFCqF5mWWpRcWJOQpGeoYGDAwsIF1AbeJ86z7FO3vAfMMgPEOtoqKhXWj7JNXG///rgXze"
        "Pfe+lV9S8bxV8OB5OsNtQQXXz3JNHHEXQy+6HCj/vNGBX6BF49XtD7sg8PbCPEvmi9UcXkC5tEdpjzYe9JuwyOEFXF5ckvWp/Ylj"
        "cPdi8FlZf9obqDHj5FOqn1Xyqb3BTQbcfNrqBwBf9nOx"
    ),
}
COLOURS = {(4, 4): (200, 40, 40), (4, 12): (40, 40, 200), (12, 4): (40, 200, 40)}  # by row and column


def read(tmp_path: Path, content: bytes) -> Model:
    document = Document()
    document.json["images"] = [{"bufferView": document.view(content), "mimeType": "image/ktx2"}]
    document.json["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 0, 0, 1]}}
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    document.json["extensionsRequired"] = ["KHR_texture_basisu"]
    return load_model_file(document.save(tmp_path / "a.glb"))


@pytest.mark.parametrize("kind", FILES)
def test_both_codecs_are_read(tmp_path: Path, kind: str) -> None:
    model = read(tmp_path, zlib.decompress(base64.b64decode(FILES[kind])))
    assert model.notes == ()
    texels = model.parts[0].material.base_map
    assert texels is not None
    assert texels.shape == (16, 16, 4)
    for place, colour in COLOURS.items():
        np.testing.assert_allclose(texels[place], (*colour, 255), atol=5)


def test_of_a_large_one_a_smaller_level_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(basis, "MAX_TEXTURE_PX", 8)
    model = read(tmp_path, zlib.decompress(base64.b64decode(FILES["UASTC"])))
    texels = model.parts[0].material.base_map
    assert texels is not None
    assert texels.shape == (8, 8, 4)


def test_of_levels_that_are_all_too_large_it_is_the_smallest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(basis, "MAX_TEXTURE_PX", 0)
    texels = read(tmp_path, zlib.decompress(base64.b64decode(FILES["UASTC"]))).parts[0].material.base_map
    assert texels is not None
    assert texels.shape == (1, 1, 4)


def test_one_that_is_too_large_is_refused_by_its_header(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_PICTURE_TEXELS", 16 * 16 - 1)
    with pytest.raises(UserError, match="has a texture of 16 x 16 texels"):
        read(tmp_path, zlib.decompress(base64.b64decode(FILES["UASTC"])))


def test_they_count_among_all_that_is_decoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    content = zlib.decompress(base64.b64decode(FILES["UASTC"]))
    monkeypatch.setattr(limits, "MAX_DECODED_TEXELS", 16 * 16)
    read(tmp_path, content)
    monkeypatch.setattr(limits, "MAX_DECODED_TEXELS", 16 * 16 - 1)
    with pytest.raises(UserError, match="more than 255 texels in their files"):
        read(tmp_path, content)


@pytest.mark.parametrize("kind", FILES)
@pytest.mark.parametrize("length", [9, 40, 100, 300])
def test_what_is_cut_off_is_said(tmp_path: Path, kind: str, length: int) -> None:
    content = zlib.decompress(base64.b64decode(FILES[kind]))[:length]
    with pytest.raises(UserError, match="its baseColorTexture cannot be read as Basis Universal"):
        read(tmp_path, content)


def test_without_the_decoder_they_are_left_out_and_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(basis, "is_readable", lambda: False)
    model = read(tmp_path, b"\xabKTX 20\xbb")
    assert model.parts[0].material.base_colour == (1, 0, 0, 1)
    assert model.notes == (basis.LEFT_OUT,)

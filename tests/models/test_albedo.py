"""The mean colour of a model's surface."""

from dataclasses import replace

import numpy as np

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.models.albedo import mean_albedo
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Model
from ashe_live.models.primitives import box

RED, BLUE = (0.8, 0.1, 0.1, 1.0), (0.1, 0.1, 0.8, 1.0)


def test_parts_count_by_their_area() -> None:
    large, small = box((2.0, 2.0, 2.0), RED), box((1.0, 1.0, 1.0), BLUE)
    found = mean_albedo(Model("two", (large, small)))
    np.testing.assert_allclose(found, (4 * np.array(RED[:3]) + np.array(BLUE[:3])) / 5, atol=1e-6)


def test_a_maps_mean_is_that_of_its_light() -> None:
    mesh = box((1.0, 1.0, 1.0))
    texels = np.full((8, 8, 4), 255, np.uint8)
    texels[:4, :, :3] = 0
    uvs = np.zeros((len(mesh.vertices), 2), np.float32)
    found = mean_albedo(Model("checked", (replace(mesh, colours=None, uvs=uvs, material=Material(base_map=texels)),)))
    np.testing.assert_allclose(found, LINEAR_FROM_SRGB_8BIT[255] / 2, atol=1e-6)


def test_what_lets_light_through_throws_less_back() -> None:
    glass = Material(base_colour=(0.9, 0.9, 0.9, 0.0), alpha=Alpha.BLEND)
    clear = replace(box((1.0, 1.0, 1.0)), colours=None, material=glass)
    assert (mean_albedo(Model("glass", (clear,))) == 0).all()
    found = mean_albedo(Model("both", (clear, box((1.0, 1.0, 1.0), RED))))
    np.testing.assert_allclose(found, RED[:3], atol=1e-6)

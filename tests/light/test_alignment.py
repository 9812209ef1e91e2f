"""Bodies moved until their outlines lie on the picture's borders: true slopes, true places, honest information."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.alignment import _slopes
from ashe_live.light.body import Body
from ashe_live.light.borders import PLACES, Places, evenly_spread
from ashe_live.light.predicted import outline
from ashe_live.light.proxies import FAMILIES
from ashe_live.light.regions import Region
from tests.light.painted_bodies import framed, slant_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX
from tests.light.synthetic_masks import direction

LIGHTS = {"one light": [direction(200.0, 40.0)], "two lights": [direction(200.0, 40.0), direction(70.0, 55.0)]}
SHAPES = {
    "box": [0.1, 0.05, 0.4, -1.1, -1.3, -0.1],
    "frustum": [0.05, -0.1, 0.0, 0.35, 0.2],
    "sphere": [0.0, 0.1, -0.7],
    "egg": [0.0, 0.1, -0.9, 0.2],
    "ell": [0.0, 0.0, 0.5, -1.5, -1.2, 0.0, -0.9, 0.0],
}


def body(family: str, region: Region, lights: list[Float]) -> Body:
    slants = np.array([slant_of(light) for light in lights])
    return Body(framed(region, BOX, slants), FAMILIES[family], slants, np.array(SHAPES[family]))


def smooth_outlines(body: Body, region: Region) -> list[Float]:
    """As `outlines` draws them, but round where they are round."""
    is_round = body.proxy.spheroids_marker[:, 4].any()
    points = body.proxy.surface(256, 129)[0] if is_round else body.proxy.points_marker(720)
    cast = [points - points[:, 2:] * (towards / towards[2]) for towards in body.to_lights_marker]
    hulls = [outline(region.view.camera, region.view.T_cam_marker, each) for each in (points, *cast)]
    return [hull for hull in hulls if hull is not None]


def moved_outward(places: Places, hull_px: Float) -> Float:
    """(n,) how far along their normals the places are from another convex outline."""
    edges = np.roll(hull_px, -1, axis=0) - hull_px
    normals = edges[:, ::-1] * (1, -1)
    normals *= np.sign(((hull_px - hull_px.mean(axis=0)) * normals).sum(axis=1))[:, None]
    facing = places.normals @ normals.T
    offset = ((hull_px - places.points[:, None]) * normals).sum(axis=2)
    reached = np.divide(offset, facing, out=np.full_like(offset, np.inf), where=facing > 1e-6 * np.abs(facing).max())
    return np.asarray(reached.min(axis=1))


def measured_slopes(body: Body, region: Region, places: list[Places], step: float = 2e-3) -> Float:
    """(n, 2 l + q) by central differences of the outlines that are drawn."""
    columns = []
    for unit in np.eye(body.slants.size + len(body.shape)):
        ahead, behind = (
            np.concatenate([moved_outward(*own) for own in zip(places, smooth_outlines(there, region), strict=True)])
            for there in (body.moved(step * unit), body.moved(-step * unit))
        )
        columns.append((ahead - behind) / (2 * step))
    return np.column_stack(columns)


# Slopes


@pytest.mark.parametrize("lights", LIGHTS.values(), ids=LIGHTS)
@pytest.mark.parametrize("family", SHAPES)
def test_slopes_are_those_of_the_outlines(family: str, lights: list[Float]) -> None:
    region = painted_region(BOX).region
    here = body(family, region, lights)
    places = [evenly_spread(hull) for hull in smooth_outlines(here, region)]
    slopes, measured = _slopes(here, places), measured_slopes(here, region, places)
    assert slopes.shape == ((1 + len(lights)) * PLACES, 2 * len(lights) + len(here.shape))
    error = np.abs(slopes - measured)
    # A place next to a corner, or where a straight edge goes over into a round one, moves as neither of them does.
    assert np.quantile(error.max(axis=1), 0.98) < 0.03 * np.abs(measured).max()
    assert np.quantile(error.max(axis=1), 0.7) < 0.01 * np.abs(measured).max()

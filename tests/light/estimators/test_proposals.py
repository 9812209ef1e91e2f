"""Which splits of painted regions are proposed."""

from dataclasses import replace

from ashe_live.light.estimators.proposals import proposals_of
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, OtherLight, overlap


def best_overlaps(here: PaintedRegion) -> tuple[float, float]:
    """Of the splits by all shifts, the best overlap of the object with the true one, with and without other ground."""
    best = {True: 0.0, False: 0.0}
    for each in proposals_of(here.region, here.ground, here.shifts, []):
        left_out = each.materials.other_ground is not None
        best[left_out] = max(best[left_out], overlap(each.split.object_mask, here.body))
    return best[False], best[True]


def test_what_glossy_ground_mirrors_is_also_left_out_of_the_object() -> None:
    here = painted_region(replace(CYLINDER, rgb=(0.03, 0.03, 0.04)), azimuth_deg=110.0, elevation_deg=35.0, gloss=0.12)
    with_it, without = best_overlaps(here)
    assert without > 0.9
    assert without > with_it + 0.03


def test_the_paler_shadow_of_another_light_is_also_left_out_of_the_object() -> None:
    other = OtherLight(60.0, 40.0, (0.25, 0.25, 0.25))
    with_it, without = best_overlaps(painted_region(BOX, azimuth_deg=200.0, other=other))
    assert without > 0.9
    assert without > with_it + 0.03

"""Which splits of painted regions are proposed."""

from dataclasses import replace

from ashe_live.light.estimators.proposals import proposals_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import CYLINDER, overlap


def test_what_glossy_ground_mirrors_is_also_left_out_of_the_object() -> None:
    here = painted_region(replace(CYLINDER, rgb=(0.03, 0.03, 0.04)), azimuth_deg=110.0, elevation_deg=35.0, gloss=0.12)
    best = {True: 0.0, False: 0.0}
    for each in proposals_of(here.region, here.ground, here.shifts, []):
        left_out = each.materials.lit_by_object is not None
        best[left_out] = max(best[left_out], overlap(each.split.object_mask, here.body))
    assert best[True] > 0.9
    assert best[True] > best[False] + 0.03

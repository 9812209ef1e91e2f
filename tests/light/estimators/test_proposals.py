"""Which splits of painted regions are proposed."""

from dataclasses import replace

import pytest

from ashe_live.light.estimators.proposals import proposals_of, selected_for_fit
from ashe_live.light.explanation.judgement.judge import fitted_judge
from tests.light.labels.test_associate import explained
from tests.light.painted_regions import PaintedRegion, in_region, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, OtherLight, overlap, paint


def best_overlaps(here: PaintedRegion) -> tuple[float, float]:
    """The best overlap of the object with the true one, of splits by shifts alone, and where other ground is none."""
    proposals = proposals_of(here.region, here.ground, here.shifts, [])
    left_out = [each.split for each in proposals if each.materials.other_ground is not None]
    by_shifts, without = (
        max(overlap(split.object_mask, here.body) for split in several) for several in (explained(here), left_out)
    )
    return by_shifts, without


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


@pytest.mark.parametrize(("ground", "rgb"), [("striped", (0.16, 0.16, 0.2)), ("checkered", (0.3, 0.3, 0.35))])
def test_an_object_that_looks_like_ground_in_shadow_is_recognised_by_its_colour(
    ground: str, rgb: tuple[float, float, float]
) -> None:
    here = painted_region(replace(CYLINDER, rgb=rgb), ground=ground)
    found = [each.split for each in proposals_of(here.region, here.ground, here.shifts, [])]
    best = max(min(overlap(one.object_mask, here.body), overlap(one.shadow_mask, here.shadow)) for one in found)
    assert best > 0.9


def test_an_object_whose_shadow_joins_another_is_fitted_by_itself() -> None:
    """Alone it leaves the other unexplained, so that variants of both together would crowd it out."""
    other = replace(CYLINDER, at=(0.21, 0.0))
    here = painted_region(BOX, other)
    alone = paint(BOX)
    body, shadow = in_region(here.region, alone.body), in_region(here.region, alone.shadow & ~paint(other).body)
    proposals = list(proposals_of(here.region, here.ground, here.shifts, []))
    fitted = [each.split for each in selected_for_fit(proposals, 6, fitted_judge())]
    assert max(min(overlap(one.object_mask, body), overlap(one.shadow_mask, shadow)) for one in fitted) > 0.8

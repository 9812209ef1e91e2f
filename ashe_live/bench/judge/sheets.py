"""`ashe-live bench fit-judge --sheets`: how well the shadow of the marker's own sheet determines the light's azimuth.

No explanation is needed for that: the number that is fitted, the concentration of azimuths about where a clear shadow
comes from, makes those of known lights likeliest. It is independent of objects and of marks at their feet, so that what
it says of an explanation's azimuth is added to the log odds by all other features as it is.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import Case, cases_of
from ashe_live.bench.tables import figures_table
from ashe_live.core.arrays import Float
from ashe_live.core.contract import Json
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.sheet_shadow import SheetShadow, sheet_shadow_in
from ashe_live.light.pixels.view import View

CONCENTRATIONS = np.arange(0.0, 8.01, 0.25)
CLEAR = 0.5  # from which on a shadow counts as clear in the table


@dataclass(frozen=True, slots=True, eq=False)
class SeenSheet:
    """The sheet's shadow in a picture with one known light."""

    ground: str  # the family of the ground; "" where it is not stated
    shadow: SheetShadow | None
    to_light_marker: Float  # (3,) unit

    def gain(self, concentration: float) -> float:
        """Log of the likelihood of the true azimuth over that of any, nats."""
        return 0.0 if self.shadow is None else self.shadow.log_odds(self.to_light_marker, concentration)

    @property
    def is_within_45(self) -> bool:
        """Whether the shadow points away from the light to 45°, as a quarter would by chance."""
        if self.shadow is None:
            return False
        away, across = -self.to_light_marker[:2], self.shadow.away
        return float(away @ across) > float(np.hypot(*away) * np.hypot(*across)) * math.cos(math.radians(45))


@dataclass(frozen=True, slots=True)
class SheetsBench(Bench):
    """Fits the concentration to the folders `scenes`, and to all grounds but each, by which that one is judged."""

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every `every`th

    def parts(self) -> Iterator[Json]:
        cases = cases_of(self.scenes, self.limit, self.every)
        lit = [case for case in cases if case.to_lights_marker is not None and len(case.to_lights_marker) == 1]
        seen = [seen_sheet(case) for case in track(lit, "sheets", console=self.console, transient=True)]
        found = fitted_to(seen)
        table = figures_table(
            f"the sheet's shadow: concentration {found:.2f} by {len(seen)} pictures, {_mean(seen, found):+.3f} nats",
            *("ground left out", "pictures", "clear", "of these within 45°", "gain, nats"),
        )
        left_out = {}
        for ground in sorted({each.ground for each in seen}):
            own = [each for each in seen if each.ground == ground]
            left_out[ground] = _mean(own, fitted_to([each for each in seen if each.ground != ground]))
            clear = [each for each in own if each.shadow is not None and each.shadow.clear > CLEAR]
            near = sum(each.is_within_45 for each in clear)
            table.add_row(ground, str(len(own)), str(len(clear)), str(near), f"{left_out[ground]:+.3f}")
        self.console.print(table)
        yield {"concentration": found, "pictures": len(seen), "gain": _mean(seen, found), "left_out": left_out}


def seen_sheet(case: Case) -> SeenSheet:
    """Of a picture with one known light, from the tracker's own pose."""
    assert case.to_lights_marker is not None
    shadow = sheet_shadow_in(View.of(case.followed(), BALANCED.fine_width_px))
    return SeenSheet(case.tags.get("ground", ""), shadow, case.to_lights_marker[0])


def fitted_to(seen: Sequence[SeenSheet]) -> float:
    """The concentration by which the true azimuths are likeliest."""
    return float(max(CONCENTRATIONS, key=lambda each: _mean(seen, float(each)), default=0.0))


def _mean(seen: Sequence[SeenSheet], concentration: float) -> float:
    return float(np.mean([each.gain(concentration) for each in seen])) if seen else 0.0

"""`ashe-live bench fit-lamps`: how far the fall of light is to be believed, by lamps whose places are known."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import cases_of
from ashe_live.bench.lamps.fall_errors import FallError, fall_error, fitted_share, whole_share
from ashe_live.bench.tables import figures_table
from ashe_live.core.contract import Json
from ashe_live.core.transforms import ELLIPSE_95
from ashe_live.errors import UserError
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.lamps.fall.fall_directions import INFORMATIVE_DEVIANCE
from ashe_live.light.lamps.sources import FALL_ERROR_SHARE, WHOLE_ERROR_SHARE

CLEAR_DEVIANCE = 80.0  # of even light, from which on the ground shows a lamp very clearly
FEWEST = 3  # lamps by which a share is fitted


@dataclass(frozen=True, slots=True)
class LampBench(Bench):
    """The error of the nearness by the fall of light alone, on the lamps in the folders `scenes`.

    The labels, the shadow's depth, and the direction from the object are the true ones; the shares of the nearness by
    which it errs beyond what the ground's noise and unevenness explain give FALL_ERROR_SHARE.
    """

    SCHEMA: ClassVar[int] = 2

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all

    def parts(self) -> Iterator[Json]:
        cases = cases_of(self.scenes, self.limit)
        looked_at = track(cases, "pictures", console=self.console, transient=True)
        several = ((case, fall_error(case, BALANCED)) for case in looked_at)
        found = {f"{case.folder}/{case.id}": error for case, error in several if error is not None}
        groups = _by_deviance(list(found.values()))
        used = groups["all informative"]
        if len(used) < FEWEST:
            raise UserError(
                f"{len(used)} of {len(cases)} pictures show a single lamp by the fall of its light",
                "give a set of lamps with masks and more pictures, such as near_training",
            )
        table = figures_table(
            "nearness by the fall of light alone", "deviance of even light", "lamps", "68 % within", "further share"
        )
        for name, errors in groups.items():
            if errors:
                table.add_row(name, str(len(errors)), f"{whole_share(errors):.0%}", f"{fitted_share(errors):.0%}")
        self.console.print(table)
        median_deg = float(np.median([each.direction_deg for each in used]))
        within = float(np.mean([each.squared_sigmas <= ELLIPSE_95 for each in used]))
        self.console.print(
            f"direction by the fall alone: {median_deg:.1f}° off in the median, {within:.0%} in the 95 % ellipse"
        )
        further, whole = fitted_share(used), whole_share(used)
        self.console.print(f"FALL_ERROR_SHARE {further:.2f}, in use {FALL_ERROR_SHARE:.2f}")
        self.console.print(f"WHOLE_ERROR_SHARE {whole:.2f}, in use {WHOLE_ERROR_SHARE:.2f}")
        yield {
            "fall_error_share": further,
            "whole_error_share": whole,
            "lamps": {key: asdict(each) for key, each in found.items()},
        }


def _by_deviance(errors: Sequence[FallError]) -> dict[str, list[FallError]]:
    """By how clearly the ground shows the lamp; all but those whose ground hardly does once more."""
    weak = [each for each in errors if each.deviance < INFORMATIVE_DEVIANCE]
    clear = [each for each in errors if each.deviance >= CLEAR_DEVIANCE]
    informative = [each for each in errors if each.deviance >= INFORMATIVE_DEVIANCE]
    return {
        f"below {INFORMATIVE_DEVIANCE:g}": weak,
        f"to {CLEAR_DEVIANCE:g}": [each for each in informative if each.deviance < CLEAR_DEVIANCE],
        "above": clear,
        "all informative": informative,
    }

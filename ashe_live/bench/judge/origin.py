"""Which pictures the judge is fitted to, and how its tables say so."""

from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from ashe_live.bench.cases import Case, read_cases
from ashe_live.core.contract import Json
from ashe_live.errors import UserError


def cases_to_fit(scenes: Sequence[Path], limit: int | None, every: int) -> list[Case]:
    """Every `every`th of the first `limit` pictures of each folder, without those whose light is not known.

    Raises UserError where none is left.
    """
    cases = [
        case for folder in scenes for case in read_cases(folder)[:limit:every] if case.to_lights_marker is not None
    ]
    if not cases:
        raise UserError("there is no picture with a known light in these sets", "give a training set of scenes")
    return cases


def origin_of(options: str, scenes: Sequence[Path], limit: int | None, every: int, cases: Sequence[Case]) -> Json:
    """The command, with these options, and the pictures that tables come from."""
    names = [folder.resolve().name for folder in scenes]
    limited = "" if limit is None else f" --limit {limit}"
    sampled = "" if every == 1 else f" --every {every}"
    return {
        "command": f"ashe-live bench fit-judge{options} --scenes {' '.join(names)}{limited}{sampled}",
        "scenes": names,
        "pictures": len(cases),
        "categories": dict(sorted(Counter(case.category for case in cases).items())),
        "date": datetime.now(UTC).date().isoformat(),
    }

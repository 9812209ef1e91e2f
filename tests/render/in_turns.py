"""Cases for the qualities in turn: where these draw alike, each case is as hard for one of them as for all three."""

from collections.abc import Iterable
from itertools import cycle

from ashe_live.quality import QUALITIES


def in_turns(cases: Iterable[tuple[object, ...]]) -> list[tuple[object, ...]]:
    """Each case once, behind the name of a quality."""
    return [(name, *case) for name, case in zip(cycle(QUALITIES), cases, strict=False)]

"""The scenes with a known light that the repository has: painted by assets/sources/paint_scenes.py."""

from ashe_live.bench.cases import Case, read_cases
from tests.checkout import CHECKOUT

FOLDER = CHECKOUT / "assets" / "scenes"
CASES: dict[str, Case] = {case.id: case for case in read_cases(FOLDER)}
LIT = [name for name, case in CASES.items() if case.to_lights_marker is not None and len(case.to_lights_marker)]

"""How many damaged files are tried, of each kind, and whether one is refused as it should be.

A few are always the same, or very many are drawn at random:

FUZZ_FILES=12000 pytest tests/fuzz/test_damaged_models.py tests/fuzz/test_damaged_files.py
"""

import os
from collections.abc import Callable

from hypothesis import settings

from ashe_live.errors import UserError

HUNTED = int(os.environ.get("FUZZ_FILES", "0"))
LONGEST_MS = 20_000  # for one file, where very many are tried


def files(few: int) -> settings:
    """`few` are tried in every run of the tests."""
    if HUNTED:
        return settings(max_examples=HUNTED, deadline=LONGEST_MS, derandomize=False, database=None)
    return settings(max_examples=few)


def is_refused(read: Callable[[], object]) -> bool:
    """Whether it ends as a UserError; any other exception fails the test."""
    try:
        read()
    except UserError as error:
        return bool(error.message and error.remedy)
    return False

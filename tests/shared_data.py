"""Scenes, photos and clips that may not be shipped: a folder beside the checkout, where there is one."""

from pathlib import Path

import pytest

from tests.checkout import CHECKOUT

SHARED = CHECKOUT.parent / "shared"


def shared_folder(name: str) -> Path:
    """Skips the test where there is no such folder; what it checks has a counterpart on scenes of the repository's."""
    if not (SHARED / name).exists():
        pytest.skip(f"there is no folder shared/{name} beside the checkout")
    return SHARED / name

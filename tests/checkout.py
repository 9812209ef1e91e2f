"""Where the repository lies, for tests of what is in it beside the package."""

from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]

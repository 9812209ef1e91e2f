"""The scripts in assets/sources are run from there, and import each other from there."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "assets" / "sources"))

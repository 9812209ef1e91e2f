"""The scripts in assets/sources are run from there, and import each other from there."""

import sys

from tests.checkout import CHECKOUT

sys.path.insert(0, str(CHECKOUT / "assets" / "sources"))

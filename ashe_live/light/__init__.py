"""Light estimation from single frames, in sub-packages with one direction of imports (docs/contributing.md).

May import `core` and `errors`; each sub-package states in its `__init__` which others it may import.
"""

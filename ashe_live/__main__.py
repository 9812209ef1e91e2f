"""`ashe-live` and `python -m ashe_live`."""

import os
import sys

from ashe_live.cli import run


def main() -> None:
    # Read by NumPy as it loads. Our matrices are small: more threads only wait for each other, six times as long for an
    # estimate, and what they compute has the same bits.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()

"""`ashe-live` and `python -m ashe_live`."""

import sys

from ashe_live.cli import run


def main() -> None:
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()

"""`ashe-live` whose light process has the viewer's priority: at the lowest one a crowded machine lets it wait."""

import sys

from ashe_live.light import worker_process

# At import, so that the light worker's process, which imports this file too, has it as well.
worker_process.NICENESS = 0

if __name__ == "__main__":
    from ashe_live.cli import run

    sys.exit(run(sys.argv[1:]))

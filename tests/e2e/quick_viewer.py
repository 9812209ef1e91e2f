"""`ashe-live` whose light worker has the quick estimator of tests: the same way, in half a second."""

import sys

from ashe_live.light.live import worker
from tests.e2e.quick_estimator import quick

worker.make_estimator = quick

if __name__ == "__main__":
    from ashe_live.cli import run
    from ashe_live.process.ending import end_process

    end_process(run(sys.argv[1:]))

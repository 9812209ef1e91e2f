"""`ashe-live` whose paper estimator works on small pictures and stops early: the same way, in half a second.

On a painted picture, whose noise is all that differs within an area, GrabCut's 25 iterations would take seconds.

Its process has the viewer's priority, as at the lowest one a crowded machine lets it wait for minutes.
"""

import sys

from ashe_live.light.estimators import estimator
from ashe_live.light.estimators.steps import ProxySteps
from ashe_live.light.live import worker_process
from ashe_live.light.paper.estimator import PaperEstimator, PaperSteps


def quick(preset: ProxySteps) -> PaperEstimator:  # noqa: ARG001
    return PaperEstimator(PaperSteps(size=(160, 120), grabcut_iterations=2))


# At import, so that the light worker's process, which imports this file too, has it as well.
estimator.ESTIMATORS = {**estimator.ESTIMATORS, "paper": quick}
worker_process.LOWEST_PRIORITY = 0

if __name__ == "__main__":
    from ashe_live.cli import run

    sys.exit(run(sys.argv[1:]))

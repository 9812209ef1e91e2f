"""The registry of estimators."""

import subprocess
import sys

import pytest

from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import ESTIMATORS, make_estimator


@pytest.mark.parametrize("name", ESTIMATORS)
def test_an_estimator_bears_the_name_it_is_chosen_by(name):
    assert make_estimator(name).name == name


def test_an_unknown_name_is_answered_with_the_known_ones():
    with pytest.raises(UserError, match="paper") as failure:
        make_estimator("papre")
    assert "papre" in failure.value.message


def test_the_names_are_known_without_opencv():
    code = "import sys, ashe_live.light.estimators.estimator; sys.exit('cv2' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

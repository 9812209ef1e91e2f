"""Pictures that are looked at by several processes: each one's samples in its place."""

import pytest
from rich.console import Console

from ashe_live.bench.judge.samples import in_processes


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_is_found_has_the_order_of_the_pictures_whichever_takes_longest(jobs: int) -> None:
    pictures = [range(3_000_000), range(5), range(3), range(4)]
    assert in_processes(sum, pictures, jobs, Console(quiet=True), "sums") == [sum(each) for each in pictures]

"""The source archive: in a folder that it was unpacked to, `make` works as in a clone."""

import re
import tomllib

import pytest

from tests.checkout import CHECKOUT

ALWAYS_THERE = {"pyproject.toml"}


@pytest.mark.packaging
def test_the_source_archive_has_every_file_that_the_makefile_needs() -> None:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))
    included = ALWAYS_THERE | set(project["tool"]["hatch"]["build"]["targets"]["sdist"]["include"])
    makefile = (CHECKOUT / "Makefile").read_text(encoding="utf-8")
    words = " ".join(re.findall(r"^[^\s#][^=\n]*:(.*)$", makefile, re.MULTILINE)).split()
    needed = {word for word in words if (CHECKOUT / word).is_file()}
    assert needed >= {"pyproject.toml", ".ci/system-packages"}, "read wrongly"
    assert {file for file in needed if not {file, file.split("/")[0]} & included} == set()

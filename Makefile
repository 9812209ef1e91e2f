# `make demo` and `make test` set up what they need on a fresh Debian or Ubuntu, and start in seconds afterwards.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DIST ?= dist

.PHONY: demo test check style wheel clean

demo: $(VENV)/demo.stamp
	$(BIN)/ashe-live demo

# tests/conftest.py parts the tests between two processes. As in the program itself, matrices are small: a second thread of
# OpenBLAS doubles the processor time of the light's tests. The types, of which one process takes half a minute, are
# checked meanwhile. Hundreds of processes are started, each of which would compile the package again where Python is told
# to write no bytecode.
test: $(VENV)/test.stamp style
	unset PYTHONDONTWRITEBYTECODE; \
	$(BIN)/mypy & types=$$!; \
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2; tests=$$?; \
	wait $$types && exit $$tests

check: $(VENV)/test.stamp style
	$(BIN)/mypy

style: $(VENV)/test.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

$(VENV)/demo.stamp: pyproject.toml .ci/system-packages
	.ci/system-packages $(PYTHON) demo
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/test.stamp: pyproject.toml .ci/system-packages
	.ci/system-packages $(PYTHON) test
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

wheel: $(VENV)/test.stamp
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir $(DIST) .

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis

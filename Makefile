# `make demo` and `make test` do everything, from installing to running; a second time they start at once.

BIN := .venv/bin
SUITE ?= trixie

.PHONY: setup demo test lint test-wheel test-debian test-matrix benchmark site clean

# Only what the others need; then `.venv/bin/python script.py`.
setup: .venv/ready

demo: .venv/ready
	$(BIN)/python demos/square_membrane.py
	$(BIN)/python demos/shade_pavilion.py
	$(BIN)/python demos/solvers.py

test: lint
	@.ci/suite $(BIN)/python mpirun

# The same suite with dolfinx 0.11 from PyPI.
test-wheel:
	@.ci/test-wheel

# The same suite in a Debian of another suite: make test-debian SUITE=sid
test-debian:
	@.ci/test-debian $(SUITE)

# All of them, and one table.
test-matrix:
	@.ci/test-matrix

lint: .venv/ready
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

benchmark: .venv/ready
	$(BIN)/python tests/benchmarks/assembly.py

# README, how-tos, gallery, table of verification, case-file reference and API, in output/site.
site: .venv/site
	$(BIN)/python .ci/site/build.py

.venv/site: .venv/ready pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --config-settings editable_mode=compat --editable '.[site]'
	@touch $@

.venv/ready: .ci/setup pyproject.toml
	@.ci/setup

clean:
	rm -rf .venv .venv-wheel output dist build *.egg-info

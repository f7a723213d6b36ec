# `make demo` and `make test` do everything, from installing to running; a second time they start at once.

export OMPI_ALLOW_RUN_AS_ROOT = 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM = 1
# More processes than cores are fine for tests: Open MPI 4, then 5.
export OMPI_MCA_rmaps_base_oversubscribe = 1
export PRTE_MCA_rmaps_default_mapping_policy = :oversubscribe

BIN := .venv/bin
PARALLEL := $(BIN)/python -m mpi4py -m pytest -q -p no:cacheprovider -m "not serial"

.PHONY: demo test lint mpi-test benchmark clean

demo: .venv/ready
	$(BIN)/python demos/square_membrane.py

test: lint
	$(BIN)/python -m pytest -q
	mpirun -n 2 $(PARALLEL)
	mpirun -n 3 $(PARALLEL)

lint: .venv/ready
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

benchmark: .venv/ready
	$(BIN)/python tests/benchmarks/assembly.py

.venv/ready: .ci/setup pyproject.toml
	@.ci/setup

clean:
	rm -rf .venv output dist build *.egg-info

# Each target sets up the virtual environment .venv first, if that is missing or older than pyproject.toml.

PYTHON ?= python3
BIN := .venv/bin
LINKAGE ?= special-double-subtractive-goldberg
STUDIES := special_wohlhart_double_goldberg special_double_subtractive_goldberg wohlhart_double_goldberg \
  zero_offset_line_symmetric_bricard first_reconfigurable_bricard

.PHONY: map test lint studies bench clean

map: .venv/ready  ## the main job: one linkage to its complete transition map
	$(BIN)/bifurc map $(LINKAGE) --out out/$(LINKAGE)

test: .venv/ready  ## all tests, the examples of README and docs among them
	$(BIN)/python -m pytest -n auto

lint: .venv/ready  ## ruff and mypy
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m mypy

studies: .venv/ready  ## every study, each into out/NAME
	for name in $(STUDIES); do $(BIN)/python -m studies.$$name --out out/$$name || exit 1; done

bench: .venv/ready  ## a short, fixed set of benchmarks, with versions and machine, into out/bench.json
	mkdir -p out
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m studies.bench --out out/bench.json

clean:
	rm -rf .venv out

.venv/ready: pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	touch $@

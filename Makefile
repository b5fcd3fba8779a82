# Each target sets up the virtual environment .venv first, if that is missing or older than what it is made of.

PYTHON ?= python3
BIN := .venv/bin
LINKAGE ?= special-double-subtractive-goldberg
STUDIES := special_wohlhart_double_goldberg special_double_subtractive_goldberg wohlhart_double_goldberg \
  zero_offset_line_symmetric_bricard first_reconfigurable_bricard wohlhart_translator

# Processes keep the byte code that they compile: tests start many, each of which would compile all modules anew.
unexport PYTHONDONTWRITEBYTECODE

# Processes share the cores: threads of BLAS in each would only compete.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: map test test-exhaustive test-fragile test-processors lint studies gallery bench docs pages picture dist viewer viewer-packages chromium clean

map: .venv/ready  ## the main job: one linkage to its complete transition map
	$(BIN)/bifurc map $(LINKAGE) --out out/$(LINKAGE)

# Neighbours in a file stay in one process, which makes what they share once.
PYTEST := $(BIN)/python -m pytest -n auto --dist worksteal

test: .venv/ready-to-test  ## the tests, the examples of README and docs among them
	$(PYTEST)

test-exhaustive: .venv/ready-to-test  ## the cases for which a sample stands in `make test`
	$(PYTEST) -m exhaustive

# OpenBLAS picks its kernels by the processor; other kernels give other last bits.
PROCESSORS := Prescott Nehalem Haswell Zen SkylakeX
FRAGILE := tests/test_literature.py tests/bifurc/curves/test_monitor.py tests/bifurc/surfaces/test_covering.py \
  tests/bifurc/search/test_canonical_order.py tests/studies/test_same_answer.py
# An area is a sum over charts, of which no last bit decides anything.
SOUND := area

test-processors: .venv/ready-to-test  ## all tests with the last bits of five processors, with one thread and with two
	for kernel in $(PROCESSORS); do for threads in 1 2; do \
	  echo "$$kernel, $$threads threads"; \
	  OPENBLAS_CORETYPE=$$kernel $(HAS_KERNEL) || { echo "not known to this processor"; continue; }; \
	  OPENBLAS_CORETYPE=$$kernel OPENBLAS_NUM_THREADS=$$threads $(PYTEST) || exit 1; \
	done; done

# A kernel may use instructions that the processor here does not know: then the process ends at once.
HAS_KERNEL := $(BIN)/python -c 'import numpy as np; np.linalg.svd(np.eye(60) + 1.0)' 2> /dev/null

# The one that OpenBLAS picks here.
OWN_KERNEL := $(BIN)/python -c 'import numpy, threadpoolctl; print(threadpoolctl.threadpool_info()[0]["architecture"])'

# With --jobs, the processors side by side.
KERNELS := $(addprefix test-fragile-,Nehalem Haswell SkylakeX)
test-fragile: $(KERNELS)  ## what once hung on the last bits, and a sample of studies.same_answer, under three processors, the one here left to `make test`

.PHONY: $(KERNELS)
$(KERNELS): test-fragile-%: .venv/ready-to-test
	@if [ "$$($(OWN_KERNEL))" = $* ]; then echo "$* is the kernel here, with which \`make test\` runs these"; \
	elif OPENBLAS_CORETYPE=$* $(HAS_KERNEL); then \
	  OPENBLAS_CORETYPE=$* $(BIN)/python -m pytest $(FRAGILE) -k 'not $(SOUND)'; \
	else echo "this processor does not know the instructions of $*: its kernel is left out"; fi

lint: .venv/packages  ## ruff and mypy
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m mypy

studies: .venv/ready  ## every study, each into out/NAME
	for name in $(STUDIES); do $(BIN)/python -m studies.$$name --out out/$$name || exit 1; done

gallery: .venv/ready  ## every figure of the sources, drawn from the geometry, into out/gallery
	$(BIN)/bifurc figure all --out out/gallery

bench: .venv/ready-to-test  ## a short, fixed set of benchmarks, with versions and machine, into out/bench.json
	mkdir -p out
	$(BIN)/python -m studies.bench --out out/bench.json

# Linkages are mapped anew where parameters or code have changed; nothing is fetched, and no page fetches anything.
docs: .venv/ready-to-test  ## the site, into out/site; fails on any warning and any dead link
	$(BIN)/python -m docs.generator sources
	MPLBACKEND=Agg $(BIN)/python -m sphinx -q -W --keep-going -n -j auto -b html -c docs \
	  build/docs/source out/site
	$(BIN)/python -m docs.generator links

pages: .venv/ready-to-test  ## the pages of the docs that come out of the code, where a test says that one is old
	$(BIN)/python -m studies.pages
	$(BIN)/python -m studies.page_sizes --page
	$(BIN)/python -m studies.margins --members 2 --near 60 --page

picture: .venv/ready  ## the moving picture of the README, made anew
	$(BIN)/bifurc animate special-double-subtractive-goldberg --route "Form I" "Bennett 4R" --count 60 --size 3.4x2.6 \
	  --out docs/static/linkage.gif

dist: .venv/ready  ## sdist and wheel into dist/
	$(BIN)/python -m pip install --quiet build
	$(BIN)/python -m build

viewer:  ## the script of the pages of `bifurc view`, built anew from viewer/ (needs node and npm)
	cd viewer && npm install --no-audit --no-fund --silent && node build.js

viewer-packages:  ## what a test needs to build that script anew, where there is npm
	@(cd viewer && npm install --no-audit --no-fund --silent) || echo "no npm: the viewer is not built anew"

# Tests of the viewer drive a browser; where there is none, and none can be installed, they are skipped and say so.
chromium:  ## a browser without a window, from Debian's packages, where that is possible
	@for name in chromium-headless-shell chromium google-chrome; do \
	  command -v $$name >/dev/null && exit 0; \
	done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	  apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium-headless-shell fonts-dejavu-core \
	    >/dev/null || echo "no chromium could be installed: tests of the viewer are skipped"; \
	else echo "no chromium here: tests of the viewer are skipped"; fi

clean:
	rm -rf .venv build dist out

SOURCES := pyproject.toml CMakeLists.txt $(wildcard */core/*)
# Python compiles a module where it is first imported; most of what is installed never is.
INSTALL = $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile

# What the program needs.
.venv/ready: $(SOURCES)
	$(require-compiler)
	$(PYTHON) -m venv .venv
	$(INSTALL) --editable .
	touch $@

# What tests, checks and the site need besides. With --jobs=2, compiler and pip work side by side.
.venv/ready-to-test: .venv/compiled .venv/packages
	touch .venv/ready $@

.venv/compiled: $(SOURCES) | .venv/made
	$(require-compiler)
	$(INSTALL) --no-deps --editable .
	touch $@

.venv/packages: pyproject.toml .ci/requirements.py | .venv/made
	$(BIN)/python .ci/requirements.py test > .venv/requirements.txt
	$(INSTALL) --requirement .venv/requirements.txt
	touch $@

.venv/made:
	$(PYTHON) -m venv .venv
	touch $@

define require-compiler
@command -v c++ > /dev/null || { echo "A C++ compiler is missing (on Debian and Ubuntu: apt install g++)." >&2; exit 1; }
endef

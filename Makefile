# Everything a person does here, by name; `make help` lists it. Each target sets up what it needs:
# the Python environment in .venv/, C++ builds in build/, Debian packages where they are missing.

SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

PYTHON ?= $(firstword $(wildcard /usr/bin/python3.11) $(shell command -v python3.11) python3)
JOBS ?= $(shell nproc)

VENV := .venv
BIN := $(VENV)/bin
HOST := build/host
# cmake, ninja and the linters are those of the environment, whatever else the machine has.
WITH_VENV := PATH="$(CURDIR)/$(BIN):$$PATH"

CXX_FILES = $(shell find include bindings firmware tests benchmarks -name '*.hpp' -o -name '*.cpp')
HEADING = @printf '\n== %s ==\n'

.PHONY: help
help: ## This list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-18s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

# ---- the environment ----------------------------------------------------------------------------

$(VENV)/pyvenv.cfg:
	tools/ensure_debian.sh $(PYTHON) build
	$(PYTHON) -m venv $(VENV)

$(VENV)/.requirements: requirements.lock | $(VENV)/pyvenv.cfg
	$(BIN)/python -m pip install --quiet --disable-pip-version-check \
	    --require-hashes --only-binary :all: -r $<
	@touch $@

# The list of sources is itself a prerequisite: a removed file, too, makes the package anew.
PACKAGE_SOURCES := pyproject.toml CMakeLists.txt LICENSE $(wildcard README.md) \
    $(shell find include bindings src cmake -type f ! -name '*.pyc')

build/package_sources.txt: FORCE
	@mkdir -p build
	@printf '%s\n' $(sort $(PACKAGE_SOURCES)) | cmp -s - $@ || \
	    printf '%s\n' $(sort $(PACKAGE_SOURCES)) > $@

.PHONY: FORCE
FORCE:

# Not an editable install: what is tested is what is installed. The stamp bears the time at which the
# build began, so that a file saved while it ran is built next time.
$(VENV)/.package: $(VENV)/.requirements build/package_sources.txt $(PACKAGE_SOURCES)
	@tools/ensure_debian.sh $(PYTHON) build
	@touch $@.began
	$(WITH_VENV) CMAKE_BUILD_PARALLEL_LEVEL=$(JOBS) $(BIN)/python -m pip install --quiet \
	    --disable-pip-version-check --no-deps --no-build-isolation --force-reinstall \
	    --config-settings=cmake.define.STRAINWAVE_WERROR=ON .
	@mv $@.began $@

.PHONY: install
install: $(VENV)/.package ## The environment with the package in it: .venv/bin/strainwave

.PHONY: lock
lock: ## Make both lock files anew from requirements*.in (UPGRADE=1: with the newest versions)
	$(PYTHON) -m venv build/lock
	build/lock/bin/python -m pip install --quiet --disable-pip-version-check uv
	build/lock/bin/uv pip compile --quiet --python-version 3.11 \
	    --python-platform x86_64-unknown-linux-gnu --only-binary :all: --generate-hashes \
	    --no-header --no-annotate --no-emit-index-url --no-emit-find-links \
	    $(if $(UPGRADE),--upgrade) --output-file requirements.lock requirements.in
	build/lock/bin/uv pip compile --quiet --python-version 3.11 \
	    --python-platform x86_64-unknown-linux-gnu --only-binary :all: --generate-hashes \
	    --no-header --no-annotate --no-emit-index-url --no-emit-find-links \
	    $(if $(UPGRADE),--upgrade) --output-file requirements-bench.lock requirements-bench.in

# ---- what a person does -------------------------------------------------------------------------

.PHONY: demo
demo: $(VENV)/.package ## Both papers and the main job on simulated joints, in demo/
	$(BIN)/strainwave demo --out demo

.PHONY: docs-images
docs-images: demo ## The README's picture, made anew by the demo, and that of the torque loop
	cp demo/before-and-after.svg docs/images/
	$(BIN)/python examples/python/torque_loop.py --figure docs/images/torque-loop.svg

.PHONY: bench-accuracy
bench-accuracy: $(VENV)/.package ## All methods on simulated joints and real recordings, one table
	$(BIN)/python -m benchmarks.accuracy --out benchmarks/results

.PHONY: bench-faults
bench-faults: $(VENV)/.package ## Gauges that fail, one after the other: found, when, what is left
	$(BIN)/python -m benchmarks.faults --out benchmarks/results

.PHONY: bench
bench: bench-peers ## Speed beside peers and this machine's limit: tables and curves, 20 minutes
	$(WITH_VENV) $(BIN)/python -m benchmarks.speed

.PHONY: bench-quick
bench-quick: bench-peers ## The same in 3 minutes, in build/bench/quick; the record stays as it is
	$(WITH_VENV) $(BIN)/python -m benchmarks.speed --quick --out build/bench/quick

# What cannot be installed is said, and the bench goes on without it.
.PHONY: bench-peers
bench-peers: $(VENV)/.package
	@tools/ensure_debian.sh $(PYTHON) bench || echo "The bench goes on without these."

.PHONY: arduino-library
arduino-library: ## The core as an Arduino library, in build/arduino/strainwave
	@rm -rf build/arduino
	@mkdir -p build/arduino
	@$(PYTHON) tools/arduino_library.py --out build/arduino/strainwave

.PHONY: golden
golden: $(VENV)/.package ## The golden vectors, made anew by the host in double and float
	$(BIN)/python -m benchmarks.golden

# Once with the host's bits, and once as a compiler does it unasked: products fused with sums.
.PHONY: firmware-golden
firmware-golden: $(VENV)/.package ## The golden vectors on a Cortex-M4F under qemu
	$(HEADING) "golden vectors: Cortex-M4F under qemu"
	@tools/ensure_debian.sh $(PYTHON) firmware
	@$(BIN)/python tools/golden_header.py tests/data/golden/golden.json \
	    build/golden/golden_vectors.hpp
	@tests/firmware/golden/run.sh build/golden/off build/golden -ffp-contract=off
	@$(BIN)/python -m benchmarks.golden --compare build/golden/off/golden-answers.bin
	@tests/firmware/golden/run.sh build/golden/fused build/golden -ffp-contract=fast >/dev/null
	@$(BIN)/python -m benchmarks.golden --compare build/golden/fused/golden-answers.bin \
	    --arithmetic fused

.PHONY: test
test: ## Every test but the slow ones; all are run even when one fails
	@$(MAKE) --no-print-directory --keep-going test-core test-compile-fail test-usage test-python

.PHONY: test-core
test-core: host-build ## The C++ core's unit tests, with sanitizers
	$(HEADING) "core: unit tests, address and undefined sanitizers"
	@$(CTEST) --label-regex '^core$$'

.PHONY: test-compile-fail
test-compile-fail: host-build ## Misuse that must not compile, and its message
	$(HEADING) "compile_fail: misuse is a compile error with a message"
	@$(CTEST) --label-regex '^compile_fail$$'

.PHONY: test-usage
test-usage: host-build ## An outside project on the installed core, hosted and freestanding
	$(HEADING) "usage: the installed core, hosted and freestanding"
	@$(CTEST) --label-regex '^usage$$'

.PHONY: firmware
firmware: build/firmware/joint/elbow.hpp ## Images for Cortex-M4F, M7 and M33, in build/firmware/
	$(HEADING) "firmware: images for Cortex-M"
	@tools/ensure_debian.sh $(PYTHON) firmware
	@$(WITH_VENV) cmake --log-level=WARNING -S firmware -B build/firmware -G Ninja \
	    -DCMAKE_TOOLCHAIN_FILE="$(CURDIR)/firmware/toolchain.cmake" -DSTRAINWAVE_WERROR=ON >/dev/null
	@$(WITH_VENV) cmake --build build/firmware --parallel $(JOBS)

build/firmware/joint/elbow.hpp: firmware/joint.toml $(VENV)/.package
	@mkdir -p $(@D)
	@$(BIN)/strainwave export $< --out $(@D) >/dev/null

.PHONY: firmware-test
firmware-test: firmware ## The images in qemu: what they do and what an update costs
	$(HEADING) "firmware: in qemu"
	@$(BIN)/python firmware/test_images.py build/firmware firmware/results.json

.PHONY: test-python
test-python: $(VENV)/.package ## The Python tests
	$(HEADING) "python: the installed package"
	@$(BIN)/python -m pytest -n $(JOBS) -m 'not slow'

.PHONY: test-slow
test-slow: host-build $(VENV)/.package ## The slow tests of both languages
	$(HEADING) "core: slow tests, optimised"
ifneq ($(wildcard tests/core/slow_*.cpp),)
	@$(WITH_VENV) cmake --build $(HOST) --parallel $(JOBS) --target strainwave_slow_tests
	@$(HOST)/tests/strainwave_slow_tests
else
	@echo "There is none"
endif
	$(HEADING) "python: slow tests"
	@$(BIN)/python -m pytest -n $(JOBS) -m slow || \
	    { status=$$?; [[ $$status == 5 ]] && echo "There is none" || exit $$status; }

.PHONY: lint
lint: $(VENV)/.package host-build ## Formatting, types and static analysis; changes nothing
	@$(MAKE) --no-print-directory --keep-going lint-ruff lint-mypy lint-numpydoc \
	    lint-clang-format lint-clang-tidy

.PHONY: lint-ruff
lint-ruff: $(VENV)/.requirements
	$(HEADING) "ruff"
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .

.PHONY: lint-mypy
lint-mypy: $(VENV)/.package
	$(HEADING) "mypy: the installed package"
	@$(BIN)/mypy -p strainwave

.PHONY: lint-numpydoc
lint-numpydoc: $(VENV)/.requirements
	$(HEADING) "numpydoc"
	@find src -name '*.py' -print0 | xargs -0 $(BIN)/python -m numpydoc.hooks.validate_docstrings
	@echo "Docstrings agree with their signatures"

.PHONY: lint-clang-format
lint-clang-format: $(VENV)/.requirements
	$(HEADING) "clang-format"
	@$(BIN)/clang-format --dry-run --Werror $(CXX_FILES)
	@echo "$(words $(CXX_FILES)) files are formatted"

.PHONY: lint-clang-tidy
lint-clang-tidy: $(VENV)/.package host-build
	$(HEADING) "clang-tidy"
	@$(BIN)/python tools/clang_tidy.py --jobs $(JOBS) $(HOST) build/cp3*

.PHONY: format
format: $(VENV)/.requirements ## Put every file in the project's format
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CXX_FILES)

.PHONY: clean
clean: ## Remove what the other targets made
	rm -rf build demo $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis

# ---- the C++ build ------------------------------------------------------------------------------

CTEST = $(WITH_VENV) ctest --test-dir $(HOST) --parallel $(JOBS) --output-on-failure \
    --no-tests=error

.PHONY: host-build
host-build: $(VENV)/.requirements
	@tools/ensure_debian.sh $(PYTHON) test
	@$(WITH_VENV) cmake --log-level=WARNING -S . -B $(HOST) -G Ninja -DCMAKE_BUILD_TYPE=Debug \
	    -DSTRAINWAVE_BUILD_TESTS=ON -DSTRAINWAVE_WERROR=ON \
	    -DPython3_EXECUTABLE="$(CURDIR)/$(BIN)/python" >/dev/null
	@$(WITH_VENV) cmake --build $(HOST) --parallel $(JOBS)

# Thin fronts of the CMake presets; `make help` lists them. Variables: JOBS (all cores), PREFIX
# (/usr/local), FUZZ_SECONDS (30), PEER (arguments of test-peer, --only MATERIAL say).
.DEFAULT_GOAL := build
.DELETE_ON_ERROR:
# Prerequisites run in the order they are written; Ninja and ctest use the cores.
.NOTPARALLEL:

JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
export JOBS FUZZ_SECONDS

configure = build/$(1)/build.ninja
compile = cmake --build --preset $(1) --parallel $(JOBS)
ctest = ctest --preset $(1) --parallel $(JOBS)

.PHONY: help setup build demo docs test test-peer checks bench format lint install dev asan tsan fuzz \
  fuzz-setup clean

help:
	@echo 'make            builds build/release/faceta'
	@echo 'make demo       installs what is missing (apt), builds, renders the gallery'
	@echo 'make docs       writes docs/site: a page a material and the report card (minutes)'
	@echo 'make test       installs what is missing (apt), builds, runs every test and check'
	@echo 'make test-peer  compares every material with Mitsuba 3.9.1 (a wheel from PyPI)'
	@echo 'make setup      only installs what is missing (apt; sudo when not root)'
	@echo 'make bench      speed tables, and build/bench/*.json'
	@echo 'make install    installs into PREFIX ($(PREFIX)); DESTDIR is honoured'
	@echo 'make format     clang-format over every source file'
	@echo 'make lint       format check, include check, clang-tidy'
	@echo 'make dev        builds build/dev: assertions, debug information'
	@echo 'make asan|tsan  builds with sanitizers and runs the tests'
	@echo 'make fuzz       builds the fuzz targets, runs each for FUZZ_SECONDS'
	@echo 'make clean      removes what the release build made'

setup:
	@.ci/install-packages build

fuzz-setup:
	@test -f fuzz/CMakeLists.txt || { echo 'make fuzz: there is no fuzz/CMakeLists.txt' >&2; exit 1; }
	@.ci/install-packages fuzz

# Ninja re-runs CMake by itself when a CMakeLists changes, but it does not know the presets.
build/%/build.ninja: CMakePresets.json
	@.ci/install-packages --check build
	cmake --preset $*
	@touch $@

build: $(call configure,release)
	@$(call compile,release)

demo: setup build
	@.ci/gallery

docs: build
	build/release/faceta docs docs/site

test: setup build checks
	$(call ctest,release)

test-peer: build
	@python3 -B tests/peer/materials.py build/release/faceta $(PEER) || [ $$? = 77 ]
	@python3 -B tests/peer/efficiency.py build/release/faceta || [ $$? = 77 ]
	@python3 -B tests/peer/measured.py build/release/faceta || [ $$? = 77 ]

checks:
	.ci/check-rooms --self-test
	.ci/check-rooms
	.ci/check-modules --self-test
	.ci/check-modules

bench: setup build
	@mkdir -p build/bench
	@$(call compile,release) --target bench

format:
	@.ci/install-packages lint
	.ci/format

lint: setup $(call configure,release)
	@.ci/install-packages lint
	.ci/format --check
	.ci/check-rooms
	@cmake --build --preset release --target build.ninja # new files, new flags
	.ci/tidy

install: build
	cmake --install build/release --prefix $(PREFIX)

dev: $(call configure,dev)
	@$(call compile,dev)

asan tsan: %: build/%/build.ninja
	@$(call compile,$@)
	$(call ctest,$@)

fuzz: setup fuzz-setup $(call configure,fuzz)
	@$(call compile,fuzz)
	@.ci/fuzz

clean:
	@test ! -f $(call configure,release) || cmake --build --preset release --target clean

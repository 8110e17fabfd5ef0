# SPDX-License-Identifier: Apache-2.0
# Everything from a fresh machine: `make demo` shows what Noli does, `make test` proves it.
# Packages are installed through apt (Debian 12, Ubuntu 24.04); elsewhere what is missing is named.

JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PRESET ?= release
BUILD := build/$(PRESET)

.PHONY: all help setup build demo test accuracy paper bench cuda-toolkit gpu-check format check clean

all: build

help:
	@echo "make demo    build, simulate scenes/demo.json, say where the results are"
	@echo "make test    build and run all tests"
	@echo "make build   the program, as build/release/noli"
	@echo "make accuracy  scenes with known answers at default settings: what is right, and by how much"
	@echo "make paper   every table and figure of the GIPC supplement, a subset in under 20 minutes;"
	@echo "             make paper FULL=1 takes hours. Results: out/paper"
	@echo "make bench   kernels and whole scenes, timed against the memory bandwidth and a baseline in the"
	@echo "             same run, about ten minutes; make bench FULL=1 takes hours. Results: out/bench"
	@echo "make cuda-toolkit  where there is no nvcc: a CUDA toolkit from Python wheels, in build/cuda-toolkit"
	@echo "make gpu-check  builds for this machine's NVIDIA GPU, compares it with the CPU, sanitizes and times it;"
	@echo "             needs the CUDA toolkit, CMake and the libraries, but no package manager. Results: out/gpu"
	@echo "make check   format, rooms and lint (what CI runs beside the tests)"
	@echo "make format  reformat the sources"

setup:
	@bash tools/setup.sh

$(BUILD)/build.ninja: setup
	@cmake --preset $(PRESET)

build: $(BUILD)/build.ninja
	@cmake --build --preset $(PRESET) -j $(JOBS) --target noli_cli

demo: build
	@$(BUILD)/noli run scenes/demo.json -o out/demo --overwrite
	@echo
	@echo "Results: out/demo (frames.pvd opens in ParaView; stats.csv has one row per step)"

test: $(BUILD)/build.ninja
	@cmake --build --preset $(PRESET) -j $(JOBS)
	@ctest --preset $(PRESET) -j $(JOBS)

# Scenes with known answers, a covering set or, with FULL=1, all of the grid.
accuracy: $(BUILD)/build.ninja
	@cmake --build --preset $(PRESET) -j $(JOBS) --target accuracy
	@mkdir -p out && rm -f out/accuracy.txt
	@ACCURACY_OUT=$(CURDIR)/out/accuracy.txt FULL=$(FULL) $(BUILD)/tests/accuracy --gtest_brief=1
	@python3 tests/accuracy/table.py out/accuracy.txt

# The distribution's Python: it has the packages that setup installs.
paper: $(BUILD)/build.ninja
	@bash tools/setup.sh paper
	@cmake --build --preset $(PRESET) -j $(JOBS) --target noli_cli noli_paper_formulas
	@/usr/bin/python3 paper/all.py --build $(BUILD) $(if $(FULL),--full)

bench: $(BUILD)/build.ninja
	@python3 bench/all.py --build $(BUILD) --jobs $(JOBS) $(if $(FULL),--full)

cuda-toolkit:
	@bash tools/cuda_toolkit.sh

# No setup before it: the machine may have no package manager.
gpu-check:
	@bash tools/gpu_check.sh

check:
	@bash tools/check.sh

format:
	@git ls-files '*.hpp' '*.cpp' '*.cu' '*.cuh' | xargs clang-format-14 -i

clean:
	@rm -rf build out

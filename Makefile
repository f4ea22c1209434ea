# Targets for people; `./run TARGET` installs the packages first.
PRESET ?= release
BUILD := build/$(PRESET)
OUT ?= out

.PHONY: build demo test bench bench-anatomy bench-touch bench-page bench-study study-simulated study-kills verify lint format assets fuzz layout

build: $(BUILD)/build.ninja
	cmake --build $(BUILD)

$(BUILD)/build.ninja: CMakeLists.txt CMakePresets.json
	cmake --preset $(PRESET)

# The main job on the bundled head; the program and the page, without the tests.
demo: $(BUILD)/build.ninja
	cmake --build $(BUILD) --target palpate palpate_page
	mkdir -p $(OUT)
	$(BUILD)/palpate build data/head.ply --unit mm -o $(OUT)/head.glb --report $(OUT)/head.report.html
	@echo
	@echo "The touchable head:  $(CURDIR)/$(OUT)/head.glb (Blender, ParaView, any glTF viewer)"
	@echo "The report:          $(CURDIR)/$(OUT)/head.report.html (any browser)"
	@echo "Touch it:            $(BUILD)/palpate view $(OUT)/head.glb"
	@if [ -t 1 ] && [ -t 0 ]; then exec $(BUILD)/palpate view $(OUT)/head.glb; fi

test: layout build
	ctest --test-dir $(BUILD) --output-on-failure -j 2

# Folder may include folder: the dependency table of docs/decisions/0001-layout.md.
layout:
	sh tools/check_layout.sh

bench: layout
	cmake --preset $(PRESET) -DPALPATE_BENCH=ON
	cmake --build $(BUILD)
	sh bench/run.sh $(BUILD)

# The figures of landmarks, fit and error bars, head by head; TURNS random copies of each. About an hour.
TURNS ?= 20
bench-anatomy: $(BUILD)/build.ninja
	cmake --build $(BUILD) --target palpate
	/usr/bin/python3 bench/anatomy.py $(BUILD)/palpate $(BUILD)/bench-anatomy --turns $(TURNS)

# The figures of touch on the demo's head, as a table; about ten minutes. bench_touch --quick takes one.
bench-touch: build $(OUT)/head.glb
	cmake --preset $(PRESET) -DPALPATE_BENCH=ON
	cmake --build $(BUILD) --target bench_touch
	$(BUILD)/bench/bench_touch --head $(OUT)/head.glb

# How fast the page opens and draws a head of 200 000 vertices, in headless Chromium.
bench-page: build
	$(BUILD)/tests/serve/write_test_head $(BUILD)/bench_page.glb 224
	PALPATE_PROGRAM=$(BUILD)/palpate PALPATE_TEST_HEAD=$(BUILD)/bench_page.glb node bench/page.mjs

# The figures of a large study (100 people, 20 minutes each at 1 kHz); some minutes, 2 GB in /tmp.
bench-study: build
	cmake --preset $(PRESET) -DPALPATE_BENCH=ON
	cmake --build $(BUILD) --target bench_study
	$(BUILD)/bench/bench_study --program $(BUILD)/palpate

# 25 simulated participants through the whole published protocol, unattended, then checked.
study-simulated: build $(OUT)/head.glb
	rm -f $(OUT)/rehearsal.db
	$(BUILD)/palpate study run protocols/head-stiffness-2015.toml $(OUT)/head.glb -o $(OUT)/rehearsal.db --simulate --participants 25
	$(BUILD)/palpate study check $(OUT)/rehearsal.db

# A study killed at 200 random moments: no answer lost, at most a second of samples, the same order.
study-kills: build
	PALPATE_KILLS=200 $(BUILD)/tests/apps/test_apps --gtest_filter='*AKillAtAnyMoment*'

$(OUT)/head.glb:
	$(MAKE) demo

# Exact solutions, GetFEM, CalculiX, mesh studies: docs/method/verification.md.
verify: build
	mkdir -p $(OUT)
	$(BUILD)/palpate verify -o $(OUT)/verification.html
	@echo "The verification:    $(CURDIR)/$(OUT)/verification.html (any browser)"

lint: build
	git ls-files '*.cpp' '*.hpp' | xargs clang-format --dry-run --Werror
	git ls-files 'src/*.cpp' 'apps/*.cpp' | xargs -P 2 -n 4 clang-tidy-16 -p $(BUILD) --quiet

format:
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i

assets:
	sh tools/assets/make_assets.sh

fuzz:
	cmake --preset asan
	cmake --build build/asan --target fuzz_readers
	build/asan/tests/io/fuzz_readers 100000
	build/asan/tests/io/fuzz_readers 1000000 2 head

# A thin layer over the CMake presets. `make` lists the targets.
PRESET  ?= release
BUILD   := build/$(PRESET)
JOBS    ?= $(shell nproc)
SUITE   ?= quick
RESULTS ?= build/results/$(basename $(notdir $(SUITE)))
# Debian's Python modules belong to Debian's interpreter.
PYTHON  ?= /usr/bin/python3
PYTHON_VENV := build/python-venv

# A motion without friction for the report.
MOTION_RESULTS ?= build/results/motion
MOTION = --scenes boxes-and-discs --size 16 --steps 100 --budget 0.5

# One with friction: solvers that are exact, loose, and stopped early (docs/motion.md has more scenes).
FRICTION_RESULTS ?= build/results/friction-motion
FRICTION_MOTION = --scenes data/scenes/arch_of_stones.json \
                  --solvers auto@1e-9,relaxation@1e-9,pgs@1e-6,pgs@1e-3,pgs@50,pgs@10,pgs@10@cold --steps 120

# Pictures of the scene families with their forces, for the report's gallery.
PICTURES     ?= build/results/pictures
PICTURE_SIZE ?= 24

# The campaign `core` runs `auto` from these builds, too, which are for narrower instruction sets.
BASELINE := build/baseline
V3       := build/v3

# The campaigns of the reference by name, and their options. `core`, which has `auto` at the flags of Debian's peers and
# with AVX2, too, is run twice, the second time at the tier of what is published, the other campaigns between its two runs.
PARTS := core friction friction-pathological pathological large sequences core-again
PART_core = --suite core --external "auto-baseline=$(CURDIR)/$(BASELINE)/lcpbench serve auto instructions=sse2" \
            --external "auto-v3=$(CURDIR)/$(V3)/lcpbench serve auto instructions=avx2"
PART_friction              = --suite friction
PART_friction-pathological = --suite friction-pathological
PART_pathological          = --suite pathological --tuned data/tuned.json
PART_large                 = --suite large
PART_sequences             = --suite sequences
PART_core-again            = $(PART_core) --tiers 1e-6
# Largest size classes take about as long as the others together. Each processor has each half of core once.
SHARDS_core       := 1-7/9 8-9/9
SHARDS_core-again := 8-9/9 1-7/9
SHARDS_friction   := 8/8 1-7/8

# Motions without friction driven by own solvers; with it by codes of every law, on straight and on curved edges.
DRIVERS := auto@1e-9,relaxation@1e-9,daqp-relaxed@1e-9,ode-dantzig@1e-9,ode-dantzig-loop@1e-9,siconos-fc2d-nsgs@1e-6,pgs@1e-6,pgs@1e-3,pgs@10,pgs@50,pgs@200,pgs@10@cold,bullet-si-10@1e-6,bullet-si-50@1e-6,bullet-si-1000@1e-6
MOTIONS := motion friction-motion curved-friction-motion
MOTION_motion = --budget 2 --steps 200
MOTION_friction-motion = --scenes data/scenes/slabs_on_slope.json,data/scenes/arch_of_stones.json,data/scenes/sliding_block.json \
                         --solvers $(DRIVERS) --steps 120 --budget 6
MOTION_curved-friction-motion = --scenes drum@velocity,cam-follower@velocity,ovals-in-bowl@velocity --friction 0.5 --size 30 \
                                --solvers $(DRIVERS) --steps 120 --budget 6

# How long and with which new inputs `make fuzz` goes on.
FUZZ_SECONDS ?= 60
FUZZ_CORPUS  := build/fuzz/corpus
FUZZ_FORMATS := json_lines matrix_market protocol journal
FUZZ_FLAGS    = -max_total_time=$(FUZZ_SECONDS) -max_len=8192 -timeout=20 -rss_limit_mb=1024 -malloc_limit_mb=512 \
                -artifact_prefix=build/fuzz/ -print_final_stats=1

# How many problems `make attack` makes, and from which seed on.
ATTACK_PROBLEMS ?= 10000
ATTACK_SEED     ?= 100000

# The campaigns and studies whose results are committed (report/reference/README.md).
REFERENCE         := report/reference
REFERENCE_RESULTS := $(REFERENCE)/core $(REFERENCE)/sequences --motion $(REFERENCE)/motion --pictures $(PICTURES)
REFERENCE_OTHERS  := pathological large friction
# Of a report: folders besides that of its name, and studies.
MORE_friction     := $(REFERENCE)/friction-pathological --motion $(REFERENCE)/friction-motion $(REFERENCE)/curved-friction-motion --pictures $(PICTURES)

.PHONY: $(BASELINE) $(V3) shards-0 shards-1 parts core reference help deps peers configure command build test test-long python-test report run pictures benchmark doc reference-report check format fuzz attack install clean

help:
	@echo "make report   install what is missing, build, run the campaign SUITE (now: $(SUITE)), write build/report/index.html"
	@echo "make test     install what is missing, build, run all tests"
	@echo "make test-long     with more cases what make test proves with few: after changes of solvers or of the report"
	@echo "make python-test   install the Python package into build/python-venv, on the libraries of the build, and run its tests"
	@echo "make build    install what is missing, configure and build"
	@echo "make core       the campaign behind the published numbers, on two processors"
	@echo "make reference  that campaign twice, those with friction, sequences, large and pathological problems and motions: what report/reference has (hours; goes on where it was)"
	@echo "make benchmark       fresh times of our solvers, ODE and Bullet, by size class and origin; of batches, derivatives and scenes (OPTIONS=--benchmark_filter=scene/)"
	@echo "make reference-report   the report of the committed results: page, summary, figures, tables, numbers in README.md and docs/"
	@echo "make peers    install the libraries of the peer solvers (cmake/packages/) and reconfigure"
	@echo "make doc      reference of the public headers, build/doc/html/index.html"
	@echo "make check    formatting, documentation of the public headers, and lint of what was changed (ALL=1: of everything)"
	@echo "make format   reformat our own code"
	@echo "make fuzz     feed every reader of files mutated ones, each for FUZZ_SECONDS (now: $(FUZZ_SECONDS))"
	@echo "make attack   problems of known status at extreme scales, also with friction, by all own solvers (ATTACK_PROBLEMS, ATTACK_SEED; at most an hour)"
	@echo "make install  install library, headers and command (PREFIX=/usr/local)"
	@echo "make clean    remove build/"
	@echo "PRESET=release|debug|asan|tsan chooses the build (now: $(PRESET))"

deps:
	@sh cmake/install_packages.sh cmake/packages/packages.txt

# Configuring looks again for what was not there before; building and reporting then take the workers along.
peers:
	@sh cmake/install_packages.sh cmake/packages/packages-peers.txt
	@sh cmake/install_wheels.sh $(PYTHON) cmake/packages/requirements-peers.txt build/peers-venv
	@sh cmake/install_sources.sh cmake/packages/sources-peers.txt build/peers-sources
	@$(MAKE) --no-print-directory configure

configure: deps
	@cmake --preset $(PRESET) > build/configure-$(PRESET).log 2>&1 || { cat build/configure-$(PRESET).log; exit 1; }

build: configure
	@cmake --build --preset $(PRESET) -j $(JOBS)

test: build
	@rm -rf $(BUILD)/Testing/tests.xml $(BUILD)/Testing/gtest
	@ctest --preset $(PRESET) -j $(JOBS) --output-junit Testing/tests.xml; status=$$?; \
	  $(PYTHON) tests/skipped.py $(BUILD)/Testing/tests.xml $(BUILD)/Testing/gtest; exit $$status

test-long: build
	@ctest --preset $(PRESET) -j $(JOBS) -C Long -L long

# pip builds the extension alone, in build/python, with the tools of the environment itself.
python-test: command
	@cmake --build --preset $(PRESET) -j $(JOBS) --target lcpbench_step
	@[ -x $(PYTHON_VENV)/bin/python ] || $(PYTHON) -m venv $(PYTHON_VENV)
	@$(PYTHON) -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")' \
	  > build/python-requires.txt
	@$(PYTHON_VENV)/bin/pip install -q -r build/python-requires.txt
	@$(PYTHON_VENV)/bin/pip install -q --no-build-isolation --config-settings=build-dir=build/python \
	  --config-settings=cmake.define.LCPBENCH_BUILD_TREE=$(CURDIR)/$(BUILD) '.[test]'
	@$(PYTHON_VENV)/bin/python -m pytest -q

# Only the command: a newcomer's first report should not wait for the tests to compile.
command: configure
	@cmake --build --preset $(PRESET) -j $(JOBS) --target lcpbench_command

# The quick campaign begins anew, so that it is never of two versions. Longer ones are not thrown away: where there is
# one, RUN_OPTIONS=--resume goes on with it, and tells if it was begun with another version.
run: command
	@$(if $(filter build/results/quick,$(RESULTS)),rm -rf build/results/quick)
	@$(BUILD)/lcpbench run --suite $(SUITE) $(RUN_OPTIONS) --output $(RESULTS)

pictures: command
	@mkdir -p $(PICTURES)
	@$(BUILD)/lcpbench list scenes > $(PICTURES)/scenes.txt
	@while read -r scene words; do \
	  $(BUILD)/lcpbench scene $$scene --size $(PICTURE_SIZE) -o $(PICTURES)/$$scene.svg || exit 1; \
	done < $(PICTURES)/scenes.txt

report: run pictures
	@$(BUILD)/lcpbench motion $(MOTION) --output $(MOTION_RESULTS)
	@$(BUILD)/lcpbench motion $(FRICTION_MOTION) --output $(FRICTION_RESULTS)
	@$(BUILD)/lcpbench report $(RESULTS) --motion $(MOTION_RESULTS) $(FRICTION_RESULTS) --pictures $(PICTURES) --output build/report/index.html
	@echo "report: $(CURDIR)/build/report/index.html"

# The report of the committed results. What is committed of it: its summary, and the numbers in README.md and docs/.
reference-report: pictures
	@$(PYTHON) report/report.py report $(REFERENCE_RESULTS) -o build/reference/index.html
	@cp build/reference/summary.md $(REFERENCE)/
	@$(foreach suite,$(REFERENCE_OTHERS), \
	  $(PYTHON) report/report.py report $(REFERENCE)/$(suite) $(MORE_$(suite)) -o build/reference/$(suite)/index.html && \
	  cp build/reference/$(suite)/summary.md $(REFERENCE)/$(suite)-summary.md || exit 1;)
	@$(PYTHON) report/report.py headline $(REFERENCE)/core $(REFERENCE)/sequences --update README.md docs/*.md
	@echo "report: $(CURDIR)/build/reference/index.html, with figures and tables beside it"

$(BASELINE) $(V3): deps
	@mkdir -p build
	@cmake --preset $(@F) > build/configure-$(@F).log 2>&1 || { cat build/configure-$(@F).log; exit 1; }
	@cmake --build --preset $(@F) -j $(JOBS)

# One processor's shards of all PARTS, one after the other; goes on where it was.
shards-0 shards-1: shards-%: command
	@$(foreach part,$(PARTS),$(BUILD)/lcpbench run $(PART_$(part)) $(RUN_OPTIONS) --resume --cpu $* \
	  --shard $(if $(filter 0,$*),$(firstword $(SHARDS_$(part)) 1/2),$(lastword 2/2 $(SHARDS_$(part)))) \
	  --output build/results/$(part)-$* &&) true

# PARTS on two processors.
parts: shards-0 shards-1
	@$(foreach part,$(PARTS),rm -rf build/results/$(part) && \
	  $(BUILD)/lcpbench merge build/results/$(part)-0 build/results/$(part)-1 --output build/results/$(part) &&) true

core: $(BASELINE) $(V3)
	@$(MAKE) --no-print-directory -j 2 parts PARTS=core

# Everything that is committed below report/reference, at one commit, and the pages made of it. Goes on where it was.
reference: command $(BASELINE) $(V3)
	@$(MAKE) --no-print-directory -j 2 parts
	@$(foreach study,$(MOTIONS),$(BUILD)/lcpbench motion $(MOTION_$(study)) --output build/results/$(study) &&) true
	@rm -rf $(REFERENCE)/*/
	@$(foreach folder,$(PARTS) $(MOTIONS), \
	  $(PYTHON) report/report.py compact build/results/$(folder) -o $(REFERENCE)/$(folder) &&) true
	@$(MAKE) --no-print-directory reference-report

benchmark: configure
	@cmake --build --preset $(PRESET) -j $(JOBS) --target lcpbench_benchmark
	@$(BUILD)/lcpbench_benchmark $(OPTIONS)

doc: configure
	@cmake --build --preset $(PRESET) --target doc > build/doc.log || { cat build/doc.log; exit 1; }
	@echo "documentation: $(CURDIR)/build/doc/html/index.html"

check: configure
	@sh cmake/check_style.sh $(BUILD)

format:
	@git ls-files '*.h' '*.cc' '*.c' | xargs clang-format -i

fuzz: deps
	@command -v clang++ > /dev/null || { echo "make fuzz needs clang and libclang-rt-14-dev (apt-get install)"; exit 2; }
	@cmake --preset fuzz > build/configure-fuzz.log 2>&1 || { cat build/configure-fuzz.log; exit 1; }
	@cmake --build --preset fuzz -j $(JOBS)
	@mkdir -p $(FUZZ_CORPUS) $(foreach format,$(FUZZ_FORMATS),$(FUZZ_CORPUS)-$(format))
	@build/fuzz/tests/fuzz/scene_reader_fuzzer $(FUZZ_FLAGS) -dict=tests/fuzz/scene.dict \
	  $(FUZZ_CORPUS) data/scenes tests/fuzz/corpus
	@for format in $(FUZZ_FORMATS); do \
	  build/fuzz/tests/fuzz/$${format}_fuzzer $(FUZZ_FLAGS) \
	    $(FUZZ_CORPUS)-$$format tests/fuzz/$${format}_corpus || exit 1; \
	done
	@$(PYTHON) python/tests/formats/fuzz.py --seconds $(FUZZ_SECONDS)

attack: configure
	@cmake --build --preset $(PRESET) -j $(JOBS) --target attack
	@$(BUILD)/tests/attack --problems $(ATTACK_PROBLEMS) --first $(ATTACK_SEED) --each-tier --threads $(JOBS)
	@$(BUILD)/tests/attack --friction --problems $(ATTACK_PROBLEMS) --first $(ATTACK_SEED) --limit 0.5 --threads $(JOBS)

install: build
	@cmake --install $(BUILD) $(if $(PREFIX),--prefix $(PREFIX))

clean:
	@rm -rf build

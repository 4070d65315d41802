# A thin layer over the CMake presets. `make` lists the targets.
PRESET  ?= release
BUILD   := build/$(PRESET)
JOBS    ?= $(shell nproc)
RESULTS ?= build/results/default
SUITE   ?= default
# Debian's Python modules belong to Debian's interpreter.
PYTHON  ?= /usr/bin/python3

.PHONY: help deps peers configure build test report run check format install clean

help:
	@echo "make report   install what is missing, build, run the default suite, write build/report/index.html"
	@echo "make test     install what is missing, build, run all tests"
	@echo "make build    install what is missing, configure and build"
	@echo "make peers    install the libraries of the peer solvers (packages-peers.txt) and reconfigure"
	@echo "make check    formatting and lint"
	@echo "make format   reformat our own code"
	@echo "make install  install library, headers and command (PREFIX=/usr/local)"
	@echo "make clean    remove build/"
	@echo "PRESET=release|debug|asan chooses the build (now: $(PRESET))"

deps:
	@sh cmake/install_packages.sh packages.txt

# Configuring looks again for what was not there before; building and reporting then take the workers along.
peers:
	@sh cmake/install_packages.sh packages-peers.txt
	@$(MAKE) --no-print-directory configure

configure: deps
	@cmake --preset $(PRESET) > build/configure-$(PRESET).log 2>&1 || { cat build/configure-$(PRESET).log; exit 1; }

build: configure
	@cmake --build --preset $(PRESET) -j $(JOBS)

test: build
	@ctest --preset $(PRESET) -j $(JOBS)

# Only the command: a newcomer's first report should not wait for the tests to compile.
run: configure
	@cmake --build --preset $(PRESET) -j $(JOBS) --target lcpbench_command
	@$(BUILD)/lcpbench run --suite $(SUITE) --output $(RESULTS)

report: run
	@$(BUILD)/lcpbench report $(RESULTS) --output build/report/index.html
	@echo "report: $(CURDIR)/build/report/index.html"

check: configure
	@sh cmake/check_style.sh $(BUILD)

format:
	@git ls-files '*.h' '*.cc' | xargs clang-format -i

install: build
	@cmake --install $(BUILD) $(if $(PREFIX),--prefix $(PREFIX))

clean:
	@rm -rf build

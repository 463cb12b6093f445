# fairlead. `make help` lists the targets. One makefile, no recursion but for other compilers and sanitizers.
.DEFAULT_GOAL := help
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc) --output-sync=target --no-print-directory
endif

BUILD ?= build
CXX   := $(if $(filter default,$(origin CXX)),g++,$(CXX))
OPT   ?= -O2

STRICT := -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow -Werror
ifneq (,$(findstring clang,$(CXX)))
STRICT += -Wno-double-promotion  # clang 14 counts double{x} as implicit; g++ checks promotions for both
endif
# the same bits everywhere: no fused multiply-add, no errno side of sqrt, baseline instruction set
BITS   := -ffp-contract=off -fno-math-errno
BASE   := -std=c++17 -g -pthread $(BITS) $(STRICT) -Ilib/include -I.
HOST   := $(BASE) $(OPT) $(EXTRA)
DEVICE := $(BASE) $(OPT) -fno-exceptions -fno-rtti

LIB_HEADERS := $(shell find lib/include -name '*.hpp' | sort)
# what is generated, or keeps the kernel's style, is not formatted
OWN_SOURCES := $(shell git ls-files -co --exclude-standard '*.hpp' '*.cpp' '*.h' '*.c' \
                 ':!examples/gateway/clients' ':!tests/linux_vm/module' 2>/dev/null)

# ---- programs and tests: one object per source file, headers tracked by the compiler
objects = $(patsubst %.cpp,$(BUILD)/obj/%.o,$(1))
UNIT_SOURCES := $(sort $(wildcard tests/unit/*.cpp tests/laws/*.cpp))

$(BUILD)/obj/%.o: %.cpp
	@mkdir -p $(@D)
	$(CXX) $(HOST) $(GLUE) -MMD -MP -c $< -o $@

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)

$(BUILD)/tests/unit: $(call objects,$(UNIT_SOURCES)) $(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -lgtest -lgtest_main -o $@

# ---- the host simulator: a program, and its parts as an archive for the tests
SIM_SOURCES := $(filter-out host_sim/sim.cpp, \
                 $(sort $(wildcard host_sim/*.cpp host_sim/commands/*.cpp host_sim/models/*.cpp \
                                  host_sim/report/*.cpp host_sim/experiments/*.cpp \
                                  host_sim/baselines/filters/*.cpp)))
$(BUILD)/libsim.a: $(call objects,$(SIM_SOURCES))
	@rm -f $@ && $(AR) rcs $@ $^
$(BUILD)/fairlead-sim: $(call objects,host_sim/sim.cpp) $(BUILD)/libsim.a $(BUILD)/libpeers.a
	$(CXX) $(HOST) -Wl,--start-group $^ -Wl,--end-group -lz -o $@

# command-line glue is wide and never hot: compile it fast
$(BUILD)/obj/host_sim/commands/%.o $(BUILD)/obj/host_sim/sim.o: GLUE := -O1 -g0

.PHONY: sim demo readme same-bytes
sim: setup-build ## build the host simulator, build/fairlead-sim
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-sim

RECORDING   ?= $(BUILD)/demo/generated.trk
DEMO_MOTION := model:optical+rest:2+reach:0.9:12+oscillate:6:1.5+gap:0.4+reach:0.7:8+turn:1.2:12+rest:4
demo: setup-build setup-demo ## replay a recording (a generated one, or RECORDING=FILE): table and report
	@$(MAKE) -s BUILD=$(BUILD) $(BUILD)/fairlead-sim $(RECORDING)
	@$(BUILD)/fairlead-sim replay $(RECORDING) --filter binomial:9 --out $(BUILD)/demo
readme: demo ## put the present output of make demo into the README
	@tests/sim/test_readme.py --write
same-bytes: setup-clang ## the same stream from g++ and clang++, -O0 and -O2, on all recordings
	@tests/sim/test_same_bytes.py $(wildcard ../shared/recordings/tracker120/*.trk)
$(BUILD)/demo/generated.trk: $(BUILD)/fairlead-sim
	@mkdir -p $(@D)
	@$(BUILD)/fairlead-sim generate '$(DEMO_MOTION)' --seed 1 --out $@

# small examples, one idea each; and what is tested from the outside
SMALL_EXAMPLES := $(patsubst %,$(BUILD)/examples/%,filter reduce decode)
$(SMALL_EXAMPLES): $(BUILD)/examples/%: $(BUILD)/obj/examples/%.o
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -o $@
build-tests: $(SMALL_EXAMPLES)
SIM_TESTS := $(sort $(wildcard tests/sim/test_*.py))
test: setup-demo

# ---- the Linux port: an archive, and its tests
PORT_SOURCES := $(sort $(wildcard port/linux/*.cpp))
PORT_TESTS   := $(sort $(wildcard tests/port/*.cpp))
$(BUILD)/libport.a: $(call objects,$(PORT_SOURCES))
	@rm -f $@ && $(AR) rcs $@ $^
$(BUILD)/tests/port: $(call objects,$(PORT_TESTS) examples/record/writer.cpp) $(BUILD)/libport.a $(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -lgpiod -lgtest -lgtest_main -o $@

# fairlead-record: a sensor into a file
$(BUILD)/fairlead-record: $(call objects,examples/record/record.cpp examples/record/writer.cpp) $(BUILD)/libport.a $(BUILD)/libsim.a
	$(CXX) $(HOST) $^ -lgpiod -o $@
.PHONY: record
record: setup-build setup-test ## build the recorder, build/fairlead-record
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-record

# both versions of libgpiod, each over a fake line; version 2 by declarations of the tests' own
GPIO_TESTS := tests/port/gpio/test_gpio.cpp tests/port/gpio/fake.cpp port/linux/gpio.cpp
$(BUILD)/tests/gpio1: $(GPIO_TESTS) tests/port/gpio/fake_v1.cpp port/linux/gpio.hpp port/linux/button.hpp
	@mkdir -p $(@D)
	$(CXX) $(HOST) $(filter %.cpp,$^) -lgtest -lgtest_main -o $@
$(BUILD)/tests/gpio2: $(GPIO_TESTS) tests/port/gpio/fake_v2.cpp port/linux/gpio.hpp port/linux/button.hpp
	@mkdir -p $(@D)
	$(CXX) $(HOST) -Itests/port/gpio/v2 $(filter %.cpp,$^) -lgtest -lgtest_main -o $@

# the port against a real kernel: a Debian machine under QEMU, its programs linked statically
VM_PROGRAMS  := $(addprefix $(BUILD)/linux_vm/bin/,slave stream stub iio edges verify record)
VM_PARTS     := $(call objects,$(wildcard host_sim/models/*.cpp host_sim/stream*.cpp) host_sim/writers.cpp \
                  $(addprefix port/linux/,gpio.cpp i2c.cpp i2c_smbus.cpp))
VM_RECORDING := $(or $(firstword $(wildcard ../shared/recordings/08*.imu ../shared/recordings/*.imu)),-)
$(BUILD)/linux_vm/bin/record: $(call objects,examples/record/record.cpp examples/record/writer.cpp) $(VM_PARTS)
	@mkdir -p $(@D)
	$(CXX) $(HOST) -static $^ -lgpiod -lz -o $@
$(BUILD)/linux_vm/bin/%: $(BUILD)/obj/tests/linux_vm/%.o $(VM_PARTS)
	@mkdir -p $(@D)
	$(CXX) $(HOST) -static $^ -lgpiod -lz -o $@
.PHONY: linux-vm-test
linux-vm-test: setup-build setup-gateway setup-linux-vm ## boot a Debian kernel under QEMU and run the port against it (minutes)
	@$(MAKE) BUILD=$(BUILD) $(VM_PROGRAMS) $(BUILD)/fairlead-gateway $(BUILD)/fairlead-poll
	@tests/linux_vm/run $(BUILD) $(VM_RECORDING)

# the sensor drivers on a microcontroller: they compile for a Cortex-M4F and ask for no heap
ARM_PORT := arm-none-eabi-g++ -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard
$(BUILD)/device/drivers.o: tests/port/device/drivers.cpp $(wildcard port/sensors/*.hpp) $(LIB_HEADERS)
	@mkdir -p $(@D)
	$(ARM_PORT) $(filter-out -pthread,$(DEVICE)) -fno-threadsafe-statics -c $< -o $@
.PHONY: port-device
port-device: setup-target ## the sensor drivers for a Cortex-M4F: no heap, no exceptions
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/device/drivers.o
	@! arm-none-eabi-nm -uC $(BUILD)/device/drivers.o | grep -E 'malloc|calloc|realloc|free|operator|__cxa|unwind'
	@echo "ok port-device: no heap, no exceptions" && arm-none-eabi-size $(BUILD)/device/drivers.o

# ---- the gateway: Modbus, sources, configuration, and the reader for the other side
GATEWAY_LIBS    := -lmodbus -lsystemd -lgpiod
GATEWAY_MAINS   := $(wildcard examples/gateway/*_main.cpp)
GATEWAY_SOURCES := $(filter-out $(GATEWAY_MAINS),$(sort $(wildcard examples/gateway/*.cpp)))
$(BUILD)/libgateway.a: $(call objects,$(GATEWAY_SOURCES))
	@rm -f $@ && $(AR) rcs $@ $^
$(BUILD)/fairlead-%: $(BUILD)/obj/examples/gateway/%_main.o $(BUILD)/libgateway.a $(BUILD)/libport.a $(BUILD)/libsim.a
	$(CXX) $(HOST) $^ $(GATEWAY_LIBS) -o $@
.SECONDARY: $(call objects,$(GATEWAY_MAINS))
GATEWAY_MEASURE := $(sort $(wildcard tests/gateway/measure/*.cpp))
$(BUILD)/fairlead-gateway-measure: $(call objects,$(GATEWAY_MEASURE)) $(BUILD)/libgateway.a $(BUILD)/libport.a $(BUILD)/libsim.a
	$(CXX) $(HOST) $^ $(GATEWAY_LIBS) -o $@
$(BUILD)/count_allocations.so: tests/gateway/measure/count_allocations.c
	@mkdir -p $(@D)
	gcc -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC $< -o $@
.PHONY: gateway
gateway: setup-build setup-gateway ## build the gateway and its reader: build/fairlead-gateway, build/fairlead-poll
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-gateway $(BUILD)/fairlead-poll
.PHONY: gateway-peers gateway-measure
gateway-peers: setup-gateway setup-modbus-peers ## other people's Modbus clients against the gateway, TCP and RTU
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-gateway $(BUILD)/fairlead-poll
	@/usr/bin/python3 tests/gateway/service.py $(BUILD)
	@/usr/bin/python3 tests/gateway/peers.py $(BUILD)
gateway-measure: setup-gateway ## the figures of docs/gateway.md: a quarter of an hour
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-gateway $(BUILD)/fairlead-gateway-measure $(BUILD)/count_allocations.so
	@set -e; for what in torn load history noise noise-table restart '--seconds 20 allocations' '--seconds 600 memory'; do \
	    echo "fairlead-gateway-measure $$what"; $(BUILD)/fairlead-gateway-measure $$what; done
$(BUILD)/firmware-motion: $(call objects,tests/gateway/firmware/motion.cpp) $(BUILD)/libsim.a
	$(CXX) $(HOST) $^ -o $@
.PHONY: gateway-firmware gateway-sanitize
gateway-firmware: setup-gateway setup-target ## the firmware image under QEMU, its UART into the gateway, a client rebuilds
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/fairlead-gateway $(BUILD)/fairlead-poll $(BUILD)/firmware-motion
	+@$(TARGET) BUILD=$(BUILD)/target $(BUILD)/target/firmware/firmware.elf
	@tests/gateway/firmware/run.py $(BUILD)
gateway-sanitize: setup-clang setup-gateway setup-test ## the gateway's tests and a hostile minute under ASan with UBSan, and under TSan
	@set -e; export TSAN_OPTIONS=halt_on_error=1; for what in address,undefined thread; do b=build/sanitize-$${what%%,*}; \
	    $(MAKE) BUILD=$$b CXX=clang++ OPT=-O1 EXTRA="-fsanitize=$$what -fno-sanitize-recover=all" \
	        $$b/tests/gateway $$b/fairlead-gateway $$b/fairlead-gateway-measure; \
	    tests/run $$b/tests/gateway; \
	    for run in '--growth 100000 memory' noise restart; do \
	        $$b/fairlead-gateway-measure --gateway $$b/fairlead-gateway --seconds 20 $$run; done; done; echo "ok gateway-sanitize"
.PHONY: registers
registers:       ## write docs/registers.md and the client configurations from the register map
registers: $(BUILD)/fairlead-registers
	@mkdir -p examples/gateway/clients
	@$<
GATEWAY_TESTS := $(sort $(wildcard tests/gateway/*.cpp))
$(BUILD)/tests/gateway: $(call objects,$(GATEWAY_TESTS)) $(BUILD)/libgateway.a $(BUILD)/libport.a $(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -lgtest -lgtest_main $(GATEWAY_LIBS) -o $@

# ---- our reducer beside its rivals: baselines as an archive, and the program (docs/peers.md)
PEERS_SOURCES := $(filter-out %/sisl.cpp, $(sort $(wildcard host_sim/baselines/*.cpp \
                   host_sim/baselines/knots/*.cpp host_sim/baselines/compress/*.cpp)))
BENCH_PEERS   := $(sort $(wildcard host_sim/bench_peers/*.cpp)) host_sim/baselines/knots/sisl.cpp
$(BUILD)/libpeers.a: $(call objects,$(PEERS_SOURCES))
	@rm -f $@ && $(AR) rcs $@ $^
$(BUILD)/bench-peers: $(call objects,$(BENCH_PEERS)) $(BUILD)/libpeers.a $(BUILD)/libsim.a
	$(CXX) $(HOST) $^ -lsisl -lz -o $@

PEERS_TESTED := $(addprefix host_sim/bench_peers/,cache.cpp ours.cpp report.cpp subjects.cpp)
$(BUILD)/tests/peers: $(call objects,$(sort $(wildcard tests/peers/*.cpp)) $(PEERS_TESTED)) \
                      $(BUILD)/libpeers.a $(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -lgtest -lgtest_main -lz -o $@

.PHONY: bench-peers
bench-peers: setup-build setup-peers ## control points and bytes beside the rivals; rewrites the table in docs/peers.md
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/bench-peers $(BUILD)/fairlead-sim
	$(BUILD)/bench-peers --page docs/peers.md --control-points host_sim/bench_peers/control_points.csv \
	  --sweep host_sim/bench_peers/sweep.csv

# ---- every public header compiles alone, strictly, without exceptions and RTTI
$(BUILD)/headers/%.ok: lib/include/%.hpp $(LIB_HEADERS)
	@mkdir -p $(@D)
	$(CXX) $(DEVICE) -fsyntax-only -include $< -x c++ /dev/null && touch $@

##
.PHONY: help
help:            ## list the targets
	@grep -hE '^[a-z-]+:.*## ' Makefile | sed -E 's/^([a-z-]+):.*## /  \1|/' | column -t -s'|'

.PHONY: setup-build setup-gateway setup-modbus-peers setup-demo setup-test setup-clang setup-lint
setup-%:
	@.ci/setup $*

.PHONY: test
TEST_PROGRAMS := $(BUILD)/tests/unit $(BUILD)/tests/port $(BUILD)/tests/gpio1 $(BUILD)/tests/gpio2 $(BUILD)/tests/gateway $(BUILD)/tests/peers
test: setup-build setup-test setup-gateway ## build and run all tests that need no other machine (installs what is missing)
	@$(MAKE) BUILD=$(BUILD) build-tests
	@BUILD=$(BUILD) tests/run $(TEST_PROGRAMS) $(SIM_TESTS)

.PHONY: build-tests headers
build-tests: $(TEST_PROGRAMS) $(BUILD)/fairlead-record $(BUILD)/fairlead-sim headers
headers:         ## compile every public header alone, under the strict flags
headers: $(patsubst lib/include/%.hpp,$(BUILD)/headers/%.ok,$(LIB_HEADERS))

.PHONY: test-clang test-sanitize
test-clang: setup-clang ## the same tests, built with clang++
	@$(MAKE) test BUILD=build/clang CXX=clang++
test-sanitize: setup-clang ## the same tests under AddressSanitizer and UBSan
	@$(MAKE) test BUILD=build/sanitize CXX=clang++ OPT=-O1 EXTRA='-D_GLIBCXX_ASSERTIONS -fsanitize=address,undefined -fno-sanitize-recover=all'

.PHONY: format format-check tidy
format: setup-lint ## rewrite the sources in the project's format
	@clang-format -i $(OWN_SOURCES)
format-check: setup-lint ## fail where a source is not in the project's format
	@clang-format --dry-run --Werror $(OWN_SOURCES)
tidy: setup-lint ## clang-tidy over the library
	@mkdir -p $(BUILD) && printf '#include "%s"\n' $(LIB_HEADERS:lib/include/%=%) > $(BUILD)/tidy.cpp
	@clang-tidy --quiet --header-filter='lib/include/.*' $(BUILD)/tidy.cpp -- $(BASE)

# ---- double-precision references and baselines use Eigen; the library never does
HOST += -isystem /usr/include/eigen3
test: setup-reference

$(BUILD)/tests/strain: $(call objects,tests/recordings/strain.cpp) $(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -o $@

# ---- smoothing side by side: whole-buffer strain, the gradient descent of its paper, fairing
SMOOTH_BASELINES := $(sort $(wildcard host_sim/baselines/filters/*.cpp))
$(BUILD)/bench-smooth: $(call objects,host_sim/bench_smooth/smooth.cpp $(SMOOTH_BASELINES))
	$(CXX) $(HOST) $^ -lbenchmark -o $@
.PHONY: bench bench-smooth
bench: bench-smooth ## time smoothing beside its rivals (also: bench-peers, compare, attitude-table)
bench-smooth: setup-build setup-bench ## time strain smoothing beside gradient descent and fairing
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/bench-smooth
	$(BUILD)/bench-smooth

.PHONY: compare
COMPARED = $(wildcard $(RECORDINGS)/tracker120/*.trk)
compare: setup-build sim ## our causal filters beside their rivals, on all recordings: the tables and plot of docs/choose.md (minutes)
	$(BUILD)/fairlead-sim compare $(COMPARED) --seconds 12 --page docs/choose.md --out $(BUILD)/compare
	@cp $(BUILD)/compare/compare_06*.svg docs/img/compare.svg

.PHONY: experiments
experiments: setup-demo sim ## rerun the papers' experiments: rewrites the tables and plots of docs/experiments
	$(BUILD)/fairlead-sim experiment all --out docs/experiments

.PHONY: test-strain
test-strain: setup-build setup-reference ## hold fixed-lag strain smoothing to the whole-buffer solve, on every tracker recording (minutes)
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/tests/strain
	@tests/run $(BUILD)/tests/strain

# ---- Cortex-M and RISC-V under an emulator: rules in tests/target/target.mk, guides docs/bounds.md, docs/target.md
TARGET = $(MAKE) -s -f tests/target/target.mk
CORE  ?= m4f
.PHONY: target-test target-soak bounds size firmware-run must-fail
target-test: setup-target ## the same bits on every core, exact counts, BOUNDS.md, heap and stack checks, a firmware run
	+@$(TARGET) calibrate same-bits bounds trap firmware-run recordings
target-soak: setup-target ## all recordings on all cores, and a longer search for dear streams
	+@$(TARGET) same-bits search recordings SOAK=1
bounds: setup-target ## check BOUNDS.md (ACCEPT=1: write it), or your CONFIG=header CORE=m4f RECORDING=file BUDGET=n
	+@$(TARGET) $(if $(CONFIG),user CORES=$(CORE),bounds)
size: setup-target ## flash, RAM and stack of the firmware example, and its linker map
	+@$(TARGET) firmware
firmware-run: setup-target ## run the firmware example under QEMU and decode what its UART sent
	+@$(TARGET) firmware-run
must-fail: setup-target ## plant six faults in a copy of the tree: the target checks must catch each
	@tests/must_fail/plantings.py

# ---- orientation on the recordings: the tables of docs/attitude.md, and a day of data
RECORDINGS ?= ../shared/recordings
$(BUILD)/bench-attitude: $(call objects,$(wildcard host_sim/bench_attitude/*.cpp host_sim/baselines/ahrs/*.cpp)) \
		$(BUILD)/libsim.a
	@mkdir -p $(@D)
	$(CXX) $(HOST) $^ -o $@

.PHONY: attitude-table attitude-day attitude-counts
attitude-table: setup-build setup-reference ## measure orientation on all recordings and rewrite the tables of docs/attitude.md
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/bench-attitude
	$(BUILD)/bench-attitude table $(RECORDINGS) --into docs/attitude.md
attitude-day: setup-build setup-reference ## a day of recordings on end: float beside double, covariance positive throughout
	@$(MAKE) BUILD=$(BUILD) $(BUILD)/bench-attitude
	$(BUILD)/bench-attitude day $(RECORDINGS)
attitude-counts: setup-target ## instructions of an attitude sample on a Cortex-M4F, all recordings, against their budgets
	@+$(TARGET) images build/target/count.so CORES=m4f SUBJECTS='attitude attitude_imu'
	@tests/target/attitude_counts.py --recordings $(RECORDINGS)

# ---- packages: install for pkg-config and CMake, and the folder that the Arduino tools want
PREFIX   ?= /usr/local
INCLUDED := $(DESTDIR)$(PREFIX)/include
SHARED   := $(DESTDIR)$(PREFIX)/share
.PHONY: install uninstall arduino test-packages
install:         ## install the headers, fairlead.pc and the CMake package (PREFIX=/usr/local, DESTDIR=)
	install -d $(INCLUDED) $(SHARED)/pkgconfig $(SHARED)/cmake
	cp -R lib/include/fairlead $(INCLUDED)/
	install -m 644 lib/fairlead.pc $(SHARED)/pkgconfig/
	install -d $(SHARED)/cmake/fairlead && install -m 644 lib/cmake/*.cmake $(SHARED)/cmake/fairlead/
uninstall:       ## remove what install put there
	rm -rf $(INCLUDED)/fairlead $(SHARED)/cmake/fairlead $(SHARED)/pkgconfig/fairlead.pc
arduino:         ## lay the library out for the Arduino tools, in build/arduino/fairlead
	@rm -rf $(BUILD)/arduino && mkdir -p $(BUILD)/arduino/fairlead/src
	@cp -R lib/include/fairlead $(BUILD)/arduino/fairlead/src/ && cp lib/library.properties LICENSE $(BUILD)/arduino/fairlead/
	@printf '#pragma once\n#include "fairlead/pipeline.hpp"\n' >$(BUILD)/arduino/fairlead/src/fairlead.h
test-packages: setup-packages arduino ## use the installed library from outside, and check every manifest
	@tests/packages/check.py

.PHONY: clean
clean:           ## remove everything that was built
	rm -rf build

include tests/tables/tables.mk

# fairlead. `make help` lists the targets.
#
# How this file is built up:
#   flags          all compiler flags, in one place
#   setup          a call of make first installs what its goals need (.ci/setup), then builds
#   programs       one line for each archive and each program; one recipe for all of them
#   targets        "name: prerequisites ## [tasks] help text": documented targets. The tasks in brackets say
#                  what the target needs; .ci/packages lists the packages of each task. A documented target
#                  without brackets is an error. It is phony; no other list says so.
# make calls itself only for another compiler, a sanitizer or a microcontroller (tests/target/target.mk).
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
ifeq (,$(MAKELEVEL:0=)$(filter -j%,$(MAKEFLAGS)))
MAKEFLAGS += -j$(or $(shell getconf _NPROCESSORS_ONLN 2>/dev/null),2) --no-print-directory
endif

BUILD      ?= build
export PYTHONDONTWRITEBYTECODE := 1  # a run leaves the tree as it was
RECORDINGS ?= ../shared/recordings

# ---- flags
CXX    := $(if $(filter default,$(origin CXX)),g++,$(CXX))
OPT    ?= -O2
include .ci/flags.mk
# clang 14 counts double{x} as implicit; g++ checks promotions for both
BASE   := $(CHECKED) -pthread $(if $(findstring clang,$(CXX)),-Wno-double-promotion)
# double-precision references and baselines use Eigen; the library never does
HOST   := $(BASE) $(OPT) $(EXTRA) -isystem /usr/include/eigen3
DEVICE := $(BASE) $(OPT) $(BARE_CPP)

# ---- setup: before anything is built, and once for all goals of this call (SETUP=no skips it)
include .ci/progress.mk
GOALS := $(or $(MAKECMDGOALS),$(.DEFAULT_GOAL))
# help needs nothing but make and a shell
WORK  := $(filter-out help,$(GOALS))
.PHONY: help $(if $(WORK),$(shell sed -n 's/^\([a-z][a-z-]*\):.*\#\# \[.*/\1/p' Makefile))
# c-library needs a cross compiler where the call names a core
CORE_TASKS := $(if $(filter c-library,$(GOALS)),$(if $(filter m%,$(CORE)),task:cortex-m) $(if $(filter rv%,$(CORE)),task:risc-v))
ifeq (,$(COUNTING)$(DRY_RUN)$(filter no,$(SETUP)))
ifneq (,$(if $(WORK),$(shell .ci/setup $(GOALS) $(CORE_TASKS) || echo failed)))
$(error the setup of '$(GOALS)' did not succeed; the lines above say why)
endif
endif

# ---- how objects, archives and programs are made
objects = $(patsubst %.cpp,$(BUILD)/obj/%.o,$(1))
sources = $(sort $(wildcard $(1)))
$(BUILD)/obj/%.o: %.cpp
	$(call step,$<) $(CXX) $(HOST) $(GLUE) -MMD -MP -c $< -o $@
-include $(if $(and $(WORK),$(wildcard $(BUILD)/obj)),$(shell find $(BUILD)/obj -name '*.d'))
# command-line glue is wide and never hot: compile it fast
$(BUILD)/obj/host_sim/commands/%.o $(BUILD)/obj/host_sim/sim.o: GLUE := -O1

# the pages embed their style, their scripts and Debian's libraries
$(BUILD)/obj/host_sim/report/assets.o: $(wildcard host_sim/report/page/*)
$(BUILD)/obj/examples/live/page.o: $(wildcard examples/live/page/*)

# $(call archive,NAME,SOURCES) makes lib<NAME>.a
define archive
$(BUILD)/lib$(1).a: $(call objects,$(2))
	@rm -f $$@
	$$(call step,lib$(1).a) $$(AR) rcs $$@ $$^
endef
# $(call program,NAME,SOURCES,ARCHIVES,LIBRARIES) links a program
define program
$(BUILD)/$(strip $(1)): $(call objects,$(2)) $(foreach a,$(3),$(BUILD)/lib$(a).a)
	$$(call step,link $(strip $(1))) $$(CXX) $$(HOST) -Wl,--start-group $$^ -Wl,--end-group $(4) -o $$@
endef

# ---- archives: the wings of the host simulator, the rivals of the reducer, the Linux port, the gateway
STUDY           := host_sim/study
SISL            := $(STUDY)/baselines/knots/sisl.cpp
PEERS_SOURCES   := $(filter-out $(SISL),$(call sources,$(addprefix $(STUDY)/baselines/,*.cpp knots/*.cpp compress/*.cpp)))
STUDY_SOURCES   := $(call sources,$(addprefix $(STUDY)/,experiments/*.cpp baselines/filters/*.cpp baselines/earlier/*.cpp))
SIM             := study report replay generate recording  # what the simulator is made of, without its commands
$(foreach wing,recording generate replay report chip_models,$(eval $(call archive,$(wing),$(call sources,host_sim/$(wing)/*.cpp))))
$(eval $(call archive,study,$(STUDY_SOURCES)))
PORT_SOURCES    := $(call sources,port/linux/*.cpp)
GATEWAY_SOURCES := $(filter-out %_main.cpp,$(call sources,examples/gateway/*.cpp))
GATEWAY_LIBS    := -lmodbus -lgpiod
$(eval $(call archive,peers,$(PEERS_SOURCES)))
$(eval $(call archive,port,$(PORT_SOURCES)))
$(eval $(call archive,gateway,$(GATEWAY_SOURCES)))

# ---- programs:      name, sources, archives, libraries
RECORD       := examples/record/record.cpp examples/record/writer.cpp
PEERS_TESTED := $(addprefix $(STUDY)/bench_peers/,cache.cpp ours.cpp report.cpp subjects.cpp) \
                $(addprefix $(STUDY)/bench_cubics/,motion.cpp samples.cpp search.cpp stream.cpp tables.cpp)
GOOGLE_TEST  := -lgtest -lgtest_main
$(eval $(call program,fairlead-sim,host_sim/sim.cpp $(call sources,host_sim/commands/*.cpp),$(SIM) peers,-lz))
$(eval $(call program,fairlead-record,$(RECORD),port recording,-lgpiod))
$(foreach p,gateway poll registers,$(eval \
  $(call program,fairlead-$(p),examples/gateway/$(p)_main.cpp,gateway port recording,$(GATEWAY_LIBS))))
$(eval $(call program,fairlead-live,$(call sources,examples/live/*.cpp),gateway port recording report,$(GATEWAY_LIBS) -lcpp-httplib -lz))
$(eval $(call program,fairlead-gateway-measure,$(call sources,tests/gateway/measure/*.cpp),gateway port recording,$(GATEWAY_LIBS)))
$(foreach e,attitude filter reduce decode,$(eval $(call program,examples/$(e),examples/$(e).cpp)))
$(eval $(call program,firmware-motion,tests/gateway/firmware/motion.cpp,recording))
$(eval $(call program,bench-peers,$(call sources,$(STUDY)/bench_peers/*.cpp) $(SISL),peers $(SIM),-lsisl -lz))
$(eval $(call program,bench-cubics,$(call sources,$(STUDY)/bench_cubics/*.cpp) $(addprefix $(STUDY)/bench_peers/,byte_rivals.cpp cache.cpp ours.cpp subjects.cpp),peers $(SIM),-lz))
$(eval $(call program,bench-smooth,$(STUDY)/bench_smooth/smooth.cpp $(call sources,$(STUDY)/baselines/filters/*.cpp),,-lbenchmark))
$(eval $(call program,bench-attitude,$(call sources,$(STUDY)/bench_attitude/*.cpp $(STUDY)/baselines/ahrs/*.cpp),$(SIM)))
$(eval $(call program,pipeline-search,tests/pipeline/search.cpp))
$(eval $(call program,pipeline-soak,tests/pipeline/soak.cpp,generate recording,-lz))
# simulated devices, and the streams of the targets
UNIT_BESIDES := $(addprefix $(STUDY)/bench_attitude/,locks.cpp motions.cpp simulated.cpp) tests/target/stream.cpp
$(eval $(call program,tests/unit,$(call sources,tests/unit/*.cpp tests/laws/*.cpp) $(UNIT_BESIDES),$(SIM) chip_models,$(GOOGLE_TEST)))
$(eval $(call program,tests/port,$(call sources,tests/port/*.cpp) examples/record/writer.cpp,port recording chip_models,-lgpiod $(GOOGLE_TEST)))
$(eval $(call program,tests/gateway,$(call sources,tests/gateway/*.cpp),gateway port recording chip_models,$(GOOGLE_TEST) $(GATEWAY_LIBS)))
$(eval $(call program,tests/peers,$(call sources,tests/peers/*.cpp) $(PEERS_TESTED),peers $(SIM),$(GOOGLE_TEST) -lz))
$(eval $(call program,tests/strain,tests/recordings/strain.cpp,recording))

# both versions of libgpiod, each over a fake line; version 2 by declarations of the tests' own
GPIO_TESTS := tests/port/gpio/test_gpio.cpp tests/port/gpio/fake.cpp port/linux/gpio.cpp
$(BUILD)/tests/gpio1 $(BUILD)/tests/gpio2: $(BUILD)/tests/gpio%: $(GPIO_TESTS) tests/port/gpio/fake_v%.cpp \
                                           port/linux/gpio.hpp port/linux/button.hpp
	$(call step,link tests/gpio$*) $(CXX) $(HOST) $(if $(filter 2,$*),-Itests/port/gpio/v2) $(filter %.cpp,$^) $(GOOGLE_TEST) -o $@

$(BUILD)/count_allocations.so: tests/gateway/measure/count_allocations.c
	$(call step,$<) gcc -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC $< -o $@

# the port's programs for the emulated Linux machine are linked statically
VM_TESTS    := slave stream stub iio edges verify
VM_PROGRAMS := $(addprefix $(BUILD)/linux_vm/bin/,$(VM_TESTS) record)
$(foreach p,$(VM_TESTS),$(eval $(call program,linux_vm/bin/$(p),tests/linux_vm/$(p).cpp,port recording chip_models,-static -lgpiod)))
$(eval $(call program,linux_vm/bin/record,$(RECORD),port recording,-static -lgpiod))

# every public header compiles alone, strictly, without exceptions and RTTI
LIB_HEADERS := $(call sources,lib/include/fairlead/*.hpp lib/include/fairlead/*/*.hpp)
HEADERS_OK  := $(patsubst lib/include/%.hpp,$(BUILD)/headers/%.ok,$(LIB_HEADERS))
$(HEADERS_OK): $(BUILD)/headers/%.ok: lib/include/%.hpp $(LIB_HEADERS)
	$(call step,$< alone) $(CXX) $(DEVICE) -fsyntax-only -include $< -x c++ /dev/null
	@touch $@

##@ Start here
help: ## [] list the targets
	@while IFS= read -r line; do case $$line in \
	  '##@ '*) printf '\n%s\n' "$${line#??? }" ;; \
	  [a-z]*': '*'## ['*) text=$${line#*## ?}; printf '  make %-18s %s\n' "$${line%%:*}" "$${text#*] }" ;; \
	  esac; done <Makefile; \
	  printf '\n%s\n%s\n' 'The Debian packages that a target needs are installed first (SETUP=no: they are not).' \
	    'V=1 shows the commands; -j1 builds one file at a time.'

RECORDING   ?= $(BUILD)/demo/generated.trk
DEMO_MOTION := model:optical+rest:2+reach:0.9:12+oscillate:6:1.5+gap:0.4+reach:0.7:8+turn:1.2:12+rest:4
demo: $(BUILD)/fairlead-sim $(RECORDING) ## [build demo] replay a recording (a generated one, or RECORDING=FILE): table and report
	@$(BUILD)/fairlead-sim replay $(RECORDING) --filter binomial:9 --out $(BUILD)/demo
$(BUILD)/demo/generated.trk: $(BUILD)/fairlead-sim
	@mkdir -p $(@D)
	@$(BUILD)/fairlead-sim generate '$(DEMO_MOTION)' --seed 1 --out $@

TEST_PROGRAMS := $(addprefix $(BUILD)/tests/,unit port gpio1 gpio2 gateway peers)
TEST_SCRIPTS  := $(call sources,tests/sim/test_*.py tests/setup/test_*.py tests/must_fail/test_*.py tests/c/test_*.py tests/docs/test_*.py)
TESTED        := $(TEST_PROGRAMS) $(HEADERS_OK) $(addprefix $(BUILD)/,fairlead-record fairlead-sim examples/attitude examples/filter examples/reduce examples/decode)
test: $(TESTED) ## [build demo script gateway test] build and run all tests that need no other machine
	@BUILD=$(BUILD) tests/run $(TEST_PROGRAMS) $(TEST_SCRIPTS)

##@ Build
all: sim record gateway live ## [] build every program that a user runs
sim: $(BUILD)/fairlead-sim ## [build] build the host simulator, build/fairlead-sim
record: $(BUILD)/fairlead-record ## [build port] build the recorder, build/fairlead-record
gateway: $(BUILD)/fairlead-gateway $(BUILD)/fairlead-poll ## [build gateway] build the gateway and its reader: build/fairlead-gateway, build/fairlead-poll
live: $(BUILD)/fairlead-live ## [build gateway live] build the live view, build/fairlead-live
headers: $(HEADERS_OK) ## [compile] compile every public header alone, under the strict flags
registers: $(BUILD)/fairlead-registers ## [build gateway] write docs/registers.md and the client configurations from the register map
	@mkdir -p examples/gateway/clients
	@$<
docs: ## [docs script compile] write the API reference, build/docs/html; check links and examples of all pages
	@mkdir -p $(BUILD) && (cat docs/Doxyfile; echo OUTPUT_DIRECTORY=$(BUILD)/docs) | doxygen -
	@tests/docs/test_pages.py
	@echo "ok docs: $(BUILD)/docs/html/index.html"
readme: demo ## [script] put the present output of make demo into the README
	@tests/sim/test_readme.py --write

clean: ## [] remove everything that was built
	rm -rf build

##@ More tests
TARGETS ?= demo test
RUN_AS  ?= both
fresh-machine: ## [fresh] run TARGETS="demo test" on a bare Debian 12 made for it, as root and as a user with sudo (RUN_AS=root|user|both)
	@.ci/fresh-machine --as $(RUN_AS) $(TARGETS)
test-clang: ## [build demo script gateway test clang] the same tests, built with clang++
	+@$(MAKE) test BUILD=build/clang CXX=clang++
test-sanitize: ## [build demo script gateway test clang sanitize] the same tests under AddressSanitizer and UBSan
	+@$(MAKE) test BUILD=build/sanitize CXX=clang++ OPT=-O1 EXTRA='-g -D_GLIBCXX_ASSERTIONS $(call sanitize,address$(comma)undefined)'
test-strain: $(BUILD)/tests/strain ## [build] hold fixed-lag strain smoothing to the whole-buffer solve, on every tracker recording (minutes)
	@tests/run $(BUILD)/tests/strain
same-bytes: ## [compile script clang] the same stream from g++ and clang++, -O0 and -O2, on all recordings
	@tests/sim/test_same_bytes.py $(wildcard $(RECORDINGS)/tracker120/*.trk)

# fuzz targets: clang, AddressSanitizer and UBSan, libFuzzer's own main; the parts that they search are compiled like them
SECONDS      ?= 60
FUZZ_CHECKS  ?= $(call sanitize,address$(comma)undefined)
FUZZ_FLAGS   := -g -O1 -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS $(FUZZ_CHECKS)
FUZZ_TARGETS := $(patsubst tests/fuzz/%.cpp,$(BUILD)/fuzz/%,$(call sources,tests/fuzz/*.cpp))
fuzz_objects  = $(patsubst %.cpp,$(BUILD)/obj/fuzz/%.o,$(1))
$(BUILD)/obj/fuzz/%.o: %.cpp
	$(call step,$< to fuzz) clang++ $(BASE) -Wno-double-promotion $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link -MMD -MP -c $< -o $@
$(FUZZ_TARGETS): $(BUILD)/fuzz/%: $(BUILD)/obj/fuzz/tests/fuzz/%.o
	$(call step,link fuzz/$*) clang++ $(FUZZ_CHECKS) -fsanitize=fuzzer $^ $(FUZZ_LIBS) -o $@
$(addprefix $(BUILD)/fuzz/,read_text read_binary read_events): $(call fuzz_objects,$(call sources,host_sim/recording/*.cpp))
$(BUILD)/fuzz/config: $(call fuzz_objects,$(addprefix examples/gateway/,config.cpp config_reader.cpp calibration_file.cpp text_file.cpp \
                      toml_parser.cpp)) $(addprefix $(BUILD)/,libgateway.a libport.a librecording.a)
$(BUILD)/fuzz/config: FUZZ_LIBS := -lmodbus -lgpiod
$(BUILD)/fuzz/modbus_rtu: $(call fuzz_objects,$(addprefix port/linux/,modbus.cpp modbus_rtu.cpp modbus_net.cpp serial.cpp))
$(BUILD)/fuzz/modbus_rtu: FUZZ_LIBS := -lmodbus -lutil
$(BUILD)/fuzz/follower: $(call fuzz_objects,$(addprefix examples/gateway/,follower.cpp span_maker.cpp))
STREAMS ?= 1000
SEED    ?= 1
HOURS   ?= 24
pipeline-search: $(BUILD)/pipeline-search ## [compile] lead random streams through whole pipelines and judge them from the bytes (STREAMS=1000 SEED=1)
	@$< --streams $(STREAMS) --seed $(SEED)
soak: $(BUILD)/pipeline-soak ## [build] loop the tracker's recordings (or generated ones) through one pipeline for HOURS=24 of data and judge it from the bytes (minutes)
	@$< --hours $(HOURS) --seed $(SEED) $(sort $(wildcard $(RECORDINGS)/tracker120/*.trk))
mutants: $(call objects,$(UNIT_BESIDES)) $(patsubst %,$(BUILD)/lib%.a,$(SIM) chip_models) ## [build script test mutants] mutation testing of lib: change one place at a time, and ask whether a test notices (hours)
	@tests/mutants/test_mutants.py
	@tests/mutants/mutants.py --build $(BUILD) --link '$^' --flags '$(BASE) -O1 -isystem /usr/include/eigen3' $(MUTANTS)
fuzz: $(FUZZ_TARGETS) ## [build gateway clang sanitize script] search for crashes and broken promises by fuzzing, SECONDS=60 for each target
	@tests/fuzz/run.py $(BUILD) --seconds $(SECONDS) $(FUZZ)
FUZZ_OF_LIB := attitude calibration decoder drivers follower intake pipeline saved
fuzz-coverage: ## [clang sanitize coverage script] line coverage of lib by the committed corpora
	+@$(MAKE) BUILD=$(BUILD)/coverage FUZZ_CHECKS='-fprofile-instr-generate -fcoverage-mapping' $(FUZZ_OF_LIB:%=$(BUILD)/coverage/fuzz/%)
	@tests/fuzz/coverage.py $(BUILD)/coverage $(FUZZ_OF_LIB)

browser-test: sim gateway live ## [script browser cortex-m cortex-m-emulator] drive report and live view in headless Chromium: zoom, cursor, playback (two minutes)
	+@$(TARGET) $(BUILD)/target/firmware/firmware.elf
	@BUILD=$(BUILD) tests/run tests/browser/test_report.py tests/browser/test_live.py
	@grep -h ' MB, ready after ' $(BUILD)/browser/figures.txt

gateway-peers: gateway ## [script modbus-peers] other people's Modbus clients against the gateway, TCP and RTU
	@/usr/bin/python3 tests/gateway/service.py $(BUILD)
	@/usr/bin/python3 tests/gateway/peers.py $(BUILD)
gateway-firmware: gateway $(BUILD)/firmware-motion ## [script cortex-m cortex-m-emulator] the firmware image under QEMU, its UART into the gateway, a client rebuilds
	+@$(TARGET) $(BUILD)/target/firmware/firmware.elf
	@tests/gateway/firmware/run.py $(BUILD)
SANITIZERS := address thread
gateway-sanitize: $(SANITIZERS:%=gateway-sanitize-%) ## [build test gateway clang sanitize] the gateway's tests and a hostile minute under ASan with UBSan, and under TSan
	@echo "ok gateway-sanitize"
.PHONY: $(SANITIZERS:%=gateway-sanitize-%)
$(SANITIZERS:%=gateway-sanitize-%): SANITIZED = $(BUILD)/sanitize-$(@:gateway-sanitize-%=%)
$(SANITIZERS:%=gateway-sanitize-%): export TSAN_OPTIONS := halt_on_error=1
$(SANITIZERS:%=gateway-sanitize-%): gateway-sanitize-%:
	+@$(MAKE) BUILD=$(SANITIZED) CXX=clang++ OPT=-O1 EXTRA="-g $(call sanitize,$(if $(filter address,$*),address$(comma)undefined,$*))" \
	  $(addprefix $(SANITIZED)/,tests/gateway fairlead-gateway fairlead-gateway-measure)
	@tests/run $(SANITIZED)/tests/gateway
	@set -e; for run in '--growth 100000 memory' noise restart; do \
	  $(SANITIZED)/fairlead-gateway-measure --gateway $(SANITIZED)/fairlead-gateway --seconds 20 $$run; done
MEASURED := torn load history noise noise-table restart '--seconds 20 allocations' '--seconds 600 memory'
gateway-measure: gateway $(BUILD)/fairlead-gateway-measure $(BUILD)/count_allocations.so ## [script] the figures of docs/gateway.md: a quarter of an hour
	@set -e; for what in $(MEASURED); do echo "fairlead-gateway-measure $$what"; $(BUILD)/fairlead-gateway-measure $$what; done
	@/usr/bin/python3 tests/gateway/rtu.py $(BUILD)
	@/usr/bin/python3 tests/gateway/reloads.py $(BUILD)
VM_RECORDING := $(or $(firstword $(wildcard $(RECORDINGS)/08*.imu $(RECORDINGS)/*.imu)),-)
linux-vm-test: gateway $(VM_PROGRAMS) ## [linux-vm] boot a Debian kernel under QEMU and run the port against it (minutes)
	@tests/linux_vm/run $(BUILD) $(VM_RECORDING)

# what is generated, or keeps the kernel's style, is not formatted
OWN_SOURCES = $(shell git ls-files -co --exclude-standard '*.hpp' '*.cpp' '*.h' '*.c' \
                ':!examples/gateway/clients' ':!tests/linux_vm/module')
format: ## [format] rewrite the sources in the project's format
	@clang-format -i $(OWN_SOURCES)
format-check: ## [format] fail where a source is not in the project's format
	@clang-format --dry-run --Werror $(OWN_SOURCES)
tidy: ## [tidy compile] clang-tidy over the library
	@mkdir -p $(BUILD) && printf '#include "%s"\n' $(LIB_HEADERS:lib/include/%=%) > $(BUILD)/tidy.cpp
	@clang-tidy --quiet --header-filter='lib/include/.*' $(BUILD)/tidy.cpp -- $(BASE)

##@ Measure, and write the tables of the documentation
bench: bench-smooth ## [] time smoothing beside its rivals (also: bench-peers, compare, attitude-table)
bench-smooth: $(BUILD)/bench-smooth ## [compile bench] time strain smoothing beside gradient descent and fairing
	$<
bench-peers: $(BUILD)/bench-peers sim ## [peers] control points and bytes beside the rivals; rewrites the table in docs/peers.md
	$< --page docs/peers.md --control-points $(STUDY)/bench_peers/control_points.csv --sweep $(STUDY)/bench_peers/sweep.csv
CUBICS_TABLES ?= bytes motion  # and knots
bench-cubics: $(BUILD)/bench-cubics sim ## [] C2 cubics beside their rivals, from their bytes: rewrites the tables of docs/cubics.md (minutes)
	$< $(CUBICS_TABLES) --recordings $(RECORDINGS)/tracker120 --folder $(BUILD)/peers --program $(BUILD)/fairlead-sim \
	  --page docs/cubics.md --plot docs/img/cubics.svg
choosing: sim ## [script demo] what each choice costs: rewrites the tables and plots of docs/choosing.md (a minute)
	@$(STUDY)/bench_peers/choosing.py $(BUILD)/fairlead-sim docs/choosing.md docs/img/choosing.svg BOUNDS.md
compare: sim ## [demo] our causal filters beside their rivals, on all recordings: the tables and plot of docs/choose.md (minutes)
	$(BUILD)/fairlead-sim compare $(wildcard $(RECORDINGS)/tracker120/*.trk) --seconds 12 --page docs/choose.md --out $(BUILD)/compare
	@cp $(BUILD)/compare/compare_06*.svg docs/img/compare.svg
experiments: sim ## [demo] rerun the papers' experiments: rewrites the tables and plots of docs/experiments
	$(BUILD)/fairlead-sim experiment all --out docs/experiments
attitude-table: $(BUILD)/bench-attitude ## [build] measure orientation on all recordings and rewrite the tables of docs/attitude.md
	$< table $(RECORDINGS) --into docs/attitude.md
attitude-foreign: $(BUILD)/bench-attitude ## [build] orientation on other devices and simulations, beside other filters: tables of docs/attitude.md
	$(BUILD)/bench-attitude foreign $(RECORDINGS)/foreign --into docs/attitude.md
attitude-smooth: $(BUILD)/bench-attitude ## [build] what smoothing is worth, whole recordings and fixed lags: table of docs/attitude.md
	$(BUILD)/bench-attitude smooth $(RECORDINGS) --into docs/attitude.md
attitude-locks: $(BUILD)/bench-attitude ## [build] 1000 starts in motion, 1000 upside-down losses: no wrong state may last (minutes)
	$(BUILD)/bench-attitude locks --into docs/attitude.md
attitude-day: $(BUILD)/bench-attitude ## [build] a day of recordings on end: float beside double, covariance positive throughout
	$< day $(RECORDINGS)
attitude-counts: ## [compile script cortex-m cortex-m-emulator] instructions of an attitude sample on a Cortex-M4F, all recordings, against their budgets
	+@$(TARGET) images $(BUILD)/target/count.so CORES=m4f SUBJECTS='attitude attitude_imu'
	@tests/target/attitude_counts.py --build $(BUILD)/target --recordings $(RECORDINGS)

# TABLE_NOTE stands in the generated file; a change of the tables is a change of the stream's format
TABLE_RECORDINGS ?= $(call sources,$(RECORDINGS)/tracker120/*.trk)
TABLE_NOTE       ?= the 13 recordings of tracker120 (BROAD): delays 60 to 240 records, 1 to 5 mm, 0.25 to 1 deg
tables: $(SIM:%=$(BUILD)/lib%.a) ## [build script] train the tables of symbol costs on TABLE_RECORDINGS (minutes)
	@tests/tables/train $(BUILD) '$^' lib/include/fairlead/code/tables.hpp '$(TABLE_NOTE)' 3 $(TABLE_RECORDINGS)

##@ The C interface (docs/c.md)
# for the host, or for the core that the call names
C_CORE    := $(if $(filter command line environment,$(origin CORE)),$(CORE))
C_LIBRARY := $(BUILD)/c-library
include lib/c/library.mk
$(eval $(call c_library,$(C_LIBRARY)/host,$(or $(CONFIG),examples/firmware/config.hpp),host,$(CXX),nm,ar,$(DEVICE) -fno-threadsafe-statics))
$(if $(and $(filter c-library,$(GOALS)),$(CONFIG)),$(if $(wildcard $(CONFIG)),,$(error there is no file '$(CONFIG)')))
ifeq (,$(C_CORE))
c-library: $(C_LIBRARY)/host/fairlead.h $(C_LIBRARY)/host/libfairlead.a
	@lib/c/header.py --say $(C_LIBRARY)/host
else
c-library:
	+@$(TARGET) c-library CORES=$(C_CORE) C_LIBRARY=$(C_LIBRARY)
endif
c-library: ## [compile script] fairlead.h and libfairlead.a for C: CONFIG=header, CORE=m4f for a core, OPT=-Os
c-firmware-run: ## [compile cortex-m cortex-m-emulator script] run the firmware in C under QEMU: its frames equal those of the one in C++
	+@$(TARGET) c-firmware-run

##@ Cortex-M and RISC-V under an emulator (docs/target.md, docs/bounds.md)
TARGET = $(MAKE) -f tests/target/target.mk BUILD=$(BUILD)/target
CORE  ?= m4f
target-test: ## [compile script reference clang cortex-m cortex-m-emulator risc-v stack-bound] the same bits on every core, exact counts, BOUNDS.md, heap and stack checks, a firmware run
	+@$(TARGET) calibrate same-bits bounds trap c-firmware-run recordings
target-soak: ## [compile script clang cortex-m cortex-m-emulator risc-v stack-bound] all recordings on all cores, and a longer search for expensive streams
	+@$(TARGET) same-bits search recordings SOAK=1
bounds: ## [compile script reference cortex-m cortex-m-emulator stack-bound] check BOUNDS.md (ACCEPT=1: write it), or your CONFIG=header CORE=m4f RECORDING=file BUDGET=n
	+@$(TARGET) $(if $(CONFIG),user CORES=$(CORE),bounds)
size: ## [compile script cortex-m] flash, RAM and stack of the firmware example, and its linker map
	+@$(TARGET) firmware
firmware-run: ## [compile cortex-m cortex-m-emulator] run the firmware example under QEMU and decode what its UART sent
	+@$(TARGET) firmware-run
must-fail: ## [compile script cortex-m cortex-m-emulator stack-bound] plant six faults in a copy of the tree: the target checks must catch each
	@tests/must_fail/plantings.py
port-device: $(BUILD)/device/drivers.o ## [cortex-m] the sensor drivers for a Cortex-M4F: no heap, no exceptions
	@! arm-none-eabi-nm -uC $< | grep -E 'malloc|calloc|realloc|free|operator|__cxa|unwind'
	@echo "ok port-device: no heap, no exceptions" && arm-none-eabi-size $<
$(BUILD)/device/drivers.o: tests/port/device/drivers.cpp $(wildcard port/sensors/*.hpp) $(LIB_HEADERS)
	$(call step,$<) arm-none-eabi-g++ $(wordlist 7,99,$(shell grep "^m4f " port/cortex_m/cores)) $(filter-out -pthread,$(DEVICE)) $(BARE_MACHINE) -c $< -o $@

##@ Compilers and packages (docs/portability.md, docs/packages.md, docs/versions.md)
compilers: ## [script compilers] the public headers with all compilers, standards, warnings and other people's macros; what flags do
	@tests/compilers/check.py
	@tests/compilers/flags.py
PREFIX    ?= /usr/local
INSTALLED := $(DESTDIR)$(PREFIX)
install: ## [install] install the headers, fairlead.pc and the CMake package (PREFIX=/usr/local, DESTDIR=)
	@cmake -S lib -B $(BUILD)/install -DCMAKE_INSTALL_PREFIX=$(PREFIX) >/dev/null && cmake --install $(BUILD)/install
uninstall: ## [] remove what install put there
	rm -rf $(INSTALLED)/include/fairlead $(INSTALLED)/share/cmake/fairlead $(INSTALLED)/share/pkgconfig/fairlead.pc
PROJECT_URL ?=
dist: ## [script] make the release archives in build/dist (PROJECT_URL: the page that the manifests name)
	@lib/packages/dist.py --url '$(PROJECT_URL)' $(BUILD)/dist
deb: gateway record sim live ## [deb] build the Debian package of the programs, and check it with lintian
	@examples/gateway/deb/build $(BUILD)
	@lintian --fail-on error $(BUILD)/fairlead_*.deb
deb-check: deb ## [fresh] install the Debian package in a bare Debian, run it, remove it: nothing may stay (minutes)
	@examples/gateway/deb/check $(BUILD)/fairlead_*.deb
test-packages: ## [packages] make the archives, unpack each, and use it as its ecosystem does
	@/usr/bin/python3 tests/packages/check.py
release-check: ## [script] is this commit ready to be tagged as a release? says what is missing
	@/usr/bin/python3 tests/packages/release.py

# Builds and measures every stage on every machine of port/cortex_m/cores. Used by the Makefile's target-* and bounds.
#   make -f tests/target/target.mk CORES="m4f gcc-O2" SUBJECTS="quat" measure
BUILD    ?= build/target
SUBJECTS ?= $(shell awk '!/^\#/ && NF {print $$1}' tests/target/stages)
# the first machine is the one that all others are compared with
CORES    ?= $(shell sed 's/\#.*//' port/cortex_m/cores | awk 'NF && $$1 != "microbit" {print $$1}')
STREAMS  := $(wildcard tests/target/streams/*/* tests/target/streams/*)

include .ci/flags.mk
COMMON := $(CHECKED) $(BARE_CPP) $(EXTRA)
DEVICE := -O2 $(BARE_MACHINE)
PICOLIBC := /usr/lib/picolibc/riscv64-unknown-elf
# libstdc++ for RISC-V is not in Debian: its headers alone are, with the Arm compiler
RISCV  := -isystem $(PICOLIBC)/include -nostdinc++ $(addprefix -isystem ,$(firstword $(wildcard /usr/include/newlib/c++/*)) $(firstword $(wildcard /usr/include/newlib/c++/*/arm-none-eabi)))

export PYTHONDONTWRITEBYTECODE := 1
.DEFAULT_GOAL := measure
MAKEFILE := tests/target/target.mk
include .ci/progress.mk
.SECONDARY:
.DELETE_ON_ERROR:

# ---- one set of rules a machine: $(1) name, $(2) compiler, $(3) emulated machine, $(4) ROM, $(5) RAM, $(6) start-up, $(7) flags
define machine
objects_$(1) := $(if $(filter -,$(3)),platform_host,platform_core) stream
$(BUILD)/$(1)/%.subject.o: tests/target/subjects/%.hpp tests/target/subject.cpp
	$$(call step,$(1) $$*.subject.o) $(2) $(7) $$(FLAGS_$(1)) -MMD -MP -DFAIRLEAD_SUBJECT='"$$<"' -c tests/target/subject.cpp -o $$@
$(BUILD)/$(1)/%.o: tests/target/%.cpp
	$$(call step,$(1) $$*.o) $(2) $(7) $$(FLAGS_$(1)) -MMD -MP -c $$< -o $$@
$(BUILD)/$(1)/%.o: port/cortex_m/%.cpp
	$$(call step,$(1) $$*.o) $(2) $(7) $$(FLAGS_$(1)) -MMD -MP -c $$< -o $$@
$(BUILD)/$(1)/user.subject.o: $(CONFIG) tests/target/user.hpp tests/target/subject.cpp always
	$$(call step,$(1) user.subject.o) $(2) $(7) $$(FLAGS_$(1)) -DFAIRLEAD_CONFIG='"$(abspath $(CONFIG))"' -DFAIRLEAD_SUBJECT='"tests/target/user.hpp"' -c tests/target/subject.cpp -o $$@
ifeq ($(3),-)
FLAGS_$(1) := $(COMMON)
$(BUILD)/$(1)/%.elf: $(BUILD)/$(1)/%.subject.o $(foreach o,run stream platform_host,$(BUILD)/$(1)/$(o).o)
	$$(call step,$(1) $$*.elf) $(2) $$^ -o $$@
$(BUILD)/$(1)/%.result: $(BUILD)/$(1)/%.elf $(STREAMS) tests/target/measure.py
	$$(call step,$(1) $$*.result) tests/target/measure.py --build $(BUILD) $(1) $$*
else
FLAGS_$(1) := $(COMMON) $(DEVICE) $(if $(filter riscv%,$(2)),$(RISCV))
LIBS_$(1) := $(if $(filter riscv%,$(2)),-L$(PICOLIBC)/lib/$(shell $(2) $(7) -print-multi-directory 2>/dev/null) -lc -lm -lgcc)
LINK_$(1) := $(if $(filter arm%,$(2)),-nostartfiles --specs=nano.specs,-nostdlib) -Wl,--gc-sections,-T,port/cortex_m/memory.ld \
	-Wl,--defsym=ROM=$(word 1,$(subst :, ,$(4))),--defsym=ROM_SIZE=$(word 2,$(subst :, ,$(4))) \
	-Wl,--defsym=RAM=$(word 1,$(subst :, ,$(5))),--defsym=RAM_SIZE=$(word 2,$(subst :, ,$(5)))
$(BUILD)/$(1)/%.elf: $(BUILD)/$(1)/%.subject.o $(foreach o,run stream platform_core $(6),$(BUILD)/$(1)/$(o).o) port/cortex_m/memory.ld
	$$(call step,$(1) $$*.elf) $(2) $(7) $$(LINK_$(1)) -Wl,-Map=$$@.map $$(filter %.o,$$^) $$(LIBS_$(1)) -o $$@
$(BUILD)/$(1)/%.bare.elf: $(BUILD)/$(1)/%.subject.o $(foreach o,bare $(6),$(BUILD)/$(1)/$(o).o) port/cortex_m/memory.ld
	$$(call step,$(1) $$*.bare.elf) $(2) $(7) $$(LINK_$(1)) -Wl,-Map=$$@.map $$(filter %.o,$$^) $$(LIBS_$(1)) -o $$@
$(BUILD)/$(1)/calibrate.elf: $(foreach o,calibrate $(6),$(BUILD)/$(1)/$(o).o) port/cortex_m/memory.ld
	$$(call step,$(1) calibrate.elf) $(2) $(7) $$(LINK_$(1)) $$(filter %.o,$$^) $$(LIBS_$(1)) -o $$@
$(BUILD)/$(1)/%.result: $(BUILD)/$(1)/%.elf $(BUILD)/$(1)/%.bare.elf $(BUILD)/$(1)/none.bare.elf $(BUILD)/count.so $(STREAMS) \
		tests/target/measure.py tests/target/elf.py tests/target/path.py
	$$(call step,$(1) $$*.result) tests/target/measure.py --build $(BUILD) $(1) $$*
endif
endef
row = $(call machine,$(word 1,$(1)),$(word 2,$(1)),$(word 3,$(1)),$(word 4,$(1)),$(word 5,$(1)),$(word 6,$(1)),$(wordlist 7,99,$(1)))
$(foreach core,$(CORES),$(eval $(call row,$(shell grep -E '^$(core) ' port/cortex_m/cores))))

# ---- the firmware of examples/firmware, and what a host makes of its frames
FIRMWARE := $(BUILD)/firmware
FIRMWARE_FLAGS = $(wordlist 7,99,$(shell grep '^m4f ' port/cortex_m/cores)) $(COMMON) $(DEVICE) -Os -DNDEBUG
FIRMWARE_HEADERS := $(wildcard examples/firmware/*.hpp port/cortex_m/*.hpp) $(shell find lib -name '*.hpp')
LINK_FIRMWARE = -nostartfiles --specs=nano.specs -Wl,--gc-sections,-T,port/cortex_m/memory.ld,-Map=$@.map \
	-Wl,--defsym=ROM=0,--defsym=ROM_SIZE=256K,--defsym=RAM=0x20000000,--defsym=RAM_SIZE=64K
# optimised as a whole, but for the start-up, which calls main() like anything else
$(FIRMWARE)/%.o: examples/firmware/%.cpp $(FIRMWARE_HEADERS)
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -flto -c $< -o $@
$(FIRMWARE)/%.o: port/cortex_m/%.cpp $(FIRMWARE_HEADERS)
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -c $< -o $@
$(FIRMWARE)/firmware.elf: $(addprefix $(FIRMWARE)/,main.o board_mps2.o startup.o) port/cortex_m/memory.ld
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -flto=auto $(LINK_FIRMWARE) $(filter %.o,$^) -o $@
$(FIRMWARE)/check_frames: $(wildcard examples/firmware/*) $(shell find lib -name '*.hpp')
	$(call step,$@) g++ $(COMMON) -O2 examples/firmware/check_frames.cpp -o $@

# ---- flash of stages at -Os, optimised as a whole like the firmware, and where RAM goes: what `budgets` speaks of
SMALL := $(BUILD)/small
SMALL_STAGES := none decode
SMALL_LINK = -nostartfiles --specs=nano.specs -Wl,--gc-sections,-T,port/cortex_m/memory.ld \
	-Wl,--defsym=ROM=0,--defsym=ROM_SIZE=1M,--defsym=RAM=0x20000000,--defsym=RAM_SIZE=1M
$(SMALL)/%.subject.o: tests/target/subjects/%.hpp tests/target/subject.cpp
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -flto -MMD -MP -DFAIRLEAD_SUBJECT='"$<"' -c tests/target/subject.cpp -o $@
$(SMALL)/%.o: tests/target/%.cpp
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -MMD -MP -c $< -o $@
$(SMALL)/%.elf: $(SMALL)/%.subject.o $(SMALL)/bare.o $(FIRMWARE)/startup.o port/cortex_m/memory.ld
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -flto=auto $(SMALL_LINK) $(filter %.o,$^) -o $@
BUDGETED := $(SMALL_STAGES:%=$(SMALL)/%.elf) $(SMALL)/parts.o $(FIRMWARE)/firmware.elf
.PHONY: firmware firmware-run c-firmware-run c-library
firmware: $(FIRMWARE)/firmware.elf
	@tests/target/size.py --readme examples/firmware/README.md $(if $(ACCEPT),--accept) $<
RUN_FIRMWARE = timeout 120 qemu-system-arm -M mps2-an386 -icount shift=3,sleep=off -nographic -monitor none \
	-semihosting-config enable=on,target=native
firmware-run: $(FIRMWARE)/firmware.elf $(FIRMWARE)/check_frames
	@$(RUN_FIRMWARE) -serial file:$(FIRMWARE)/frames.bin -kernel $<
	@$(FIRMWARE)/check_frames $(FIRMWARE)/frames.bin

# ---- the C interface for a core, and the firmware in C
include lib/c/library.mk
C_LIBRARY ?= $(BUILD)/c-library
compiler = $(word 2,$(shell grep -E '^$(1) ' port/cortex_m/cores))
$(foreach core,$(filter-out gcc-% clang-%,$(CORES)),$(eval $(call c_library,$(C_LIBRARY)/$(core),$(or $(CONFIG),examples/firmware/config.hpp),$(core),\
  $(call compiler,$(core)),$(patsubst %g++,%nm,$(call compiler,$(core))),$(patsubst %g++,%ar,$(call compiler,$(core))),\
  $(wordlist 7,99,$(shell grep -E '^$(core) ' port/cortex_m/cores)) $(FLAGS_$(core)) $(or $(OPT),-Os) -DNDEBUG)))
c-library: $(foreach core,$(CORES),$(C_LIBRARY)/$(core)/fairlead.h $(C_LIBRARY)/$(core)/libfairlead.a)
	@lib/c/header.py --say $(foreach core,$(CORES),$(C_LIBRARY)/$(core))
C_FIRMWARE := $(FIRMWARE)/c
C_COMPILED = -I$(C_FIRMWARE) -I. -Os -ffunction-sections -fdata-sections $(wordlist 7,99,$(shell grep '^m4f ' port/cortex_m/cores))
$(eval $(call c_library,$(C_FIRMWARE),examples/firmware/config.hpp,m4f,arm-none-eabi-g++,arm-none-eabi-nm,arm-none-eabi-ar,$(FIRMWARE_FLAGS)))
$(C_FIRMWARE)/firmware.o: examples/c/firmware.c examples/c/board.h $(C_FIRMWARE)/fairlead.h
	$(call step,$@) arm-none-eabi-gcc $(STRICT_C) $(C_COMPILED) -c $< -o $@
$(C_FIRMWARE)/board.o: examples/c/board_mps2.cpp examples/c/board.h $(C_FIRMWARE)/fairlead.h $(FIRMWARE_HEADERS)
	$(call step,$@) arm-none-eabi-g++ $(FIRMWARE_FLAGS) -I$(C_FIRMWARE) -c $< -o $@
$(C_FIRMWARE)/firmware.elf: $(C_FIRMWARE)/firmware.o $(C_FIRMWARE)/board.o $(addprefix $(FIRMWARE)/,board_mps2.o startup.o) \
		$(C_FIRMWARE)/libfairlead.a port/cortex_m/memory.ld
	$(call step,$@) arm-none-eabi-gcc $(filter-out -std=% -W% -I%,$(FIRMWARE_FLAGS)) -flto=auto $(LINK_FIRMWARE) $(filter %.o %.a,$^) -o $@
# the same board, the same motion: the frames are equal byte for byte
c-firmware-run: $(C_FIRMWARE)/firmware.elf firmware-run
	@$(RUN_FIRMWARE) -serial file:$(C_FIRMWARE)/frames.bin -kernel $<
	@cmp $(FIRMWARE)/frames.bin $(C_FIRMWARE)/frames.bin
	@echo "ok the frames of the firmware in C equal those of the one in C++: $$(wc -c <$(C_FIRMWARE)/frames.bin) bytes"
	@arm-none-eabi-size $<

$(BUILD)/count.so: tests/target/count.c
	$(call step,$@) $(CC) -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC $< -o $@

-include $(wildcard $(BUILD)/*/*.d)

ERRORS := $(addprefix $(BUILD)/host/,errors/errors.o stream.o)
$(ERRORS): $(BUILD)/host/%.o: tests/target/%.cpp
	$(call step,$@) g++ $(COMMON) -O1 -isystem /usr/include/eigen3 -MMD -MP -c $< -o $@
$(BUILD)/errors: $(ERRORS)
	$(call step,$@) g++ $^ -o $@
$(BUILD)/errors.tsv: $(BUILD)/errors tests/target/streams/adverse
	@$< >$@
-include $(ERRORS:.o=.d)

EMULATED = $(foreach core,$(CORES),$(if $(filter-out -,$(shell awk '$$1 == "$(core)" {print $$3}' port/cortex_m/cores)),$(core)))
.PHONY: images measure calibrate same-bits bounds trap
calibrate: $(BUILD)/count.so $(EMULATED:%=$(BUILD)/%/calibrate.elf)
	@tests/target/calibrate.py $(BUILD) $(EMULATED)
	@tests/target/walk.py $(BUILD)
BOUNDED := $(filter m%,$(CORES))
bounds: $(if $(ROWS),,$(BUILD)/errors.tsv $(BUDGETED)) tests/target/budgets $(foreach core,$(BOUNDED),$(SUBJECTS:%=$(BUILD)/$(core)/%.result))
	@tests/target/bounds.py --build $(BUILD) --subjects $(SUBJECTS) --cores $(BOUNDED) $(if $(ACCEPT),--accept) $(if $(ROWS),--rows)
# a user's own configuration: CONFIG=header CORES=core, perhaps RECORDING=file BUDGET=instructions
ifdef CONFIG
KNOWN_CORES := $(shell awk '!/^\#/ && NF && $$3 != "-" {print $$1}' port/cortex_m/cores)
$(if $(filter-out $(KNOWN_CORES),$(CORES)),$(error CORE=$(CORES) is none of: $(KNOWN_CORES)))
$(foreach file,$(CONFIG) $(RECORDING),$(if $(wildcard $(file)),,$(error there is no file '$(file)')))
endif
user: $(CORES:%=$(BUILD)/%/user.elf) $(CORES:%=$(BUILD)/%/user.bare.elf) $(CORES:%=$(BUILD)/%/none.bare.elf) $(BUILD)/count.so
	@tests/target/user.py --build $(BUILD) --core $(CORES) $(if $(RECORDING),--recording $(RECORDING)) $(if $(BUDGET),--budget $(BUDGET))
recordings: images
	@tests/target/recordings.py --build $(BUILD) --subjects $(SUBJECTS) --cores $(CORES) $(if $(SOAK),--soak)
SEARCHES := $(SUBJECTS:%=search-%)
.PHONY: $(SEARCHES)
search: $(SEARCHES)
$(SEARCHES): search-%: $(BUILD)/m4f/%.result $(BUILD)/count.so
	@tests/target/search.py --build $(BUILD) --core m4f $(if $(KEEP),--keep) $(if $(SEED),--seed $(SEED)) $(if $(TRIES),--budget $(TRIES)) $*
.PHONY: user recordings search
trap: $(BUILD)/m4f/planted.elf $(BUILD)/count.so
	@tests/target/search.py --build $(BUILD) --core m4f planted --must-reach 6000 $(if $(SEED),--seed $(SEED)) $(if $(TRIES),--budget $(TRIES))
same-bits: measure
	@tests/target/compare.py --build $(BUILD) --subjects $(SUBJECTS) --cores $(CORES)
images: $(foreach core,$(CORES),$(SUBJECTS:%=$(BUILD)/$(core)/%.elf))
measure: $(foreach core,$(CORES),$(SUBJECTS:%=$(BUILD)/$(core)/%.result))

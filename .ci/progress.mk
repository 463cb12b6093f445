# Progress: "$(call step,LABEL) COMMAND" in a recipe runs the command by .ci/step, which prints one line,
# "[ 42/310] LABEL". The total is counted beforehand by a dry run of the same goals (make -n).
# In the dry run COUNTING is set and MAKE is ":", so that lines which call make again do nothing.
FLAG_LETTERS := $(filter-out -%,$(firstword $(MAKEFLAGS)))
DRY_RUN := $(findstring n,$(FLAG_LETTERS))$(findstring q,$(FLAG_LETTERS))
ifneq (,$(COUNTING)$(DRY_RUN))
else ifneq (,$(findstring s,$(FLAG_LETTERS)))
STEP_COUNT := quiet
else
STEP_COUNT = $(eval STEP_COUNT := $$(shell $(COUNT_STEPS)))$(STEP_COUNT)
endif
COUNT_STEPS = mkdir -p $(BUILD) && rm -f $(BUILD)/.steps; MAKEFLAGS= MAKELEVEL= \
  $(MAKE) -n COUNTING=1 MAKE=: $(foreach f,$(MAKEFILE),-f $(f)) $(MAKEOVERRIDES) $(MAKECMDGOALS) 2>/dev/null | grep -c '^\.ci/step '
export V
step = @.ci/step $(BUILD)/.steps '$(STEP_COUNT)' $@ '$(1)'

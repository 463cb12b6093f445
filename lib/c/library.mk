# The C interface of one configuration on one machine: FOLDER/fairlead.h and FOLDER/libfairlead.a (docs/c.md).
# Included by the Makefile for the host and by tests/target/target.mk for cores.
#   $(call c_library,FOLDER,CONFIG,MACHINE,COMPILER,NM,AR,FLAGS)
C_PARTS := status pipeline decoder attitude
define c_library
# remembers the configuration, and changes only when that does
$(1)/config: always
	@mkdir -p $$(@D); echo '$(abspath $(2))' | cmp -s - $$@ || echo '$(abspath $(2))' >$$@
$(1)/fairlead.h: $(1)/constants.o lib/c/fairlead.h.in lib/c/header.py
	@lib/c/header.py --nm $(5) --config '$(2)' --machine $(3) lib/c/fairlead.h.in $$< >$$@
$(1)/constants.o: lib/c/constants.cpp $(1)/config
	$$(call step,$(3) $$<) $(4) $(7) -DFAIRLEAD_CONFIG='"$(abspath $(2))"' -MMD -MP -c $$< -o $$@
$(C_PARTS:%=$(1)/%.o): $(1)/%.o: lib/c/%.cpp $(1)/fairlead.h
	$$(call step,$(3) $$<) $(4) $(7) -I$(1) -DFAIRLEAD_CONFIG='"$(abspath $(2))"' -MMD -MP -c $$< -o $$@
$(1)/libfairlead.a: $(C_PARTS:%=$(1)/%.o)
	@rm -f $$@
	$$(call step,$(3) libfairlead.a) $(6) rcs $$@ $$^
-include $$(wildcard $(1)/*.d)
endef
.PHONY: always
always:

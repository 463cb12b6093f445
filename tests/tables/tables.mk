# Trains the tables of symbol costs on recordings (tests/tables/train): minutes, the result is committed.
TABLE_RECORDINGS ?= $(sort $(wildcard ../shared/recordings/tracker120/*.trk))
TABLE_NOTE ?= the 13 recordings of tracker120 (BROAD): delays 60 to 240 records, 1 to 5 mm, 0.25 to 1 deg
.PHONY: tables
tables: $(BUILD)/libsim.a ## train lib/include/fairlead/code/tables.hpp on TABLE_RECORDINGS: minutes; changes the format
	@tests/tables/train $(BUILD) lib/include/fairlead/code/tables.hpp '$(TABLE_NOTE)' 3 $(TABLE_RECORDINGS)

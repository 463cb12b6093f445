# All compiler flags that say what the code is held to: the Makefile and tests/target/target.mk include this file.
STRICT := -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow -Werror
# the same bits everywhere: no fused multiply-add, no errno side of sqrt
BITS   := -ffp-contract=off -fno-math-errno
CHECKED := -std=c++17 $(BITS) $(STRICT) -Ilib/include -I.
# the library needs no run-time support of C++
BARE_CPP := -fno-exceptions -fno-rtti
# a bare machine: nothing at start or exit, and the linker may drop what is not called
BARE_MACHINE := -fno-threadsafe-statics -fno-use-cxa-atexit -ffunction-sections -fdata-sections
# C users compile the header and the examples with these
STRICT_C := -std=c99 -Wall -Wextra -pedantic -Wconversion -Wshadow -Werror
# $(call sanitize,LIST): what a sanitizer finds ends the program
sanitize = -fsanitize=$(1) -fno-sanitize-recover=all
comma := ,

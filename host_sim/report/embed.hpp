#pragma once
// A file of the tree, or of the system, as a text in the program. The assembler reads it when the
// program is built, so that no copy stands in the tree; paths are those from the top of the tree,
// where the compiler runs.
#include <cstddef>
#include <string_view>

/// Defines std::string_view SPACE::NAME().
#define FAIRLEAD_EMBED(space, name, path)                                           \
    __asm__(                                                                        \
        ".section .rodata\n"                                                        \
        ".global fairlead_" #name                                                   \
        "\n"                                                                        \
        "fairlead_" #name ":\n.incbin \"" path                                      \
        "\"\n"                                                                      \
        ".global fairlead_" #name                                                   \
        "_end\n"                                                                    \
        "fairlead_" #name "_end:\n.byte 0\n.previous\n");                           \
    extern "C" const char fairlead_##name[];                                        \
    extern "C" const char fairlead_##name##_end[];                                  \
    namespace space {                                                               \
    std::string_view name() {                                                       \
        return {fairlead_##name,                                                    \
                static_cast<std::size_t>(fairlead_##name##_end - fairlead_##name)}; \
    }                                                                               \
    }

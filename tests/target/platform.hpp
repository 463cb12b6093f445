#pragma once
// The few services that the target tests ask of the machine they run on: by semihosting on a core
// (platform_core.cpp), by the C library on the host (platform_host.cpp).
#include <cstddef>

namespace fairlead::target::platform {

/// Fills in what main() was given, where the machine does not do so by itself.
void command_line(int& argc, char**& argv);
int open_to_read(const char* path);   // a handle, or -1
int open_to_write(const char* path);  // a handle, or -1
std::size_t read(int file, void* to, std::size_t size);
bool write(int file, const void* from, std::size_t size);
void close(int file);
void complain(const char* text);

/// Calls f(argument) between the markers, on a stack of its own where the machine allows.
void call_marked(void (*f)(const void*), const void* argument);
/// Deepest use of that stack so far, in bytes; 0 where it is not known.
std::size_t stack_used();

}  // namespace fairlead::target::platform

#pragma once
// Files, arguments, console and exit code of the machine that runs the emulator or debugger, by Arm
// semihosting (and its RISC-V twin). For tests on target; a product has no such host.
#include <cstddef>
#include <cstdint>

namespace fairlead::cortex_m::semihosting {

enum class Call : int {
    open = 0x01,
    close = 0x02,
    print = 0x04,
    write = 0x05,
    read = 0x06,
    command_line = 0x15,
    exit = 0x20
};
enum class Mode : int { read = 1, write = 5 };  // "rb", "wb"

inline int call(Call number, const void* block) noexcept {
#if defined(__riscv)
    register int a0 __asm__("a0") = static_cast<int>(number);
    register const void* a1 __asm__("a1") = block;
    // the three instructions, uncompressed and in one 16-byte line, are the host's signature
    __asm__ volatile(
        ".option push\n.option norvc\n.balign 16\n"
        "slli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
        : "+r"(a0)
        : "r"(a1)
        : "memory");
    return a0;
#else
    register int r0 __asm__("r0") = static_cast<int>(number);
    register const void* r1 __asm__("r1") = block;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
#endif
}

inline std::size_t length(const char* text) noexcept {
    std::size_t n = 0;
    while (text[n] != '\0') ++n;
    return n;
}

inline void print(const char* text) noexcept { call(Call::print, text); }

/// A handle, or -1.
inline int open(const char* path, Mode mode) noexcept {
    const struct {
        const char* path;
        int mode;
        std::size_t length;
    } block{path, static_cast<int>(mode), length(path)};
    return call(Call::open, &block);
}
inline void close(int file) noexcept { call(Call::close, &file); }

/// Bytes read; fewer than asked only at the end of the file.
inline std::size_t read(int file, void* to, std::size_t size) noexcept {
    const struct {
        int file;
        void* to;
        std::size_t size;
    } block{file, to, size};
    return size - static_cast<std::size_t>(call(Call::read, &block));
}
inline bool write(int file, const void* from, std::size_t size) noexcept {
    const struct {
        int file;
        const void* from;
        std::size_t size;
    } block{file, from, size};
    return call(Call::write, &block) == 0;
}

/// The words given to the image, as main() takes them: the line is cut into them. @return how many.
inline int command_line(char* line, std::size_t size, char** words, int words_max) noexcept {
    const struct {
        char* to;
        std::size_t size;
    } block{line, size};
    if (call(Call::command_line, &block) != 0) return 0;
    int count = 0;
    for (char* at = line; *at != '\0' && count < words_max;) {
        while (*at == ' ') *at++ = '\0';
        if (*at == '\0') break;
        words[count++] = at;
        while (*at != '\0' && *at != ' ') ++at;
    }
    return count;
}

[[noreturn]] inline void exit(int code) noexcept {
    const struct {
        std::uint32_t reason, code;
    } block{0x20026, static_cast<std::uint32_t>(code)};  // 0x20026: the application ended
    call(Call::exit, &block);
    for (;;) {
    }
}

}  // namespace fairlead::cortex_m::semihosting

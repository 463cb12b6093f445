#include "host_sim/recording/encoding.hpp"

#include <algorithm>
#include <cstdint>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {
namespace {

std::uint32_t byte_at(std::string_view bytes, std::size_t i) {
    return static_cast<unsigned char>(bytes[i]);
}

void append_utf8(std::string& out, std::uint32_t code) {
    const auto put = [&](std::uint32_t c) { out += static_cast<char>(c); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0 | code >> 6);
        put(0x80 | (code & 0x3F));
    } else if (code < 0x10000) {
        put(0xE0 | code >> 12);
        put(0x80 | (code >> 6 & 0x3F));
        put(0x80 | (code & 0x3F));
    } else {
        put(0xF0 | code >> 18);
        put(0x80 | (code >> 12 & 0x3F));
        put(0x80 | (code >> 6 & 0x3F));
        put(0x80 | (code & 0x3F));
    }
}

/// An odd last byte, half a character, is left out.
std::string from_utf16(std::string_view bytes, bool little) {
    const auto unit = [&](std::size_t i) {
        const std::uint32_t a = byte_at(bytes, i), b = byte_at(bytes, i + 1);
        return little ? a | b << 8 : a << 8 | b;
    };
    std::string out;
    out.reserve(bytes.size() / 2);
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t code = unit(i);
        if (code >= 0xD800 && code < 0xDC00 && i + 3 < bytes.size()) {
            const std::uint32_t low = unit(i + 2);
            if (low >= 0xDC00 && low < 0xE000) {
                code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
                i += 2;
            }
        }
        append_utf8(out, code >= 0xD800 && code < 0xE000 ? 0xFFFD : code);
    }
    return out;
}

/// Length of the UTF-8 character at i; 0: there is none.
std::size_t utf8_size(std::string_view text, std::size_t i) {
    const std::uint32_t first = byte_at(text, i);
    const std::size_t size = first < 0x80         ? 1
                             : first >> 5 == 0x6  ? 2
                             : first >> 4 == 0xE  ? 3
                             : first >> 3 == 0x1E ? 4
                                                  : 0;
    if (size == 0 || i + size > text.size()) return 0;
    for (std::size_t k = 1; k < size; ++k)
        if (byte_at(text, i + k) >> 6 != 2) return 0;
    return size;
}

bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t size = utf8_size(text, i);
        if (size == 0) return false;
        i += size;
    }
    return true;
}

std::string from_latin1(std::string_view bytes) {
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); ++i) append_utf8(out, byte_at(bytes, i));
    return out;
}

bool starts(std::string_view bytes, std::string_view mark) {
    return bytes.substr(0, mark.size()) == mark;
}

/// Zero bytes at odd (little endian) or even places of the first characters, and nowhere else.
bool zeros_at(std::string_view bytes, std::size_t first) {
    const std::size_t n = std::min<std::size_t>(bytes.size(), 64) & ~std::size_t{1};
    if (n < 8) return false;
    for (std::size_t i = 0; i < n; ++i)
        if ((bytes[i] == '\0') != (i % 2 == first)) return false;
    return true;
}

}  // namespace

bool looks_utf16(std::string_view bytes) {
    return starts(bytes, "\xFF\xFE") || starts(bytes, "\xFE\xFF") || zeros_at(bytes, 1) ||
           zeros_at(bytes, 0);
}

std::string_view as_utf8(std::string_view bytes, std::string& storage,
                         std::vector<std::string>& notes) {
    if (starts(bytes, std::string_view("\xFF\xFE\0\0", 4)) ||
        starts(bytes, std::string_view("\0\0\xFE\xFF", 4)))
        throw BadData("byte 0: the text is UTF-32; save it as UTF-8");
    if (starts(bytes, "\xEF\xBB\xBF")) bytes.remove_prefix(3);
    if (looks_utf16(bytes)) {
        const bool marked = starts(bytes, "\xFF\xFE") || starts(bytes, "\xFE\xFF");
        const bool little = starts(bytes, "\xFF\xFE") || (!marked && zeros_at(bytes, 1));
        storage = from_utf16(bytes.substr(marked ? 2 : 0), little);
        notes.emplace_back(little ? "the text is UTF-16, little endian"
                                  : "the text is UTF-16, big endian");
        return storage;
    }
    if (is_utf8(bytes)) return bytes;
    storage = from_latin1(bytes);
    notes.emplace_back("the text is not UTF-8; it is read as Latin-1");
    return storage;
}

}  // namespace fairlead::sim

#pragma once
// Values in little-endian binary files. The host is little endian, like the files.
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "fairlead/base/types.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

template <class T>
T load(std::string_view bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

inline Vec3 load_vec3(std::string_view bytes, std::size_t offset) {
    const auto v = load<std::array<float, 3>>(bytes, offset);
    return {v[0], v[1], v[2]};
}

inline Quat load_quat(std::string_view bytes, std::size_t offset) {
    const auto q = load<std::array<float, 4>>(bytes, offset);
    return {q[0], q[1], q[2], q[3]};
}

template <class T>
void store(std::string& out, const T& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof bytes);
}

inline void store(std::string& out, const Vec3& v) {
    for (const float x : {v.x, v.y, v.z}) store(out, x);
}

inline void store(std::string& out, const Quat& q) {
    for (const float x : {q.w, q.x, q.y, q.z}) store(out, x);
}

/// A name field of fixed size that ends with a zero; a cut does not split a UTF-8 character.
inline void store_name(std::string& out, std::string name, std::size_t size) {
    if (name.size() >= size) {
        std::size_t end = size - 1;
        while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
        name.resize(end);
    }
    name.resize(size);
    out += name;
}

[[noreturn]] inline void refuse_at(std::size_t offset, const std::string& why) {
    throw BadData("byte " + std::to_string(offset) + ": " + why);
}

}  // namespace fairlead::sim

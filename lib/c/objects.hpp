#pragma once
// Objects in the caller's memory: how they are made there and found again.
#include <cstring>
#include <new>

#include "lib/c/convert.hpp"

namespace fairlead::c {

/// The cell of an object of C, or null: no object was made there.
template <class ACell, class Opaque>
ACell* find(Opaque* object) noexcept {
    static_assert(sizeof(object->opaque) == sizeof(ACell) && alignof(Opaque) >= alignof(ACell),
                  "fairlead.h is of another configuration than this archive");
    std::uint32_t tag = 0;
    if (object == nullptr) return nullptr;
    std::memcpy(&tag, object->opaque, sizeof tag);
    if (tag != ACell::tag_value) return nullptr;
    return std::launder(reinterpret_cast<ACell*>(object->opaque));
}
template <class ACell, class Opaque>
const ACell* find(const Opaque* object) noexcept {
    return find<ACell>(const_cast<Opaque*>(object));
}

/// Is there memory for an object, of the size and alignment that this archive was built for?
template <class Opaque>
bool fits(const Opaque* object, std::size_t size) noexcept {
    return object != nullptr && size == sizeof(Opaque) &&
           reinterpret_cast<std::uintptr_t>(object) % alignof(Opaque) == 0;
}

/// Makes a cell whose value is built from these arguments, in place.
template <class ACell, class Opaque, class... Arguments>
ACell* make(Opaque* object, const Arguments&... arguments) noexcept {
    return ::new (static_cast<void*>(object->opaque)) ACell{arguments...};
}

/// The status of a call on an object that was not found.
inline fairlead_status missing(const void* object) noexcept {
    return object == nullptr ? FAIRLEAD_BAD_ARGUMENT : FAIRLEAD_CLOSED;
}
inline fairlead_status code(Status status) noexcept { return static_cast<fairlead_status>(status); }
inline fairlead_bytes bytes_of(const Bytes& bytes) noexcept {
    return {bytes.data, bytes.size, code(bytes.status)};
}

}  // namespace fairlead::c

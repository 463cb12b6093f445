// The frame of the second example in docs/reducer.md.
#include "example_headers.inc"

void show(const fairlead::Vec3& position, const fairlead::Vec3& velocity, const fairlead::Quat& q,
          const fairlead::Vec3& rate);

void example(const std::uint8_t* bytes, std::size_t size, std::int64_t t_ns) {
#include "example.inc"
}

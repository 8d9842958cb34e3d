#include <meshoptimizer.h>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/unpacked_view.hpp"

namespace palpate {

namespace {

/// Elements that the decoder requires; it asserts them.
bool isAllowed(const PackedView& view) {
  if (view.mode == "ATTRIBUTES") {
    if (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256) return false;
    if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8;
    if (view.filter == "QUATERNION") return view.stride == 8;
    return view.filter == "NONE" || view.filter == "EXPONENTIAL";
  }
  if (view.stride != 2 && view.stride != 4) return false;
  return view.filter == "NONE" && (view.mode == "INDICES" || (view.mode == "TRIANGLES" && view.count % 3 == 0));
}

int decode(const PackedView& view, std::byte* to) {
  const auto* from = reinterpret_cast<const unsigned char*>(view.bytes.data());
  if (view.mode == "ATTRIBUTES")
    return meshopt_decodeVertexBuffer(to, view.count, view.stride, from, view.bytes.size());
  if (view.mode == "TRIANGLES") return meshopt_decodeIndexBuffer(to, view.count, view.stride, from, view.bytes.size());
  return meshopt_decodeIndexSequence(to, view.count, view.stride, from, view.bytes.size());
}

}  // namespace

std::vector<std::byte> unpackView(const PackedView& view) {
  constexpr std::size_t kMaxRatio =
      64;  // vertices need two bits for 16 bytes, and indices a byte each or for a triangle
  if (!isAllowed(view))
    throw Error("elements of {} bytes, mode {}, filter {} cannot be compressed", view.stride, inQuotes(view.mode),
                inQuotes(view.filter));
  if (view.count > kMaxRatio * view.bytes.size() / view.stride)
    throw Error("{} elements of {} bytes cannot be contained in {}", view.count, view.stride, view.bytes.size());
  std::vector<std::byte> bytes(view.count * view.stride);
  if (decode(view, bytes.data()) != 0) throw Error("its data are damaged");
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  return bytes;
}

}  // namespace palpate

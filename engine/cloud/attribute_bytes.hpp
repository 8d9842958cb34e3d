// A change of a mask, a field or a layer of strokes as bytes, for a history on the disk and for session logs.
#pragma once

#include <span>

#include "engine/core/attribute_change.hpp"

namespace palpate {

/// Memory.
std::uint64_t bytesOf(const AttributeChange& change);
/// To bytes, and back; false if they are not those of a change.
std::vector<std::byte> bytesIn(const AttributeChange& change);
bool readChange(std::span<const std::byte> bytes, AttributeChange& change);

}  // namespace palpate

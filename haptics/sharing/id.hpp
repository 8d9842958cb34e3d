#pragma once

#include <array>
#include <cstdint>

namespace palpate::sharing {

/// Unique id of a session or a client.
using Id = std::array<std::uint8_t, 16>;

}  // namespace palpate::sharing

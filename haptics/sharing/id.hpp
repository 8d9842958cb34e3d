#pragma once

#include <array>
#include <cstdint>

namespace palpate::sharing {

/// Of a session, or of a client: one that no other has.
using Id = std::array<std::uint8_t, 16>;

}  // namespace palpate::sharing

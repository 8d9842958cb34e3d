// CRC-32C (Castagnoli, Braeuer and Herrmann 1993), which guards the pages of E57.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate {

std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace palpate

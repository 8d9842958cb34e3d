// CRC-32C (Castagnoli, Braeuer and Herrmann 1993), the checksum of E57 pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate {

std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace palpate

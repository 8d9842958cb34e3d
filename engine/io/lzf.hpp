// Decompression of LZF (Lehmann 2000), the compression of PCD files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

/// Maximum number of output bytes per input byte.
inline constexpr std::uint64_t kMaxPerLzfByte = 132;

/// Fills `out` completely; on failure returns the byte of `in` where the error is.
std::optional<std::size_t> unpackLzf(std::span<const std::byte> in, std::span<std::byte> out);

}  // namespace palpate

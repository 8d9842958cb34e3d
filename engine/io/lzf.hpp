// LZF (Lehmann 2000), the compression of PCD files, as far as it is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

/// No byte of input stands for more of output.
inline constexpr std::uint64_t kMaxPerLzfByte = 132;

/// Fills `out` to its last byte; where it cannot, the byte of `in` at which that is seen.
std::optional<std::size_t> unpackLzf(std::span<const std::byte> in, std::span<std::byte> out);

}  // namespace palpate

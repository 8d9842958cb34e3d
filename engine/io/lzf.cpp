#include "engine/io/lzf.hpp"

#include <cstring>

namespace palpate {

std::optional<std::size_t> unpackLzf(std::span<const std::byte> in, std::span<std::byte> out) {
  std::size_t from = 0, to = 0;
  const auto byteAt = [&](std::size_t k) { return std::to_integer<std::size_t>(in[k]); };
  while (from < in.size()) {
    const std::size_t begin = from, control = byteAt(from++);
    if (control < 32) {  // control + 1 literal bytes
      const std::size_t length = control + 1;
      if (length > in.size() - from || length > out.size() - to) return begin;
      std::memcpy(out.data() + to, in.data() + from, length);
      from += length;
      to += length;
      continue;
    }
    std::size_t length = control >> 5;  // of earlier output, minus two
    if (length == 7) {
      if (from == in.size()) return begin;
      length += byteAt(from++);
    }
    if (from == in.size()) return begin;
    const std::size_t back = ((control & 31) << 8) + byteAt(from++) + 1;
    length += 2;
    if (back > to || length > out.size() - to) return begin;
    for (; length > 0; --length, ++to) out[to] = out[to - back];  // byte by byte, since the ranges may overlap
  }
  if (to < out.size()) return from;
  return std::nullopt;
}

}  // namespace palpate

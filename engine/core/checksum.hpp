#pragma once

#include <cstdint>
#include <cstring>
#include <span>

namespace palpate {

/// A 64-bit hash to distinguish data, after FNV-1a (Fowler, Noll, Vo), taken eight bytes at a time, each step folded so
/// that high bits reach low ones. It protects against accidents, not against malice.
class Checksum {
 public:
  /// Adding in pieces differs from adding at once, unless all pieces but the last are multiples of eight bytes long.
  void add(std::span<const std::byte> bytes) {
    std::size_t at = 0;
    for (; at + sizeof(std::uint64_t) <= bytes.size(); at += sizeof(std::uint64_t)) {
      std::uint64_t word;
      std::memcpy(&word, bytes.data() + at, sizeof word);
      addWord(word);
    }
    if (at == bytes.size()) return;
    std::uint64_t rest = 0;
    std::memcpy(&rest, bytes.data() + at, bytes.size() - at);
    addWord(rest ^ std::uint64_t{bytes.size() - at} << 56);
  }
  template <class T>
  void addValue(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  std::uint64_t value() const { return value_; }

 private:
  void addWord(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001b3ull;
    value_ ^= value_ >> 32;
  }

  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace palpate

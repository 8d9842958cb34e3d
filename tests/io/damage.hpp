// Damaged copies of files, the same in each run.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace palpate::test {

/// Flips bits, truncates, and sets numbers to extreme values.
class Damage {
 public:
  explicit Damage(std::uint32_t seed = 12345) : state_(seed) {}
  /// `head`: number of leading bytes that describe the content of the file.
  std::string of(std::string text, std::size_t head) {
    constexpr std::array<std::uint64_t, 6> kExtremes{0, 1, 0x7f, 0xff, 0x7fffffffffffffff, 0xffffffffffffffff};
    for (std::size_t flips = random(4); flips > 0; --flips)
      text[random(text.size())] ^= static_cast<char>(1u << random(8));
    switch (random(4)) {
      case 0:
        text.resize(random(text.size()));
        break;
      case 1: {
        const std::uint64_t extreme = kExtremes[random(kExtremes.size())];
        const std::size_t bytes = std::size_t{1} << random(4), at = random(head - 8);
        std::memcpy(text.data() + at, &extreme, bytes);
        break;
      }
      case 2:  // replaces a digit of text
        for (int tries = 0; tries < 50; ++tries)
          if (char& c = text[random(head)]; c >= '0' && c <= '9') c = static_cast<char>('0' + random(10));
        break;
      default:
        break;
    }
    return text;
  }

 private:
  std::size_t random(std::size_t below) {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<std::size_t>((std::uint64_t{state_} * below) >> 32);
  }
  std::uint32_t state_;
};

}  // namespace palpate::test

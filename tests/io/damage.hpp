// Files made worse, the same way in each run.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test {

/// Bits are flipped, ends are cut, numbers become extreme.
class Damage {
 public:
  explicit Damage(std::uint32_t seed = 12345) : state_(seed) {}
  /// `head`: how many of the first bytes are numbers that say what the file holds.
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
      case 2:  // a digit of text becomes another one
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

/// How many of so many damaged files are read; all others are refused. What is read is written again, and the table is
/// asked what it holds.
inline int readOfDamaged(const std::string& good, const std::string& ending, std::size_t head, int tries) {
  const ScratchFolder folder;
  Damage damage;
  int read = 0;
  for (int k = 0; k < tries; ++k) {
    const std::filesystem::path file = folder / ("a" + ending);
    std::ofstream(file, std::ios::binary) << damage.of(good, head);
    try {
      contentsOf(file);
      const StoredCloud stored = readCloud(file);
      ++read;
      writeCloud(folder / ("b" + ending), stored.cloud);
    } catch (const FileError&) {
    }
  }
  return read;
}

}  // namespace palpate::test

// Damaged copies of files, the same in each run.
#pragma once

#include <doctest/doctest.h>

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

/// Number of `tries` damaged files that are read; all others must be refused. Each is also queried for its contents,
/// and a file that is read is written again.
inline int readOfDamaged(const std::string& good, const std::string& ending, std::size_t head, int tries,
                         const CloudReadOptions& options = {}) {
  const ScratchFolder folder;
  Damage damage;
  int read = 0;
  for (int k = 0; k < tries; ++k) {
    const std::filesystem::path file = folder / ("a" + ending);
    std::ofstream(file, std::ios::binary) << damage.of(good, head);
    try {
      contentsOf(file);
      const StoredCloud stored = readCloud(file, nullptr, options);
      ++read;
      writeCloud(folder / ("b" + ending), stored.cloud);
    } catch (const FileError&) {
    }
  }
  return read;
}

/// `between`: bounds of the number of damaged files that are read.
inline void checkDamaged(const std::string& good, const std::string& ending, std::size_t head, int tries,
                         const std::array<int, 2>& between, const CloudReadOptions& options = {}) {
  const int read = readOfDamaged(good, ending, head, tries, options);
  CHECK(read > between[0]);
  CHECK(read < between[1]);
}

}  // namespace palpate::test

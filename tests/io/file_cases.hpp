// Files that are written for a case and read at once, and tables of those that must be refused.
#pragma once

#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/error_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test {

inline StoredCloud readingFile(const std::string& name, const std::string& bytes, const CloudReadOptions& options = {},
                               Log* log = nullptr) {
  const ScratchFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return readCloud(folder / name, log, options);
}

/// The error without the file's name; "read" if there is none.
inline std::string refusalOf(const std::string& name, const std::string& bytes, const CloudReadOptions& options = {}) {
  const std::string said = errorOf<FileError>([&] { readingFile(name, bytes, options); });
  return said.empty() ? "read" : said.substr(said.find(name) + name.size());
}

/// Whether a message is the expected one, of which "..." at the beginning or at the end leaves out any text.
inline bool fits(std::string_view said, std::string_view expected) {
  const bool begins = !expected.starts_with("..."), ends = !expected.ends_with("...");
  if (!begins) expected.remove_prefix(3);
  if (!ends) expected.remove_suffix(3);
  if (begins) return ends ? said == expected : said.starts_with(expected);
  return ends ? said.ends_with(expected) : said.find(expected) != said.npos;
}

/// A row of a table: what is said of an input, and what must be said.
inline void checkSaid(const std::string& said, const std::string& expected) {
  CHECK_MESSAGE(fits(said, expected), "said '", said, "', expected '", expected, "'");
}

/// A row of a table: a file of these bytes, and the message (see fits()) by which it must be refused, or "read".
inline void refuses(const std::string& name, const std::string& bytes, const std::string& expected,
                    const CloudReadOptions& options = {}) {
  CAPTURE(expected);
  checkSaid(refusalOf(name, bytes, options), expected);
}

/// 20 points, i to the right, j up: their positions, and colours from 0 to 255.
struct Sheet {
  static constexpr int kPoints = 20;
  static DVec3 place(int k) {
    const int i = k % 5, j = k / 5;
    return {i, j, 0.1 * i * j};
  }
  static std::array<int, 3> color(int k) { return {50 * (k % 5), 80 * (k / 5), 255 - 50 * (k % 5)}; }
};

inline void checkSheetColors(const PointCloud& cloud) {
  REQUIRE(cloud.size() == Sheet::kPoints);
  REQUIRE(cloud.hasColors());
  for (int k = 0; k < Sheet::kPoints; ++k)
    for (std::size_t channel = 0; channel < 3; ++channel)
      CHECK(std::abs(int{cloud.colors[static_cast<std::size_t>(k)][channel]} - Sheet::color(k)[channel]) <= 1);
}

inline void checkSheetPlaces(const PointCloud& cloud) {
  REQUIRE(cloud.size() == Sheet::kPoints);
  for (int k = 0; k < Sheet::kPoints; ++k)
    CHECK(glm::length(cloud.fileCoordinates(static_cast<std::size_t>(k)) - Sheet::place(k)) < 1e-6);
}

}  // namespace palpate::test

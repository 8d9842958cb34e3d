// Files that are written for a case and read at once.
#pragma once

#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test {

inline StoredCloud readingFile(const std::string& name, const std::string& bytes,
                               const CloudReadOptions& options = {}) {
  const ScratchFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return readCloud(folder / name, nullptr, options);
}

/// The error without the file's name; "read" if there is none.
inline std::string refusalOf(const std::string& name, const std::string& bytes) {
  try {
    readingFile(name, bytes);
  } catch (const FileError& error) {
    const std::string said = error.what();
    return said.substr(said.find(name) + name.size() + 1);
  }
  return "read";
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

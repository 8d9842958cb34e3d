// COPC files made by hand for the tests of the reader.
#pragma once

#include "tests/io/laz_bytes.hpp"

namespace palpate::test {

struct CopcNode {
  std::array<std::int32_t, 4> key;
  std::uint64_t at;
  std::int32_t bytes, points;  // -1 points: a page
};

/// A file of three nodes, two of them on a page of their own. The offsets of its parts are members, so that tests can
/// damage them.
struct CopcFile {
  std::string text, rows;
  std::size_t info = 375 + 54, root = 0, page = 0;

  static constexpr std::size_t kEntry = 32;
  void put(std::size_t at, const CopcNode& node) {
    for (std::size_t k = 0; k < 4; ++k) putAt(text, at + 4 * k, node.key[k]);
    putAt(text, at + 16, node.at);
    putAt(text, at + 24, node.bytes);
    putAt(text, at + 28, node.points);
  }
};

inline CopcFile copcFile() {
  LasBytes las = variedFile(7, 900);
  CopcFile file{.rows = las.points};
  las.records = lasRecord("copc", 1, std::string(160, '\0'));
  las.recordCount = 1;
  const std::vector<std::size_t> counts{300, 500, 100};
  file.text = packedFile(las, {.chunks = counts});
  std::uint32_t body = 0;
  std::memcpy(&body, file.text.data() + 96, sizeof body);
  const LazLayout layout = lazLayoutFor(7, 36);
  std::vector<std::pair<std::uint64_t, std::int32_t>> chunks;
  std::uint64_t at = body + 8, row = 0;
  for (const std::size_t count : counts) {
    const auto rows = std::as_bytes(std::span(las.points)).subspan(row * 36, count * 36);
    chunks.emplace_back(at, static_cast<std::int32_t>(encodeLazChunk(layout, rows).size()));
    at += static_cast<std::uint64_t>(chunks.back().second);
    row += count;
  }
  const std::size_t tail = file.text.size();
  file.root = tail + 60, file.page = file.root + 2 * CopcFile::kEntry;
  file.text += lasLongRecord("copc", 1000, std::string(4 * CopcFile::kEntry, '\0')) + lasLongRecord("late", 3, "stays");
  putAt(file.text, 235, std::uint64_t{tail});
  putAt(file.text, 243, std::uint32_t{2});
  putAt(file.text, file.info + 40, std::uint64_t{file.root});
  putAt(file.text, file.info + 48, std::uint64_t{2 * CopcFile::kEntry});
  file.put(file.root, {{0, 0, 0, 0}, chunks[0].first, chunks[0].second, 300});
  file.put(file.root + 32, {{1, 0, 1, 0}, file.page, 2 * CopcFile::kEntry, -1});
  file.put(file.page, {{1, 0, 1, 0}, chunks[2].first, chunks[2].second, 100});
  file.put(file.page + 32, {{2, 1, 3, 0}, chunks[1].first, chunks[1].second, 500});
  return file;
}

}  // namespace palpate::test

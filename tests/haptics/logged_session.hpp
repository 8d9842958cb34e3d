// A synthetic session, written to a log and compared with what is read back.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <tuple>
#include <utility>

#include "haptics/session_writer.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

inline LoggedTick tickAt(std::uint64_t i) {
  const auto x = static_cast<double>(i);
  return {.time_s = x / 1000,
          .device = {x, -x, 0.1 * x},
          .proxy = {x, 1, 2},
          .force_N = {0, 0, 1 / (1 + x)},
          .edits = 3 * i,
          .neighbours = static_cast<std::uint32_t>(i % 50),
          .flags = static_cast<std::uint32_t>(i % 8)};
}

inline EditBatch editsAt(std::uint32_t i) {
  EditBatch batch;
  for (std::uint32_t k = 0; k < 3; ++k)
    batch.points.push_back({.position = {1, 2, 3}, .number = 3 * i + k, .parent = k});
  if (i % 10 == 9) batch.marks.push_back({3, EditMark::Kind::stroke});
  return batch;
}

/// A change of a field of bytes.
inline AttributeChange changeOf(std::uint32_t i, std::uint64_t points) {
  return FieldChange{
      .field = i, .points = PointSet::range(i, i + points), .values = std::vector<std::byte>(points, std::byte(i))};
}

inline void writeSession(const std::filesystem::path& file, std::uint32_t ticks, bool ends = true) {
  SessionWriter writer(file, "a text");
  for (std::uint32_t i = 0; i < ticks; ++i) {
    writer.add(tickAt(i));
    writer.add(editsAt(i));
    if (i % 100 == 99) writer.flush();
  }
  if (ends) writer.finish(77);
}

inline bool sameTick(const LoggedTick& a, const LoggedTick& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Checks that the record is writeSession()'s, except for gaps.
inline void checkPieces(const SessionRecord& record) {
  std::size_t wrong = 0;
  double last_s = -1;
  for (const LoggedTick& tick : record.ticks) {
    wrong += !(tick.time_s > std::exchange(last_s, tick.time_s));
    wrong += !sameTick(tick, tickAt(static_cast<std::uint64_t>(std::lround(tick.time_s * 1000))));
  }
  std::uint64_t next = 0;
  for (const PointState& state : record.edits.points) wrong += state.number < std::exchange(next, state.number + 1);
  for (const EditMark& mark : record.edits.marks) {
    wrong += mark.at > record.edits.points.size();
    if (mark.at > 0) wrong += (record.edits.points[mark.at - 1].number + 1) % 30 != 0 && record.gaps.empty();
  }
  CHECK(wrong == 0);
}

// Checks that the record is a prefix of writeSession()'s.
inline void checkBeginning(const SessionRecord& record) {
  checkPieces(record);
  const auto& [ticks, edits] = std::tie(record.ticks, record.edits);
  if (!ticks.empty()) CHECK(ticks.back().time_s == tickAt(ticks.size() - 1).time_s);
  if (!edits.points.empty()) CHECK(edits.points.back().number == edits.points.size() - 1);
  for (std::size_t i = 0; i < edits.marks.size(); ++i) CHECK(edits.marks[i].at == 30 * (i + 1));
}

// Amount that the gaps report as missing.
inline std::uint64_t missing(const SessionRecord& record, std::optional<std::uint64_t> LogGap::*what) {
  std::uint64_t sum = 0;
  for (const LogGap& gap : record.gaps) sum += (gap.*what).value_or(0);
  return sum;
}

inline bool saysOneOf(const std::vector<std::string>& sentences, const std::string& part) {
  return std::ranges::any_of(sentences, [&](const std::string& s) { return s.find(part) != s.npos; });
}

inline void write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

}  // namespace palpate

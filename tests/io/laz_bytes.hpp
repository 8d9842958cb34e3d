// LAZ and COPC files made by hand, from points that vary as in scans, for the tests of their readers.
#pragma once

#include <algorithm>

#include "engine/io/integer_model.hpp"
#include "engine/io/laz_chunk.hpp"
#include "tests/io/las_points.hpp"

namespace palpate::test {

/// Pseudo-random numbers, the same in each run.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : state_(seed) {}
  std::uint32_t below(std::uint32_t limit) {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<std::uint32_t>((std::uint64_t{state_} * limit) >> 32);
  }
  bool oneIn(std::uint32_t n) { return below(n) == 0; }
  int upTo(int most) { return static_cast<int>(below(static_cast<std::uint32_t>(2 * most + 1))) - most; }

 private:
  std::uint32_t state_;
};

/// Rows of a point format: positions that walk and jump, pulses of several returns, times that stay, step, jump and
/// alternate, colours that are sometimes grey, several scanner channels, and `more` extra bytes.
class VariedPoints {
 public:
  VariedPoints(unsigned format, unsigned more, std::uint32_t seed = 1)
      : format_(format), more_(more, '\0'), dice_(seed + 977 * format) {}

  std::string row() {
    const Places& places = kPlaces[format_];
    std::string row(places.bytes, '\0');
    for (std::size_t k = 0; k < 3; ++k) putAt(row, 4 * k, place_[k] = nextPlace(place_[k]));
    if (dice_.oneIn(3)) intensity_ = static_cast<std::uint16_t>(intensity_ + dice_.upTo(dice_.oneIn(50) ? 40000 : 30));
    putAt(row, 12, intensity_);
    const bool extended = format_ >= 6;
    nextReturn(extended ? 15 : 7);
    putReturn(row, extended);
    if (places.time >= 0) putAt(row, static_cast<std::size_t>(places.time), nextTime());
    if (places.color >= 0) putColor(row, static_cast<std::size_t>(places.color));
    if (places.infrared >= 0 && dice_.oneIn(2)) infrared_ = static_cast<std::uint16_t>(infrared_ + dice_.upTo(300));
    if (places.infrared >= 0) putAt(row, static_cast<std::size_t>(places.infrared), infrared_);
    for (std::size_t k = 0; k < more_.size(); ++k)
      if (k > 0 && dice_.oneIn(4)) more_[k] = static_cast<char>(more_[k] + dice_.upTo(5));  // not the first
    return row + more_;
  }

 private:
  std::int32_t nextPlace(std::int32_t last) {
    if (dice_.oneIn(500)) return static_cast<std::int32_t>(dice_.below(0xffffffffu));
    const std::int64_t next = std::int64_t{last} + dice_.upTo(dice_.oneIn(20) ? 100'000 : 120);
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(next, -2147483647, 2147483647));
  }
  void nextReturn(unsigned most) {
    if (return_ < returns_ && !dice_.oneIn(30)) {
      ++return_;
    } else {
      returns_ = dice_.oneIn(100) ? dice_.below(most + 1) : 1 + dice_.below(std::min(most, 5u));
      return_ = dice_.oneIn(100) ? dice_.below(most + 1) : 1;
    }
  }
  void putReturn(std::string& row, bool extended) {
    const auto put = [&](std::size_t at, unsigned value) { putAt(row, at, static_cast<std::uint8_t>(value)); };
    if (dice_.oneIn(40)) class_ = dice_.below(extended ? 256 : 32);
    if (dice_.oneIn(60)) flags_ = dice_.below(16);
    if (dice_.oneIn(25)) angle_ = static_cast<std::int16_t>(angle_ + dice_.upTo(90));
    if (dice_.oneIn(200)) user_ = dice_.below(256);
    if (dice_.oneIn(300)) source_ = static_cast<std::uint16_t>(dice_.below(65536));
    if (dice_.oneIn(9)) channel_ = dice_.below(4);
    if (extended) {
      put(14, return_ | returns_ << 4);
      put(15, flags_ | channel_ << 4 | (flags_ & 3u) << 6);
      put(16, class_), put(17, user_);
      putAt(row, 18, angle_);
      putAt(row, 20, source_);
    } else {
      put(14, return_ | returns_ << 3 | (flags_ & 3u) << 6);
      put(15, class_ | (flags_ & 7u) << 5);
      put(16, static_cast<unsigned>(angle_) & 0xffu), put(17, user_);
      putAt(row, 18, source_);
    }
  }
  double nextTime() {
    if (dice_.oneIn(50)) clock_ = dice_.below(6);
    double& time = times_[clock_];
    std::uint64_t bits = 0;
    switch (dice_.below(12)) {
      case 0:
        time += 1e-5 * dice_.below(700);
        break;
      case 1:
        time -= 1e-5 * dice_.below(20);
        break;
      case 2:
        break;
      case 3:
        std::memcpy(&bits, &time, sizeof bits);
        bits += dice_.below(2'000'000'000);
        std::memcpy(&time, &bits, sizeof bits);
        break;
      default:
        time += 1e-5;
    }
    if (dice_.oneIn(2000)) time = 3.5e8 + dice_.below(1'000'000);
    return time;
  }
  void putColor(std::string& row, std::size_t at) {
    const bool grey = dice_.oneIn(5);
    for (std::size_t k = 0; k < 3; ++k) {
      if (dice_.oneIn(2)) color_[k] = static_cast<std::uint16_t>(color_[k] + dice_.upTo(dice_.oneIn(10) ? 20000 : 900));
      putAt(row, at + 2 * k, grey ? color_[0] : color_[k]);
    }
  }

  unsigned format_;
  std::string more_;
  Dice dice_;
  std::array<std::int32_t, 3> place_{};
  std::uint16_t intensity_ = 500, source_ = 7, infrared_ = 9000;
  unsigned return_ = 1, returns_ = 1, class_ = 2, flags_ = 0, user_ = 0, channel_ = 0, clock_ = 0;
  std::int16_t angle_ = -20;
  std::array<double, 6> times_{0, 4000.5, 1e9, -17, 3e8, 5e-300};
  std::array<std::uint16_t, 3> color_{30000, 20000, 10000};
};

inline LasBytes variedFile(unsigned format, std::size_t count, unsigned more = 0) {
  LasBytes las{.minor = format >= 6 ? 4u : 2u, .format = format, .pointBytes = kPlaces[format].bytes + more};
  las.count = count;
  VariedPoints points(format, more);
  for (std::size_t i = 0; i < count; ++i) las.points += points.row();
  return las;
}

inline std::string textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Options for packing points.
struct LazWay {
  std::vector<std::size_t> chunks = {};  ///< points of each; empty: as they are written
  bool chunked = true, tableAtEnd = false, version4 = false;
};

/// A LAZ file with the points of a LAS file, made independently of the writer.
inline std::string packedFile(const LasBytes& las, const LazWay& way = {}) {
  LazLayout layout = lazLayoutFor(las.format, las.pointBytes);
  layout.channelsLag = !way.version4;
  std::vector<std::size_t> sizes = way.chunks;
  for (std::size_t left = sizes.empty() ? las.count : 0; left > 0; left -= sizes.back())
    sizes.push_back(std::min<std::size_t>(left, way.chunked ? 50'000 : left));
  std::string body;
  std::vector<std::size_t> lengths;
  std::size_t done = 0;
  for (const std::size_t points : sizes) {
    const auto rows = std::as_bytes(std::span(las.points)).subspan(done * las.pointBytes, points * las.pointBytes);
    const std::string chunk = textOf(encodeLazChunk(layout, rows));
    lengths.push_back(chunk.size());
    body += chunk;
    done += points;
  }
  RangeEncoder encoder;
  IntegerModel model(32, 2);
  std::int32_t lastPoints = 0, lastLength = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const auto points = static_cast<std::int32_t>(sizes[k]), length = static_cast<std::int32_t>(lengths[k]);
    if (!way.chunks.empty()) model.code(encoder, lastPoints, points, 0);
    model.code(encoder, lastLength, length, 1);
    lastPoints = points, lastLength = length;
  }
  std::string table(8, '\0');
  putAt(table, 4, static_cast<std::uint32_t>(sizes.size()));
  table += textOf(encoder.finish());
  std::string record = textOf(lazRecordFor(las.format, layout));
  if (!way.chunked) putAt(record, 54, std::uint16_t{1});
  if (!way.chunks.empty()) putAt(record, 54 + 12, std::uint32_t{0xffffffff});
  for (std::size_t at = 54 + 34 + 4; way.version4 && at < record.size(); at += 6) putAt(record, at, std::uint16_t{4});
  LasBytes packed = las;
  packed.records += record;
  ++packed.recordCount;
  packed.points = body;
  if (way.chunked) {
    const std::size_t begin = packed.headerBytes() + packed.records.size() + packed.padding.size();
    const auto tableAt = static_cast<std::int64_t>(begin + 8 + body.size());
    std::string place(8, '\0'), atEnd;
    putAt(place, 0, way.tableAtEnd ? std::int64_t{-1} : tableAt);
    if (way.tableAtEnd) putAt(atEnd, 0, tableAt);
    packed.points = place + body + table + atEnd;
  }
  std::string text = packed.text();
  text[104] = static_cast<char>(las.format | 0x80u);
  return text;
}

}  // namespace palpate::test

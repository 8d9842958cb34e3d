// LAS files made by hand, byte by byte, for the tests of the reader.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace palpate::test {

/// Little endian on any machine.
template <class T>
void putAt(std::string& bytes, std::size_t at, T value) {
  if (bytes.size() < at + sizeof value) bytes.resize(at + sizeof value, '\0');
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// The fields of a file that a test sets; the rest is zero.
struct LasBytes {
  unsigned minor = 2, format = 0, pointBytes = 20;
  std::array<double, 3> step{0.01, 0.01, 0.01}, offset{0, 0, 0};
  std::string records = {};  ///< records that follow the header
  std::uint32_t recordCount = 0;
  std::string padding = {}, points = {}, tail = {};
  std::uint64_t count = 0;
  std::uint32_t longRecords = 0;

  std::size_t headerBytes() const { return minor == 4 ? 375 : minor == 3 ? 235 : 227; }
  std::string text() const {
    std::string out(headerBytes(), '\0');
    out.replace(0, 4, "LASF");
    putAt(out, 24, std::uint8_t{1});
    putAt(out, 25, static_cast<std::uint8_t>(minor));
    out.replace(26, 9, "by a test");
    putAt(out, 94, static_cast<std::uint16_t>(headerBytes()));
    const std::size_t pointsAt = headerBytes() + records.size() + padding.size();
    putAt(out, 96, static_cast<std::uint32_t>(pointsAt));
    putAt(out, 100, recordCount);
    putAt(out, 104, static_cast<std::uint8_t>(format));
    putAt(out, 105, static_cast<std::uint16_t>(pointBytes));
    if (format < 6) putAt(out, 107, static_cast<std::uint32_t>(count));
    for (std::size_t k = 0; k < 3; ++k) {
      putAt(out, 131 + 8 * k, step[k]);
      putAt(out, 155 + 8 * k, offset[k]);
    }
    if (minor == 4) {
      putAt(out, 247, count);
      if (longRecords > 0) putAt(out, 235, std::uint64_t{pointsAt + points.size()});
      putAt(out, 243, longRecords);
    }
    return out + records + padding + points + tail;
  }
};

inline std::string lasRecord(std::string user, unsigned id, const std::string& data) {
  std::string out(54, '\0');
  out.replace(2, user.size(), user);
  putAt(out, 18, static_cast<std::uint16_t>(id));
  putAt(out, 20, static_cast<std::uint16_t>(data.size()));
  return out + data;
}

inline std::string lasLongRecord(std::string user, unsigned id, const std::string& data) {
  std::string out(60, '\0');
  out.replace(2, user.size(), user);
  putAt(out, 18, static_cast<std::uint16_t>(id));
  putAt(out, 20, std::uint64_t{data.size()});
  return out + data;
}

/// `options`: 8 and 16 if scale and offset are valid.
inline std::string lasDescriptor(const std::string& name, unsigned code, unsigned options = 0, double scale = 0,
                                 double offset = 0) {
  std::string out(192, '\0');
  putAt(out, 2, static_cast<std::uint8_t>(code));
  putAt(out, 3, static_cast<std::uint8_t>(options));
  out.replace(4, name.size(), name);
  putAt(out, 112, scale);
  putAt(out, 136, offset);
  return out;
}

}  // namespace palpate::test

// Arrays of NumPy and archives of them, made by hand for the tests of the readers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::test::npy {

template <class T>
std::string bytes(std::initializer_list<T> values, bool reversed = false) {
  std::string out;
  for (const T value : values) {
    std::string one(reinterpret_cast<const char*>(&value), sizeof value);
    if (reversed) std::reverse(one.begin(), one.end());
    out += one;
  }
  return out;
}

/// `type`: with its quotes, or a list of fields.
inline std::string array(const std::string& type, const std::string& shape, const std::string& data,
                         bool fortran = false, int version = 1) {
  const std::string head =
      "{'descr': " + type + ", 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
  std::string out("\x93NUMPY", 6);
  out += static_cast<char>(version);
  out += '\0';
  for (int k = 0; k < (version == 1 ? 2 : 4); ++k) out += static_cast<char>(head.size() >> (8 * k) & 0xff);
  return out + head + data;
}

struct Member {
  std::string name, data, packed;  // `packed`: deflated bytes; empty: stored
};

inline std::uint32_t checksum(const std::string& text) {  // CRC-32 by its polynomial, bit by bit
  std::uint32_t sum = 0xffffffff;
  for (const char c : text) {
    sum ^= static_cast<std::uint8_t>(c);
    for (int k = 0; k < 8; ++k) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0u);
  }
  return ~sum;
}

inline std::string zip(const std::vector<Member>& members, bool wide = false) {
  std::string out, list;
  for (const Member& member : members) {
    const bool deflated = !member.packed.empty();
    const std::string& body = deflated ? member.packed : member.data;
    const std::size_t at = out.size();
    out += bytes<std::uint32_t>({0x04034b50}) +
           bytes<std::uint16_t>({20, 0, deflated ? std::uint16_t{8} : std::uint16_t{0}, 0, 0});
    out += bytes<std::uint32_t>({0, 0, 0}) + bytes<std::uint16_t>({static_cast<std::uint16_t>(member.name.size()), 4});
    out += member.name + bytes<std::uint16_t>({99, 0}) + body;
    const auto size = [&](std::size_t n) { return wide ? 0xffffffffu : static_cast<std::uint32_t>(n); };
    list += bytes<std::uint32_t>({0x02014b50}) +
            bytes<std::uint16_t>({20, 20, 0, deflated ? std::uint16_t{8} : std::uint16_t{0}, 0, 0});
    list += bytes<std::uint32_t>({checksum(member.data), size(body.size()), size(member.data.size())});
    list += bytes<std::uint16_t>(
        {static_cast<std::uint16_t>(member.name.size()), wide ? std::uint16_t{20} : std::uint16_t{0}, 0, 0, 0});
    list += bytes<std::uint32_t>({0, static_cast<std::uint32_t>(at)}) + member.name;
    if (wide) list += bytes<std::uint16_t>({1, 16}) + bytes<std::uint64_t>({member.data.size(), body.size()});
  }
  const std::size_t listAt = out.size();
  out += list + bytes<std::uint32_t>({0x06054b50}) + bytes<std::uint16_t>({0, 0});
  out += bytes<std::uint16_t>({static_cast<std::uint16_t>(members.size()), static_cast<std::uint16_t>(members.size())});
  return out + bytes<std::uint32_t>({static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(listAt)}) +
         bytes<std::uint16_t>({0});
}

/// A deflate block of type stored: the bytes are unchanged.
inline std::string plainBlock(const std::string& text) {
  const auto length = static_cast<std::uint16_t>(text.size());
  return std::string(1, '\1') + bytes<std::uint16_t>({length, static_cast<std::uint16_t>(~length)}) + text;
}

}  // namespace palpate::test::npy

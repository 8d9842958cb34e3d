// E57 files made by hand: pages with their checksums, packets of bits, and the XML that describes them.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/crc32c.hpp"
#include "tests/io/las_bytes.hpp"

namespace palpate::test {

/// One stream: integers in the fewest bits they need, or floats.
struct E57Stream {
  std::string xml;    ///< XML of the field
  unsigned bits = 0;  ///< bits of an integer; 0: floats in `real`
  std::vector<std::uint64_t> whole = {};
  std::string real = {};

  std::string bytes() const {
    if (bits == 0) return real;
    std::string out((whole.size() * bits + 7) / 8, '\0');
    for (std::size_t i = 0; i < whole.size(); ++i)
      for (unsigned b = 0; b < bits; ++b)
        if (whole[i] >> b & 1)
          out[(i * bits + b) / 8] = static_cast<char>(out[(i * bits + b) / 8] | 1 << (i * bits + b) % 8);
    return out;
  }
};

struct E57Part {
  std::uint64_t points = 0;
  std::vector<E57Stream> streams = {};
  std::string more = {};  ///< XML of the scan besides its points
};

class E57Bytes {
 public:
  std::string xmlBehind = {};    ///< at the end of the root element
  std::size_t pieceBytes = 900;  ///< bytes of a stream in one packet
  std::string codecs = {};

  void add(const E57Part& part) {
    const std::size_t at = logical_.size();
    std::string data;
    std::vector<std::string> streams;
    std::size_t longest = 0;
    for (const E57Stream& stream : part.streams) {
      streams.push_back(stream.bytes());
      longest = std::max(longest, streams.back().size());
    }
    data += std::string("\x02\0\x03\0", 4);  // an empty packet, as some programs write
    for (std::size_t begin = 0; begin < longest; begin += pieceBytes) {
      std::string packet("\x01\0\0\0", 4), body;
      putAt(packet, 4, static_cast<std::uint16_t>(streams.size()));
      for (std::size_t k = 0; k < streams.size(); ++k) {
        const std::string piece = begin < streams[k].size() ? streams[k].substr(begin, pieceBytes) : "";
        putAt(packet, 6 + 2 * k, static_cast<std::uint16_t>(piece.size()));
        body += piece;
      }
      packet += body;
      packet.resize((packet.size() + 3) / 4 * 4, '\0');
      putAt(packet, 2, static_cast<std::uint16_t>(packet.size() - 1));
      data += packet;
    }
    std::string head(32, '\0');
    head[0] = 1;
    putAt(head, 8, std::uint64_t{32 + data.size()});
    putAt(head, 16, physical(at + 32));
    logical_ += head + data;
    xml_ += "<vectorChild type=\"Structure\">" + part.more + "<points type=\"CompressedVector\" fileOffset=\"" +
            std::to_string(physical(at)) + "\" recordCount=\"" + std::to_string(part.points) +
            "\"><prototype type=\"Structure\">";
    for (const E57Stream& stream : part.streams) xml_ += stream.xml;
    xml_ += "</prototype><codecs type=\"Vector\">" + codecs + "</codecs></points></vectorChild>\n";
  }

  std::string text() const {
    const std::string xml = "<?xml version=\"1.0\"?>\n<e57Root type=\"Structure\"><data3D type=\"Vector\">" + xml_ +
                            "</data3D>" + xmlBehind + "</e57Root>\n";
    std::string logical = logical_ + xml;
    const std::size_t pages = (logical.size() + 1019) / 1020;
    logical.resize(pages * 1020, '\0');
    logical.replace(0, 8, "ASTM-E57");
    putAt(logical, 8, std::uint32_t{1});
    putAt(logical, 16, std::uint64_t{pages * 1024});
    putAt(logical, 24, physical(logical_.size()));
    putAt(logical, 32, std::uint64_t{xml.size()});
    putAt(logical, 40, std::uint64_t{1024});
    return paged(logical);
  }

  /// Pages with valid checksums, whatever the bytes are.
  static std::string paged(const std::string& logical) {
    std::string out;
    for (std::size_t at = 0; at < logical.size(); at += 1020) {
      const std::string page = logical.substr(at, 1020);
      const std::uint32_t sum = crc32c(std::as_bytes(std::span(page)));
      out += page;
      for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(sum >> shift & 255);
    }
    return out;
  }
  static std::string unpaged(const std::string& text) {
    std::string out;
    for (std::size_t at = 0; at < text.size(); at += 1024) out += text.substr(at, 1020);
    return out;
  }

 private:
  static std::uint64_t physical(std::size_t at) { return at / 1020 * 1024 + at % 1020; }

  std::string logical_ = std::string(48, '\0'), xml_;
};

inline E57Stream floats(const std::string& name, const std::vector<double>& values, bool single) {
  E57Stream stream{.xml = "<" + name + " type=\"Float\"" + (single ? " precision=\"single\"" : "") + "/>"};
  for (const double value : values)
    if (single)
      putAt(stream.real, stream.real.size(), static_cast<float>(value));
    else
      putAt(stream.real, stream.real.size(), value);
  return stream;
}

inline E57Stream integers(const std::string& name, const std::vector<std::int64_t>& values, std::int64_t least,
                          std::int64_t most, const std::string& scaled = "") {
  E57Stream stream{.xml = "<" + name + " type=\"" + (scaled.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                          std::to_string(least) + "\" maximum=\"" + std::to_string(most) + "\" " + scaled + "/>"};
  stream.bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(most - least)));
  for (const std::int64_t value : values) stream.whole.push_back(static_cast<std::uint64_t>(value - least));
  return stream;
}

}  // namespace palpate::test

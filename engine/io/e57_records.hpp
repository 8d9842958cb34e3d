// The points of an E57 scan as columns: a bit stream for each field, split into packets.
#pragma once

#include "engine/io/e57_scans.hpp"

namespace palpate {

/// Values may be read by number from any thread.
class E57Records {
 public:
  /// Throws FileError with the byte for an invalid packet, and if there are fewer values than the scan declares.
  E57Records(const E57Pages& pages, const E57Scan& scan);

  /// Value of field `field`, scaled if necessary. Not for text.
  double value(std::size_t field, std::uint64_t point) const;

 private:
  void readPackets(const E57Pages& pages);
  std::size_t takePacket(const E57Pages& pages, std::span<const std::byte> packet);
  void checkCounts(const E57Pages& pages) const;

  const E57Scan& scan_;
  std::vector<std::vector<std::byte>> streams_;  // padded with zeros, since whole words are read
};

}  // namespace palpate

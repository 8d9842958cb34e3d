// The points of a scan of E57 as columns: a stream of bits for each field, cut into packets.
#pragma once

#include "engine/io/e57_scans.hpp"

namespace palpate {

/// Values are asked for by number, from any threads.
class E57Records {
 public:
  /// Throws FileError with the byte of a packet that lies, and where there are fewer values than the scan says.
  E57Records(const E57Pages& pages, const E57Scan& scan);

  /// Of field `field`, as it is meant: scaled, or real. Nothing that a text has.
  double value(std::size_t field, std::uint64_t point) const;

 private:
  void readPackets(const E57Pages& pages);
  std::size_t takePacket(const E57Pages& pages, std::span<const std::byte> packet);
  void checkCounts(const E57Pages& pages) const;

  const E57Scan& scan_;
  std::vector<std::vector<std::byte>> streams_;  // with some zeros at their end, where whole words are read
};

}  // namespace palpate

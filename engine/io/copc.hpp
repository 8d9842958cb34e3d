// COPC 1.0, LAZ whose chunks are the nodes of an octree (Hobu 2021): what says where the nodes are.
#pragma once

#include "engine/io/laz_layout.hpp"

namespace palpate {

inline constexpr std::string_view kCopcUser = "copc";
inline constexpr unsigned kCopcInfo = 1, kCopcHierarchy = 1000;

/// Whether a file, by its first bytes, says that it is one: by its first record, which stands right behind the header.
inline constexpr std::size_t kCopcHead = kLasHeader14 + kLasRecordHead;
bool isCopc(std::span<const std::byte> begin);

struct CopcNodes {
  LazChunks found;           ///< in the order of the file
  std::size_t nodes = 0;     ///< also those without points
  std::int32_t deepest = 0;  ///< level, the root's is 0
};

/// Walks the pages of the hierarchy. `info`: the first record; `body`: the bytes of the file from its points on. Throws
/// FileError with the byte of what lies: a page that is met twice, a node beside the file or over another one, points
/// that are in no node.
CopcNodes readCopcNodes(const std::filesystem::path& file, const LasHeader& header, const LasRecord& info,
                        std::span<const std::byte> body);

}  // namespace palpate

// COPC 1.0: LAZ whose chunks are the nodes of an octree (Hobu 2021); reads the positions of the nodes.
#pragma once

#include "engine/io/laz_layout.hpp"

namespace palpate {

inline constexpr std::string_view kCopcUser = "copc";
inline constexpr unsigned kCopcInfo = 1, kCopcHierarchy = 1000;

/// Whether a file is COPC by its first bytes: by its first record, which directly follows the header.
inline constexpr std::size_t kCopcHead = kLasHeader14 + kLasRecordHead;
bool isCopc(std::span<const std::byte> begin);

struct CopcNodes {
  LazChunks found;           ///< in the order of the file
  std::size_t nodes = 0;     ///< also those without points
  std::int32_t deepest = 0;  ///< level; the root has 0
};

/// Reads all pages of the hierarchy. `info`: the first record; `body`: the bytes of the file starting at its points.
/// Throws FileError with the byte for duplicate pages, nodes outside the file, overlapping nodes, and points that
/// belong to no node.
CopcNodes readCopcNodes(const std::filesystem::path& file, const LasHeader& header, const LasRecord& info,
                        std::span<const std::byte> body);

}  // namespace palpate

// Decodes the points of LAZ, one chunk per thread or two interleaved.
#pragma once

#include "engine/core/log.hpp"
#include "engine/io/las_columns.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

/// `body`: the bytes of the file from byte `bodyAt` on, with all chunks. Memory grows with the decoded points, at most
/// some millions ahead, independent of what the file claims. Throws FileError with the byte of the damage.
void readLazPoints(const std::filesystem::path& file, const LazLayout& layout, std::span<const LazChunk> chunks,
                   std::span<const std::byte> body, std::uint64_t bodyAt, LasColumns& columns, Log* log);

}  // namespace palpate

// Unpacks the points of LAZ: a chunk a thread, or two side by side.
#pragma once

#include <functional>

#include "engine/core/log.hpp"
#include "engine/io/las_columns.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

/// `body`: the bytes of the file from byte `bodyAt` on, with all chunks. Memory follows the points that are unpacked,
/// some millions ahead at most, whatever the file says. Throws FileError with the byte of what is damaged.
void readLazPoints(const std::filesystem::path& file, const LazLayout& layout, std::span<const LazChunk> chunks,
                   std::span<const std::byte> body, std::uint64_t bodyAt, LasColumns& columns, Log* log);

}  // namespace palpate

// Room for open files.
#pragma once

#include <cstddef>

namespace palpate {

/// Whether this program can open that many more files at once, up to its limit (ulimit -n).
bool canOpenFiles(std::size_t count) noexcept;

}  // namespace palpate

// The files that commands write: a format that depends on the file's ending is checked before any work.
#pragma once

#include <string>

#include "apps/cli/options.hpp"

namespace palpate {

enum class Output {
  points,   ///< of a cloud, in a format of clouds
  mesh,     ///< triangles, or their corners
  copy,     ///< of a file, in any format that is written
  picture,  ///< .png, .jpg, .jpeg
  plot,     ///< .png, .pdf, .svg
  only,     ///< in the one format that such files have, under any name: traces, logs, results
};

/// Throws UsageError, listing the known endings, if the format of `kind` depends on the ending of `file` and that is
/// unknown, and FileError if the file cannot be written: now, rather than after an hour's work. The name of a device or
/// a pipe may have any ending. Ignores an empty name.
void checkOutput(const std::string& file, Output kind);

/// Throws UsageError if two options of the command line write the same file, if one would replace a file that another
/// one reads, such as the model, or if one has the next option as its file. Devices and pipes may be named twice.
void checkFileNames(const Options& program);

}  // namespace palpate

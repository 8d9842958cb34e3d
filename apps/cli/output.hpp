// The files that commands write. A file's ending says what it holds, so that another one is refused before any work.
#pragma once

#include <string>

namespace palpate {

enum class Output {
  points,      ///< of a cloud, in a format of clouds
  mesh,        ///< triangles, or their corners
  copy,        ///< of a file, in any format that is written
  picture,     ///< .png, .jpg, .jpeg
  depth,       ///< .pfm
  trace,       ///< .csv
  trajectory,  ///< .csv, .txt
  result,      ///< .json
  plot,        ///< .png, .pdf, .svg
  session,     ///< a session log: .session, .log or no ending
  journal,     ///< of strokes: .strokes, .journal or no ending
};

/// Throws UsageError, naming the endings that there are, where the ending of `file` is not one of those of `kind`, and
/// FileError where the file could not be written: now, rather than after an hour's work. The name of a device or a pipe
/// may have any ending. An empty name asks for nothing.
void checkOutput(const std::string& file, Output kind);

}  // namespace palpate

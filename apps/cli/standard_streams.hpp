// Clouds that a command reads from standard input, or writes to standard output: "-", with a format.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

class StandardStreams {
 public:
  /// Adds --format.
  void addOption(Options& program);
  /// Replaces each "-" that names a cloud on the command line by a temporary file, which messages name by its stream.
  /// Throws UsageError without --format.
  void redirect(const Options& program);
  /// Reads standard input into its file, if it is named. Throws UsageError for a terminal, and FileError.
  void read();
  /// Whether standard output is reserved for a cloud.
  bool writes() const { return output_.has_value(); }
  /// Writes the file of the command to standard output.
  void finish();

 private:
  std::string format_;
  std::optional<TemporaryFile> input_, output_;
};

}  // namespace palpate

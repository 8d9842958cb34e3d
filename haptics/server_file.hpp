// The file of a joined session's server, which it writes on request.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace palpate {

/// The server's answer to a request to write it.
struct ServerSave {
  bool written = false;
  std::uint64_t points = 0;  ///< written
  std::string words;         ///< the file, as its server names it; or why it was not written
  bool operator==(const ServerSave&) const = default;
};
/// As a sentence.
std::string inWords(const ServerSave& save);

/// Thread-safe.
class ServerFile {
 public:
  virtual ~ServerFile() = default;
  /// Asks the server to write its points, with all strokes that it has taken by now. Ends an earlier request.
  virtual void requestWrite() = 0;
  /// Answer to the last request; nothing as long as there is none.
  virtual std::optional<ServerSave> answer() const = 0;
};

}  // namespace palpate

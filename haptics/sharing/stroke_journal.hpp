// Stores the strokes of a shared session on disk, so that they outlive the server. Independent of DDS.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "engine/core/point_state.hpp"
#include "haptics/sharing/id.hpp"

namespace palpate::sharing {

/// A file to which each piece of a stroke is added before its client is notified. A server that is killed
/// and restarted with it continues where it was, and so do its clients. Numbers are little-endian.
class StrokeJournal {
 public:
  struct Piece {
    Id client;
    std::uint64_t number;
    std::span<const PointState> states;
  };
  /// Creates the file, or continues it: `take` gets all its pieces, in order. `checksum`: of the `points` that are
  /// served. A truncated last piece, as after a kill, is removed: no client was notified of it. Throws
  /// FileError for a file that is not a journal, belongs to other points, or is damaged, and leaves it unchanged.
  StrokeJournal(std::filesystem::path file, std::uint64_t points, std::uint64_t checksum, const Id& fresh,
                const std::function<void(const Piece&)>& take);

  /// Session of the journal: `fresh`, or the one in the file.
  const Id& session() const { return session_; }
  std::uint64_t pieces() const { return pieces_; }
  /// Bytes that were truncated when the file was opened.
  std::uint64_t tornBytes() const { return tornBytes_; }
  /// The piece is in the file when this returns, even if this program is killed. Throws FileError.
  void add(const Piece& piece);

 private:
  void begin(std::uint64_t points, std::uint64_t checksum);
  void goOn(std::uint64_t points, std::uint64_t checksum, const std::function<void(const Piece&)>& take);
  void write(std::span<const std::byte> bytes);

  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path file_;
  Id session_;
  std::unique_ptr<std::FILE, Closer> stream_;
  std::uint64_t pieces_ = 0, tornBytes_ = 0;
};

}  // namespace palpate::sharing

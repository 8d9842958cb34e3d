// The strokes of a shared session on disk: what a server has taken outlives it. Nothing of DDS is seen here.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "engine/core/point_state.hpp"
#include "haptics/sharing/id.hpp"

namespace palpate::sharing {

/// A file that each piece of a stroke is added to before its client hears that it was taken: a server that is killed
/// and started again with it goes on where it was, and its clients with it. Numbers are little-endian.
class StrokeJournal {
 public:
  struct Piece {
    Id client;
    std::uint64_t number;
    std::span<const PointState> states;
  };
  /// Makes the file, or goes on with it: `take` gets all pieces that it has, in order. `checksum`: of the `points` that
  /// are served. A last piece that was cut off, as by a kill, is taken away: no client has heard that it was taken.
  /// Throws FileError for a file that is none, is of other points, or is damaged, and leaves it as it was.
  StrokeJournal(std::filesystem::path file, std::uint64_t points, std::uint64_t checksum, const Id& fresh,
                const std::function<void(const Piece&)>& take);

  /// Of the session that it is of: `fresh`, or what the file says.
  const Id& session() const { return session_; }
  std::uint64_t pieces() const { return pieces_; }
  /// Bytes that were cut off as the file was opened.
  std::uint64_t tornBytes() const { return tornBytes_; }
  /// In the file when it returns, whatever becomes of this program. Throws FileError.
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

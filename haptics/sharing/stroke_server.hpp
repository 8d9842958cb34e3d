// Takes the strokes of all clients of a session.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/log.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/sharing/id.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

/// Stores the strokes of a shared session on disk, so that they outlive the server. Independent of DDS.
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

struct StrokeTally {
  std::uint64_t pieces = 0, states = 0;  ///< of strokes, taken, including those in the journal
  std::uint64_t again = 0;               ///< duplicates, and pieces received too early
  std::uint64_t refused = 0;             ///< invalid pieces
  std::uint64_t sculptors = 0;           ///< clients of which at least one piece was taken
};

class StrokeServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    SharedPoints& points;
    StrokeJournal* journal = nullptr;  ///< has each piece before its client is notified; may be null
    Log* log = nullptr;                ///< logs the first refused piece
  };
  /// All that `parts` refers to must outlive it.
  explicit StrokeServer(const Parts& parts);
  void attach(ReaderWait& wait) const { wait.attach(strokes_); }
  /// Processes what was received. Throws FileError for the journal.
  void take();
  const StrokeTally& counts() const { return counts_; }

 private:
  void take(const Stroke& stroke);

  Parts parts_;
  Reader<Stroke> strokes_;
  std::vector<PointState> states_;
  StrokeTally counts_;
};

}  // namespace palpate::sharing

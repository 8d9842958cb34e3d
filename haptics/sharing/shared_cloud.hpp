// A cloud that one machine serves, and others join: they get its points, bit by bit, and feel and draw them as their
// own.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/core/log.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

/// How much was handed out.
struct ServedCounts {
  std::uint64_t clients = 0;  ///< that have ever asked for points
  std::uint64_t requests = 0, blocks = 0, pings = 0;
  /// Requests that no client of ours makes, or of one more than there is room for, and pieces of strokes.
  std::uint64_t refused = 0;
  std::uint64_t sculptors = 0;  ///< clients of whom strokes were taken, before the server was started again included
  std::uint64_t pieces = 0, states = 0;  ///< of strokes; states of points in them
  std::uint64_t copied = 0;              ///< of the pieces, whose best-effort copy came before they did
  std::uint64_t again = 0;               ///< pieces that the reliable way had brought before, or before another one
  std::uint64_t sent = 0;                ///< states, to all who follow
  std::uint64_t near = 0;                ///< clients that have ever felt the points around their hands alone
  std::uint64_t nearPoints = 0, nearSteps = 0;  ///< that went to them, and in how many steps
  std::uint64_t frames = 0;                     ///< of points that move, that were shown
};

/// Moves the points of a cloud: where they are at that time, s since it was begun, with hands in it that feel it from
/// elsewhere. False where they are as at the last call. On a thread of its own.
using ServedMotion = std::function<bool(double time_s, std::span<const SeenHand> hands, CloudFrame& frame)>;

/// Serves a cloud as it was loaded, and, where it is sculpted, what has been done to it since, in one order for all.
/// Reads the cloud from one thread; nothing of it is written.
class CloudServer {
 public:
  struct Parts {
    NetworkConfig network;
    std::string name;   ///< by which it is joined
    std::string model;  ///< what the points are, in words
    double mm_per_unit = 1;
    bool sculptable = true;         ///< whoever joins can sculpt
    std::filesystem::path journal;  ///< of the strokes: made, or gone on with; empty: none
    Log* log = nullptr;             ///< hears of who comes; outlives this
    /// What has been measured of the cloud; nothing: that is done here.
    std::optional<FarFacts> facts = {};
    /// Empty: the cloud stands still. Otherwise it is as the motion begins, and is not sculptable.
    ServedMotion motion = {};
    double motion_Hz = 60;  ///< frames a second, at most
    /// How often the motion has begun anew, for any thread: those who feel it are told. Empty: it never does.
    std::function<Restarts()> restarts = {};
    StopSign stop = {};  ///< ends the constructor, which listens for a second for another session of the name
  };
  /// `cloud` has normals, and outlives this. Throws UsageError for a name that cannot be, NetworkError where a session
  /// of that name is served already, or nothing can be, FileError of the journal.
  CloudServer(const PointCloud& cloud, Parts parts);
  ~CloudServer();
  CloudServer(const CloudServer&) = delete;
  CloudServer& operator=(const CloudServer&) = delete;

  /// Answers until `stop` is true, or `seconds` have passed, where they are more than 0. Throws NetworkError, also
  /// where another session of its name has begun at the same time and this is the one to give way, and what the motion
  /// has thrown.
  void serve(const std::atomic<bool>& stop, double seconds = 0);
  ServedCounts counts() const;
  /// The points as they are, by id; those of the cloud where nobody has sculpted. Between calls of serve().
  std::span<const PointState> points() const;

 private:
  struct Link;
  std::unique_ptr<Link> link_;
};

class JoinedSession;

struct JoinedCloud {
  PointCloud cloud;  ///< as it was loaded; what was done to it since comes by shareEdits()
  double mm_per_unit = 0;
  std::string host, model;
  bool sculptable = false;
  std::shared_ptr<const JoinedSession> session;
  /// Where the points around the hands alone come here: `cloud` are a few thousand of them, from all over it.
  std::shared_ptr<FarCloud> far;
  std::optional<FarFacts> facts;  ///< of all points, then
};

struct JoinOptions {
  NetworkConfig network;
  bool present = false;  ///< with what has been done to it so far, to be looked at; it is not shared then
  bool near = false;     ///< the points around the hands alone; so it is in any case where they move, unless `present`
  double patience_s = 10;  ///< for the session to be found, and for each next piece of it
  Log* log = nullptr;      ///< hears how far it has come; outlives the call
  StopSign stop = {};      ///< ends it
};

/// The points of the session of that name, as they are served. Takes memory as they come, and no more for what is only
/// announced. Throws NetworkError where there is none, or two of that name, or one of another version, or its points
/// are none, or not those that it announced.
JoinedCloud joinCloud(const std::string& name, const JoinOptions& options);

}  // namespace palpate

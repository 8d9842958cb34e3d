// A cloud that one machine serves and others join: they get an identical copy of its points, and feel and draw it
// locally.
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
#include "haptics/session/far_cloud.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

/// Counts of what was served.
struct ServedCounts {
  std::uint64_t clients = 0;                          ///< clients that have ever requested points
  std::uint64_t requests = 0, blocks = 0, pings = 0;  ///< taken; of points as served; answered
  /// Invalid requests and pieces of strokes, and requests of clients beyond the maximum.
  std::uint64_t refused = 0;
  std::uint64_t sculptors = 0;  ///< clients whose strokes were taken, including those before a restart of the server
  std::uint64_t pieces = 0, states = 0;  ///< of strokes; states of points in them
  std::uint64_t again = 0;               ///< duplicate pieces, and those received too early
  std::uint64_t sent = 0;                ///< states, to all clients
  std::uint64_t partial = 0;             ///< clients that have ever requested only the points around their hands
  std::uint64_t partialPoints = 0, partialSteps = 0;  ///< points sent to those, in how many steps
  std::uint64_t frames = 0;                           ///< of moving points, shown
};

/// Moves the points of a cloud: positions at `time_s` seconds after the start, with remote hands that act on them,
/// and on which it may set forces.
/// False if nothing has changed since the last call. Called on a thread of its own.
using ServedMotion = std::function<bool(double time_s, std::span<SeenHand> hands, CloudFrame& frame)>;

/// Writes points to the server's file, under a temporary name first. Returns the name of the file for clients. Called
/// on a thread of its own, never twice at once. Throws Error.
using SaveFunction = std::function<std::string(const PointCloud& points)>;

/// Serves a cloud as loaded, and all edits since, in one order for all clients. Reads the cloud from one thread, and
/// never writes to it.
class CloudServer {
 public:
  struct Parts {
    NetworkConfig network;
    std::string name;   ///< by which clients join it
    std::string model;  ///< what the points are, for display
    double mm_per_unit = 1;
    bool sculptable = true;         ///< clients can sculpt
    std::filesystem::path journal;  ///< of the strokes: created or continued; empty: none
    Log* log = nullptr;             ///< logs new clients; must outlive this
    /// Measured properties of the cloud; empty: they are measured here.
    std::optional<FarFacts> facts = {};
    /// Empty: the cloud is static. Otherwise `cloud` is its first frame, and it is not sculptable.
    ServedMotion motion = {};
    double motion_Hz = 60;  ///< maximum of frames a second
    /// Restarts of the motion, of which clients are notified; thread-safe. Empty: it never restarts.
    std::function<Restarts()> restarts = {};
    /// Writes the present points when clients ask for it; empty: they are refused.
    SaveFunction save = {};
    StopSign stop = {};  ///< interrupts the constructor, which listens for a second for another session of the name
  };
  /// `cloud` must have normals and outlive this. Throws UsageError for an invalid name, NetworkError if a session of
  /// that name is served already or the network cannot be used, FileError for the journal.
  CloudServer(const PointCloud& cloud, Parts parts);
  ~CloudServer();
  CloudServer(const CloudServer&) = delete;
  CloudServer& operator=(const CloudServer&) = delete;

  /// Serves until `stop` is true, or `seconds` have passed if that is positive. Throws NetworkError, also if another
  /// session of its name has begun at the same time and takes precedence, and rethrows what the motion has thrown.
  void serve(const std::atomic<bool>& stop, double seconds = 0);
  ServedCounts counts() const;
  /// Current points, by id; those of the cloud if it was not sculpted. Only between calls of serve().
  std::span<const PointState> points() const;
  /// Writes the present points by Parts::save, and throws what that throws. Only between calls of serve().
  void save();

 private:
  struct Link;
  std::unique_ptr<Link> link_;
};

class BrickCloud;
class JoinedSession;

struct JoinedCloud {
  PointCloud cloud;  ///< as loaded; edits since are received by shareEdits()
  double mm_per_unit = 0;
  std::string host, model;
  bool sculptable = false;
  std::string unsent;  ///< what the cloud lacks of the server's file, in words; empty: nothing
  std::shared_ptr<const JoinedSession> session;
  /// If only the points around the hands are streamed: `cloud` is then a subsample of a few thousand points.
  std::shared_ptr<BrickCloud> far;
  std::optional<FarFacts> facts;  ///< of all points; set with `far`
};

struct JoinOptions {
  NetworkConfig network;
  bool present = false;   ///< with all edits so far, for display; edits are not shared then
  bool partial = false;   ///< stream only the points around the hands; moving points always are, unless `present`
  double timeout_s = 10;  ///< timeout for finding the session, and for each next part of it
  Log* log = nullptr;     ///< logs progress; must outlive the call
  StopSign stop = {};     ///< interrupts it
};

/// The points of the session of that name, as served. Allocates memory as they are received, not as announced. Throws
/// NetworkError if there is no such session, two of that name, or one of another version, or if its points are invalid
/// or differ from those announced.
JoinedCloud joinCloud(const std::string& name, const JoinOptions& options);

}  // namespace palpate

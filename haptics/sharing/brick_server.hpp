// Sends each client the points around its hands, and their changes.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/served_file.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

struct BrickCounts {
  std::uint64_t clients = 0;  ///< clients that have ever sent a request
  std::uint64_t samples = 0, points = 0, steps = 0;
  std::uint64_t refused = 0;  ///< invalid requests, and those of clients beyond the maximum
};

class BrickServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    FarFacts facts;
    ServedFile file;
    const SharedPoints& points;  ///< of a static cloud
    Log* log = nullptr;          ///< logs each new client
  };
  /// Everything that `parts` refers to must outlive the server. Publishes the facts.
  explicit BrickServer(const Parts& parts);
  void attach(ReaderWait& wait) const { wait.attach(nears_); }
  /// Processes the received requests.
  void take();
  /// Current frame of moving points, and the forces on hands.
  void show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands);
  /// Publishes how often the motion has restarted, and why.
  void tell(const Restarts& restarts);
  /// Sends what is due, as far as the links accept it. Returns the seconds until there is more to do.
  double write();
  /// No clients: no frame has to be shown.
  bool isIdle() const { return clients_.empty(); }
  const BrickCounts& counts() const { return counts_; }

 private:
  // A step that is being sent, sample by sample.
  struct Gone {
    std::size_t dropped = 0, brick = 0, point = 0;
  };
  using Forces = std::array<float, 3 * kMaxHands>;  // of a client's hands, N
  struct Outgoing {
    BrickLedger::Step step;
    Forces forces{};
    double true_s = 0;
    std::uint64_t acked = 0;
    Gone gone;
  };
  struct Sent {
    std::uint64_t sample = 0;
    Stopwatch since;
  };
  // Balls around a client's hands with their bricks; `asked`: newer balls whose bricks were not looked up yet.
  struct Wanted {
    std::vector<Ball> balls;
    std::vector<BrickKey> bricks;
    std::optional<std::vector<Ball>> asked;
    Stopwatch::Clock::time_point since;  // `asked` is pending since then
  };
  struct Client {
    Writer<Bricks> writer;  // in its partition
    std::uint32_t number = 0, epoch = 0;
    std::uint64_t sample = 0, taken = 0, window = 0;
    std::uint64_t acked = 0;  // last piece of its strokes that was acknowledged to it
    Forces forces{};          // the last ones that it was sent
    Wanted wanted;
    std::uint64_t seen = 0;  // version of the bricks at which nothing was left to send
    bool wantsMore = true;   // its request has changed since
    BrickLedger ledger;
    std::optional<Outgoing> outgoing;
    std::deque<Sent> unacked;  // last samples of steps, not acknowledged yet, oldest first
    double fastest_s = 1;      // shortest time from a sample to its acknowledgement
    Stopwatch heard, progressed;
  };
  void take(const Near& near);
  bool isWhole(const Near& near) const;
  Client* clientOf(const Near& near);
  void acknowledge(Client& client, std::uint64_t taken);
  bool lookAround();
  void follow();
  double showWanted();
  bool mayBegin(const Client& client) const;
  bool begin(const Id& id, Client& client);
  Forces forcesOn(const Id& client) const;
  bool writeSample(Client& client);
  void probe(Client& client);
  void fill(Bricks& sample, Outgoing& going);

  Parts parts_;
  Facts said_{};
  Writer<Facts> facts_;
  Reader<Near> nears_;
  std::map<Id, Client> clients_;
  ServedBricks bricks_;
  SharedPoints::Place place_;  // the bricks contain the edits up to here
  bool isBuilt_ = false;
  // For moving points.
  struct Shown {
    std::shared_ptr<const CloudFrame> frame;
    bool isOld = false;              // the frame is new, or was searched for other bricks than those wanted now
    std::optional<Stopwatch> since;  // empty: never shown
  };
  Shown shown_;
  std::unordered_map<std::uint32_t, DVec3> forces_N_;  // by SeenHand::number
  std::vector<PointState> states_;
  // Buffers of the sample that is being written.
  std::vector<BrickPart> heads_;
  std::vector<std::uint32_t> ids_;
  std::vector<Point> points_;
  std::vector<float> velocities_;
  BrickCounts counts_;
};

}  // namespace palpate::sharing

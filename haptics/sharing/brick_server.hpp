// Hands each client the points around its hands, and what becomes of them.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <unordered_set>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

struct BrickCounts {
  std::uint64_t clients = 0;  ///< that have ever asked
  std::uint64_t samples = 0, points = 0, steps = 0;
  std::uint64_t refused = 0;  ///< requests that no client of ours makes
};

class BrickServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    FarFacts facts;
    const SharedPoints& points;  ///< of a cloud that stands still
    Log* log = nullptr;          ///< hears of who comes
  };
  /// All that `parts` refers to outlives it. Says the facts.
  explicit BrickServer(const Parts& parts);
  void attach(ReaderWait& wait) const { wait.attach(nears_); }
  /// What has come.
  void take();
  /// Of points that move: where they are.
  void show(std::shared_ptr<const CloudFrame> frame);
  /// What moves has begun anew so often.
  void tell(const Restarts& restarts);
  /// What is due, as far as the links take it; so many seconds later there is more to do.
  double write();
  /// Nobody is there for whom something would have to be shown.
  bool isIdle() const { return clients_.empty(); }
  const BrickCounts& counts() const { return counts_; }

 private:
  // A step on its way, sample by sample.
  struct Gone {
    std::size_t dropped = 0, brick = 0, point = 0;
  };
  struct Outgoing {
    BrickLedger::Step step;
    double true_s = 0;
    std::uint64_t acked = 0;
    Gone gone;
  };
  struct Sent {
    std::uint64_t sample = 0;
    Stopwatch since;
  };
  // What is wanted around a client's hands, and what it has asked for since, where nobody has looked yet which bricks
  // that are.
  struct Wanted {
    std::vector<Ball> balls;
    std::vector<BrickKey> bricks;
    std::optional<std::vector<Ball>> asked;
    Stopwatch::Clock::time_point since;  // it has waited
  };
  struct Client {
    Writer<Bricks> writer;  // in its partition
    std::uint32_t number = 0, epoch = 0;
    std::uint64_t sample = 0, taken = 0, window = 0;
    std::uint64_t acked = 0;  // the last piece of its strokes of which it was told
    Wanted wanted;
    std::uint64_t seen = 0;  // version of the bricks for which nothing was left to do
    bool wantsMore = true;   // since then it has asked for something else
    BrickLedger ledger;
    std::optional<Outgoing> outgoing;
    std::deque<Sent> unacked;  // the last samples of steps, oldest first
    double fastest_s = 1;      // from a sample to the news that it was taken
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
  bool writeSample(Client& client);
  void probe(Client& client);
  void fill(Bricks& sample, Outgoing& going);

  Parts parts_;
  Facts said_{};
  Writer<Facts> facts_;
  Reader<Near> nears_;
  std::map<Id, Client> clients_;
  ServedBricks bricks_;
  SharedPoints::Place place_;  // up to where the bricks have followed
  bool isBuilt_ = false;
  // Of points that move.
  struct Shown {
    std::shared_ptr<const CloudFrame> frame;
    bool isOld = false;              // it is another one, or has been looked through for others than are wanted
    std::optional<Stopwatch> since;  // nothing: never
  };
  Shown shown_;
  std::vector<PointState> states_;
  // Of the sample that is written.
  std::vector<BrickPart> heads_;
  std::vector<std::uint32_t> ids_;
  std::vector<Point> points_;
  std::vector<float> velocities_;
  BrickCounts counts_;
};

}  // namespace palpate::sharing

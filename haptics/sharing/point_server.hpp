// Sends each client the points that it wants, and their changes.
#pragma once

#include <map>
#include <memory>
#include <variant>

#include "engine/core/log.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/sharing/near_feed.hpp"
#include "haptics/sharing/served_file.hpp"
#include "haptics/sharing/whole_feed.hpp"

namespace palpate::sharing {

struct StreamCounts {
  std::uint64_t whole = 0, near = 0;       ///< clients that have ever wanted points as served; around their hands
  std::uint64_t requests = 0, blocks = 0;  ///< valid requests; blocks of points as served
  std::uint64_t nearPoints = 0, nearSteps = 0;
  std::uint64_t states = 0;   ///< of edits, to all clients together
  std::uint64_t refused = 0;  ///< invalid requests, and those of clients beyond the maximum
};

class PointServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    const PointCloud& cloud;  ///< as served
    FarFacts facts;
    ServedFile file;
    const SharedPoints& points;  ///< of a static cloud, as edited since
    Log* log = nullptr;          ///< logs each new client
  };
  /// Everything that `parts` refers to must outlive the server. Publishes the facts.
  explicit PointServer(const Parts& parts);
  void attach(ReaderWait& wait) const { wait.attach(wants_); }
  /// Processes the received requests: each is answered with all strokes that were taken before.
  void take();
  /// That client was heard.
  void heard(const Id& client);
  /// Current frame of moving points, and the forces on hands.
  void show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands);
  /// Publishes how often the motion has restarted, and why.
  void tell(const Restarts& restarts);
  /// Sends what is due, as far as the links accept it. Returns the seconds until there is more to do.
  double write();
  /// No client near its hands: no frame has to be shown.
  bool isIdle() const;
  const StreamCounts& counts() const { return counts_; }

 private:
  using Feed = std::variant<std::monostate, WholeFeed, NearFeed>;
  struct Client {
    ClientStream stream;
    Feed feed;
  };
  void take(const Want& want);
  bool isValid(const Want& want) const;
  Client* clientOf(const Want& want);
  void begin(Client& client, const Want& want);
  double lookUp();
  double write(Client& client);
  template <class Served>
  double write(ClientStream& stream, Served& feed);

  Parts parts_;
  Facts said_{};
  Writer<Facts> facts_;
  Reader<Want> wants_;
  std::map<Id, Client> clients_;
  NearPoints near_;
  StreamCounts counts_;
};

}  // namespace palpate::sharing

// Replaces the room if palpate is built without PALPATE_NETWORK, or where Cyclone DDS is missing.
#include "haptics/sharing/presence.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/session_joiner.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/shared_edits.hpp"

namespace palpate {

namespace {

[[noreturn]] void refuse() {
  throw NetworkError(
      "this palpate was built without PALPATE_NETWORK, and cannot share; install cyclonedds-dev and cyclonedds-tools, "
      "and build it again with -DPALPATE_NETWORK=ON");
}

}  // namespace

bool canShare() { return false; }
std::string opennessOf(const NetworkConfig&) { refuse(); }
NetworkSurvey discoverSessions(const NetworkConfig&, double, const StopSign&) { refuse(); }

struct CloudServer::Link {};
CloudServer::CloudServer(const PointCloud&, Parts) { refuse(); }
CloudServer::~CloudServer() = default;
void CloudServer::serve(const std::atomic<bool>&, double) { refuse(); }
ServedCounts CloudServer::counts() const { refuse(); }
std::span<const PointState> CloudServer::points() const { refuse(); }
void CloudServer::save() { refuse(); }

std::unique_ptr<SharedFollower> shareEdits(const SharedParts&) { refuse(); }

std::shared_ptr<SharedPresence> sharePresence(std::shared_ptr<const JoinedSession>, const std::string&,
                                              const PointCloud&) {
  refuse();
}

SessionJoiner sessionJoiner(const Joining&) {
  return [](const std::string&, const JoinConfig&, Log&) -> JoinedModel { refuse(); };
}
SessionJoiner pointsJoiner(const Joining& how) { return sessionJoiner(how); }
JoinedCloud joinCloud(const std::string&, const JoinOptions&) { refuse(); }

void requireRosName(const std::string&) { refuse(); }
void requireRosFrame(const std::string&) { refuse(); }
void requireRosParent(const std::string&, const std::string&) { refuse(); }

class RosHand::Link {};
RosHand::RosHand(const RosPublishing&, double) { refuse(); }
RosHand::~RosHand() = default;
void RosHand::ticked(const TraceRow&, const DeviceState&) noexcept {}
RosHand::Counts RosHand::finish() { refuse(); }

class RosCloud::Link {};
RosCloud::RosCloud(const RosPublishing&) { refuse(); }
RosCloud::~RosCloud() = default;
bool RosCloud::show(std::span<const PointState>, const DVec3&) { refuse(); }
std::uint64_t RosCloud::shown() const { refuse(); }

class RosCamera::Link {};
RosCamera::RosCamera(const RosPublishing&) { refuse(); }
RosCamera::~RosCamera() = default;
void RosCamera::show(const CameraPlace&, double) { refuse(); }

PointCloud hearRosCloud(const std::string&, const RosListening&) { refuse(); }
RosContent whatRosSends(const std::string&, const RosListening&) { refuse(); }
std::shared_ptr<DepthStream> watchRosFrames(const std::string&, const RosWatching&) { refuse(); }

}  // namespace palpate

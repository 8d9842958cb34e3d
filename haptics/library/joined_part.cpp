#include "haptics/library/joined_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/job_stop.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate::library {

NetworkConfig networkFrom(const pp_network* given) {
  const pp_network network = optionsFrom(given, "network");
  constexpr std::uint64_t kMaxPeers = 1000;
  if (network.peer_count > kMaxPeers)
    throw UsageError("network.peers: {} exceed the maximum of {}", network.peer_count, kMaxPeers);
  NetworkConfig config{
      .interface = textOf(network.interface_name), .domain = network.domain, .security = textOf(network.security)};
  if (network.peer_count > 0) required(network.peers, "network.peers");
  for (std::uint64_t i = 0; i < network.peer_count; ++i)
    config.peers.emplace_back(&required(network.peers[i], "network.peers"));
  return config;
}

StopSign stopFrom(const pp_network* given) {
  const pp_network network = optionsFrom(given, "network");
  if (!network.stop && !jobStop.flag) return {};
  return [stop = network.stop, user = network.stop_user, sign = jobStop] {
    return isStopWanted(sign) || (stop && stop(user) != 0);
  };
}

JoinSubject joinFrom(const pp_join_options& options) {
  if (!(options.timeout_s > 0 && options.timeout_s <= bounds::kLongest_s))
    throw UsageError("timeout_s: {} is not above 0, or is above {}", options.timeout_s, bounds::kLongest_s);
  const NetworkConfig network = networkFrom(options.network);
  return {.network = {.network = network.interface,
                      .peers = network.peers,
                      .domain = network.domain,
                      .security = network.security,
                      .partial = options.partial != 0},
          .hand = textOf(options.hand_name),
          .timeout_s = options.timeout_s,
          .readOnly = options.read_only != 0,
          .stop = stopFrom(options.network)};
}

SessionJoiner JoinedPart::joiner() {
  return [this,
          join = sessionJoiner({.hand = how_.hand, .timeout_s = how_.timeout_s, .stop = std::exchange(how_.stop, {})})](
             const std::string& name, const JoinConfig& config, Log& log) {
    JoinedModel joined = join(name, config, log);
    name_ = name;
    host_ = joined.host;
    source_ = joined.source;
    return joined;
  };
}

BrushConfig JoinedPart::allowed(const BrushConfig& brush, const Session& session) const {
  session.abilities().require(Action::sculpt, "brush");
  if (how_.readOnly) throw UsageError("brush: '{}' was joined with read_only; it can be felt and not sculpted", name_);
  BrushConfig allowed = brush;
  allowed.resample = false;  // the cloud would differ from that of the others
  return allowed;
}

namespace {

// State of a session that has only the points around the hands.
void tellFar(const FarCloud& far, pp_sharing& state) {
  const FarCounts counts = far.counts();
  state.sculptable = far.isSculptable();
  state.delivered = counts.delivered;
  state.sent = counts.sent;
  state.resent = counts.resent;
  state.restarts = counts.restarts;
  state.connected = far.known().isTrue() && far.known().share() > 0;
  state.pings = counts.pings;
  state.answered = counts.answered;
  state.silent_s = counts.silent_s;
  state.longest_silent_s = counts.longestSilent_s;
  if (counts.roundTrip_ms) state.round_trip_ms = *counts.roundTrip_ms;
  try {
    far.check();
  } catch (const NetworkError& error) {
    putText(error.what(), state.fault);
  }
}

}  // namespace

pp_sharing JoinedPart::state(const Session& session) const {
  pp_sharing state = usual<pp_sharing>();
  state.round_trip_ms = -1;
  putText(name_, state.name);
  putText(host_, state.host);
  putText(source_, state.model);
  if (session.far()) tellFar(*session.far(), state);
  const SharedFollower* const shared = session.shared();
  if (!shared) return state;
  const SharedCounts counts = shared->counts();
  state.sculptable = 1;
  state.connected = shared->known().isTrue() && shared->known().share() > 0;
  state.delivered = counts.delivered;
  state.idle = counts.idle;
  state.same = counts.same;
  state.sent = counts.sent;
  state.received = counts.received;
  state.resent = counts.resent;
  state.resumed = counts.resumed;
  state.pings = counts.link.pings;
  state.answered = counts.link.answered;
  state.silent_s = counts.silent_s;
  state.longest_silent_s = counts.longestSilent_s;
  if (counts.link.roundTrip_ms) state.round_trip_ms = *counts.link.roundTrip_ms;
  putText(counts.fault, state.fault);
  return state;
}

std::vector<pp_other_hand> JoinedPart::otherHands(const Session& session) const {
  std::vector<pp_other_hand> hands;
  for (const SeenHand& seen : session.presence()->hands()) {
    pp_other_hand hand{};
    putText(seen.name, hand.name);
    hand.number = seen.number;
    hand.touching = seen.place.touching;
    hand.sculpts = seen.place.sculpts;
    for (int k = 0; k < 3; ++k) {
      hand.position[k] = seen.place.position[k];
      hand.proxy[k] = seen.place.proxy[k];
    }
    hand.age_s = seen.age_s;
    hands.push_back(hand);
  }
  return hands;
}

std::vector<pp_other_camera> JoinedPart::cameras(const Session& session) const {
  std::vector<pp_other_camera> cameras;
  for (const SeenCamera& seen : session.presence()->cameras()) {
    pp_other_camera camera{};
    putText(seen.name, camera.name);
    camera.number = seen.number;
    for (int k = 0; k < 3; ++k) camera.place.position[k] = seen.place.position[k];
    const DQuat& turn = seen.place.turn;
    std::ranges::copy(std::array{turn.w, turn.x, turn.y, turn.z}, camera.place.orientation);
    camera.place.fov_deg = glm::degrees(seen.place.fovY_rad);
    camera.place.aspect = seen.place.aspect;
    camera.age_s = seen.age_s;
    cameras.push_back(camera);
  }
  return cameras;
}

void JoinedPart::publishCamera(const Session& session, const pp_camera_place* camera) const {
  if (!camera) return session.presence()->show(std::nullopt);
  const auto& [w, x, y, z] = camera->orientation;
  session.presence()->show(CameraPlace{.position = DVec3(camera->position[0], camera->position[1], camera->position[2]),
                                       .turn = DQuat(w, x, y, z),
                                       .fovY_rad = glm::radians(camera->fov_deg),
                                       .aspect = camera->aspect});
}

bool JoinedPart::isDelivered(const Session& session) {
  if (session.far()) return session.far()->counts().delivered;
  return !session.shared() || session.shared()->counts().delivered;
}

void JoinedPart::requireDelivered(const Session& session, std::string_view what) const {
  if (isDelivered(session)) return;
  throw NetworkError(
      "'{}': the server has not confirmed {} within {:g} s; it is sent again until the server answers, and is "
      "lost if it does not: settle to wait for it",
      name_, what, how_.timeout_s);
}

void JoinedPart::check(const Session& session) const {
  if (session.far()) session.far()->check();
  if (!session.shared()) return;
  const std::string fault = session.shared()->counts().fault;
  if (!fault.empty()) throw NetworkError("{}", fault);
}

}  // namespace palpate::library

#include "haptics/sharing/presence.hpp"

#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/sharing/heard_hands.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kPosePoll_s = 0.004;  // polling interval for hands and a camera that have moved
constexpr double kHand_s = 1.0 / 60;   // between two positions of a hand
constexpr double kEnded_s = 1;         // hands are shown for this long after their last update
constexpr double kMoved_s = 1.0 / 30;  // between two poses of a moving camera
constexpr double kBeat_s = 0.5;        // and of one at rest
constexpr double kSeen_s = 2;          // others that are silent for this long are removed

std::optional<CameraPlace> placeOf(const Camera& said, const PresenceRoom& room) {
  const CameraPlace camera{
      .position = DVec3(said.position[0], said.position[1], said.position[2]),
      .turn = DQuat(said.orientation[0], said.orientation[1], said.orientation[2], said.orientation[3]),
      .fovY_rad = said.fov_y,
      .aspect = said.aspect};
  if (!isCamera(camera) || !room.has(camera.position)) return std::nullopt;
  return camera;
}

class Presence final : public SharedPresence {
 public:
  Presence(std::shared_ptr<const JoinedSession> session, const std::string& name, const PointCloud& cloud)
      : session_(std::move(session)),
        name_(name.empty() ? ownHost() : name),
        room_(cloud),
        handWriter_(session_->participant, session_->topics.hands, bestEffortQos()),
        hands_(session_->participant, session_->topics, cloud, kSeen_s),
        cameraWriter_(session_->participant, session_->topics.cameras, bestEffortQos()),
        cameraReader_(session_->participant, session_->topics.cameras, keepingInstances(bestEffortQos(), kMaxShown)),
        cameras_(kSeen_s),
        notices_(session_->participant, session_->topics),
        served_(session_->session),
        thread_(startThread([this](const std::stop_token& stop) { run(stop); })) {}

  void moved(const HandPlaces& hands) noexcept override { moved_.store({.hands = hands, .count = ++told_}); }

  void show(const std::optional<CameraPlace>& camera) override {
    if (camera && !isCamera(*camera)) throw UsageError("camera: invalid position, rotation, angle or aspect");
    const std::scoped_lock hold(lock_);
    ownCamera_ = camera;
  }

  std::vector<SeenHand> hands() const override {
    const std::scoped_lock hold(lock_);
    return hands_.all();
  }

  std::vector<SeenCamera> cameras() const override {
    const std::scoped_lock hold(lock_);
    return cameras_.all();
  }

 private:
  // Only for display: if the network has failed, the sharing of the points reports it, and the others are no longer
  // shown.
  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::duration<double>(kPosePoll_s));
        const std::scoped_lock hold(lock_);
        findServer();
        hands_.hear(served_, session_->client);
        cameras_.forget();
        cameraReader_.take([&](const Camera& camera) { hear(camera); });
        showHands();
        publishCamera();
      }
    } catch (const std::exception&) {
    }
  }

  // Follows the session of that name to a restarted server, if that serves the same points.
  void findServer() {
    if (lastLooked_.elapsed_s() < kBeat_s) return;
    lastLooked_ = {};
    std::optional<Id> found;
    for (const SessionNotice& notice : notices_.known()) {
      if (notice.name != session_->name || notice.version != kVersion || notice.checksum != session_->checksum)
        continue;
      found = notice.session;
      if (notice.session == served_) break;
    }
    served_ = found.value_or(served_);
  }

  void hear(const Camera& said) {
    if (!isSame(said.session, served_) || isSame(said.client, session_->client)) return;
    if (const std::optional<CameraPlace> place = placeOf(said, room_))
      cameras_.hear(idOf(said.client), 0, said.number, {.name = printable(said.name), .place = *place});
  }

  void showHands() {
    if (const auto moved = moved_.load(); moved && moved->count != own_.count) {
      own_ = *moved;
      lastMoved_ = {};
    }
    if (own_.count == 0 || lastMoved_.elapsed_s() > kEnded_s || lastHands_.elapsed_s() < kHand_s) return;
    lastHands_ = {};
    ++handsShown_;
    for (std::uint32_t i = 0; i < own_.hands.count; ++i) showHand(static_cast<std::uint8_t>(i), own_.hands.hands[i]);
  }

  void showHand(std::uint8_t which, const HandPlace& place) {
    if (!room_.has(place.position) || !room_.has(place.proxy)) return;
    HandSample hand{};
    set(hand.session, served_);
    set(hand.client, session_->client);
    hand.which = which;
    put(hand.name, name_);
    for (int axis = 0; axis < 3; ++axis) {
      hand.position[axis] = place.position[axis];
      hand.proxy[axis] = place.proxy[axis];
    }
    hand.orientation[0] = 1;
    hand.touching = place.touching;
    hand.sculpts = place.sculpts;
    hand.number = handsShown_;
    handWriter_.write(hand);
  }

  void publishCamera() {
    if (!ownCamera_ || lastCamera_.elapsed_s() < (ownCamera_ == shownCamera_ ? kBeat_s : kMoved_s)) return;
    lastCamera_ = {};
    shownCamera_ = ownCamera_;
    Camera camera{};
    set(camera.session, served_);
    set(camera.client, session_->client);
    put(camera.name, name_);
    for (int axis = 0; axis < 3; ++axis) camera.position[axis] = ownCamera_->position[axis];
    const DQuat& turn = ownCamera_->turn;
    const double turns[4] = {turn.w, turn.x, turn.y, turn.z};
    for (int k = 0; k < 4; ++k) camera.orientation[k] = static_cast<float>(turns[k]);
    camera.fov_y = static_cast<float>(ownCamera_->fovY_rad);
    camera.aspect = static_cast<float>(ownCamera_->aspect);
    camera.number = ++camerasShown_;
    cameraWriter_.write(camera);
  }

  // Hands, stored by the thread that answers them, and how often it has stored them.
  struct Moved {
    HandPlaces hands;
    std::uint64_t count = 0;
  };

  const std::shared_ptr<const JoinedSession> session_;
  const std::string name_;
  const PresenceRoom room_;
  LatestValue<Moved> moved_;
  std::uint64_t told_ = 0;   // used by that thread only
  mutable std::mutex lock_;  // guards all members below
  Writer<HandSample> handWriter_;
  HeardHands hands_;
  Writer<Camera> cameraWriter_;
  Reader<Camera> cameraReader_;
  SeenOthers<SeenCamera> cameras_;
  SessionNotices notices_;
  Id served_;
  Moved own_;
  std::optional<CameraPlace> ownCamera_, shownCamera_;
  std::uint32_t handsShown_ = 0, camerasShown_ = 0;
  Stopwatch lastMoved_, lastHands_, lastCamera_, lastLooked_;
  std::jthread thread_;  // destroyed first
};

}  // namespace

std::shared_ptr<SharedPresence> sharePresence(std::shared_ptr<const JoinedSession> session, const std::string& name,
                                              const PointCloud& cloud) {
  return std::make_shared<Presence>(std::move(session), name, cloud);
}

}  // namespace palpate

#include "haptics/sharing/camera_presence.hpp"

#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "haptics/sharing/hand_presence.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/session_notices.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kLook_s = 1.0 / 60;   // for a camera that has moved
constexpr double kMoved_s = 1.0 / 30;  // between two places of a camera that moves
constexpr double kBeat_s = 0.5;        // and of one that stands
constexpr double kSeen_s = 2;          // after which a camera that says nothing is gone
constexpr std::size_t kMostCameras = 256;

std::optional<CameraPlace> placeOf(const Camera& said, const HandRoom& room) {
  const CameraPlace camera{
      .position = DVec3(said.position[0], said.position[1], said.position[2]),
      .turn = DQuat(said.orientation[3], said.orientation[0], said.orientation[1], said.orientation[2]),
      .fovY_rad = said.fov_y,
      .aspect = said.aspect};
  if (!isCamera(camera) || !room.has(camera.position)) return std::nullopt;
  return camera;
}

class CameraPresence final : public SharedCameras {
 public:
  CameraPresence(std::shared_ptr<const JoinedSession> session, const std::string& name, const PointCloud& cloud)
      : session_(std::move(session)),
        name_(name.empty() ? ownHost() : name),
        room_(cloud),
        writer_(session_->participant, session_->topics.cameras, bestEffortQos()),
        reader_(session_->participant, session_->topics.cameras, keepingInstances(bestEffortQos(), kMostShownHands)),
        notices_(session_->participant, session_->topics),
        served_(session_->session),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void show(const std::optional<CameraPlace>& camera) override {
    if (camera && !isCamera(*camera))
      throw UsageError("camera: has no place, turn, angle or aspect that a picture can have");
    const std::scoped_lock hold(lock_);
    own_ = camera;
  }

  std::vector<SeenCamera> others() const override {
    const std::scoped_lock hold(lock_);
    std::vector<SeenCamera> seen;
    for (const auto& [client, other] : others_) {
      seen.push_back(other.seen);
      seen.back().age_s = other.since.elapsed_s();
      if (seen.back().age_s > kSeen_s) seen.pop_back();
    }
    return seen;
  }

 private:
  struct Other {
    SeenCamera seen;
    Stopwatch since;
    std::uint32_t last = 0;
  };

  // Cameras are for the eye: where the network has failed, what shares the points says so, and none is seen any more.
  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::duration<double>(kLook_s));
        const std::scoped_lock hold(lock_);
        findServer();
        reader_.take([&](const Camera& camera) { hear(camera); });
        std::erase_if(others_, [](const auto& one) { return one.second.since.elapsed_s() > kSeen_s; });
        show();
      }
    } catch (const NetworkError&) {
    }
  }

  // One that is served anew, whose points are gone on with.
  void findServer() {
    if (lastLooked_.elapsed_s() < kBeat_s) return;
    lastLooked_ = {};
    std::optional<Id> found;
    for (const SessionNotice& notice : notices_.known()) {
      if (notice.name != session_->name || notice.version != kVersion) continue;
      found = notice.session;
      if (notice.session == served_) break;
    }
    served_ = found.value_or(served_);
  }

  void hear(const Camera& said) {
    if (!isSame(said.session, served_) || isSame(said.client, session_->client)) return;
    const std::optional<CameraPlace> place = placeOf(said, room_);
    const Id client = idOf(said.client);
    const auto known = others_.find(client);
    const bool isKnown = known != others_.end();
    if (!place || (isKnown ? known->second.last >= said.number : others_.size() >= kMostCameras))
      return;  // or overtaken
    Other& other = others_[client];
    std::memcpy(&other.seen.number, client.data(), sizeof other.seen.number);
    other.last = said.number;
    other.since = {};
    other.seen.name = printable(said.name);
    other.seen.place = *place;
  }

  void show() {
    if (!own_ || lastShown_.elapsed_s() < (own_ == shown_ ? kBeat_s : kMoved_s)) return;
    lastShown_ = {};
    shown_ = own_;
    Camera camera{};
    set(camera.session, served_);
    set(camera.client, session_->client);
    put(camera.name, name_);
    for (int axis = 0; axis < 3; ++axis) camera.position[axis] = own_->position[axis];
    const DQuat& turn = own_->turn;
    const double turns[4] = {turn.x, turn.y, turn.z, turn.w};
    for (int k = 0; k < 4; ++k) camera.orientation[k] = static_cast<float>(turns[k]);
    camera.fov_y = static_cast<float>(own_->fovY_rad);
    camera.aspect = static_cast<float>(own_->aspect);
    camera.number = ++count_;
    writer_.write(camera);
  }

  const std::shared_ptr<const JoinedSession> session_;
  const std::string name_;
  const HandRoom room_;
  mutable std::mutex lock_;  // of all that follows
  Writer<Camera> writer_;
  Reader<Camera> reader_;
  SessionNotices notices_;
  Id served_;
  std::optional<CameraPlace> own_, shown_;
  std::map<Id, Other> others_;
  std::uint32_t count_ = 0;
  Stopwatch lastShown_, lastLooked_;
  std::jthread thread_;  // goes first
};

}  // namespace

std::shared_ptr<SharedCameras> shareCameras(std::shared_ptr<const JoinedSession> session, const std::string& name,
                                            const PointCloud& cloud) {
  return std::make_shared<CameraPresence>(std::move(session), name, cloud);
}

}  // namespace palpate

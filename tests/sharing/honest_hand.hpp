// A hand that has joined a session on this test's own network, sculpts it and follows others' edits, without a device
// or a full back end.
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "haptics/sharing/presence.hpp"
#include "haptics/sharing/shared_edits.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

inline PointCloud flatCloud(std::size_t points) {
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.positions.emplace_back(static_cast<float>(i % 100), static_cast<float>(i / 100), 0);
    cloud.normals.emplace_back(0, 0, 1);
  }
  return cloud;
}

/// Applies others' changes at once, and the edits that the test requests.
class PlainEdits final : public EditStream {
 public:
  void keep() override {}
  void take(EditBatch& batch) override { batch = edit({}); }
  EditProgress progress() const noexcept override { return {}; }
  void change(std::span<const PointChange>) override {}
  bool offer(std::span<const PointChange> changes, std::uint64_t) override {
    const std::scoped_lock hold(lock_);
    for (const PointChange& change : changes) batch_.points.push_back(change.to);
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::received});
    return true;
  }
  std::size_t mostOffered() const override { return 256; }

  /// All edits since the last call, followed by these.
  EditBatch edit(std::span<const PointState> states) {
    const std::scoped_lock hold(lock_);
    batch_.points.insert(batch_.points.end(), states.begin(), states.end());
    if (!states.empty()) batch_.marks.push_back({batch_.points.size(), EditMark::Kind::stroke});
    return std::exchange(batch_, {});
  }

 private:
  std::mutex lock_;
  EditBatch batch_;
};

/// An honest hand: moves a point every few milliseconds, and shows its position.
class HonestHand {
 public:
  explicit HonestHand(const std::string& name)
      : joined_(joinCloud(name, {.network = ownNetwork()})),
        follower_(shareEdits({.session = joined_.session, .cloud = joined_.cloud, .edits = edits_, .cell = 1})),
        presence_(sharePresence(joined_.session, "honest", joined_.cloud)),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  /// Stops moving points, and waits until every edit has arrived.
  SharedCounts end() {
    sculpts_ = false;
    for (const Stopwatch since; since.elapsed_s() < 10 && !follower_->counts().same;)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    thread_.request_stop();
    thread_.join();
    CHECK(fault_ == "");
    return follower_->counts();
  }
  SharedCounts counts() const { return follower_->counts(); }
  std::vector<SeenHand> others() const { return presence_->hands(); }

 private:
  void run(const std::stop_token& stop) {
    std::mt19937 dice(7);
    const std::vector<PointState> states = statesOf(joined_.cloud);
    try {
      while (!stop.stop_requested()) {
        PointState state = states[dice() % states.size()];
        state.position.z = static_cast<float>(dice() % 1000);
        follower_->catchUp(edits_.edit(sculpts_ ? std::span(&state, 1) : std::span<PointState>()));
        HandPlaces own{.count = 1};
        own.hands[0] = {.position = DVec3(1), .proxy = DVec3(1), .touching = true, .sculpts = true};
        follower_->moved(own);
        presence_->moved(own);
        std::this_thread::sleep_for(std::chrono::milliseconds(4));
      }
    } catch (const NetworkError& error) {
      fault_ = error.what();
    }
  }

  JoinedCloud joined_;
  PlainEdits edits_;
  std::unique_ptr<SharedFollower> follower_;
  std::shared_ptr<SharedPresence> presence_;
  std::string fault_;
  std::atomic<bool> sculpts_ = true;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate

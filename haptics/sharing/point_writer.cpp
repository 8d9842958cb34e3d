#include "haptics/sharing/point_writer.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/counted.hpp"

namespace palpate::sharing {

namespace {

constexpr double kWritesApart_s = 5;         // between two writes
constexpr double kWritePoll_s = 0.05;        // of a write in progress
constexpr std::size_t kCollected = 1 << 14;  // changed points collected per round: other work waits meanwhile

}  // namespace

void PointWriter::answer(Ping& ping) {
  isWanted_ = isWanted_ || (parts_.save && ping.write > begun_);
  ping.writes = static_cast<bool>(parts_.save);
  ping.begun = begun_;
  ping.ended = ended_;
  ping.failed = last_.failed;
  ping.points = last_.points;
  put(ping.words, last_.words);
}

double PointWriter::advance() {
  if (running_.valid()) {
    if (running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return kWritePoll_s;
    end();
  }
  if (!isWanted_) return kWritePoll_s;
  if (since_ && since_->elapsed_s() < kWritesApart_s)
    return std::min(kWritePoll_s, kWritesApart_s - since_->elapsed_s());
  if (!collect()) return 0;
  begin();
  return kWritePoll_s;
}

// Returns whether all changes so far are collected.
bool PointWriter::collect() {
  parts_.points.collect(place_, Id{}, kCollected, changed_);
  return !parts_.points.isBehind(place_);
}

void PointWriter::begin() {
  isWanted_ = false;
  ++begun_;
  since_.emplace();
  place_ = {};
  auto work = [this, changed = std::exchange(changed_, {})] { return write(parts_, changed); };
  try {
    running_ = std::async(std::launch::async, std::move(work));
  } catch (const std::system_error& error) {  // no further thread
    std::promise<Result> none;
    running_ = none.get_future();
    none.set_value(Result{.words = error.what(), .failed = true});
  }
}

void PointWriter::end() {
  last_ = running_.get();
  ended_ = begun_;
  if (!parts_.log) return;
  if (last_.failed)
    parts_.log->warn("a client asked for a save, which failed: {}", last_.words);
  else
    parts_.log->say("{}: {} saved, as a client asked for", last_.words, counted(last_.points, "point"));
}

PointWriter::Result PointWriter::write(const Parts& parts, const std::vector<PointState>& changed) {
  try {
    std::vector<PointState> present = statesOf(parts.cloud);
    for (const PointState& state : changed) present[state.number] = state;
    const PointCloud edited = editedCloud(parts.cloud, present);
    return {.points = edited.size(), .words = parts.save(edited)};
  } catch (const std::exception& error) {
    return {.words = error.what(), .failed = true};
  }
}

void PointWriter::writeNow() {
  if (running_.valid()) end();
  parts_.save(editedCloud(parts_.cloud, parts_.points.points()));
}

}  // namespace palpate::sharing

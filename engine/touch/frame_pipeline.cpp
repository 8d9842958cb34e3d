#include "engine/touch/frame_pipeline.hpp"

#include <bit>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // budget too short for a thread to sleep
constexpr std::chrono::microseconds kBetweenLooks{100};

std::size_t velocitySlots(const FrameWriter& writer) { return (writer.turnsNormals() ? 2 : 1) * writer.size(); }

}  // namespace

FramePipeline::FramePipeline(Device& device, FrameWriter& writer, LiveIndex& index)
    : device_(device),
      writer_(writer),
      index_(index),
      velocities_{Buffer::of<Vec4>(device, velocitySlots(writer), Memory::device, "velocities"),
                  Buffer::of<Vec4>(device, velocitySlots(writer), Memory::device, "velocities")},
      incoming_{Buffer::of<Vec4>(device, writer.size(), Memory::device, "incoming positions"),
                Buffer::of<Vec4>(device, writer.size(), Memory::device, "incoming normals"), 0},
      beside_(device.backgroundQueue().another()),
      task_([this] { make(); }) {
  PALPATE_CHECK_EQ(writer.size(), std::size_t{index.cloud().slots()});
  for (const Buffer& velocities : velocities_) fillWithZeros(device.latencyQueue(), velocities);
  for (int turn = 0; turn < 2; ++turn) {
    record(device.latencyQueue(), listsFirst_);
    index_.flip();
  }
  bring(0);
}

void FramePipeline::fillWithZeros(Queue& queue, const Buffer& velocities) const {
  CommandList list(device_, queue, "no velocities");
  list.begin();
  list.fill(velocities, 0, velocities.bytes());
  list.end();
  queue.run(list);
}

// Records the lists of the front half, unless they exist.
void FramePipeline::record(const Queue& queue, Lists& lists) {
  const SpatialHash& hash = index_.hash();
  const LiveCloud& cloud = index_.cloud();
  for (const SortMethod sort : {hash.sort(), hash.fallback()})
    for (const bool writes : {true, false}) {
      auto& list = (writes ? lists.frames : lists.builds)[cloud.parity()][sort];
      if (list) continue;
      list = std::make_unique<CommandList>(device_, queue, writes ? "frame" : "frame's index");
      list->begin();
      if (writes)
        writer_.record(*list, {.points = cloud.front(), .velocities = velocities_[cloud.parity()]}, incoming_,
                       velocities_[cloud.back().parity]);
      hash.recordBuild(*list, incoming_, cloud.back(), cloud.slots(), sort);
      list->end();
    }
}

// Runs on its own thread, against the clock. The previous frame must be built first: its list reads the buffers that
// the next frame is made in.
void FramePipeline::make() {
  if (before_ > 0) beside_->wait(before_);
  made_ = writer_.make(wanted_s_.load(), incoming_);
  if (made_ == MadeFrame::none) return;
  mayWrite_.wait(false);
  while (!isDropped_.load() && !exchange_.beginWriting(back()))
    std::this_thread::sleep_for(kBetweenLooks);  // a reader holds that half
  if (isDropped_.load()) return;
  // Recorded only here, when questions are known to be urgent, so that the lists are split into pieces that yield.
  record(*beside_, listsBeside_);
  submit(*beside_, listsBeside_);
}

void FramePipeline::submit(Queue& queue, const Lists& lists) {
  const double comes_s = writer_.comes_s();
  times_[back()] = {
      .true_s = writer_.time_s() + comes_s, .extrapolationLimit_s = writer_.extrapolationLimit_s(), .comes_s = comes_s};
  if (made_ == MadeFrame::incoming) fillWithZeros(queue, velocities_[back()]);
  colored_[back()] = writer_.isColored();
  points_[back()] = writer_.points();
  const auto& ways = made_ == MadeFrame::incoming ? lists.builds : lists.frames;
  on_ = &queue;
  ticket_ = queue.submit(*ways[index_.parity()].at(index_.hash().sort()));
}

void FramePipeline::hasArrived() {
  index_.built();
  if (writer_.looksAtPoints()) points_[index_.parity()] = writer_.points();  // and makes no further frame yet
  exchange_.publish(index_.parity(), frameTime_s(index_.parity()));
  isBuilding_ = false;
}

void FramePipeline::startMaking() {
  isMaking_ = true;
  before_ = isBuilding_ ? ticket_ : 0;
  task_.start();
}

// On true also sets isBuilding_ from the result.
bool FramePipeline::isMade(double budget_us) {
  try {
    if (!task_.finishedWithin(budget_us)) return false;
  } catch (...) {
    isMaking_ = false;
    throw;
  }
  isMaking_ = false;
  isBuilding_ = made_ != MadeFrame::none;
  return true;
}

void FramePipeline::allowWriting(bool may) {
  if (mayWrite_.exchange(may) != may && may) mayWrite_.notify_one();
}

void FramePipeline::runNow() {
  while (!exchange_.beginWriting(back())) std::this_thread::yield();
  const SpatialHash& hash = index_.hash();
  const SortMethod used = hash.sort();
  submit(device_.latencyQueue(), listsFirst_);
  on_->wait(ticket_);
  // A bucket may have overflowed, which leaves the order of its points undefined.
  if (used != hash.sort()) on_->run(*listsFirst_.builds[index_.parity()].at(hash.fallback()));
  hasArrived();
}

void FramePipeline::bring(double time_s) {
  finish();
  while ((made_ = writer_.make(time_s, incoming_)) != MadeFrame::none) runNow();
}

bool FramePipeline::goOn(double time_s, bool isRead) {
  wanted_s_.store(time_s);
  if (isBuilding_) {
    if (!on_->isDone(ticket_)) return false;
    hasArrived();
    if (!isRead) allowWriting(true);
    if (!isMaking_) startMaking();
    return true;
  }
  if (!isRead) allowWriting(true);
  if (!isMaking_) startMaking();
  if (!isMade(kLook_us) || !isBuilding_) return false;
  allowWriting(false);
  if (!writer_.looksAtPoints()) startMaking();
  return false;
}

void FramePipeline::finish() {
  while (isMaking_ || isBuilding_) {
    if (isBuilding_) {
      on_->wait(ticket_);
      hasArrived();
    }
    allowWriting(true);
    if (isMaking_) isMade(0);
  }
}

void FramePipeline::stop() noexcept {
  isDropped_.store(true);
  allowWriting(true);
  try {
    if (std::exchange(isMaking_, false)) task_.finishedWithin(0);
    if (on_) on_->finish();  // this queue may not be covered by waiting for the device
  } catch (...) {            // errors of a discarded frame are ignored
  }
  isBuilding_ = false;
}

bool FramePipeline::read(const std::function<void(const Placed&)>& read) {
  return exchange_.read([&](const FrameExchange::Frame& newest) {
    read({.half = index_.cloud().half(newest.half),
          .time_s = newest.time_s,
          .colored = colored_[newest.half],
          .points = points_[newest.half]});
  });
}

bool FramePipeline::take(CloudFrame& frame) {
  return read([&](const Placed& placed) { frame = fetch(device_.throughputQueue(), placed); });
}

CloudFrame FramePipeline::front() const {
  return fetch(device_.latencyQueue(), {.half = index_.cloud().front(),
                                        .time_s = frameTime_s(index_.parity()),
                                        .colored = colored_[index_.parity()],
                                        .points = points_[index_.parity()]});
}

CloudFrame FramePipeline::fetch(Queue& queue, const Placed& placed) const {
  const auto positions = download<Vec4>(device_, queue, placed.half.positions, slots());
  const auto normals = download<Vec4>(device_, queue, placed.half.normals, slots());
  const auto velocities = download<Vec4>(device_, queue, velocities_[placed.half.parity], slots());  // by id
  std::vector<std::uint32_t> slotOf(slots(), shared::kEmptySlot);                                    // by id
  for (std::uint32_t slot = 0; slot < slots(); ++slot)
    if (const auto id = std::bit_cast<std::uint32_t>(positions[slot].w); id != shared::kEmptySlot) slotOf[id] = slot;
  CloudFrame frame{.time_s = placed.time_s};
  for (std::uint32_t id = 0; id < slotOf.size(); ++id) {
    if (slotOf[id] == shared::kEmptySlot) continue;
    frame.positions.emplace_back(positions[slotOf[id]]);
    frame.normals.emplace_back(normals[slotOf[id]]);
    frame.velocities.emplace_back(velocities[id]);
    if (placed.colored) frame.colors.push_back(colorOfBits(std::bit_cast<std::uint32_t>(normals[slotOf[id]].w)));
    frame.ids.push_back(id);
  }
  if (!frame.ids.empty() && frame.ids.back() + 1 == frame.ids.size()) frame.ids.clear();  // each one's is its place
  return frame;
}

}  // namespace palpate

#include "engine/touch/frame_pipeline.hpp"

#include <bit>
#include <thread>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // a budget that lets no thread sleep

std::uint32_t packed(const std::array<std::uint8_t, 3>& color) {
  return std::uint32_t{color[0]} | std::uint32_t{color[1]} << 8 | std::uint32_t{color[2]} << 16;
}

std::array<std::uint8_t, 3> unpacked(float bits) {
  const auto color = std::bit_cast<std::uint32_t>(bits);
  return {static_cast<std::uint8_t>(color), static_cast<std::uint8_t>(color >> 8), static_cast<std::uint8_t>(color >> 16)};
}

}  // namespace

FramePipeline::FramePipeline(Device& device, CloudSource& source, LiveIndex& index)
    : device_(device),
      source_(source),
      index_(index),
      stagedPositions_(Buffer::of<Vec4>(device, source.size(), Memory::staging, "staged positions")),
      stagedNormals_(Buffer::of<Vec4>(device, source.size(), Memory::staging, "staged normals")),
      stagedVelocities_(Buffer::of<Vec4>(device, source.size(), Memory::staging, "staged velocities")),
      velocities_{Buffer::of<Vec4>(device, source.size(), Memory::device, "velocities"),
                  Buffer::of<Vec4>(device, source.size(), Memory::device, "velocities")},
      incoming_{Buffer::of<Vec4>(device, source.size(), Memory::device, "incoming positions"),
                Buffer::of<Vec4>(device, source.size(), Memory::device, "incoming normals"), 0},
      task_([this] { make(); }) {
  PALPATE_CHECK_EQ(source.size(), std::size_t{index.cloud().slots()});
  for (int turn = 0; turn < 2; ++turn) {
    record();
    index_.flip();
  }
  bring(0);
}

void FramePipeline::record() {
  const SpatialHash& hash = index_.hash();
  const LiveCloud& cloud = index_.cloud();
  for (const SortMethod sort : {hash.sort(), hash.fallback()}) {
    auto& list = lists_[cloud.parity()][sort];
    list = std::make_unique<CommandList>(device_, device_.latencyQueue(), "frame");
    list->begin();
    {
      const auto overlap = list->independent();
      list->copy(stagedPositions_, incoming_.positions, stagedPositions_.bytes());
      list->copy(stagedNormals_, incoming_.normals, stagedNormals_.bytes());
      list->copy(stagedVelocities_, velocities_[cloud.back().parity], stagedVelocities_.bytes());
    }
    hash.recordBuild(*list, incoming_, cloud.back(), cloud.slots(), sort);
    list->end();
  }
}

void FramePipeline::make() {
  source_.makeFrame(wanted_s_, frame_);
  requireWhole(frame_, source_.size());
  const std::span<Vec4> positions = stagedPositions_.mapped<Vec4>(), normals = stagedNormals_.mapped<Vec4>();
  const std::span<Vec4> velocities = stagedVelocities_.mapped<Vec4>();
  const auto count = static_cast<std::uint32_t>(frame_.positions.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = frame_.idOf(i);
    positions[i] = Vec4(frame_.positions[i], std::bit_cast<float>(id));
    normals[i] = Vec4(frame_.normals[i], std::bit_cast<float>(frame_.colors.empty() ? 0u : packed(frame_.colors[i])));
    velocities[id] = frame_.velocities.empty() ? Vec4(0) : Vec4(frame_.velocities[i], 0.0f);
  }
  std::fill(positions.begin() + count, positions.end(), Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot)));
}

void FramePipeline::submit(SortMethod sort) {
  times_s_[back()] = frame_.time_s;
  colored_[back()] = !frame_.colors.empty();
  ticket_ = device_.latencyQueue().submit(*lists_[index_.parity()].at(sort));
}

void FramePipeline::hasArrived() {
  exchange_.publish(index_.parity(), frame_.time_s);
  stage_ = Stage::idle;
}

void FramePipeline::startMaking(double time_s) {
  wanted_s_ = time_s;
  stage_ = Stage::making;
  task_.start();
}

void FramePipeline::bring(double time_s) {
  finish();
  while (!exchange_.beginWriting(back())) std::this_thread::yield();
  wanted_s_ = time_s;
  make();
  const SpatialHash& hash = index_.hash();
  for (SortMethod used = hash.sort();; used = hash.fallback()) {
    submit(used);
    device_.latencyQueue().wait(ticket_);
    if (used == hash.sort()) break;  // otherwise a bucket was crowded, and its points may stand in any order
  }
  index_.built();
  hasArrived();
}

bool FramePipeline::goOn(double time_s) {
  if (stage_ == Stage::building && device_.latencyQueue().isDone(ticket_)) hasArrived();
  if (stage_ == Stage::idle) startMaking(time_s);
  if (stage_ != Stage::making || !task_.finishedWithin(kLook_us) || !exchange_.beginWriting(back())) return false;
  submit(index_.hash().sort());
  index_.built();
  stage_ = Stage::building;
  return true;
}

void FramePipeline::finish() {
  if (stage_ == Stage::making) {
    task_.finishedWithin(0);
    while (!exchange_.beginWriting(back())) std::this_thread::yield();
    submit(index_.hash().sort());
    index_.built();
    stage_ = Stage::building;
  }
  if (stage_ != Stage::building) return;
  device_.latencyQueue().wait(ticket_);
  hasArrived();
}

bool FramePipeline::read(const std::function<void(const Placed&)>& read) {
  return exchange_.read([&](const FrameExchange::Frame& newest) {
    read({.half = index_.cloud().half(newest.half), .time_s = newest.time_s, .colored = colored_[newest.half]});
  });
}

bool FramePipeline::take(CloudFrame& frame) {
  return read([&](const Placed& placed) { frame = fetch(device_.throughputQueue(), placed); });
}

CloudFrame FramePipeline::front() const {
  return fetch(device_.latencyQueue(),
               {.half = index_.cloud().front(), .time_s = frame_.time_s, .colored = colored_[index_.parity()]});
}

CloudFrame FramePipeline::fetch(Queue& queue, const Placed& placed) const {
  const auto positions = download<Vec4>(device_, queue, placed.half.positions, slots());
  const auto normals = download<Vec4>(device_, queue, placed.half.normals, slots());
  std::vector<std::uint32_t> slotOf(slots(), shared::kEmptySlot);  // by id
  for (std::uint32_t slot = 0; slot < slots(); ++slot)
    if (const auto id = std::bit_cast<std::uint32_t>(positions[slot].w); id != shared::kEmptySlot) slotOf[id] = slot;
  CloudFrame frame{.time_s = placed.time_s};
  for (std::uint32_t id = 0; id < slotOf.size(); ++id) {
    if (slotOf[id] == shared::kEmptySlot) continue;
    frame.positions.emplace_back(positions[slotOf[id]]);
    frame.normals.emplace_back(normals[slotOf[id]]);
    if (placed.colored) frame.colors.push_back(unpacked(normals[slotOf[id]].w));
    frame.ids.push_back(id);
  }
  if (!frame.ids.empty() && frame.ids.back() + 1 == frame.ids.size()) frame.ids.clear();  // each one's is its place
  return frame;
}

}  // namespace palpate

#include "engine/touch/frame_pipeline.hpp"

#include <bit>
#include <thread>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // a budget that lets no thread sleep

}  // namespace

FramePipeline::FramePipeline(Device& device, CloudSource& source, LiveIndex& index)
    : device_(device),
      source_(source),
      index_(index),
      stagedPositions_(Buffer::of<Vec4>(device, source.size(), Memory::staging, "staged positions")),
      stagedNormals_(Buffer::of<Vec4>(device, source.size(), Memory::staging, "staged normals")),
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
    }
    hash.recordBuild(*list, incoming_, cloud.back(), cloud.slots(), sort);
    list->end();
  }
}

void FramePipeline::make() {
  source_.makeFrame(wanted_s_, frame_);
  requireWhole(frame_, source_.size());
  const std::span<Vec4> positions = stagedPositions_.mapped<Vec4>(), normals = stagedNormals_.mapped<Vec4>();
  for (std::uint32_t i = 0; i < source_.size(); ++i) {
    positions[i] = Vec4(frame_.positions[i], std::bit_cast<float>(i));
    normals[i] = Vec4(frame_.normals[i], 0.0f);
  }
}

void FramePipeline::submit(SortMethod sort) {
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

bool FramePipeline::read(const std::function<void(const LiveCloud::Half&, double)>& read) {
  return exchange_.read(
      [&](const FrameExchange::Frame& newest) { read(index_.cloud().half(newest.half), newest.time_s); });
}

bool FramePipeline::take(CloudFrame& frame) {
  return read(
      [&](const LiveCloud::Half& half, double time_s) { frame = fetch(device_.throughputQueue(), half, time_s); });
}

CloudFrame FramePipeline::front() const { return fetch(device_.latencyQueue(), index_.cloud().front(), frame_.time_s); }

CloudFrame FramePipeline::fetch(Queue& queue, const LiveCloud::Half& half, double time_s) const {
  const std::size_t count = source_.size();
  const auto positions = download<Vec4>(device_, queue, half.positions, count);
  const auto normals = download<Vec4>(device_, queue, half.normals, count);
  CloudFrame frame{.time_s = time_s, .positions = std::vector<Vec3>(count), .normals = std::vector<Vec3>(count)};
  for (std::size_t slot = 0; slot < count; ++slot) {
    const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
    frame.positions[id] = Vec3(positions[slot]);
    frame.normals[id] = Vec3(normals[slot]);
  }
  return frame;
}

}  // namespace palpate

#include "engine/touch/cpu_frames.hpp"

#include <thread>
#include <utility>

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // budget too short for a thread to sleep

}  // namespace

CpuFrames::CpuFrames(CloudSource& source, const HashGrid& grid, unsigned threads)
    : source_(source),
      halves_{Half{.frame = {}, .grid = SortedGrid(grid, threads)},
              Half{.frame = {}, .grid = SortedGrid(grid, threads)}},
      task_([this] { make(); }) {
  bring(0);
}

void CpuFrames::make() {
  isNew_ = count_ == 0 || source_.hasNewer(wanted_s_, frame().time_s);
  if (!isNew_) return;
  Half& half = halves_[back()];
  source_.makeFrame(wanted_s_, half.frame);
  requireWhole(half.frame, source_.size());
  half.grid.build(half.frame.positions);
}

void CpuFrames::flip() {
  if (!isNew_) return;
  front_ = back();
  exchange_.publish(front_, frame().time_s);
  ++count_;
}

void CpuFrames::bring(double time_s) {
  finish();
  while (!exchange_.beginWriting(back())) std::this_thread::yield();
  wanted_s_ = time_s;
  make();
  flip();
}

void CpuFrames::goOn(double time_s) {
  if (!task_.finishedWithin(kLook_us)) return;
  if (std::exchange(isMaking_, false)) flip();
  if (!exchange_.beginWriting(back())) return;
  wanted_s_ = time_s;
  isMaking_ = true;
  task_.start();
}

void CpuFrames::finish() {
  task_.finishedWithin(0);
  if (std::exchange(isMaking_, false)) flip();
}

bool CpuFrames::take(CloudFrame& frame) {
  return exchange_.read([&](const FrameExchange::Frame& newest) { frame = halves_[newest.half].frame; });
}

}  // namespace palpate

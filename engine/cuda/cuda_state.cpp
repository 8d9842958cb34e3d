#include "engine/cuda/cuda_state.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/brush_stroke.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/cuda/cuda_error.hpp"
#include "engine/edit/spacing_measure.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

constexpr std::size_t kEditTimesReserved = 1 << 16;  // a minute at 1 kHz without an allocation on the servo thread
constexpr double kLongestWait_us = 20e6;             // timeout of any answer
constexpr unsigned kSpinsPerCheck = 256;             // polls of the word in host memory per check of the stream

// Target spacings, measured on the host.
std::vector<float> spacingsOf(const PointCloud& cloud, const CudaTouchOptions& options) {
  SortedGrid grid(options.grid, 0);
  grid.build(cloud.positions);
  return measuredSpacings(grid, cloud.positions, cloud.normals, options.radius, std::vector<float>(cloud.size()));
}

}  // namespace

CudaTouch::State::State(const PointCloud& cloud, const CudaTouchOptions& options)
    : machine(cudaDeviceName()),
      cell(1.0 / static_cast<double>(options.grid.inverseCell)),
      options_(options),
      origin_(cloud.origin),
      live_(cloud, stream_),
      stroke_(options.radius),
      build_(options.grid, live_.count()),
      buffers_(stream_, options.radius, options.friction, live_.count()) {
  PALPATE_CHECK_LT(0.0, options.radius);
  cu::Event start, end;
  start.record(stream_);
  build_.record(stream_, live_.half(0), live_.half(1), live_.count());
  end.record(stream_);
  end.synchronize("building the index");
  buildTime_us = end.since_us(start);
  live_.flip();
  if (options.push) {
    push_.emplace(sharedBrush(*options.push, options.radius), options.radius, spacingsOf(cloud, options), stream_);
    stroke_.setBrush(*options.push);
    editTimes_us.reserve(kEditTimesReserved);
    for (const unsigned parity : {0u, 1u}) recordEdit(parity);
  }
  const shared::CloudView views[2] = {build_.view(live_.half(0), live_.count()),
                                      build_.view(live_.half(1), live_.count())};
  method_ = cu::makeQueryMethod(options.method, stream_, buffers_, views);
  stream_.synchronize("preparing the touch side");
}

CudaTouch::State::~State() {
  try {
    method_->rest();  // before memory is freed, which waits for the whole GPU
    stream_.synchronize("ending");
  } catch (const Error&) {  // the GPU has failed: nothing runs on it any more
  }
}

void CudaTouch::State::recordEdit(unsigned parity) {
  edits_[parity] = std::make_unique<cu::Graph>(stream_, [&] {
    cu::CloudHalf &from = live_.half(parity), &to = live_.half(1 - parity);
    push_->recordPush(stream_, from, live_.count());
    build_.record(stream_, from, to, live_.count());
    push_->recordSequel(stream_, build_.view(to, live_.count()));
  });
}

Contact CudaTouch::State::query(const Pose& pose, double budget_us) noexcept {
  Contact invalid{.proxy = pose.hip, .lost = failure_ != nullptr};
  if (failure_ || !isFinite(Vec3(pose.hip - origin_))) return invalid;
  try {
    const Stopwatch watch;
    const auto left_us = [&] { return budget_us > 0 ? std::max(1.0, budget_us - watch.elapsed_us()) : 0; };
    // Takes an answer that was too late for its own tick; no new question is asked while one is in flight.
    if (asked_ && !answerWithin(left_us())) return held(pose);
    if (!method_->inStreamOrder() && !editDoneWithin(left_us())) return held(pose);
    ask(pose, options_.timeGpu && budget_us <= 0);
    if (!answerWithin(left_us())) return held(pose);
    // Only a fresh answer triggers an edit: after an edit the next one waits until the hand has felt the last one.
    if (last_.valid) editIfYielding();
    return last_;
  } catch (...) {
    failure_ = std::current_exception();
    invalid.lost = true;
    return invalid;
  }
}

void CudaTouch::State::ask(const Pose& pose, bool timed) {
  asked_ = Asked{pose, timed};
  method_->ask({.hip = Vec3(pose.hip - origin_), .tick = ++tick_}, live_.parity(), timed);
}

bool CudaTouch::State::answerWithin(double budget_us) {
  const auto answered = [&] { return buffers_.sample(tick_).has_value(); };
  const Stopwatch watch;
  for (unsigned spins = 1; !answered(); ++spins) {
    method_->advance();
    if (budget_us > 0 && watch.elapsed_us() > budget_us) return false;
    if (spins % kSpinsPerCheck != 0) continue;
    if (method_->ended() && !answered()) method_->revive();
    if (watch.elapsed_us() > kLongestWait_us)
      throw CudaError("CUDA: no answer for {:.0f} s; is another program holding the GPU?", kLongestWait_us * 1e-6);
  }
  takeAnswer();
  return true;
}

void CudaTouch::State::takeAnswer() {
  const cu::Answer& answer = buffers_.answer();
  const shared::ContactSample sample = *buffers_.sample(tick_);
  if (answer.launchError != 0) cu::checkCuda(static_cast<cudaError_t>(answer.launchError), "launching from the device");
  const Asked asked = *asked_;
  asked_.reset();
  if (editOut_) editDone();
  shortfalls.truncatedTicks += (sample.flags & shared::kSampleTruncated) != 0;
  shortfalls.thinnedTicks += (sample.flags & shared::kSampleThinned) != 0;
  last_ = {
      .proxy = asked.pose.hip + DVec3(sample.spring),
      .normal = DVec3(sample.normal),
      .touching = sample.touching != 0,
      .fresh = true,
      .valid = sample.tick == tick_ && isFinite(sample.spring) && isFinite(sample.normal),
      .isWithin = sample.touching == shared::kFree && sample.flags >> shared::kSampleFaceShift == shared::kFaceInside,
      .neighbours = sample.neighbours,
      .gpu_us = asked.timed || !method_->inStreamOrder() ? method_->time_us() : 0};
  lastPose_ = asked.pose;
  if (push_ && last_.valid)
    stroke_.feel(last_, lastPose_.hip - origin_, DVec3(sample.spring), lastPose_.press(), lastPose_.time_s);
}

Contact CudaTouch::State::held(const Pose& pose) const { return heldContact(last_, lastPose_, pose); }

void CudaTouch::State::editIfYielding() {
  if (!push_ || !stroke_.acts()) return;
  push_->setTool(placedTool(stroke_.next(lastPose_.time_s)));
  editStart_.record(stream_);
  edits_[live_.parity()]->launch(stream_);
  editEnd_.record(stream_);
  editOut_ = true;
  if (!firstEditTime_s) firstEditTime_s = lastPose_.time_s;
  live_.flip();
}

bool CudaTouch::State::editDone() {
  if (!editOut_) return true;
  if (!editEnd_.reached("editing")) return false;
  editOut_ = false;
  const cu::PushEdit::Sums& sums = push_->sums();
  SurfaceMeasure measured{
      .weights = sums.weights, .normals = {sums.normals[0], sums.normals[1], sums.normals[2]}, .heights = sums.heights};
  std::ranges::copy(sums.seen, measured.seen.begin());
  measured.nearest = sums.nearest;
  stroke_.note(measured - std::exchange(measured_, measured));
  if (editTimes_us.size() < editTimes_us.capacity()) editTimes_us.push_back(editEnd_.since_us(editStart_));
  return true;
}

bool CudaTouch::State::editDoneWithin(double budget_us) {
  const Stopwatch watch;
  while (!editDone())
    if (budget_us > 0 && watch.elapsed_us() > budget_us) return false;
  return true;
}

void CudaTouch::State::finish() {
  if (failure_) std::rethrow_exception(failure_);
  if (asked_) answerWithin(0);
  editDoneWithin(0);
  method_->rest();
  stream_.synchronize("finishing");
}

std::size_t CudaTouch::State::readBack(PointCloud& cloud) {
  method_->rest();
  return live_.readBack(cloud, stream_);
}

}  // namespace palpate

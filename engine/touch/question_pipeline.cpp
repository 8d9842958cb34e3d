#include "engine/touch/question_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr double kSleep_us = 40;  // between polls, if spinning would starve the driver

// Maximum time in which a withdrawn question ends, if the GPU sees the host's writes at all.
constexpr double kWithdrawTimeout_us = 5000;

// At about the 520th submission NVIDIA's driver allocates room for more, once, which takes 1.8 ms: it must not be in a
// tick.
constexpr int kFirstSubmissions = 1100;

// Drivers known to make host writes visible to a running shader. If sight shares the queue, its frames would wait
// behind a waiting question.
bool mayHearTheHost(const Device& device) {
  return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY && !device.roles().shared();
}

}  // namespace

QuestionPipeline::QuestionPipeline(Device& device, const ContactOptions& options, const HashGrid& grid,
                                   std::uint32_t points, Wait wait, CommandList::Timing timing)
    : device_(device), wait_(wait), timing_(timing), contact_(device, options, grid, points) {}

void QuestionPipeline::record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress logHead,
                              DeviceAddress velocities) {
  lists_[parity].clear();
  for (std::uint32_t i = 0; i < contact_.lists(); ++i) {
    auto& list =
        lists_[parity].emplace_back(std::make_unique<CommandList>(device_, device_.latencyQueue(), "query", timing_));
    list->begin();
    contact_.record(*list, i, cloud, logHead, velocities);
    list->end();
  }
}

void QuestionPipeline::recordForgetting(std::span<const ProbeRange> hands) {
  forgets_.clear();
  for (const ProbeRange& hand : hands) {
    auto& list = forgets_.emplace_back(std::make_unique<CommandList>(device_, device_.latencyQueue(), "restart"));
    list->begin();
    list->fill(contact_.state(), 0, std::uint64_t{hand.count} * sizeof(shared::ContactState),
               std::uint64_t{hand.first} * sizeof(shared::ContactState));
    list->end();
  }
}

void QuestionPipeline::warmUp() {
  if (wait_ != Wait::spin) return;
  Queue& queue = device_.latencyQueue();
  for (int i = 0; i < kFirstSubmissions; ++i) queue.wait(queue.submit(*forgets_.front()), Wait::spin);
}

void QuestionPipeline::setContact(const ContactOptions& options, const HashGrid& grid, std::uint32_t points) {
  if (state() == QuestionState::ending) progress_.happened(QuestionEvent::ended);
  contact_ = ContactStep(device_, options, grid, points);
  answered_ = {};
  ahead_ = ahead_ && contact_.canWait();
}

void QuestionPipeline::allowAhead(std::optional<bool> wanted, std::uint32_t parity) {
  const bool may = wait_ == Wait::spin && mayHearTheHost(device_);
  ahead_ = contact_.canWait() && wanted.value_or(may && hearsTheHost(parity));
}

void QuestionPipeline::askAhead(std::uint32_t parity, bool realtime) {
  if (!ahead_ || (state() != QuestionState::idle && state() != QuestionState::ending)) return;
  settle();
  const std::uint32_t first = contact_.waiting(contact_.firstList());
  run_ = {.parity = parity, .first = first, .last = first};
  contact_.awaitAnother(realtime);
  run_.ticket = device_.latencyQueue().submit(lastList(run_));
  progress_.happened(QuestionEvent::submittedAhead);
}

void QuestionPipeline::withdraw() {
  if (state() != QuestionState::waitingForPose) return;
  contact_.withdraw(++tick_);
  progress_.happened(QuestionEvent::withdrawn);
  device_.latencyQueue().wait(run_.ticket);
}

bool QuestionPipeline::hearsTheHost(std::uint32_t parity) {
  ahead_ = true;
  askAhead(parity, true);
  const bool waits = !device_.latencyQueue().isDone(run_.ticket);
  const Stopwatch watch;
  withdraw();
  return waits && watch.elapsed_us() < kWithdrawTimeout_us;
}

bool QuestionPipeline::mayAskWithin(double budget_us) const {
  if (wait_ == Wait::spin || state() != QuestionState::ending) return true;  // begin() spins for the remaining us
  const Stopwatch watch;
  while (!device_.latencyQueue().isDone(run_.ticket)) {
    if (watch.elapsed_us() + kSleep_us > budget_us) return false;
    std::this_thread::sleep_for(std::chrono::duration<double, std::micro>(kSleep_us));
  }
  return true;
}

void QuestionPipeline::begin() {
  settle();
  ++tick_;
}

void QuestionPipeline::put(std::uint32_t probe, const Vec3& place, const shared::ContactState& carried,
                           const PointsMotion& motion) {
  contact_.put({.pose = {.hip = place, .tick = tick_},
                .carried = carried,
                .pointsAge = static_cast<float>(motion.age_s),
                .sinceLast = static_cast<float>(motion.sinceLast_s)},
               probe);
}

void QuestionPipeline::ask(double time_s, bool realtime, bool behindEdit, std::uint32_t parity) {
  question_ = {
      .time_s = time_s, .realtime = realtime, .behindEdit = behindEdit, .timed = wait_ == Wait::spin || !realtime};
  if (state() != QuestionState::waitingForPose) submit(parity);
  progress_.happened(QuestionEvent::asked);
}

void QuestionPipeline::submit(std::uint32_t parity) {
  const std::uint32_t first = contact_.firstList();
  run_ = {.parity = parity, .first = first, .last = first};
  run_.ticket = device_.latencyQueue().submit(lastList(run_));
}

void QuestionPipeline::settle() {
  // The answer may be visible some us before the driver lets its list run again.
  if (state() != QuestionState::ending) return;
  progress_.happened(QuestionEvent::ended);
  device_.latencyQueue().wait(run_.ticket, wait_);
  if (wait_ == Wait::spin) lastTime_us_ += timeOf_us(run_.last);
}

double QuestionPipeline::timeOf_us(std::uint32_t list) const {
  return contact_.answeringTime_us(list, lists_[run_.parity][list]->sectionTime_us("contact"));
}

bool QuestionPipeline::isAnsweredWithin(double budget_us) {
  const Stopwatch watch;
  while (true) {
    const double left_us = budget_us > 0 ? std::max(1.0, budget_us - watch.elapsed_us()) : 0;
    if (!runEndsWithin(left_us)) return false;
    const bool ahead = contact_.waits(run_.last);
    if (ahead && !isWhole()) {  // it timed out before its pose was written
      submit(run_.parity);
      continue;
    }
    answeredAhead_ += ahead;
    const std::uint32_t ran = run_.last;
    const auto next = contact_.nextList(run_.last);
    if (next) {
      run_.last = *next;
      run_.ticket = device_.latencyQueue().submit(lastList(run_));
    }
    if (question_.timed && (next || wait_ != Wait::spin)) question_.gpu_us += timeOf_us(ran);
    if (!next) break;
  }
  progress_.happened(QuestionEvent::answered);
  answered_ = run_;
  // An answer seen in memory precedes its time, so the time reported is that of the previous run.
  if (wait_ == Wait::spin) std::swap(question_.gpu_us, lastTime_us_);
  return true;
}

bool QuestionPipeline::runEndsWithin(double budget_us) {
  Queue& queue = device_.latencyQueue();
  const bool answers = contact_.answers(run_.last);
  // In real time a thread that may not spin sleeps between polls: blocked in the driver it would wait for the driver's
  // threads, which have no raised priority.
  const bool naps = wait_ != Wait::spin && budget_us > 0;
  if (!naps && (wait_ != Wait::spin || !answers)) return queue.wait(run_.ticket, wait_, budget_us);
  // The shader's words in host memory are the fastest sign. The driver is polled now and then: it knows when no answer
  // will come, but may block this thread.
  constexpr int kPolls = 256;
  const bool asksDriver = !naps || !answers || budget_us <= kPoll_us;
  const Stopwatch watch;
  while (true) {
    for (int poll = 0; answers && poll < (naps ? 1 : kPolls); ++poll)
      if (isWhole()) return true;
    if (asksDriver && queue.isDone(run_.ticket)) return true;
    const double left_us = budget_us > 0 ? budget_us - watch.elapsed_us() : kSleep_us;
    if (left_us <= kPoll_us) return false;
    if (naps) std::this_thread::sleep_for(std::chrono::duration<double, std::micro>(std::min(kSleep_us, left_us)));
  }
}

void QuestionPipeline::resetHand(std::size_t hand) {
  if (isOut()) question_.dropped.set(hand);
  withdraw();
  settle();
  device_.latencyQueue().wait(device_.latencyQueue().submit(*forgets_[hand]), wait_);
}

std::vector<PassRecord> QuestionPipeline::passes() const {
  std::vector<PassRecord> all;
  for (std::uint32_t list = answered_.first; list <= answered_.last; ++list)
    std::ranges::copy(lists_[answered_.parity][list]->passes(), std::back_inserter(all));
  return all;
}

shared::ContactState stateOf(const std::optional<ProxyTracker::State>& state) {
  if (!state) return {};
  return {.lastHip = Vec3(state->lastHip),
          .touching = !state->touching ? shared::kFree
                      : state->sticks  ? shared::kSticking
                                       : shared::kSliding,
          .spring = Vec3(state->proxy - state->lastHip),
          .face = state->face,
          .facing = Vec3(state->facing),
          .velocity = Vec3(state->velocity),
          .started = state->started ? 1u : 0u};
}

ProxyTracker::State proxyStateOf(const shared::ContactSample& sample, const DVec3& hip, double time_s) {
  const std::uint32_t face = sample.flags >> shared::kSampleFaceShift;
  const bool touching = sample.touching != shared::kFree;
  const DVec3 normal(sample.normal);
  return {.started = true,
          .touching = touching,
          .sticks = sample.touching == shared::kSticking,
          .face = face,
          .facing = touching && face == shared::kFaceBehind ? -normal : normal,
          .lastHip = hip,
          .proxy = hip + DVec3(sample.spring),
          .velocity = DVec3(sample.velocity),
          .time_s = time_s};
}

Contact contactOf(const shared::ContactSample& sample, const DVec3& hip, const QuestionPipeline& questions) {
  return {
      .proxy = hip + DVec3(sample.spring),
      .normal = DVec3(sample.normal),
      .touching = sample.touching != 0,
      .fresh = true,
      .valid = questions.isWhole() && isFinite(sample.spring) && isFinite(sample.normal) && isFinite(sample.velocity),
      .isWithin = sample.touching == shared::kFree && sample.flags >> shared::kSampleFaceShift == shared::kFaceInside,
      .neighbours = sample.neighbours,
      .gpu_us = questions.question().gpu_us,
      .velocity = DVec3(sample.velocity)};
}

}  // namespace palpate

#include "haptics/servo_loop.hpp"

#include <algorithm>
#include <limits>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/crash_stop.hpp"

namespace palpate {
namespace {

constexpr double kSmallestBudget_us = 20;  // a budget of 0 would mean to wait as long as it takes
constexpr double kMostReserve = 0.2;       // of a tick

class ZeroForceAtExit {
 public:
  ZeroForceAtExit(const Hand& hand, const std::optional<Hand>& second)
      : device_(hand.device()), second_(second ? &second->device() : nullptr) {}
  ~ZeroForceAtExit() {
    device_.write(DVec3(0));
    if (second_) second_->write(DVec3(0));
  }
  ZeroForceAtExit(const ZeroForceAtExit&) = delete;
  ZeroForceAtExit& operator=(const ZeroForceAtExit&) = delete;

 private:
  HapticDevice& device_;
  HapticDevice* second_;
};

std::uint64_t ticksFor(const ServoOptions& options) {
  const std::uint64_t planned = plannedTicks(options.rate_Hz, options.endless ? 0 : options.duration_s);
  if (!options.endless) return planned;
  if (!options.realtime || !options.stop)
    throw UsageError("only a session against the wall clock that can be stopped is endless");
  return std::numeric_limits<std::uint64_t>::max();
}

}  // namespace

ServoLoop::ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options,
                     const std::optional<SecondHand>& second)
    : query_(query),
      options_(options),
      plannedTicks_(ticksFor(options)),
      hand_(device, std::move(law), {.map = options.map, .passivity = options.passivity}, options.rate_Hz,
            query.points().size()) {
  if (!second) return;
  if (options.realtime && second->device.paces())
    throw UsageError("the second device, {}, would call the ticks itself; only the first one may",
                     second->device.name());
  second_.emplace(second->device, second->law, second->options, options.rate_Hz, 0);
}

ServoResult ServoLoop::run(const TickObserver& observer) {
  ServoResult result;
  result.trace.virtualTime = !options_.realtime;
  result.trace.torques = !query_.points().empty();
  result.trace.rows.resize(
      options_.endless ? 1 : plannedTicks_);  // written here, so that no tick waits for a page of memory
  if (second_) {
    result.second.emplace();
    result.second->trace.virtualTime = result.trace.virtualTime;
    result.second->trace.rows.resize(result.trace.rows.size());
    second_->begin();
  }
  hand_.begin();
  failed_ = nullptr;
  const std::size_t done = play(observer, result);
  result.trace.rows.resize(options_.endless ? 0 : done);
  const HandCounts counts = hand_.counts();
  result.withheld = counts.withheld;
  result.leastEnergy_mJ = counts.leastEnergy_mJ;
  if (second_) {
    result.second->trace.rows.resize(result.trace.rows.size());
    result.second->trace.missedTicks = result.trace.missedTicks;
    result.second->counts = second_->counts();
  }
  if (result.deviceFailed) result.fault = (failed_ ? *failed_ : hand_).faultText();
  return result;
}

std::size_t ServoLoop::play(const TickObserver& observer, ServoResult& result) {
  const CrashStop crash(hand_.device());
  std::optional<CrashStop> secondCrash;
  if (second_) secondCrash.emplace(second_->device());
  if (!options_.realtime) return playAtOnce(observer, result);
  return hand_.device().paces() ? playByDevice(result) : playByClock(result);
}

bool ServoLoop::isOver(std::uint64_t index) const noexcept {
  return index >= plannedTicks_ || (options_.stop && options_.stop->load(std::memory_order_relaxed));
}

bool ServoLoop::next(std::uint64_t index, double budget_us, Progress& progress, ServoResult& result) noexcept {
  const double time_s = options_.begin_s + static_cast<double>(index) / options_.rate_Hz;
  const std::size_t place = options_.endless ? 0 : progress.done;
  TraceRow& row = result.trace.rows[place];
  TraceRow* secondRow = result.second ? &result.second->trace.rows[place] : nullptr;
  if (place > 0) {  // where the hands were last, should a device fail now
    row.hip = result.trace.rows[place - 1].hip;
    if (secondRow) secondRow->hip = result.second->trace.rows[place - 1].hip;
  }
  const double lastTime_s = progress.lastTime_s.value_or(time_s - 1 / options_.rate_Hz);
  const Tick how = tick(time_s, time_s - lastTime_s, budget_us, row, secondRow);
  ++progress.done;
  result.deviceFailed = how == Tick::deviceFailed;
  result.queryLost = how == Tick::queryLost;
  if (how != Tick::done) return false;
  result.step_us.add(row.step_us);
  progress.lastTime_s = time_s;
  return true;
}

std::size_t ServoLoop::playAtOnce(const TickObserver& observer, ServoResult& result) {
  const ZeroForceAtExit zero(hand_, second_);
  Progress progress;
  for (std::uint64_t index = 0; !isOver(index); ++index) {
    if (!next(index, 0, progress, result)) break;
    if (observer) observer(result.trace.rows[progress.done - 1]);
  }
  return progress.done;
}

double ServoLoop::budgetOf(const TickPacer& pacer, std::uint64_t index) const noexcept {
  if (options_.clock) return 0;
  const double reserve_us = std::min(options_.reserve_us, kMostReserve * 1e6 / options_.rate_Hz);
  return std::max(pacer.remaining_us(index + 1) - reserve_us, kSmallestBudget_us);
}

std::size_t ServoLoop::playByClock(ServoResult& result) {
  std::optional<RealtimePriority> priority;
  if (!options_.clock) priority.emplace();
  result.realtimePriority = priority && priority->granted();
  const TickPacer pacer(options_.rate_Hz, result.realtimePriority, options_.clock);
  const ThreadToll before = tollOfThisThread();
  const ZeroForceAtExit zero(hand_, second_);  // goes first, still under the raised priority
  Progress progress;
  for (std::uint64_t index = 0; !isOver(index); ++index) {
    const std::uint64_t due = std::min(pacer.waitFor(index), plannedTicks_);
    result.trace.missedTicks += due - index;
    index = due;
    if (index == plannedTicks_) break;
    result.late_us.add(-pacer.remaining_us(index));
    if (!next(index, budgetOf(pacer, index), progress, result)) break;
  }
  result.toll = tollOfThisThread() - before;
  return progress.done;
}

std::size_t ServoLoop::playByDevice(ServoResult& result) {
  const ZeroForceAtExit zero(hand_, second_);
  Progress progress;
  result.pacedByDevice = true;
  std::optional<TickPacer> pacer;  // begins with the device's first tick
  std::uint64_t index = 0;
  const bool cameToEnd = hand_.device().pace(options_.rate_Hz, [&]() noexcept {
    if (!pacer) pacer.emplace(options_.rate_Hz, false, options_.clock);
    // The device's pace wavers and is not quite that of our clock: only what is late by more than a tick is missed.
    const std::uint64_t due = std::min(std::max(index, pacer->passed()), plannedTicks_);
    if (isOver(due)) return false;
    result.trace.missedTicks += due - index;
    result.late_us.add(std::max(0.0, -pacer->remaining_us(due)));
    index = due + 1;
    return next(due, budgetOf(*pacer, due), progress, result);
  });
  result.deviceFailed = result.deviceFailed || !cameToEnd;
  return progress.done;
}

ServoLoop::Tick ServoLoop::tick(double time_s, double dt_s, double budget_us, TraceRow& row,
                                TraceRow* secondRow) noexcept {
  const Stopwatch watch;
  for (TraceRow* each : {&row, secondRow}) {
    if (!each) continue;
    each->time_s = time_s;
    each->proxy = each->hip;
  }
  if (!readAll(time_s)) return Tick::deviceFailed;
  if (hand_.state().putDown) query_.beginAnew();
  if (second_ && second_->state().putDown) query_.secondBeginsAnew();

  Pose pose{.time_s = time_s, .hip = hand_.hip(), .sculpts = hand_.sculpts(), .turn = hand_.state().turn};
  if (second_) pose.secondHip = second_->hip();
  const Contact answer = query_.query(pose, budget_us);
  const bool forcesOn = !options_.forcesOn || options_.forcesOn->load(std::memory_order_relaxed);
  hand_.feel(answer, query_.points(), pose, dt_s, forcesOn);
  if (second_) second_->feel(query_.second(), {}, {.time_s = time_s, .hip = second_->hip()}, dt_s, forcesOn);
  row.step_us = watch.elapsed_us();
  const bool written = writeAll();
  query_.prepare();

  hand_.note(row);
  if (second_) {
    secondRow->step_us = row.step_us;
    second_->note(*secondRow);
  }
  if (options_.recorder) options_.recorder->ticked(row, hand_.state());
  if (!written) return Tick::deviceFailed;
  return answer.lost ? Tick::queryLost : Tick::done;
}

bool ServoLoop::readAll(double time_s) noexcept {
  // Both in any case: a device whose frame a read begins ends it with a write.
  const bool first = hand_.read(time_s), second = !second_ || second_->read(time_s);
  if (!first) return failedAt(hand_);
  return second || failedAt(*second_);
}

bool ServoLoop::writeAll() noexcept {
  if (!hand_.write()) return failedAt(hand_);
  return !second_ || second_->write() || failedAt(*second_);
}

bool ServoLoop::failedAt(const Hand& hand) noexcept {
  failed_ = &hand;
  if (!second_) return false;  // whose force goes as the session ends
  hand_.takeForceAway();
  second_->takeForceAway();
  return false;
}

}  // namespace palpate

#include "haptics/servo_loop.hpp"

#include <algorithm>
#include <limits>
#include <list>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/thread_priority.hpp"
#include "haptics/crash_stop.hpp"
#include "haptics/realtime_priority.hpp"

namespace palpate {
namespace {

class ZeroForceAtExit {
 public:
  explicit ZeroForceAtExit(std::span<const Hand> hands) : hands_(hands) {}
  ~ZeroForceAtExit() {
    for (const Hand& hand : hands_) hand.device().write(DVec3(0));
  }
  ZeroForceAtExit(const ZeroForceAtExit&) = delete;
  ZeroForceAtExit& operator=(const ZeroForceAtExit&) = delete;

 private:
  std::span<const Hand> hands_;
};

/// While a held clock lets the loop wait for a tick, it takes commands.
class ServedWhileWaiting {
 public:
  explicit ServedWhileWaiting(const ServoOptions& options) : clock_(options.mailbox ? options.clock : nullptr) {
    if (clock_) clock_->serve([mailbox = options.mailbox] { mailbox->serve(); });
  }
  ~ServedWhileWaiting() {
    if (clock_) clock_->serve({});
  }
  ServedWhileWaiting(const ServedWhileWaiting&) = delete;
  ServedWhileWaiting& operator=(const ServedWhileWaiting&) = delete;

 private:
  SteppedClock* clock_;
};

std::uint64_t ticksFor(const ServoOptions& options) {
  const std::uint64_t planned = plannedTicks(options.rate_Hz, options.endless ? 0 : options.duration_s);
  if (!options.endless) return planned;
  if (!options.realtime || !options.stop) throw UsageError("an endless session requires real time and a stop flag");
  return std::numeric_limits<std::uint64_t>::max();
}

}  // namespace

ServoLoop::ServoLoop(ContactQuery& query, const std::vector<SessionHand>& hands, const ServoOptions& options)
    : query_(query), options_(options), plannedTicks_(ticksFor(options)), poses_(hands.size()) {
  if (hands.empty() || hands.size() != query.hands())
    throw UsageError("a session of {} hands, and a back end for {}", hands.size(), query.hands());
  hands_.reserve(hands.size());
  for (const SessionHand& hand : hands) {
    if (options.realtime && !hands_.empty() && hand.device.paces())
      throw UsageError("the device {} would call the ticks itself; only the first one may", hand.device.name());
    hands_.emplace_back(hand.device, hand.law, hand.options, options.rate_Hz, query.points(hands_.size()).size());
  }
  countsTicks_ = hands.front().device.limits().countsTicks;
}

ServoLoop::ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options,
                     const HandOptions& hand)
    : ServoLoop(query, {SessionHand{.device = device, .law = std::move(law), .options = hand}}, options) {}

ServoResult ServoLoop::run(const TickObserver& observer, const TickHook& before) {
  ServoResult result;
  result.hands.resize(hands_.size());
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Trace& trace = result.hands[i].trace;
    trace.virtualTime = !options_.realtime;
    trace.torques = !query_.points(i).empty();
    trace.rows.resize(options_.endless ? 1 : plannedTicks_);  // written here, so that no tick causes a page fault
    hands_[i].begin();
  }
  failed_ = nullptr;
  progress_ = {};
  begin_s_ = options_.begin_s;
  first_ = 0;
  if (StateNumbers numbers = StateNumbers::from(options_.resume); numbers.reads()) visitState(numbers);
  const std::size_t done = play(observer, before, result);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    result.hands[i].trace.rows.resize(options_.endless ? 0 : done);
    result.hands[i].trace.missedTicks = result.trace().missedTicks;
    result.hands[i].counts = hands_[i].counts();
  }
  if (result.deviceFailed) result.fault = (failed_ ? *failed_ : hands_.front()).faultText();
  return result;
}

std::size_t ServoLoop::play(const TickObserver& observer, const TickHook& before, ServoResult& result) {
  std::list<CrashStop> crashes;
  for (const Hand& hand : hands_)  // a script needs no protection, and leaves the program's signals alone
    if (hand.device().limits().handHeld) crashes.emplace_back(hand.device(), options_.forcesOn);
  if (!options_.realtime) return playAtOnce(observer, before, result);
  return hands_.front().device().paces() ? playByDevice(result) : playByClock(result);
}

bool ServoLoop::isOver(std::uint64_t index) const noexcept {
  return index >= plannedTicks_ || (options_.stop && options_.stop->load(std::memory_order_relaxed));
}

// A device that a person holds is read at each tick; a loop with a held clock waits by itself.
bool ServoLoop::rest() noexcept {
  constexpr double kAwake_s = 0.2;  // all effects of the last motion or command are over by then
  ServoMailbox* const mailbox = options_.mailbox;
  if (!mailbox || options_.clock || !countsTicks_ || hands_.size() != 1) return false;
  const std::uint32_t wakes = mailbox->wakes();
  const bool rests = hands_.front().state().rests && std::exchange(wakes_, wakes) == wakes;
  rested_s_ = rests ? rested_s_ + 1 / options_.rate_Hz : 0;
  if (rested_s_ < kAwake_s) return false;
  mailbox->sleep(wakes);
  return true;
}

bool ServoLoop::next(std::uint64_t due, double budget_us, ServoResult& result) noexcept {
  Progress& progress = progress_;
  progress.missed += due - progress.next;
  progress.next = due;
  if (options_.mailbox) options_.mailbox->serve();
  const std::uint64_t index = next();
  progress.next = due + 1;
  const std::size_t place = options_.endless ? 0 : progress.done;
  if (place > 0)  // last positions of the hands, in case a device fails now
    for (HandResult& hand : result.hands) hand.trace.rows[place].hip = hand.trace.rows[place - 1].hip;
  // From the numbers of the ticks: a difference of times would be rounded depending on when the session began, and a
  // replay begins at 0.
  const auto sinceBegin_s = [&](std::uint64_t tick) { return static_cast<double>(tick) / options_.rate_Hz; };
  const double dt_s =
      progress.lastIndex ? sinceBegin_s(index) - sinceBegin_s(*progress.lastIndex) : 1 / options_.rate_Hz;
  const Tick how = tick(time_s(index), dt_s, budget_us, place, progress.missed, result);
  if (how == Tick::waits) return true;
  ++progress.done;
  progress.missed = 0;
  result.deviceFailed = how == Tick::deviceFailed;
  result.queryLost = how == Tick::queryLost;
  if (how != Tick::done) return false;
  result.step_us.add(result.trace().rows[place].step_us);
  progress.lastIndex = index;
  return true;
}

std::size_t ServoLoop::playAtOnce(const TickObserver& observer, const TickHook& before, ServoResult& result) {
  const ZeroForceAtExit zero(hands_);
  for (std::uint64_t index = 0; !isOver(index); ++index) {
    const std::size_t done = progress_.done;
    if (before) before(done);
    if (!next(index, 0, result)) break;
    if (observer && progress_.done > done) observer(result.trace().rows[progress_.done - 1]);
  }
  return progress_.done;
}

void ServoLoop::setForce(const ForceOptions& options) noexcept {
  for (Hand& hand : hands_) hand.setForce(options);
}

void ServoLoop::visitState(StateNumbers& visit) noexcept {
  std::uint64_t number = next();
  double begin_s = begin_s_;
  std::optional<double> last;
  if (progress_.lastIndex) last = static_cast<double>(*progress_.lastIndex);
  visit(begin_s, number, last);
  if (visit.reads()) {
    begin_s_ = begin_s;
    first_ = number;
    if (last) progress_.lastIndex = static_cast<std::uint64_t>(*last);
  }
  for (Hand& hand : hands_) hand.visitState(visit);
}

std::size_t ServoLoop::stateSize() noexcept {
  StateNumbers numbers;
  visitState(numbers);
  return numbers.count();
}

void ServoLoop::saveState(std::span<double> numbers) noexcept {
  StateNumbers to = StateNumbers::to(numbers);
  visitState(to);
}

double ServoLoop::budgetOf(const TickPacer& pacer, std::uint64_t index) const noexcept {
  return options_.clock ? 0 : pacer.budget_us(index, options_.reserve_us);
}

std::size_t ServoLoop::playByClock(ServoResult& result) {
  std::optional<RealtimePriority> priority;
  std::optional<HasDeadlines> deadlines;
  if (!options_.clock) {
    priority.emplace();
    deadlines.emplace();
  }
  result.realtimePriority = priority && priority->granted();
  const TickPacer pacer(options_.rate_Hz, result.realtimePriority, options_.clock);
  const SchedulingStatistics before = schedulingOfThisThread();
  const ZeroForceAtExit zero(hands_);  // destroyed first, still under the raised priority
  const ServedWhileWaiting served(options_);
  for (std::uint64_t index = 0; !isOver(index); ++index) {
    const std::uint64_t due = std::min(pacer.waitFor(index), plannedTicks_);
    result.hands.front().trace.missedTicks += due - index;
    index = due;
    if (index == plannedTicks_) break;
    result.late_us.add(-pacer.remaining_us(index));
    if (!next(index, budgetOf(pacer, index), result)) break;
    // The ticks that it has slept through are not missed.
    if (rest()) progress_.next = (index = std::max(index, pacer.passed())) + 1;
  }
  result.scheduling = schedulingOfThisThread() - before;
  return progress_.done;
}

std::size_t ServoLoop::playByDevice(ServoResult& result) {
  const ZeroForceAtExit zero(hands_);
  const HasDeadlines deadlines;
  result.pacedByDevice = true;
  std::optional<TickPacer> pacer;  // starts with the device's first tick
  std::uint64_t index = 0;
  const bool cameToEnd = hands_.front().device().pace(options_.rate_Hz, [&]() noexcept {
    if (!pacer) pacer.emplace(options_.rate_Hz, false, options_.clock);
    // The device's pace varies and differs from our clock's: only a tick that is late by more than a period is missed.
    const std::uint64_t due = std::min(std::max(index, pacer->passed()), plannedTicks_);
    if (isOver(due)) return false;
    result.hands.front().trace.missedTicks += due - index;
    result.late_us.add(std::max(0.0, -pacer->remaining_us(due)));
    index = due + 1;
    return next(due, budgetOf(*pacer, due), result);
  });
  result.deviceFailed = result.deviceFailed || !cameToEnd;
  return progress_.done;
}

ServoLoop::Tick ServoLoop::tick(double time_s, double dt_s, double budget_us, std::size_t place, std::uint64_t missed,
                                ServoResult& result) noexcept {
  const Stopwatch watch;
  const auto row = [&](std::size_t hand) -> TraceRow& { return result.hands[hand].trace.rows[place]; };
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    row(i).time_s = time_s;
    row(i).missed = static_cast<std::uint32_t>(missed);
    row(i).forcesOn = true;
    row(i).proxy = row(i).hip;
  }
  if (!readAll(time_s)) return Tick::deviceFailed;
  if (countsTicks_ && hands_.front().state().waits) {
    for (Hand& hand : hands_) hand.takeForceAway();
    return Tick::waits;
  }
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Hand& hand = hands_[i];
    if (hand.state().putDown) query_.resetHand(i);
    poses_[i] = {.time_s = time_s,
                 .hip = hand.hip(),
                 .sculpts = hand.sculpts(),
                 .byButton = hand.hasButtons(),
                 .turn = hand.state().turn,
                 .felt = hand.felt()};
  }
  double step_us = 0;
  bool written = false;
  const bool forcesOn = !options_.forcesOn || options_.forcesOn->load(std::memory_order_relaxed);
  const bool canAnswer = runTick({.query = query_,
                                  .poses = poses_,
                                  .budget_us = budget_us,
                                  .dt_s = dt_s,
                                  .forcesOn = forcesOn,
                                  .known = options_.known},
                                 hands_, [&] {
                                   step_us = watch.elapsed_us();
                                   written = writeAll();
                                 });
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    row(i).step_us = step_us;
    row(i).forcesOn = forcesOn;
    hands_[i].note(row(i));
  }
  if (options_.recorder) {
    for (std::size_t i = 1; i < hands_.size(); ++i) options_.recorder->tickedToo(i, row(i));
    options_.recorder->ticked(row(0), hands_.front().state());
  }
  if (!written) return Tick::deviceFailed;
  return canAnswer ? Tick::done : Tick::queryLost;
}

bool ServoLoop::readAll(double time_s) noexcept {
  // Reads all in any case: a device whose read begins a frame ends it with a write.
  const Hand* failing = nullptr;
  for (Hand& hand : hands_)
    if (!hand.read(time_s) && !failing) failing = &hand;
  return !failing || failedAt(*failing);
}

bool ServoLoop::writeAll() noexcept {
  for (Hand& hand : hands_)
    if (!hand.write()) return failedAt(hand);
  return true;
}

bool ServoLoop::failedAt(const Hand& hand) noexcept {
  failed_ = &hand;
  if (hands_.size() == 1) return false;  // its force ends with the session
  for (Hand& each : hands_) each.takeForceAway();
  return false;
}

}  // namespace palpate

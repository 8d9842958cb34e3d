#include "haptics/servo_loop.hpp"

#include <algorithm>
#include <limits>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/crash_stop.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {
namespace {

constexpr double kHighestRate_Hz = 100'000;
constexpr double kMostTicks = 50'000'000;  // 14 hours at 1 kHz; their rows take about 10 GB
constexpr double kSmallestBudget_us = 20;  // a budget of 0 would mean to wait as long as it takes
constexpr double kMostReserve = 0.2;       // of a tick
constexpr double kSmallestJump_mm = 1;     // encoder steps and late reads look fast from tick to tick

class ZeroForceAtExit {
 public:
  explicit ZeroForceAtExit(HapticDevice& device) : device_(device) {}
  ~ZeroForceAtExit() { device_.write(DVec3(0)); }
  ZeroForceAtExit(const ZeroForceAtExit&) = delete;
  ZeroForceAtExit& operator=(const ZeroForceAtExit&) = delete;

 private:
  HapticDevice& device_;
};

/// The answer as it is, or, when it is a fault or holds numbers that are not finite, "nothing touched, not valid".
Contact trusted(const Contact& contact, const DVec3& hip) {
  const bool sane = contact.valid && isFinite(contact.proxy) && isFinite(contact.normal);
  return sane ? contact : Contact{.proxy = hip};
}

std::uint64_t ticksFor(const ServoOptions& options) {
  if (!(options.rate_Hz > 0 && options.rate_Hz <= kHighestRate_Hz))
    throw UsageError("rate {} Hz: it must be above 0 and at most {}", options.rate_Hz, kHighestRate_Hz);
  if (options.endless) {
    if (!options.realtime || !options.stop)
      throw UsageError("only a session against the wall clock that can be stopped is endless");
    return std::numeric_limits<std::uint64_t>::max();
  }
  const double ticks = options.duration_s * options.rate_Hz;
  if (!(options.duration_s >= 0 && ticks <= kMostTicks))
    throw UsageError("{} s at {} Hz: a session has at most {} ticks; make it shorter", options.duration_s,
                     options.rate_Hz, kMostTicks);
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(ticks)));
}

}  // namespace

ServoLoop::ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options)
    : device_(device),
      query_(query),
      law_(std::move(law)),
      options_(options),
      plannedTicks_(ticksFor(options)),
      limits_(device.limits()),
      passivityMode_(options.passivity.value_or(limits_.handHeld ? PassivityMode::on : PassivityMode::off)),
      passivity_(passivityMode_, limits_),
      gate_(limits_, 1 / options.rate_Hz) {
  law_.limitTo(limits_.peakForce_N);
  if (passivityMode_ == PassivityMode::on && !limits_.handHeld)
    throw UsageError("passivity on: the device '{}' yields to no force, so there is nothing to brake; observe it",
                     device_.name());
}

ServoResult ServoLoop::run(const TickObserver& observer) {
  ServoResult result;
  result.trace.virtualTime = !options_.realtime;
  result.trace.rows.resize(
      options_.endless ? 1 : plannedTicks_);  // written here, so that no tick waits for a page of memory
  law_.reset();
  passivity_ = Passivity(passivityMode_, limits_);
  gate_ = ForceGate(limits_, 1 / options_.rate_Hz);
  lastPosition_.reset();
  const std::size_t done = play(observer, result);
  result.trace.rows.resize(options_.endless ? 0 : done);
  result.withheld = gate_.counts();
  if (passivityMode_ != PassivityMode::off) result.leastEnergy_mJ = passivity_.leastEnergy_mJ();
  if (result.deviceFailed) {
    result.fault = device_.faultText();
    if (result.fault.empty()) result.fault = fmt::format("{}: the device failed without saying why", device_.name());
  }
  return result;
}

std::size_t ServoLoop::play(const TickObserver& observer, ServoResult& result) {
  std::optional<RealtimePriority> priority;
  std::optional<TickPacer> pacer;
  if (options_.realtime) {
    priority.emplace();
    pacer.emplace(options_.rate_Hz, priority->granted());
    result.realtimePriority = priority->granted();
  }
  const CrashStop crash(device_);
  const ZeroForceAtExit zero(device_);  // goes first, still under the raised priority
  const double reserve_us = std::min(options_.reserve_us, kMostReserve * 1e6 / options_.rate_Hz);

  std::size_t done = 0;
  double lastTime_s = options_.begin_s - 1 / options_.rate_Hz;
  for (std::uint64_t index = 0; index < plannedTicks_; ++index) {
    if (options_.stop && options_.stop->load(std::memory_order_relaxed)) break;
    double budget_us = 0;
    if (pacer) {
      const std::uint64_t due = std::min(pacer->waitFor(index), plannedTicks_);
      result.trace.missedTicks += due - index;
      index = due;
      if (index == plannedTicks_) break;
      result.late_us.add(-pacer->remaining_us(index));
      budget_us = std::max(pacer->remaining_us(index + 1) - reserve_us, kSmallestBudget_us);
    }
    const double time_s = options_.begin_s + static_cast<double>(index) / options_.rate_Hz;
    TraceRow& row = result.trace.rows[options_.endless ? 0 : done];
    if (done > 0 && !options_.endless)
      row.hip = result.trace.rows[done - 1].hip;  // where the hand was last, should the device fail now
    const Tick how = tick(time_s, time_s - lastTime_s, budget_us, row);
    ++done;
    result.deviceFailed = how == Tick::deviceFailed;
    result.queryLost = how == Tick::queryLost;
    if (how != Tick::done) break;
    result.step_us.add(row.step_us);
    lastTime_s = time_s;
    if (observer && !pacer) observer(row);
  }
  return done;
}

ServoLoop::Tick ServoLoop::tick(double time_s, double dt_s, double budget_us, TraceRow& row) noexcept {
  const Stopwatch watch;
  row.time_s = time_s;
  row.proxy = row.hip;
  const DeviceState state = device_.read(time_s);
  const DVec3 hip = options_.map.toModel(state.position);
  if (!state.ok || !isFinite(hip)) {
    law_.reset();
    return Tick::deviceFailed;
  }
  if (state.putDown) {
    law_.reset();
    passivity_.lift();
    lastPosition_.reset();
    query_.beginAnew();
  }
  const Pose pose{.time_s = time_s, .hip = hip};
  const Contact answer = query_.query(pose, budget_us);
  const Contact contact = trusted(answer, hip);
  const DVec3 force_N = forceFor(state.position, pose, contact, dt_s);
  const double step_us = watch.elapsed_us();
  const bool written = device_.write(force_N);
  passivity_.acted(written ? force_N : DVec3(0));
  query_.prepare();

  row.hip = hip;
  row.proxy = contact.proxy;
  row.normal = contact.normal;
  row.force_N = written ? force_N : DVec3(0);
  row.penetration_mm = contact.touching ? law_.scale().toMm(glm::length(contact.proxy - hip)) : 0;
  row.contact = contact.touching;
  row.fresh = contact.fresh;
  row.valid = contact.valid && written;
  row.putDown = state.putDown;
  row.neighbours = contact.neighbours;
  row.gpu_us = contact.gpu_us;
  row.step_us = step_us;
  if (options_.recorder) options_.recorder->ticked(row, state.position);
  if (!written) return Tick::deviceFailed;
  return answer.lost ? Tick::queryLost : Tick::done;
}

DVec3 ServoLoop::forceFor(const DVec3& position, const Pose& pose, const Contact& contact, double dt_s) noexcept {
  TickSigns signs{.on = !options_.forcesOn || options_.forcesOn->load(std::memory_order_relaxed),
                  .answered = contact.valid,
                  .fresh = contact.fresh,
                  .jumped = hasJumped(position, dt_s)};
  if (contact.dataTime_s >= 0) signs.age_s = pose.time_s - contact.dataTime_s;
  if (signs.jumped) {
    law_.reset();
    passivity_.lift();
  }
  const DVec3 spring_N = law_.update(contact, pose, dt_s);
  signs.demand_N = law_.demand_N();
  const DVec3 hand_mm = limits_.handHeld ? position : law_.scale().mm_per_unit * pose.hip;
  return gate_.pass(passivity_.damped(spring_N, hand_mm, dt_s), signs, dt_s);
}

bool ServoLoop::hasJumped(const DVec3& position, double dt_s) noexcept {
  const double reach_mm = limits_.fastest_mm_per_s * std::max(dt_s, 0.0) + kSmallestJump_mm;
  const bool jumped = lastPosition_ && glm::distance(position, *lastPosition_) > reach_mm;
  lastPosition_ = position;
  return jumped;
}

}  // namespace palpate

#include "engine/touch/touch_side.hpp"

#include <algorithm>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/touch/memory.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

// Drivers that are known to bring what the host writes before a shader that is running. Where sight has the same queue,
// its frames would wait behind a question that waits.
bool mayHearTheHost(const Device& device) {
  return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY && !device.roles().shared();
}

// At about the 520th submission NVIDIA's driver makes room for more, once, and takes 1.8 ms: not in a tick.
constexpr int kFirstSubmissions = 1100;

// A cloud whose index is always built anew needs spare slots for new points alone.
constexpr std::uint32_t kFewerSpare = 4;

std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options) {
  const std::uint32_t spare = HashUpdate::spareSlots(cloud.size());
  return options.index == IndexFollow::rebuild ? spare / kFewerSpare : options.spareSlots.value_or(spare);
}

// RGBA8 of every point; none where the cloud has none and none are painted.
std::vector<std::uint32_t> colorsOf(const PointCloud& cloud, const TouchOptions& options) {
  std::vector<std::uint32_t> colors;
  if (!cloud.hasColors() && !options.paintable && options.brush->kind != BrushKind::paint) return colors;
  for (std::size_t i = 0; i < cloud.size(); ++i) colors.push_back(packedColor(cloud, i));
  return colors;
}

void requireFused(const TouchOptions& options, QueryMethod method) {
  if (method == QueryMethod::fused) return;
  if (!options.tool.points.empty())
    throw UsageError("a tool of many points is answered by the query method fused alone");
  if (options.secondHand) throw UsageError("two hands are answered by the query method fused alone");
}

// The cloud, once it is known to fit: before a byte of it is uploaded.
const PointCloud& fitting(const Device& device, const PointCloud& cloud, const TouchOptions& options) {
  requireFused(options, options.method);
  requireGpuMemory(device, cloud.size(), options.brush.has_value());
  return cloud;
}

HashGrid gridFor(const PointCloud& cloud, const TouchOptions& options) {
  const double cell = options.cell > 0 ? options.cell : options.radius;
  return makeHashGrid(Vec3(boundsOf(cloud).min), std::max(cell, smallestCell(options.radius)), cloud.size(),
                      options.bucketKey);
}

}  // namespace

TouchSide::TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options)
    : device_(device),
      options_(options),
      wait_(options.wait.value_or(device.defaultWait())),
      origin_(cloud.origin),
      live_(device, fitting(device, cloud, options), options.brush ? spareSlots(cloud, options) : 0),
      hash_(device, gridFor(cloud, options), live_.slots(), options.sort, options.bucketOrder,
            options.brush ? Slots::spare : Slots::full),
      contact_(device, contactOptions(), hash_.grid(), live_.slots()),
      log_(device, options.brush ? live_.count() : 0),
      forget_(device, device.touch(), "begin anew"),
      forgetSecond_(device, device.touch(), "second hand begins anew"),
      pace_(kStalest_s) {
  buildTime_us_ = hash_.build(live_);
  if (!options.tool.points.empty()) tool_.emplace(options.tool);
  toolTrackers_.assign(options.tool.points.size(), {.tracker = ProxyTracker(options.radius, options.friction)});
  if (options.secondHand) second_.emplace();
  if (options.brush) {
    edit_.emplace(device, *options.brush, hash_, live_, log_, colorsOf(cloud, options),
                  options.radius / options.widening);
    editTimes_us_.reserve(kEditTimesKept);
    wishTimes_us_.reserve(kEditTimesKept);
  }
  makeBridge();
  recordAll();
  if (edit_ && options.index == IndexFollow::incremental)
    compaction_.emplace(device, hash_, live_, edit_->update(), options.compaction);
  if (wait_ == Wait::spin) warmUp();
  const bool mayAskAhead = wait_ == Wait::spin && mayHearTheHost(device);
  ahead_ = contact_.canWait() && options.ahead.value_or(mayAskAhead && hearsTheHost());
  device_.noteTouch(1);
}

void TouchSide::warmUp() {
  for (int i = 0; i < kFirstSubmissions; ++i) device_.touch().wait(device_.touch().submit(forget_), Wait::spin);
}

TouchSide::~TouchSide() {
  device_.noteTouch(-1);
  try {
    withdraw();
    device_.waitIdle();
  } catch (const GpuError&) {  // the device is lost: nothing runs on it any more
  }
}

ContactOptions TouchSide::contactOptions() const {
  return {.radius = options_.radius,
          .method = options_.method,
          .surface = options_.surface,
          .localRadius = options_.localRadius,
          .widening = options_.widening,
          .friction = options_.friction,
          .split = options_.split,
          .probes = secondProbe() + (options_.secondHand ? 1 : 0)};
}

void TouchSide::makeBridge() {
  bridge_.emplace(device_, hash_.grid(), origin_,
                  SurfaceOptions{.radius = options_.radius,
                                 .kind = options_.surface,
                                 .localRadius = options_.localRadius,
                                 .widening = options_.widening},
                  options_.friction, live_.slots());
}

void TouchSide::recordAll() {
  for (int turn = 0; turn < 2; ++turn) {
    recordQuery(live_.parity());
    bridge_->record(live_.parity(), hash_.view(live_.side(), live_.slots()));
    if (edit_) recordEdits();
    live_.flip();
  }
  const std::uint64_t ofFirst = std::uint64_t{secondProbe()} * sizeof(shared::ContactState);
  forget_.begin();
  forget_.fill(contact_.state(), 0, ofFirst);
  forget_.end();
  if (!second_) return;
  forgetSecond_.begin();
  forgetSecond_.fill(contact_.state(), 0, sizeof(shared::ContactState), ofFirst);
  forgetSecond_.end();
}

void TouchSide::settle() {
  if (failure_) std::rethrow_exception(failure_);
  closeTick();
  withdraw();
  if (asked_) answerWithin(0, lastPose_.time_s);
}

void TouchSide::setContact(SurfaceKind surface, double friction, QueryMethod method) {
  requireFused(options_, method);
  finish();
  device_.waitIdle();
  options_.surface = surface;
  options_.friction = friction;
  options_.method = method;
  toolTrackers_.assign(toolTrackers_.size(), {.tracker = ProxyTracker(options_.radius, friction)});
  forgetTool();
  if (second_) second_->forget();
  ended_.reset();
  contact_ = ContactStep(device_, contactOptions(), hash_.grid(), live_.slots());
  makeBridge();
  recordAll();
  lastQuery_ = {};
  last_ = {};
  ahead_ = ahead_ && contact_.canWait();
}

void TouchSide::beginAnew() noexcept {
  if (failure_) return;
  try {
    if (asked_) asked_->dropped = true;
    forgetBy(forget_);
    bridge_->beginAnew();
    last_.touching = false;
    forgetTool();
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::secondBeginsAnew() noexcept {
  if (failure_ || !second_) return;
  try {
    if (asked_) asked_->secondDropped = true;
    forgetBy(forgetSecond_);
    second_->forget();
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::forgetBy(const CommandList& forget) {
  closeTick();
  withdraw();
  settleLast();
  device_.touch().wait(device_.touch().submit(forget), wait_);
}

void TouchSide::recordQuery(std::uint32_t parity) {
  queries_[parity].clear();
  for (std::uint32_t i = 0; i < contact_.lists(); ++i) {
    auto& list = queries_[parity].emplace_back(
        std::make_unique<CommandList>(device_, device_.touch(), "query", options_.timing));
    list->begin();
    contact_.record(*list, i, hash_.view(live_.side(), live_.slots()), log_.head());
    list->end();
  }
}

std::span<const PointContact> TouchSide::points() const noexcept {
  return tool_ ? tool_->points() : std::span<const PointContact>();
}

Contact TouchSide::told() { return tool_ ? tool_->whole() : last_; }

Contact TouchSide::bridged(const Pose& pose) {
  const Contact own = bridge_->answer(pose);
  if (second_) second_->hold(pose);
  if (!tool_) return own;
  return tool_->bridged(own, pose, bridge_->trust(pose.time_s), [&](std::uint32_t i, const Pose& at) {
    const std::optional<Contact> contact = bridge_->follow(toolTrackers_[i].tracker, at);
    toolTrackers_[i].ahead = toolTrackers_[i].ahead || contact;
    return contact;
  });
}

void TouchSide::forgetTool() {
  if (!tool_) return;
  tool_->forget();
  for (ToolTracker& point : toolTrackers_) {
    point.tracker.goOnFrom({});
    point.ahead = false;
  }
}

void TouchSide::prepare() noexcept {
  if (failure_) return;
  try {
    closeTick();
    if (ahead_ && !asked_ && !waiting_) askAhead();
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::closeTick() {
  const std::optional<Open> open = std::exchange(open_, std::nullopt);
  if (!open) return;
  if (open->realtime) bridge_->renew(open->pose, live_.parity());
  if (!open->answered) return;
  if (last_.valid) editIfYielding(open->realtime);
  compactFurther(open->realtime);
}

void TouchSide::finish() {
  settle();
  log_.publish(download<std::uint32_t>(device_, log_.headBuffer(), 1)[0]);  // waits for the queue
  collectEdit(true);
  endStroke();
}

std::vector<PassRecord> TouchSide::passes() const {
  std::vector<PassRecord> all;
  for (std::uint32_t list = lastQuery_.first; list <= lastQuery_.last; ++list)
    std::ranges::copy(queries_[lastQuery_.parity][list]->passes(), std::back_inserter(all));
  if (edit_) {
    const CommandList& edit = lastEdit_ ? *lastEdit_ : chosenEdit();
    std::ranges::copy(edit.passes(), std::back_inserter(all));
  }
  return all;
}

}  // namespace palpate

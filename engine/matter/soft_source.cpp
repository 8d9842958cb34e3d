#include "engine/matter/soft_source.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/check.hpp"
#include "engine/matter/matter_touch.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

// Radius of the surface positions that support a position's surface, in cell spacings: as many as the points of any
// cloud.
const double kSupport_cells = static_cast<double>(shared::kSupportSpacings) / kPlacesOfSpacing;

struct NowPlace {
  std::uint32_t number;
  DVec3 place;  // model units
  Vec3 normal;
};

constexpr double kSameTime_s = 1e-7;
// Against the clock a hand has felt the surface of an earlier frame. While it presses, the simulation knows the depth
// better: this share of the difference is applied at a time.
constexpr double kTrustInFelt = 0.1;
// In support radii: an even pressure on a disc of this radius is about as wide as the weights of touch.
constexpr double kPressedShare = 0.5;
// Number of steps of a touch before its compliance is computed, and between later computations: one takes as long as
// about fifteen steps, and as 150 for 200,000 nodes.
constexpr std::uint32_t kFirstCompliance = 50, kNextCompliance = 250, kNodesOfNext = 20'000;

std::uint32_t stepsToNext(const MatterPlan& plan) {
  return kNextCompliance * std::max(1u, static_cast<std::uint32_t>(plan.particles / kNodesOfNext));
}

// Below this pace the body is treated as at rest between two frames.
constexpr double kSlowPace = 0.5;

// Step that contains a time: a frame is never of a future time.
std::int64_t stepAt(double time_s) {
  return static_cast<std::int64_t>(std::floor((time_s + kSameTime_s) / kMatterStep_s));
}

}  // namespace

SurfaceMeasure sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m) {
  PALPATE_CHECK(brush.has(shared::kShapesBodies));
  SurfaceMeasure measure;
  if (!brush.acts()) return measure;
  const SoftBody& body = sculpture.body();
  const SoftSurface& surface = sculpture.surface();
  const bool smooths = brush.has(shared::kUsesNeighbours);
  const double support = kSupport_cells * body.lattice().spacing_m() / unit_m;
  const double reach = brush.radius() + (smooths ? support : 0);
  std::vector<NowPlace> near;
  for (std::uint32_t i = 0; i < surface.size(); ++i)
    if (const DVec3 place = DVec3(surface.placeOf(body, i)) / unit_m; glm::distance(place, brush.center()) < reach)
      near.push_back({.number = i, .place = place, .normal = surface.normalOf(body, i)});
  std::vector<PlaceWay> ways;
  for (const NowPlace& at : near) {
    if (!(glm::distance(at.place, brush.center()) < brush.radius())) continue;
    const PlacedBrush::Found found{at.place, DVec3(at.normal), double{shared::kUnseen}};
    if (brush.measures(at.number)) brush.measure(at.place, found, measure);
    DVec3 to;
    if (smooths) {
      const auto forEachNear = [&](double radius, auto&& visit) {
        for (const NowPlace& other : near)
          if (const DVec3 offset = other.place - at.place; glm::length(offset) < radius) visit(offset, other.normal);
      };
      to = brush.smoothed(at.place, found,
                          surfaceOf({.radius = support, .kind = SurfaceKind::sphere}, DVec3(at.normal), forEachNear));
    } else {
      to = brush.brushed(at.place, DVec3(at.normal), found).position;
    }
    if (to != at.place) ways.push_back({.place = at.number, .way = unit_m * (to - at.place)});
  }
  sculpture.yield(ways);
  return measure;
}

SoftSource::SoftSource(std::unique_ptr<MatterSimulation> world, const SoftSourceOptions& options)
    : SteppedControl(*world, options.hands, options.mostAtOnce),
      world_(std::move(world)),
      options_(options),
      stroke_(options.radius),
      slots_(kMaxTouches) {
  PALPATE_CHECK(world_->hasSurface());
  const double radius_m = kMatterUnit_m * std::max(kPressedShare * options_.radius, options_.toolReach);
  for (std::atomic<double>& compliance : compliances_)
    compliance = halfSpaceCompliance_m_N(world_->scene(), radius_m) / kMatterUnit_m;
}

void SoftSource::restart() {
  world_->reset();
  std::ranges::fill(slots_, Slot{});
  energies_J_.fill(0);
  forget();
  beginnings_.fetch_add(1, std::memory_order_relaxed);
}

bool SoftSource::hasNewer(double time_s, double /*than_s*/) {
  if (isToBeReset() || isTurned_) return true;
  const auto newest = asked_.load();
  const bool isAsked = question_.count > 0 || (newest && newest->count > 0);
  return !isPaused() && isAsked && last() != stepAt(time_s);
}

// One edit per step, after the steps, so that a hand's contact has pressed where the surface was felt. Pressed
// positions move with the surface under them.
void SoftSource::sculpt(std::uint32_t steps) {
  SoftSculpture* const sculpture = world_->sculpture();
  if (!sculpture) return;
  const SurfaceBrush& now = question_.brush;
  if (now.brush != brush_) {
    brush_ = now.brush;
    stroke_.setBrush(brush_.value_or(BrushOptions()));
  }
  stroke_.feel({.normal = now.normal, .touching = now.touching}, now.hip, now.spring,
               now.brush ? now.press : Press::none, question_.time_s);
  if (!stroke_.isGoingOn()) endStroke();
  if (!stroke_.acts()) return;
  world_->beginSculpting();
  const SoftBody& body = sculpture->body();
  const SoftSurface& surface = sculpture->surface();
  std::vector<std::pair<Slot*, std::uint32_t>> under;
  for (Slot& slot : slots_)
    if (slot.presses) under.emplace_back(&slot, surface.nearest(body, slot.place_m));
  std::vector<Vec3> before;
  before.reserve(under.size());
  for (const auto& [slot, place] : under) before.push_back(surface.placeOf(body, place));
  edit(*sculpture, question_.time_s, steps);
  world_->endSculpting();
  for (std::size_t i = 0; i < under.size(); ++i)
    under[i].first->place_m += DVec3(surface.placeOf(body, under[i].second) - before[i]);
}

// One edit per step, as if the hand had been queried in each of them.
void SoftSource::edit(SoftSculpture& sculpture, double time_s, std::uint32_t steps) {
  for (std::uint32_t k = 0; k < steps && stroke_.acts(); ++k) {
    const PlacedBrush brush(*brush_, options_.radius, stroke_.next(time_s - (steps - 1 - k) * kMatterStep_s));
    stroke_.note(palpate::sculpt(sculpture, brush, kMatterUnit_m));
  }
}

void SoftSource::endStroke() {
  stroke_.end();
  if (SoftSculpture* const sculpture = world_->sculpture()) sculpture->endStroke();
}

void SoftSource::takeStrokes(std::vector<ShapeStroke>& strokes) {
  if (SoftSculpture* const sculpture = world_->sculpture()) sculpture->take(strokes);
}

void SoftSource::exchange(ShapeStroke& stroke) {
  endStroke();
  world_->beginSculpting();
  world_->sculpture()->exchange(stroke);
  world_->endSculpting();
  isTurned_ = true;
  beginnings_.fetch_add(1, std::memory_order_relaxed);
}

SurfaceHolds SoftSource::surfaceHolds() const noexcept {
  return {.keptTicks = keptTicks_.load(std::memory_order_relaxed),
          .gaveWayTicks = gaveWayTicks_.load(std::memory_order_relaxed)};
}

void SoftSource::count(bool isKept, bool gaveWay) noexcept {
  keptTicks_.fetch_add(isKept ? 1 : 0, std::memory_order_relaxed);
  gaveWayTicks_.fetch_add(gaveWay ? 1 : 0, std::memory_order_relaxed);
}

DVec3 SoftSource::placeOf(const SurfaceTouch& touch, const Slot& slot) const {
  const double age_s = std::max(0.0, bodyTime_s_ - question_.feltAt_s);
  if (std::abs(question_.pointsTime_s - bodyTime_s_) < kSameTime_s || !slot.presses)
    return kMatterUnit_m * (touch.proxy + age_s * touch.velocity);
  const DVec3 apart = kMatterUnit_m * touch.proxy - slot.place_m;
  const double deeper = glm::dot(apart, touch.normal);
  return slot.place_m + apart - (1 - kTrustInFelt) * deeper * touch.normal;
}

// The questions' proxies refer to the body's state before the first step.
void SoftSource::advance(std::uint32_t steps) {
  const double radius_m = std::max(kMatterUnit_m * options_.radius, world_->plan().spacing_m);
  for (std::size_t i = 0; i < question_.count; ++i) {
    const SurfaceTouch& touch = question_.touches[i];
    Slot& slot = slots_[i];
    if (!slot.known) slot.hand_m = kMatterUnit_m * touch.hip;
    slot.known = true;
    slot.place_m = touch.touching ? placeOf(touch, slot) : DVec3(0);
    slot.velocity_m_s = kMatterUnit_m * touch.velocity;
    slot.isAlone = slot.isAlone && touch.touching;
    slot.presses = touch.touching;
    slot.steps = touch.touching ? slot.steps + steps : 0;
  }
  for (std::uint32_t k = 0; k < steps; ++k) {
    presses_.clear();
    pressing_.clear();
    for (std::size_t i = 0; i < question_.count; ++i) {
      const SurfaceTouch& touch = question_.touches[i];
      Slot& slot = slots_[i];
      const DVec3 to = glm::mix(slot.hand_m, kMatterUnit_m * touch.hip, 1.0 / (steps - k));
      if (slot.presses) {
        pressing_.push_back(i);
        presses_.push_back({.place_m = slot.place_m,
                            .normal = touch.normal,
                            .handFrom_m = slot.hand_m,
                            .handTo_m = to,
                            .radius_m = radius_m,
                            .stiffness_N_m = touch.spring.stiffness_N_per_unit / kMatterUnit_m / world_->scene().gain,
                            .damping_N_s_m = touch.spring.damping_N_s_per_unit / kMatterUnit_m / world_->scene().gain,
                            .friction = question_.friction,
                            .most_N = touch.spring.most_N / world_->scene().gain,
                            .hand = touch.hand,
                            .touch = static_cast<std::uint32_t>(i),
                            .isSamePlace = touch.isSamePlace});
      }
      slot.hand_m = to;
    }
    world_->press(presses_);
    world_->step();
    if (world_->state() != MatterState::running) break;  // pressed() is of an earlier step
    for (std::size_t n = 0; n < pressing_.size(); ++n) {
      Slot& slot = slots_[pressing_[n]];
      const PressReport& report = world_->pressed()[n];
      slot.velocity_m_s = (report.place_m - slot.place_m) / kMatterStep_s;
      slot.place_m = report.place_m;
      slot.isAlone = report.isAlone;
      energies_J_[presses_[n].hand] += question_.touches[pressing_[n]].felt * world_->scene().gain * report.work_J;
    }
    for (std::size_t hand = 0; hand < options_.hands; ++hand) seeEnergy(hand, energies_J_[hand]);
  }
  sculpt(steps);
  for (std::size_t i = 0; i < question_.count && question_.goesOn; ++i)
    findCompliance(question_.touches[i], slots_[i], steps);
}

// For a tool, the first touching point represents all. `steps`: the latest steps of the touch.
void SoftSource::findCompliance(const SurfaceTouch& touch, const Slot& slot, std::uint32_t steps) {
  if (!slot.presses) return;
  const auto parts = [&](std::uint32_t pressed) {
    return (pressed >= kFirstCompliance ? 1 : 0) + pressed / stepsToNext(world_->plan());
  };
  if (parts(slot.steps) == parts(slot.steps - steps)) return;
  const double reach = touch.hand == 0 ? options_.toolReach : 0;
  const double radius_m = kMatterUnit_m * std::max(kPressedShare * options_.radius, reach);
  const double compliance = world_->localCompliance_m_N(slot.place_m, radius_m, -touch.normal) / kMatterUnit_m;
  // A failed body has no compliance; the last one is kept for the restart.
  if (std::isfinite(compliance)) compliances_[touch.hand].store(compliance, std::memory_order_relaxed);
}

void SoftSource::follow(double time_s) {
  if (const auto newest = asked_.load()) question_ = *newest;
  if (takeReset()) restart();
  takeParameters(*world_);
  std::uint32_t steps = 0;
  if (question_.count > 0) {  // a question was received
    const std::int64_t now = stepAt(time_s);
    if (goesBack(now)) restart();
    const double dropped_s = this->dropped_s();
    steps = stepsTo(now, 0);
    const double left = (this->dropped_s() - dropped_s) / kMatterStep_s;
    if (steps > 0) pace_ = steps / (steps + left);
  }
  if (isPaused())
    std::ranges::fill(slots_, Slot{});
  else
    advance(steps);
  bodyTime_s_ = std::min(time_s, last() ? static_cast<double>(*last()) * kMatterStep_s : time_s);
  tellPlaces();
  see(world_->state());
  isTurned_ = false;
}

void SoftSource::tellPlaces() {
  for (std::size_t i = 0; i < question_.count; ++i) {
    const Slot& slot = slots_[i];
    told_[i] = {.contact = slot.presses ? question_.touches[i].contact : 0,
                .place = slot.place_m / kMatterUnit_m,
                .velocity = slot.velocity_m_s / kMatterUnit_m,
                .isAlone = slot.isAlone,
                .time_s = bodyTime_s_};
  }
  pressed_.store(told_);
}

std::optional<double> SoftSource::goTo(double time_s) {
  follow(time_s);
  world_->carryVelocities(!isPaused() && pace_ > kSlowPace);
  return world_->state() == MatterState::running ? std::optional(bodyTime_s_) : std::nullopt;
}

void SoftSource::makeFrame(double time_s, CloudFrame& frame) {
  follow(time_s);
  world_->makeFrame(frame);
  constexpr auto kUnits = static_cast<float>(1 / kMatterUnit_m);
  for (Vec3& position : frame.positions) position *= kUnits;
  const auto perSecond = static_cast<float>(isPaused() ? 0 : pace_ / kMatterUnit_m);
  for (Vec3& velocity : frame.velocities) velocity *= perSecond;
  frame.time_s = bodyTime_s_;
}

}  // namespace palpate

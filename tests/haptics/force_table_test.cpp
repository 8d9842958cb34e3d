// The table of forces in haptics/README.md: each of its rows through the whole loop, with a hand that does not yield.
#include <doctest/doctest.h>

#include <atomic>
#include <functional>

#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/device_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::force_table_test {
namespace {

constexpr double kTick_s = 0.001, kEvent_s = 1, kEnd_s = 1.7;
constexpr double kStiffness_N_per_mm = 0.8;
constexpr double kSurface_N = 0.06, kHand_N = 0.6, kFade_N = 3.3 * kTick_s / 0.05;  // in a tick

enum class Change {
  byHand,     // exactly as the spring
  bySurface,  // 60 N/s at most, and what the hand's motion does
  fading,     // within 50 ms
  atOnce      // to zero within the tick
};

DVec3 resting(double) { return {0, 0, -3}; }

/// Deep in the plane z = 0 at the event, if nothing else is said.
struct Row {
  const char* event;
  Change change;
  DVec3 before_N, after_N;
  std::function<void(Contact&)> surface = nullptr;  // from the event on
  std::function<DVec3(double)> hand = resting;      // by the time since the event
  std::function<void(DeviceState&, double)> device = nullptr;
  bool isOff = false;  // the user switches forces off
  bool byOthers = false;
  bool withTool = false;
  CustomForce law = {};
};

/// The plane z = 0, as a row changes it, for the HIP, or for two points that are equally deep.
class Surface final : public OneHandQuery {
 public:
  explicit Surface(const Row& row) : row_(row) {}
  Contact answerTo(const Pose& pose, double) noexcept override {
    Contact contact = at(pose.hip);
    const bool changed = pose.time_s >= kEvent_s;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const DVec3 hip = pose.hip + DVec3(i == 0 ? -4 : 4, 0, 0);
      points_[i] = {.hip = hip, .share = 0.5, .contact = at(hip)};
      if (changed && i == 0 && row_.surface) row_.surface(points_[i].contact);
    }
    if (changed && row_.surface && !row_.withTool) row_.surface(contact);
    return contact;
  }
  std::span<const PointContact> points(std::size_t) const noexcept override {
    return row_.withTool ? std::span<const PointContact>(points_) : std::span<const PointContact>();
  }
  void resetHand(std::size_t) noexcept override { isLifted_ = true; }

 private:
  Contact at(const DVec3& hip) const {
    const bool touching = hip.z < 0 && !isLifted_;
    return {.proxy = touching ? DVec3(hip.x, hip.y, 0) : hip,
            .normal = {0, 0, 1},
            .touching = touching,
            .fresh = true,
            .valid = true};
  }

  const Row& row_;
  std::array<PointContact, 2> points_{};
  bool isLifted_ = false;
};

std::vector<TraceRow> played(const Row& row) {
  std::atomic<bool> on = true;
  const auto stateAt = [&](double time_s) {
    if (row.isOff && time_s >= kEvent_s) on = false;
    // Outside until the force has ramped up, and in with 40 mm/s.
    const DVec3 begun = row.hand(0);
    const DVec3 hip =
        time_s < kEvent_s ? begun + DVec3(0, 0, 40 * std::max(0.0, 0.9 - time_s)) : row.hand(time_s - kEvent_s);
    DeviceState state{.position = hip, .ok = true};
    if (row.device && time_s >= kEvent_s) row.device(state, time_s - kEvent_s);
    return state;
  };
  ScriptedDevice device(stateAt, {.continuousForce_N = kTouchPeakForce_N, .buttons = 2});
  Surface surface(row);
  InformationAge known;
  if (row.byOthers) known.changed(InformationAge::Clock::now() + std::chrono::hours(1));
  ForceLaw law({.stiffness_N_per_mm = kStiffness_N_per_mm, .damping_N_s_per_mm = 0}, {});
  law.setCustom(row.law);
  ServoLoop loop(device, surface, law, {.duration_s = kEnd_s, .forcesOn = &on, .known = &known},
                 {.passivity = PassivityMode::off});
  return loop.run().trace().rows;
}

const std::vector<Row> kTable{
    {"contact begins",
     Change::byHand,
     {0, 0, 0},
     {0, 0, 2.4},
     nullptr,
     [](double t) { return DVec3(0, 0, std::max(1 - 200 * t, -3.0)); }},
    {"the hand presses",
     Change::byHand,
     {0, 0, 0.8},
     {0, 0, 2.4},
     nullptr,
     [](double t) { return DVec3(0, 0, std::max(-1 - 200 * t, -3.0)); }},
    {"the hand withdraws",
     Change::byHand,
     {0, 0, 2.4},
     {0, 0, 0},
     nullptr,
     [](double t) { return DVec3(0, 0, std::min(-3 + 1000 * t, 2.0)); }},
    {"the hand slides over an edge",
     Change::bySurface,
     {0, 0, 2.4},
     {1.44, 0, 1.92},
     [](Contact& contact) {
       contact.normal = {0.6, 0, 0.8};
       contact.proxy += 3.0 * (contact.normal - DVec3(0, 0, 1));
     },
     [](double t) { return DVec3(20 * t, 0, -3); }},
    {"the surface ends",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 0},
     [](Contact& contact) { contact.touching = false; },
     [](double t) { return DVec3(20 * t, 0, -3); }},
    {"the surface is lost inside",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 0},
     [](Contact& contact) { contact.touching = false, contact.isWithin = true; }},
    {"the proxy changes its side",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, -0.8},
     [](Contact& contact) {
       contact.normal = {0, 0, -1}, contact.proxy.z = -4;
     }},
    {"an own edit lowers the surface",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 1.6},
     [](Contact& contact) { contact.proxy.z = -1; }},
    {"undo raises it", Change::bySurface, {0, 0, 2.4}, {0, 0, 3.2}, [](Contact& contact) { contact.proxy.z = 1; }},
    {"another's edit raises it",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 3.2},
     [](Contact& contact) { contact.proxy.z = 1; },
     resting,
     nullptr,
     false,
     true},
    {"a frame moves it",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 2.8},
     [](Contact& contact) {
       contact.proxy.z = 0.5, contact.velocity = {0, 0, 5};
     }},
    {"matter or a soft body yields",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0.3, 0.4},
     [](Contact& contact) { contact.force_N = DVec3(0, 0.3, 0.4); }},
    {.event = "a custom force",
     .change = Change::bySurface,
     .before_N = {0, 0, 2.4},
     .after_N = {0, 0, 1.2},
     .law = {[](void*, const Contact&, const Pose& pose, double, const DVec3& usual_N) noexcept {
       return pose.time_s < kEvent_s ? usual_N : 0.5 * usual_N;
     }}},
    {"another model",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, kTouchPeakForce_N},
     [](Contact& contact) { contact.proxy.z = 20; }},
    {"the surface ends under half a tool",
     Change::bySurface,
     {0, 0, 2.4},
     {0, 0, 1.2},
     [](Contact& contact) { contact.touching = false; },
     resting,
     nullptr,
     false,
     false,
     true},
    {"the data are stale", Change::fading, {0, 0, 2.4}, {0, 0, 0}, [](Contact& contact) { contact.fresh = false; }},
    {"a fault", Change::atOnce, {0, 0, 2.4}, {0, 0, 0}, [](Contact& contact) { contact.valid = false; }},
    {"the device jumps",
     Change::atOnce,
     {0, 0, 2.4},
     {0, 0, 0},
     nullptr,
     resting,
     [](DeviceState& state, double) { state.position.x += 8; }},
    {"the device has no force for a moment",
     Change::atOnce,
     {0, 0, 2.4},
     {0, 0, 2.4},
     nullptr,
     resting,
     [](DeviceState& state, double t) { state.rendersForce = t > 0.05; }},
    {"forces off", Change::atOnce, {0, 0, 2.4}, {0, 0, 0}, nullptr, resting, nullptr, true},
    {"the device is put down",
     Change::atOnce,
     {0, 0, 2.4},
     {0, 0, 0},
     nullptr,
     resting,
     [](DeviceState& state, double t) { state.putDown = t == 0; }},
    {"clutch",
     Change::atOnce,
     {0, 0, 2.4},
     {0, 0, 0},
     nullptr,
     resting,
     [](DeviceState& state, double) { state.buttons = kClutchButton; }},
};

}  // namespace

TEST_CASE("each event of the table of forces changes the force as the table says") {
  const auto event = static_cast<std::size_t>(std::lround(kEvent_s / kTick_s));
  for (const Row& row : kTable) {
    CAPTURE(row.event);
    const std::vector<TraceRow> rows = played(row);
    CHECK(glm::distance(rows[event - 1].force_N, row.before_N) < 1e-9);
    CHECK(glm::distance(rows.back().force_N, row.after_N) < 1e-9);
    if (row.change == Change::atOnce) CHECK(rows[event].force_N == DVec3(0));
    double most_N = 0;
    for (std::size_t i = event; i < rows.size(); ++i) {
      const double step_N = glm::distance(rows[i].force_N, rows[i - 1].force_N);
      const double hand_N = kStiffness_N_per_mm * glm::distance(rows[i].hip, rows[i - 1].hip);
      most_N = std::max(most_N, step_N);
      if (row.change == Change::byHand) {
        CHECK(step_N <= std::max(kHand_N, hand_N) + 1e-9);
        CHECK(rows[i].force_N.z == within(kStiffness_N_per_mm * std::max(0.0, -rows[i].hip.z), 1e-9));
      }
      if (row.change == Change::bySurface) CHECK(step_N <= kSurface_N + hand_N + 1e-9);
      if (row.change == Change::fading) CHECK(step_N <= kFade_N + 1e-9);
    }
    CHECK(most_N > 0.9 * std::min({kSurface_N, kFade_N * 2.4 / 3.3}));
  }
}

}  // namespace palpate::force_table_test

// A hand that presses on a sphere while random commands reach its live session.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/haptics/device_doubles.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate {

/// A hand that presses with a newton and moves slowly over the surface; the thread that reads it is noted.
class PressingHand {
 public:
  static constexpr double kWanted_N = 1, kFastest_mm = 0.02;  // per tick

  PressingHand() : device_([this](double time_s) { return at(time_s); }, {.continuousForce_N = kTouchPeakForce_N}) {}

  OpenHand hand() { return {.device = &device_}; }
  std::size_t threads() const { return threads_.size(); }
  const DVec3& last_N() const { return device_.last_N; }

 private:
  DeviceState at(double time_s) {
    threads_.insert(std::this_thread::get_id());
    const double felt_N = isRead_ ? glm::length(device_.last_N) : 0;
    isRead_ = true;
    // From outside, and then with the force that it feels.
    radius_ -= std::clamp(0.1 * (kWanted_N - felt_N), -1.0, 1.0) * kFastest_mm;
    const double turn = 0.1 * std::sin(0.7 * time_s), tilt = 0.1 * std::sin(0.9 * time_s);
    return {.position = radius_ * glm::normalize(DVec3(turn, tilt, 1)), .ok = true};
  }

  std::set<std::thread::id> threads_;
  double radius_ = 50.2;
  bool isRead_ = false;
  ScriptedDevice device_;
};

/// Random commands of a person.
class RandomCommands {
 public:
  RandomCommands(Session& session, std::uint32_t seed, double stiffest_N_per_mm = kStiffest_N_per_mm)
      : session_(session), random_(seed), stiffest_N_per_mm_(stiffest_N_per_mm) {}

  void one() {
    ++count;
    BrushConfig brush = session_.config().brush.value_or(BrushConfig{});
    SurfaceConfig surface = session_.config().surface;
    ForceOptions force = session_.config().force;
    switch (std::uniform_int_distribution(0, 10)(random_)) {
      case 0:
        brush.kind = std::array{BrushKind::push, BrushKind::carve, BrushKind::inflate, BrushKind::smooth,
                                BrushKind::paint}[random_() % 5];
        return session_.setBrush(brush);
      case 1:
        brush.radius_mm = between(3, 8);
        return session_.setBrush(brush);
      case 2:
        brush.strength = between(0.02, 0.2);
        return session_.setBrush(brush);
      case 3:
        return session_.setBrush(std::nullopt);
      case 4:
        surface.kind = random_() % 2 ? SurfaceKind::average : SurfaceKind::sphere;
        return session_.setContact(surface, force, session_.config().backend.method);
      case 5:
        force.stiffness_N_per_mm = between(0.4 * stiffest_N_per_mm_, stiffest_N_per_mm_);
        return session_.setContact(surface, force, session_.config().backend.method);
      case 6:
        session_.undo(1, 0);
        return;
      case 7:
        session_.undo(0, 1);
        return;
      case 8:
        session_.setFrames(Session::Frames::pause);
        return;
      default:
        return layer();
    }
  }

  static constexpr double kStiffest_N_per_mm = 1.2;
  std::size_t count = 0;

 private:
  // Makes a layer of strokes, opens one, or slides one.
  void layer() {
    const StrokeLayers& layers = session_.scene().layers[0].attributes.strokeLayers();
    const std::size_t number = random_() % 3;
    if (number >= layers.size())
      return session_.setStrokeLayer(static_cast<std::uint32_t>(layers.size()), {.name = "layer"}, true);
    StrokeLayer set = layers[number];
    const bool opens = random_() % 3 == 0;
    if (!opens) set.strength = between(0, 1.5);
    session_.setStrokeLayer(static_cast<std::uint32_t>(number), std::move(set), opens, random_() % 2 == 0);
  }
  double between(double a, double b) { return std::uniform_real_distribution(a, b)(random_); }

  Session& session_;
  std::mt19937 random_;
  double stiffest_N_per_mm_;
};

/// Largest change of the force between two ticks beyond what the hand's motion explains, N, and ticks without force.
struct Felt {
  double most_N = 0, mostHand_N = 0;
  std::size_t without = 0, ticks = 0;
};

inline Felt feltIn(const std::vector<TraceRow>& rows, double from_s) {
  Felt felt;
  for (std::size_t i = 2; i < rows.size(); ++i) {
    if (rows[i].time_s < from_s) continue;
    const DVec3 way_mm = rows[i].hip - rows[i - 1].hip, before_mm = rows[i - 1].hip - rows[i - 2].hip;
    const double hand_N = RandomCommands::kStiffest_N_per_mm * glm::length(way_mm) +
                          ForceOptions{}.damping_N_s_per_mm * glm::distance(way_mm, before_mm) / 1e-3;
    felt.most_N = std::max(felt.most_N, glm::distance(rows[i].force_N, rows[i - 1].force_N) - hand_N);
    felt.mostHand_N = std::max(felt.mostHand_N, hand_N);
    felt.without += rows[i].force_N == DVec3(0);
    ++felt.ticks;
  }
  return felt;
}

inline SessionConfig stormy(const BackendKind& kind, const std::string& file) {
  SessionConfig config{.model = {.file = file}, .backend = {.name = std::string(kind.name()), .deterministic = kOnGpu}};
  config.brush = BrushConfig{.kind = BrushKind::push};
  config.realtime = true;
  return config;
}

}  // namespace palpate

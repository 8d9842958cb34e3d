// A person's session, with masks and fields of the points of a sphere.
#pragma once

#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <optional>

#include "engine/core/clock.hpp"
#include "haptics/session/interactive_session.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::kept_attributes_test {

inline constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

template <class T>
std::vector<std::byte> bytesOf(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

inline SessionConfig carving(const std::string& file) {
  SessionConfig config{.model = {.file = file}, .backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(1)};
  config.model.mm_per_unit = 1;
  config.brush = BrushConfig{.kind = BrushKind::carve, .yieldDepth_mm = 0.5, .radius_mm = 6};
  return config;
}

inline const LayerAttributes& attributesOf(const Session& session) { return session.scene().layers[0].attributes; }

/// What the existing points have, bit by bit.
inline std::vector<std::uint64_t> sumsOf(const Session& session) {
  return checksumsOf(attributesOf(session), session.history()->points());
}

/// A session of a person, on a clock of its own.
struct Person {
  explicit Person(const ScratchFolder& folder, const InteractiveOptions& more = {}, std::optional<Model> model = {})
      : file((folder / "sphere.ply").string()),
        session(carving(file), model ? std::move(*model) : sphereModel(),
                {.backend = *cpu, .threads = 1, .undo = {1 << 26}}, [&] {
                  InteractiveOptions options = more;
                  options.clock = clock;
                  return options;
                }()) {}
  void goOn(double duration_s) { CHECK_FALSE(session.tickUntil(until_s += duration_s)); }
  // Into the top of the sphere, and out again.
  void stroke() {
    const std::uint64_t before = session.session().strokes().strokes;
    session.aim({0, 0, 55});
    goOn(0.2);
    session.aim({0, 0, 46});
    goOn(0.3);
    session.lift();
    goOn(0.5);
    REQUIRE(session.session().strokes().strokes > before);
  }
  InteractiveSession::Saved save(const std::string& to) {
    session.save(to);
    const Stopwatch since;
    while (since.elapsed_s() < 60)
      if (auto saved = session.takeSaved()) return *saved;
    return {.failure = "not in time"};
  }
  std::vector<std::uint64_t> sums() const { return sumsOf(session.session()); }
  std::size_t undoCount() const { return session.session().strokes().undoCount; }

  std::unique_ptr<BackendKind> cpu = cpuBackend();
  std::shared_ptr<SteppedClock> clock = std::make_shared<SteppedClock>();
  double until_s = 0;
  std::string file;
  InteractiveSession session;
};

inline void setSome(Person& person, std::uint64_t from) {
  person.session.setMask(MaskRole::selected, PointSet::range(from, from + 1500));
  const std::uint32_t number = person.session.fieldNamed("number", ScalarType::i64);
  std::vector<std::int64_t> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = kLargest - static_cast<std::int64_t>(i * from);
  person.session.setField(number, PointSet::range(from, from + 1000), bytesOf(values));
}

}  // namespace palpate::kept_attributes_test

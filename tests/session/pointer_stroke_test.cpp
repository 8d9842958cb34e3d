// Strokes of a pointer in sessions on the CPU: the events decide, not when they come.
#include "haptics/session/pointer_stroke.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <random>

#include "haptics/session/interactive_session.hpp"
#include "tests/near.hpp"
#include "tests/session/session_scene.hpp"
#include "tests/touch/rim_scene.hpp"

namespace palpate::pointer_stroke_test {

namespace {

constexpr double kPress_mm = 2.5;
const DVec2 kSize_px(400, 300);
const Camera kCamera{.eye = {0, 0, 200}, .target = {0, 0, 0}};

/// Depth along a ray of the camera, whose direction has length 1 along the view; 0 beside the model.
using Shape = std::function<double(const DVec3& ray)>;

FoundSurface pictureOf(const Shape& shape) {
  std::vector<float> depths;
  for (double y = 0.5; y < kSize_px.y; ++y)
    for (double x = 0.5; x < kSize_px.x; ++x)
      depths.push_back(static_cast<float>(shape(kCamera.unproject({x, y}, 1, kSize_px) - kCamera.eye)));
  return FoundSurface({.depths = std::move(depths),
                       .width = static_cast<std::uint32_t>(kSize_px.x),
                       .camera = kCamera,
                       .size_px = kSize_px});
}

double sphereDepth(const DVec3& ray) {
  const double a = glm::dot(ray, ray), b = glm::dot(ray, kCamera.eye), c = kCamera.eye.z * kCamera.eye.z - 50 * 50;
  return b * b < a * c ? 0 : (-b - std::sqrt(b * b - a * c)) / a;
}

double sheetDepth(const DVec3& ray) {
  const DVec3 at = kCamera.eye + kCamera.eye.z * ray;
  return std::max(std::abs(at.x), std::abs(at.y)) > 20.5 ? 0 : kCamera.eye.z;
}

struct Subject {
  Model model;
  FoundSurface found;
};
Subject sphere() { return {sphereModel(), pictureOf(sphereDepth)}; }
Subject sheet() {
  return {{.cloud = openSheet(), .scale = {1}, .spacing = 1, .wideSpacing = 1}, pictureOf(sheetDepth)};
}

struct Event {
  double time_s = 0;
  DVec2 place_px{0};
};

/// A path of the pointer, with uneven times and pauses. The first event presses, the last one releases.
std::vector<Event> drag(const std::vector<DVec2>& corners_px, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> gap_s(0.001, 0.009);
  std::vector<Event> events{{0.3, corners_px.front()}};
  for (std::size_t k = 1; k < corners_px.size(); ++k)
    for (int i = 1; i <= 40; ++i)
      events.push_back({events.back().time_s + (i == 20 ? 0.15 : gap_s(random)),
                        glm::mix(corners_px[k - 1], corners_px[k], i / 40.0)});
  events.push_back({events.back().time_s + 0.02, events.back().place_px});
  return events;
}

/// How events and ticks reach the session.
struct Delivery {
  std::size_t bunch = 1;                 // of events
  std::optional<std::uint32_t> leftOut;  // seed by which frames and ticks are left out
};

struct Played {
  std::vector<PointState> points;
  std::vector<TraceRow> rows;
  std::uint64_t missed = 0;
};

Played play(const Subject& subject, BrushKind kind, const std::vector<Event>& events, const Delivery& how,
            double after_s = 1) {
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  SessionConfig config{.model = {.file = "cloud"}, .backend = {.name = "cpu"}};
  config.brush = BrushConfig{.kind = kind};
  InteractiveSession session(config, subject.model, {.backend = *cpu, .threads = 1}, {.clock = clock});
  std::mt19937 random(how.leftOut.value_or(0));
  double clock_s = 0;
  const auto goOn = [&](double duration_s) {
    if (how.leftOut && random() % 2) clock->passTo(clock_s + 0.8 * duration_s);
    session.tickUntil(clock_s += duration_s);
  };
  session.aim(DVec3(0, 0, 60), false);
  goOn(0.05);
  session.press(PointerStroke(subject.found, session.strokeOptions(kPress_mm), events[0].place_px, events[0].time_s));
  for (std::size_t i = 1; i < events.size();) {
    const double from_s = events[i - 1].time_s;
    const std::size_t bunch = how.leftOut ? 1 + random() % 30 : how.bunch, end = std::min(i + bunch, events.size());
    for (; i < end && i + 1 < events.size(); ++i) session.stroke()->moveTo(events[i].place_px, events[i].time_s);
    if (end == events.size()) {
      session.stroke()->release(events.back().time_s);
      i = end;
    }
    session.drawUntil(events[i - 1].time_s);
    if (!how.leftOut || random() % 3) goOn(events[i - 1].time_s - from_s);
  }
  for (int guard = 0; session.isDrawing() && guard < 500; ++guard) {
    session.drawUntil(events.back().time_s);
    goOn(0.02);
  }
  CHECK_FALSE(session.isDrawing());
  goOn(0.002);
  const std::uint64_t missed = session.recentTicks().missed();
  session.tickUntil(clock_s + after_s);
  Played played{.points = {session.history().points().begin(), session.history().points().end()},
                .rows = {session.recentTicks().rows().begin(), session.recentTicks().rows().end()},
                .missed = missed};
  CHECK_FALSE(session.follow());
  return played;
}

std::size_t changed(const Subject& subject, const Played& played) {
  const PointStates before(subject.model.cloud);
  std::size_t count = 0;
  for (const PointState& state : played.points)
    count += state.number >= before.size() || !(before[state.number] == state);
  return count;
}

const std::vector<DVec2> kAcross{{200, 150}, {240, 140}, {215, 180}};

}  // namespace

TEST_CASE("the same events make the same stroke, however they are bunched and whatever frames and ticks are left out") {
  for (const bool isSheet : {false, true}) {
    const Subject subject = isSheet ? sheet() : sphere();
    for (const BrushKind kind : {BrushKind::push, BrushKind::grab, BrushKind::paint}) {
      CAPTURE(isSheet);
      CAPTURE(kind);
      // On the sheet the second part of the path leaves the border, and comes back.
      const auto events = drag(isSheet ? std::vector<DVec2>{{200, 150}, {250, 150}, {210, 170}} : kAcross, 1);
      const Played single = play(subject, kind, events, {});
      CHECK(changed(subject, single) > 10);
      CHECK(single.missed == 0);
      const auto isSame = [&](const Played& other) { return other.points == single.points; };
      CHECK(isSame(play(subject, kind, events, {.bunch = 50})));
      std::uint64_t missed = 0;
      for (const std::uint32_t seed : {1u, 2u, 3u}) {
        CAPTURE(seed);
        const Played other = play(subject, kind, events, {.leftOut = seed});
        CHECK(isSame(other));
        missed += other.missed;
      }
      CHECK(missed > 100);
      CHECK_FALSE(isSame(play(subject, kind, drag(kAcross, 2), {})));
    }
  }
}

TEST_CASE("the stylus is never farther from its proxy than the stroke presses") {
  for (const bool isSheet : {false, true}) {
    const Subject subject = isSheet ? sheet() : sphere();
    for (const auto& [name, kind] : kBrushKinds) {
      CAPTURE(name);
      CAPTURE(isSheet);
      const auto events = drag({{200, 150}, {250, 150}, {180, 190}, {150, 100}}, 3);
      const double press_mm = kPress_mm + BrushConfig{}.yieldDepth_mm;
      double farthest = 0;
      for (const TraceRow& row : play(subject, kind, events, {}).rows)
        farthest = std::max(farthest, glm::distance(row.hip, row.proxy));
      const double risesInATick_mm = kind == BrushKind::inflate ? 0.02 : 1e-6;
      CHECK(farthest > (kind == BrushKind::grab ? 0.9 * BrushConfig{}.yieldDepth_mm : 0.5 * press_mm));
      CHECK(farthest < press_mm + risesInATick_mm);
    }
  }
}

TEST_CASE("a drag off an open border leaves no point above its surface") {
  const Subject subject = sheet();
  for (const auto& [name, kind] : kBrushKinds) {
    if (kind == BrushKind::inflate) continue;  // it raises
    for (const double y_px : {150.0, 120.0, 170.0}) {
      CAPTURE(name);
      CAPTURE(y_px);
      const auto events = drag({{200, y_px}, {300, y_px}, {205, y_px + 5}, {200, 290}}, 4);
      double highest = 0;
      for (const PointState& state : play(subject, kind, events, {}).points)
        if (!state.gone) highest = std::max(highest, static_cast<double>(state.position.z));
      CHECK(highest <= 0.6);
    }
  }
}

TEST_CASE("after the release nothing changes but what was drawn") {
  const Subject subject = sphere();
  const auto events = drag(kAcross, 5);
  for (const BrushKind kind : {BrushKind::push, BrushKind::grab, BrushKind::paint}) {
    CAPTURE(kind);
    const Played brief = play(subject, kind, events, {}, 1), longer = play(subject, kind, events, {}, 3);
    CHECK(brief.points == longer.points);
  }
  // A flick is followed to its end, though the button is up long before the stylus is there.
  const DVec2 end_px(240, 150);
  const auto rows = play(subject, BrushKind::push, {{0.3, {200, 150}}, {0.302, end_px}, {0.303, end_px}}, {}).rows;
  double reached = 0;
  for (const TraceRow& row : rows)
    if (row.contact) reached = std::max(reached, row.hip.x);
  const auto end = subject.found.at(end_px);
  const double depth = kPress_mm + BrushConfig{}.yieldDepth_mm;  // the model's unit is a millimetre
  const double expected = end->place.x - depth * end->outward.x;
  CHECK(reached > expected - kFastestHand_mm_per_s * 1e-3);  // the last tick in contact
  CHECK(reached < expected + 0.1);
}

TEST_CASE("a stroke is interrupted where the surface recedes in a step, not where it is steep") {
  const auto steps = [](const Shape& shape) {
    const FoundSurface found = pictureOf(shape);
    int count = 0;
    for (double x = 120; x < 280; x += 2) count += found.isStep(*found.at({x, 150}), *found.at({x + 2, 150}), 2, 2);
    return count;
  };
  // Depths by the place on a plane in front of the eye: `way` is across, in mm.
  const auto over = [](const std::function<double(double way)>& height) {
    return [height](const DVec3& ray) { return kCamera.eye.z - height(kCamera.eye.z * ray.x); };
  };
  CHECK(steps(over([](double) { return 0; })) == 0);
  CHECK(steps(over([](double way) { return way < 10 ? 0 : -8; })) == 1);
  CHECK(steps(over([](double way) { return 10 * std::clamp(way, -5.0, 5.0); })) == 0);  // a wall of 84 degrees
  CHECK(steps(over([](double way) { return 30 * std::sin(0.5 * way); })) == 0);         // folds
  CHECK(steps(over([](double way) { return 30 * std::sin(0.5 * way) + (way < 0 ? 0 : 60); })) == 1);
}

TEST_CASE("beside the model and behind a step the stylus is put down again, in the same stroke") {
  const Subject subject = sheet();
  const auto events = drag({{200, 150}, {300, 150}, {205, 160}}, 6);
  const auto rows = play(subject, BrushKind::push, events, {}).rows;
  int putDowns = 0, pressed = 0;
  bool wasLifted = false;
  for (const TraceRow& row : rows) {
    putDowns += row.putDown;
    wasLifted = wasLifted || (row.putDown && putDowns > 2);
    pressed += row.contact && wasLifted;
  }
  CHECK(putDowns >= 4);  // at the first aim, at the press, when lifted, when put down again
  CHECK(pressed > 50);
}

TEST_CASE("what is grabbed moves parallel to the picture, as far as the pointer, and no faster than a hand") {
  const Subject subject = sphere();
  const std::vector<Event> events{{0.3, {200, 150}}, {0.5, {205, 150}}, {0.6, {280, 150}}, {1.2, {280, 150}}};
  const auto rows = play(subject, BrushKind::grab, events, {}).rows;
  const auto isJump = [](const TraceRow& row) { return row.putDown; };
  const auto lifted = std::find_if(rows.rbegin(), rows.rend(), isJump) + 1;  // the last hover, after the end
  const auto ended = std::find_if(lifted, rows.rend(), isJump);
  const auto pressed = std::find_if(ended + 1, rows.rend(), isJump);
  double fastest = 0, lowest = 100, highest = -100;
  for (auto row = ended + 1; row + 1 < pressed; ++row) {
    fastest = std::max(fastest, glm::distance(row->hip, (row + 1)->hip));
    if (row->hip.x < 0.5) continue;
    lowest = std::min(lowest, row->hip.z);
    highest = std::max(highest, row->hip.z);
  }
  const double pixel = 150 / kCamera.focal_px(kSize_px.y);
  CHECK(fastest == near(0.6, 0.001));
  CHECK(highest - lowest < 0.1);
  CHECK((ended + 1)->hip.x == near(80 * pixel, 0.01));
}

TEST_CASE("what is grabbed stays where it is until the pointer moves, and is not pressed in by a drag aside") {
  const double pixel = 150 / kCamera.focal_px(kSize_px.y);
  for (const bool isSheet : {false, true}) {
    const Subject subject = isSheet ? sheet() : sphere();
    const PointStates before(subject.model.cloud);
    for (const double way_px : {0.0, 4.0}) {
      CAPTURE(isSheet);
      CAPTURE(way_px);
      const std::vector<Event> events{
          {0.3, {200, 150}}, {0.6, {200, 150}}, {0.7, {200 + way_px, 150}}, {1.2, {200 + way_px, 150}}};
      const Played played = play(subject, BrushKind::grab, events, {});
      double deepest = 0, aside = 0;
      for (const PointState& state : played.points) {
        if (state.number >= before.size()) continue;
        const DVec3 moved = DVec3(state.position) - DVec3(before[state.number].position);
        deepest = std::max(deepest, -moved.z);
        aside = std::max(aside, moved.x);
      }
      CHECK(deepest < 0.05);
      CHECK((changed(subject, played) == 0) == (way_px == 0));
      const double merged = isSheet && way_px > 0 ? 0.5 * subject.model.spacing : 0.01;
      CHECK(aside == within(way_px * pixel, 0.2 * way_px * pixel + merged));
    }
  }
}

TEST_CASE("a steadied stroke follows a trembling pointer by a string, and ends where the string has pulled it") {
  for (const double string_px : {0.0, 30.0}) {
    CAPTURE(string_px);
    const StrokeOptions options{.inward = kPress_mm, .string_px = string_px};
    PointerStroke stroke(pictureOf(sheetDepth), options, {180, 150}, 0);
    double time_s = 0;
    for (int x = 181; x <= 230; ++x) stroke.moveTo({x, x == 230 ? 150 : 150 + (x % 2 ? 6 : -6)}, time_s += 0.01);
    stroke.release(time_s + 0.1);
    double trembles = 0;
    std::optional<DVec2> last_px;
    while (!stroke.isOver())
      if (const auto pose = stroke.next()) {
        const auto at_px = kCamera.project(pose->place, kSize_px);
        REQUIRE(at_px);
        last_px = DVec2(*at_px);
        if (last_px->x > 190) trembles = std::max(trembles, std::abs(last_px->y - 150));
      }
    REQUIRE(last_px);
    CHECK(last_px->x == within(230 - string_px, 1.5));
    CHECK((string_px > 0 ? trembles < 1.5 : trembles > 5));
  }
}

}  // namespace palpate::pointer_stroke_test

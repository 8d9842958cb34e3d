#include "apps/bench/touch_judge.hpp"

#include <algorithm>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/worker_team.hpp"
#include "haptics/force_law.hpp"

namespace palpate {

namespace {

constexpr double kRate_Hz = 1000;
constexpr double kIdealStep_mm = 0.05;  // step of the god-object
constexpr double kLift_mm = 3;          // above the height from which no force is allowed
constexpr double kSlide_mm = 30, kLongestSlide_s = 2;
constexpr double kTapSpeed_mm_per_s = 100, kPressDepth_mm = 2;

// The spring alone: damping, limits and ramps would hide the surface's behaviour.
ForceLaw plainSpring(double stiffness_N_per_mm, const ModelScale& scale) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {{.stiffness_N_per_mm = stiffness_N_per_mm,
           .damping_N_s_per_mm = 0,
           .maxForce_N = kNone,
           .maxRise_N_per_s = kNone},
          scale};
}

std::vector<DVec3> hipsAlong(const Path& path, double to_s) {
  std::vector<DVec3> hips;
  for (std::uint64_t i = 0; static_cast<double>(i) / kRate_Hz <= to_s; ++i)
    hips.push_back(path.at(static_cast<double>(i) / kRate_Hz));
  return hips;
}

// Runs in virtual time; `observer` sees the trace after each tick.
template <class Observer>
Trace play(TouchBackend& backend, const std::vector<DVec3>& hips, ForceLaw law, Observer&& observer) {
  Trace trace;
  for (std::size_t i = 0; i < hips.size(); ++i) {
    const Pose pose{.time_s = static_cast<double>(i) / kRate_Hz, .hip = hips[i]};
    const Stopwatch watch;
    const Contact contact = backend.query(pose, 0);
    const DVec3 force_N = law.update(contact, pose, 1 / kRate_Hz);
    if (!contact.valid) backend.finish();  // throws the back end's failure
    trace.rows.push_back({.time_s = pose.time_s,
                          .hip = pose.hip,
                          .proxy = contact.proxy,
                          .normal = contact.normal,
                          .force_N = force_N,
                          .penetration_mm = law.scale().toMm(glm::distance(contact.proxy, pose.hip)),
                          .contact = contact.touching,
                          .fresh = contact.fresh,
                          .valid = contact.valid,
                          .neighbours = contact.neighbours,
                          .gpu_us = contact.gpu_us,
                          .step_us = watch.elapsed_us()});
    observer(trace);
  }
  backend.finish();
  return trace;
}

Trace play(TouchBackend& backend, const std::vector<DVec3>& hips, const ForceLaw& law) {
  return play(backend, hips, law, [](const Trace&) {});
}

// Uses a back end of its own.
Trace feel(Context& context, const Model& model, const JudgePath& way, const BenchBackend& options,
           double stiffness_N_per_mm) {
  Session session = startSession(context, model, options);
  return play(session.backend(), hipsAlong(way.path.path, way.path.path.duration_s()),
              plainSpring(stiffness_N_per_mm, model.scale));
}

SlideJudgement judgeSlides(const std::vector<JudgedTicks>& ways, double speed_mm_per_s, const JudgeOptions& options,
                           const ModelScale& scale, double spacing) {
  std::vector<JudgedTick> all;
  for (const JudgedTicks& way : ways) all.insert(all.end(), way.begin(), way.end());
  SlideJudgement result{.speed_mm_per_s = speed_mm_per_s,
                        .heldShare = heldShare(all),
                        .angle = angleError(all),
                        .height = heightError(all, scale),
                        .forceError = forceError(all, options.stiffness_N_per_mm, scale),
                        .tangentialShare = tangentialShare(all)};
  // These compare successive ticks, so each path is judged alone.
  const double share = 1 / static_cast<double>(ways.size());
  double roughPower = 0, roughPowerOffEdges = 0, powerOffEdges = 0;
  for (const JudgedTicks& way : ways) {
    const Continuity steady = continuity(way, kRate_Hz, spacing);
    result.continuity.p99_N_per_s += share * steady.p99_N_per_s;
    result.continuity.max_N_per_s = std::max(result.continuity.max_N_per_s, steady.max_N_per_s);
    result.continuity.power += steady.power;
    roughPower += steady.roughShare * steady.power;
    const Continuity offEdges = continuityOffEdges(way, kRate_Hz);
    powerOffEdges += offEdges.power;
    roughPowerOffEdges += offEdges.roughShare * offEdges.power;
    const Lag lag = lagBehind(way, scale);
    result.lag.count += lag.count;
    result.lag.mean_mm += share * lag.mean_mm;
    result.lag.max_mm = std::max(result.lag.max_mm, lag.max_mm);
    result.lag.delay_ms += share * lag.delay_ms;
  }
  if (result.continuity.power > 0) result.continuity.roughShare = roughPower / result.continuity.power;
  if (powerOffEdges > 0) result.roughOffEdges = roughPowerOffEdges / powerOffEdges;
  return result;
}

std::vector<DVec2> forces(JudgedTicks way, double stiffness_N_per_mm, const ModelScale& scale) {
  std::vector<DVec2> pairs;
  for (const JudgedTick& tick : way)
    pairs.emplace_back(
        glm::length(tick.row.force_N),
        tick.shouldTouch ? stiffness_N_per_mm * scale.toMm(glm::distance(tick.row.hip, tick.truth.position)) : 0);
  return pairs;
}

PointCloud plateCloud(std::size_t points, double thickness_mm, unsigned threads) {
  PointCloud plate;
  for (const double side : {1.0, -1.0}) {
    const auto plane = makeShape("plane", 100, {0, 0, 0.5 * side * thickness_mm});
    const PointCloud half = sampleShape(*plane, {.count = points / 2, .seed = side > 0 ? 1u : 2u, .threads = threads});
    plate.positions.insert(plate.positions.end(), half.positions.begin(), half.positions.end());
    for (const Vec3& normal : half.normals) plate.normals.push_back(static_cast<float>(side) * normal);
  }
  return plate;
}

}  // namespace

JudgePlan planFor(Context& context, const JudgeSubject& subject, double widestRadius, const JudgeOptions& options) {
  const ModelScale& scale = subject.model.scale;
  JudgePlan plan{.freeMargin = widestRadius + 5 * subject.noise};
  const double lift_mm = kLift_mm + scale.toMm(plan.freeMargin);
  const SurfacePoint& place = subject.starts.front().place;
  const TruthPathOptions tap{.depth_mm = options.depth_mm, .lift_mm = lift_mm, .speed_mm_per_s = kTapSpeed_mm_per_s};
  plan.ways.push_back({truthTaps(place, scale, tap), {}});
  plan.ways.push_back({truthPress(place, scale, {.depth_mm = kPressDepth_mm, .lift_mm = lift_mm}), {}});
  for (const double speed : options.speeds_mm_per_s)
    for (const JudgeSubject::Start& start : subject.starts) {
      const TruthPathOptions slide{.depth_mm = options.depth_mm,
                                   .lift_mm = lift_mm,
                                   .speed_mm_per_s = speed,
                                   .length_mm = std::min(kSlide_mm, kLongestSlide_s * speed)};
      plan.ways.push_back({truthSlide(subject.truth, start.place, start.towards, scale, slide), {}});
    }
  WorkerTeam team(context.threads());
  team.forEach(plan.ways.size(), [&](std::size_t k) {
    const Path& path = plan.ways[k].path.path;
    plan.ways[k].ideal =
        followTruth(hipsAlong(path, path.duration_s()), subject.truth, scale.toUnits(kIdealStep_mm), widestRadius);
  });
  return plan;
}

Judgement judgeTouch(Context& context, const JudgeSubject& subject, const JudgePlan& plan, const BenchBackend& backend,
                     const JudgeOptions& options) {
  const ModelScale& scale = subject.model.scale;
  Judgement result{.backend = backend.backend,
                   .surface = backend.surface,
                   .subject = subject.name,
                   .condition = subject.condition,
                   .points = subject.model.cloud.size(),
                   .spacing_mm = scale.toMm(subject.model.spacing),
                   .radius_mm = scale.toMm(surfaceOptions(context, subject.model, backend).radius),
                   .noise_spacings = subject.model.noise,
                   .friction = backend.friction};
  // Everything is felt first, one path after the other, since ticks are timed; then it is judged on all cores.
  std::vector<Trace> traces;
  for (const JudgePath& way : plan.ways)
    traces.push_back(feel(context, subject.model, way, backend, options.stiffness_N_per_mm));
  std::vector<std::vector<JudgedTick>> judged(plan.ways.size());
  WorkerTeam team(context.threads());
  team.forEach(plan.ways.size(),
               [&](std::size_t k) { judged[k] = judge(traces[k], plan.ways[k].ideal, subject.truth); });
  const auto window = [&](std::size_t k) {
    return between(judged[k], plan.ways[k].path.from_s, plan.ways[k].path.to_s);
  };

  std::size_t next = JudgePlan::kSlides;
  for (const double speed : options.speeds_mm_per_s) {
    const std::size_t first = next;
    std::vector<JudgedTicks> windows;
    while (windows.size() < subject.starts.size()) windows.push_back(window(next++));
    result.slides.push_back(judgeSlides(windows, speed, options, scale, subject.model.spacing));
    if (speed != options.mainSpeed_mm_per_s) continue;
    result.force_N = forces(windows.front(), options.stiffness_N_per_mm, scale);
    const auto again = [&](const BenchBackend& on) {
      return feel(context, subject.model, plan.ways[first], on, options.stiffness_N_per_mm);
    };
    result.identical = identical(traces[first], again(backend));
    BenchBackend onCpu = backend;
    onCpu.backend = "cpu";
    onCpu.method.clear();
    if (backend.backend != "cpu") result.fromCpu_N = forceDifference_N(traces[first], again(onCpu));
  }
  result.drift_mm = drift_mm(window(JudgePlan::kPress), scale);
  std::vector<JudgedTick> everyTick;
  for (const auto& ticks : judged) everyTick.insert(everyTick.end(), ticks.begin(), ticks.end());
  std::vector<double> step_us;
  step_us.reserve(everyTick.size());
  for (const JudgedTick& tick : everyTick) step_us.push_back(tick.row.step_us);
  result.step_us = summarize(std::move(step_us));
  result.lateShare = lateShare(everyTick, 1e6 / kRate_Hz);
  result.free_N = freeForce_N(everyTick, plan.freeMargin);
  return result;
}

EditJudgement judgeEdit(Context& context, const JudgeSubject& subject, const BenchBackend& backend,
                        const JudgeOptions& options) {
  constexpr double kTolerance_N = 1e-3;  // far below the smallest force that a hand can feel
  const ModelScale& scale = subject.model.scale;
  const BrushConfig push{.yieldDepth_mm = 0.3, .pushRate = 0.1, .radius_mm = 6};
  const TruthPath press = truthPress(subject.starts.front().place, scale, {.depth_mm = kPressDepth_mm});
  // The hand does not wait until the surface has fully yielded: it turns back while edits still occur.
  const double rest_s = 0.05;
  const double down_s = press.to_s - 0.25, up_s = press.path.duration_s() - press.to_s;
  const Path path({{0, press.path.at(0)},
                   {down_s, press.path.at(press.to_s)},
                   {down_s + rest_s, press.path.at(press.to_s)},
                   {down_s + rest_s + up_s, press.path.at(press.path.duration_s())}});
  const auto hips = hipsAlong(path, path.duration_s());
  const ForceLaw law = plainSpring(options.stiffness_N_per_mm, scale);

  EditJudgement result;
  Model sculpted = subject.model;
  std::size_t lastEdited = 0;
  Session session = startSession(context, subject.model, backend, {.brush = push});
  TouchBackend& edited = session.backend();
  const Trace after = play(edited, hips, law, [&](const Trace& trace) {
    if (edited.report().editTimes_us.size() > result.edits) lastEdited = trace.rows.size() - 1;
    result.edits = edited.report().editTimes_us.size();
  });
  edited.readBack(sculpted.cloud);
  Session fresh = startSession(context, sculpted, backend);
  const Trace replayed = play(fresh.backend(), hips, law);
  result.ticksUntilEqual = ticksUntilEqual(after, replayed, lastEdited, kTolerance_N);
  result.largestStep_N = largestForceStep_N(after);
  return result;
}

std::vector<PlateJudgement> judgePlates(Context& context, std::size_t points, const BenchBackend& backend) {
  constexpr std::size_t kPushes = 16;
  constexpr double kBeyond_mm = 2, kSlant = 0.3;  // the latter as a tangent, maximum
  std::vector<PlateJudgement> results;
  Model model;
  model.cloud = plateCloud(points, 0, context.threads());
  model.spacing = 100 / std::sqrt(static_cast<double>(points / 2));  // of one side; the other side must not change R
  const double radius_mm = supportRadius(backend.radius, model);
  for (const double thicknessOverRadius : {0.25, 0.5, 1.0, 1.5, 2.0}) {
    const double thickness_mm = thicknessOverRadius * radius_mm;
    model.cloud = plateCloud(points, thickness_mm, context.threads());
    for (const double speed : {50.0, 200.0, 1000.0}) {
      std::size_t through = 0;
      for (std::uint64_t i = 0; i < kPushes; ++i) {
        const auto number = [&](std::uint64_t k) { return 2 * randomUnit(17, 4 * i + k) - 1; };
        const SurfacePoint place{{30 * number(0), 30 * number(1), 0.5 * thickness_mm},
                                 glm::normalize(DVec3(kSlant * number(2), kSlant * number(3), 1))};
        const TruthPath push = truthPress(
            place, {1},
            {.depth_mm = thickness_mm + kBeyond_mm, .lift_mm = radius_mm + kLift_mm, .speed_mm_per_s = speed});
        Session plate = startSession(context, model, backend);
        const Trace trace = play(plate.backend(), hipsAlong(push.path, push.to_s), plainSpring(1, {1}));
        through += cameThrough(trace, DVec3(0), DVec3(0, 0, 1));
      }
      results.push_back({.backend = backend.backend,
                         .surface = backend.surface,
                         .thicknessOverRadius = thicknessOverRadius,
                         .speed_mm_per_s = speed,
                         .pushes = kPushes,
                         .throughShare = static_cast<double>(through) / kPushes});
    }
  }
  return results;
}

}  // namespace palpate

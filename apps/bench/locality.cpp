#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "apps/bench/bench.hpp"
#include "apps/bench/edit_locality.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/study/uneven_clouds.hpp"
#include "haptics/session/sculpting_hand.hpp"
#include "haptics/surface_walk.hpp"

namespace palpate {

namespace {

constexpr double kQueryRate_Hz = 1000;
constexpr double kAbove_mm = 3, kDown_mm_per_s = 25, kAlong_mm_per_s = 50;
constexpr double kQuerySlide_mm = 20, kQueryStep_mm = 0.5;
constexpr int kDirections = 8;
constexpr double kTau_mm = 0.5, kBeta = 0.1, kStrength = 0.5;  // as in touch
constexpr double kDepthSlack_mm = 0.4, kMaxRaised_mm = 0.3;
// Support radii: the brush's axis and the surface over the hand are computed differently here than in the session.
constexpr double kWaySlack = 0.12;
constexpr std::size_t kIdleTicks = 100;
constexpr double kIdleDeeper_mm = 1;  // below the stroke, so that the brush acts in the dent that the stroke left
constexpr std::size_t kMaxSettling = 400, kQuiet = 24, kDrain = 8;  // ticks
constexpr std::int64_t kUsualPoints = 15'000;

struct LocalityBenchOptions : BenchOptions {
  std::vector<std::string> clouds, brushes, gestures{"press", "slide"};
  double hold_s = 2, brushRadius_mm = 3, depth_mm = 3;
};

struct LocalitySubject {
  std::string name;
  Model model;
  std::vector<SurfaceSpot> way;  // path of a slide, starting where the press is; relative to the cloud's origin
  bool isDeep = true;            // thicker than the brush goes deep
};

std::vector<SurfaceSpot> wayFrom(const ThinnedCloud& surface, const SurfaceSpot& start, const DVec3& towards,
                                 const ModelScale& scale) {
  std::vector<SurfaceSpot> way{start};
  const auto spots = walk(surface, start, towards, scale.toUnits(kQueryStep_mm),
                          static_cast<std::size_t>(kQuerySlide_mm / kQueryStep_mm));
  way.insert(way.end(), spots.begin(), spots.end());
  return way;
}

// Of a few directions, the one along which the surface continues and bends least.
std::vector<SurfaceSpot> wayOn(const Model& model) {
  const WalkedSurface surface(model.cloud);
  const SurfaceSpot& start = surface.best;
  const Frame3 frame = frameAround(start.normal);
  std::vector<SurfaceSpot> best;
  double most = -1e9;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * std::numbers::pi * k / kDirections;
    auto way = wayFrom(surface.points, start, std::cos(angle) * frame.u + std::sin(angle) * frame.v, model.scale);
    double score = 0;
    for (const SurfaceSpot& spot : way) score += spot.supported ? glm::dot(spot.normal, start.normal) : -4;
    if (score <= most) continue;
    most = score;
    best = std::move(way);
  }
  return best;
}

LocalitySubject fileSubject(Context& context, const std::string& file, EstimateOn where) {
  LocalitySubject subject{.name = std::filesystem::path(file).stem().string(),
                          .model = loadModel(context, {.file = file}, where),
                          .way = {}};
  subject.way = wayOn(subject.model);
  return subject;
}

LocalitySubject unevenSubject(Context& context, const std::string& name, std::size_t count) {
  UnevenCloud uneven = makeUnevenCloud(name, count);
  LocalitySubject subject{.name = name, .model = {.cloud = std::move(uneven.cloud), .scale = {1}}, .way = {}};
  const SpacingRange spacing = spacingRange(subject.model.cloud, context.threads());
  subject.model.spacing = spacing.mean;
  subject.model.wideSpacing = spacing.wide;
  subject.model.noise = spacing.noise;
  subject.isDeep = name != "plate";
  subject.way = wayFrom(ThinnedCloud(subject.model.cloud, kWalkedPoints),
                        {.position = uneven.place, .normal = uneven.normal}, uneven.towards, subject.model.scale);
  return subject;
}

// HIP position in a tick, and the surface over it; relative to the cloud's origin.
struct HipPlace {
  DVec3 hip{0}, on{0}, normal{0};
};

// The HIP's positions, one for each tick.
class HipWay {
 public:
  HipWay(const SurfaceSpot& over, double height) : places_{at(over, height)} {}

  void moveTo(const SurfaceSpot& over, double height, double speed) {  // units per second
    const HipPlace start = places_.back(), end = at(over, height);
    const auto ticks = static_cast<int>(std::ceil(glm::distance(start.hip, end.hip) / speed * kQueryRate_Hz));
    for (int k = 1; k <= ticks; ++k) {
      const double share = static_cast<double>(k) / ticks;
      places_.push_back({.hip = glm::mix(start.hip, end.hip, share),
                         .on = glm::mix(start.on, end.on, share),
                         .normal = glm::normalize(glm::mix(start.normal, end.normal, share))});
    }
  }
  void rest(std::size_t ticks) { places_.insert(places_.end(), ticks, places_.back()); }
  const std::vector<HipPlace>& places() const { return places_; }

 private:
  static HipPlace at(const SurfaceSpot& over, double height) {
    return {over.position + height * over.normal, over.position, over.normal};
  }
  std::vector<HipPlace> places_;
};

// Mean normal over the brush on the surface before any stroke, of the points that face the same way. The last result is
// reused for nearby positions.
class FoundAxes {
 public:
  FoundAxes(const PointCloud& cloud, double radius) : cloud_(cloud), tree_(cloud.positions), radius_(radius) {}

  DVec3 axisAt(const HipPlace& place) {
    if (last_ && glm::distance(last_->first, place.on) < kSamePlace * radius_) return last_->second;
    found_.clear();
    tree_.near(place.on, radius_, found_);
    DVec3 sum(0);
    for (const std::uint32_t i : found_) {
      const DVec3 normal(cloud_.normals[i]), offset = (DVec3(cloud_.positions[i]) - place.on) / radius_;
      if (glm::dot(normal, place.normal) > kFaces) sum += (1 - glm::dot(offset, offset)) * normal;
    }
    const DVec3 axis = glm::length(sum) > 0 ? glm::normalize(sum) : place.normal;
    last_.emplace(place.on, axis);
    return axis;
  }

 private:
  static constexpr double kSamePlace = 0.01, kFaces = 0.2;
  const PointCloud& cloud_;
  PointTree tree_;
  double radius_;
  std::vector<std::uint32_t> found_;
  std::optional<std::pair<DVec3, DVec3>> last_;
};

std::vector<HipPlace> pressHips(const LocalitySubject& subject, double depth_mm, std::size_t restTicks) {
  const ModelScale& scale = subject.model.scale;
  const SurfaceSpot& spot = subject.way.front();
  HipWay way(spot, scale.toUnits(kAbove_mm));
  way.moveTo(spot, -scale.toUnits(depth_mm), scale.toUnits(kDown_mm_per_s));
  way.rest(restTicks);
  return way.places();
}

std::vector<HipPlace> slideHips(const LocalitySubject& subject, double depth_mm) {
  const ModelScale& scale = subject.model.scale;
  HipWay way(subject.way.front(), scale.toUnits(kAbove_mm));
  for (const SurfaceSpot& next : subject.way)
    way.moveTo(next, -scale.toUnits(depth_mm),
               scale.toUnits(&next == &subject.way.front() ? kDown_mm_per_s : kAlong_mm_per_s));
  return way.places();
}

// The brush of a stroke; `idle`: the same brush without any effect.
BrushConfig brushFor(BrushKind kind, const LocalityBenchOptions& options, bool idle) {
  return {.kind = kind,
          .yieldDepth_mm = kTau_mm,
          .pushRate = idle ? 0 : kBeta,
          .radius_mm = options.brushRadius_mm,
          .strength = idle ? 0 : kStrength};
}

// Moves the brush of a session that keeps a journal, in virtual time, and tracks the state of the points.
class Play {
 public:
  Play(Session& session, FoundAxes& axes) : session_(session), origin_(session.model().cloud.origin), axes_(axes) {}

  std::span<const PointState> points() { return session_.journal()->points(); }
  /// Centres of the brush's ball, one for each acting tick since the last begin().
  const std::vector<DVec3>& centers() const { return centers_; }

  void begin(const BrushConfig& brush) {
    session_.setBrush(brush);
    brush_ = brushOptions(brush, session_.model().scale);
    centers_.clear();
  }
  void follow(const std::vector<HipPlace>& places) {
    for (const HipPlace& place : places) tick(place);
    finish();
  }
  /// Lifts the hand to `hip` and waits until nothing changes any more. Returns the number of ticks until the last
  /// change, and false if changes did not end.
  std::pair<std::size_t, bool> settle(const DVec3& hip) {
    std::size_t last = 0;
    for (std::size_t ticks = 0; ticks < kMaxSettling; ticks += kDrain) {
      if (ticks - last >= kQuiet) return {last, true};
      std::size_t states = 0;
      for (std::size_t k = 0; k < kDrain; ++k) states += tick({hip, hip, DVec3(0)});
      states += finish();
      if (states > 0) last = ticks + kDrain;
    }
    return {last, false};
  }

 private:
  std::size_t tick(const HipPlace& place) {
    TouchBackend& backend = session_.backend();
    const Contact contact =
        backend.query({.time_s = static_cast<double>(ticks_++) / kQueryRate_Hz, .hip = origin_ + place.hip}, 0);
    if (!contact.valid) backend.finish();  // throws the back end's failure
    // As in engine/core/brush.hpp: a ball whose tip is the yield depth before the HIP, or a ball about the surface
    // position over the hand.
    const bool tip = brushHas(brush_.kind, shared::kHasShaft);
    if (contact.touching && glm::distance(contact.proxy, origin_ + place.hip) > brush_.yieldDepth)
      centers_.push_back(tip ? place.hip + (brush_.yieldDepth + brush_.radius) * axes_.axisAt(place) : place.on);
    return ticks_ % kDrain == 0 ? drain() : 0;
  }
  std::size_t finish() {
    session_.finish();
    return session_.lastEdits().points.size();
  }
  std::size_t drain() {
    session_.catchUp();
    return session_.lastEdits().points.size();
  }

  Session& session_;
  DVec3 origin_;
  FoundAxes& axes_;
  BrushOptions brush_;
  std::vector<DVec3> centers_;
  std::uint64_t ticks_ = 0;
};

IdleRecord pressIdly(Play& play, const LocalitySubject& subject, const BrushConfig& idle, double depth_mm) {
  const std::vector<PointState> before(play.points().begin(), play.points().end());
  play.begin(idle);
  play.follow(pressHips(subject, depth_mm, kIdleTicks));
  play.settle(subject.way.front().position + subject.model.scale.toUnits(2 * kAbove_mm) * subject.way.front().normal);
  const auto after = play.points();
  IdleRecord record{.ticks = play.centers().size()};
  for (std::size_t i = 0; i < after.size(); ++i) {
    const bool wasThere = i < before.size() && !before[i].gone();
    record.inserted += !wasThere && !after[i].gone();
    record.removed += wasThere && after[i].gone();
    record.moved += wasThere && !after[i].gone() && after[i].position != before[i].position;
  }
  return record;
}

StrokeRecord playStroke(Context& context, const LocalitySubject& subject, EditJudge& judge, const StrokeRecord& what,
                        const LocalityBenchOptions& options) {
  const Model& model = subject.model;
  const BrushKind kind = *valueNamed(kBrushKinds, what.brush);
  const BrushConfig brush = brushFor(kind, options, false), idle = brushFor(kind, options, true);
  BenchBackend way = options.backend;
  way.backend = what.backend;
  Session session = startSession(context, model, way, {.brush = brush, .journal = true});
  const double support = session.surface().radius / session.surface().widening;  // edits do not widen the radius

  StrokeRecord record = what;
  record.points = model.cloud.size();
  record.spacing_mm = model.scale.toMm(model.spacing);
  record.radius_mm = model.scale.toMm(support);
  record.brushRadius_mm = options.brushRadius_mm;
  record.carves = brushHas(kind, shared::kRemovesPoints);
  FoundAxes axes(model.cloud, model.scale.toUnits(options.brushRadius_mm));
  Play play(session, axes);
  record.before = pressIdly(play, subject, idle, options.depth_mm);

  const auto hips = what.gesture == "press"
                        ? pressHips(subject, options.depth_mm, static_cast<std::size_t>(options.hold_s * kQueryRate_Hz))
                        : slideHips(subject, options.depth_mm);
  play.begin(brush);
  play.follow(hips);
  record.ticks = hips.size();
  const std::vector<DVec3> centers = play.centers();
  record.acting = centers.size();
  const SurfaceSpot& end = what.gesture == "press" ? subject.way.front() : subject.way.back();
  play.begin(idle);  // the lifted hand may be inside another part of the model
  std::tie(record.settling, record.settled) =
      play.settle(end.position + model.scale.toUnits(2 * kAbove_mm) * end.normal);
  const bool presses = brushHas(kind, shared::kHasShaft);
  record.verdict =
      judge.judge(play.points(),
                  {.centers = centers,
                   .radius = model.scale.toUnits(brush.radius_mm),
                   .support = support,
                   .reachSlack = kWaySlack,
                   .carves = record.carves,
                   .pushes = presses && !record.carves,
                   .depth = presses && subject.isDeep ? std::optional(model.scale.toUnits(options.depth_mm - kTau_mm))
                                                      : std::nullopt,
                   .depthSlack = model.scale.toUnits(kDepthSlack_mm),
                   .mostRaised = presses ? std::optional(model.scale.toUnits(kMaxRaised_mm)) : std::nullopt});
  record.deepest_mm = model.scale.toMm(record.verdict.deepest);
  record.highest_mm = model.scale.toMm(record.verdict.highest);
  record.after = pressIdly(play, subject, idle, options.depth_mm + kIdleDeeper_mm);
  return record;
}

Json benchLocality(Context& context, const LocalityBenchOptions& options) {
  const EstimateOn where = options.wants("vulkan") ? EstimateOn::gpu : EstimateOn::cpu;
  std::vector<std::function<LocalitySubject()>> subjects;
  for (const std::string& file : options.models)
    subjects.emplace_back([&context, file, where] { return fileSubject(context, file, where); });
  const std::vector<std::int64_t> sizes = options.sizes.empty() ? std::vector{kUsualPoints} : options.sizes;
  for (const std::int64_t size : sizes)
    for (const std::string& cloud : options.clouds)
      if (cloud != "none")
        subjects.emplace_back(
            [&context, cloud, size] { return unevenSubject(context, cloud, static_cast<std::size_t>(size)); });
  if (subjects.empty()) throw UsageError("bench locality: --clouds none requires --models");
  LocalityResults results;
  printStrokeHeading(context.tables());
  for (const auto& makeOne : subjects) {
    const LocalitySubject subject = makeOne();
    EditJudge judge(subject.model.cloud);
    for (const std::string& backend : options.backends)
      for (const std::string& brush : options.brushes)
        for (const std::string& gesture : options.gestures) {
          context.log().say("locality: {}, {} points, {}, {}, {}", subject.name, subject.model.cloud.size(), backend,
                            brush, gesture);
          results.strokes.push_back(
              playStroke(context, subject, judge,
                         {.subject = subject.name, .backend = backend, .brush = brush, .gesture = gesture}, options));
          printStroke(context.tables(), results.strokes.back());
        }
  }
  fmt::print(context.tables(),
             "\n{} of {} strokes meet all requirements within the judge's tolerance, {} without any tolerance\n",
             results.strokes.size() - results.broken(), results.strokes.size(),
             results.strokes.size() - results.broken(true));
  return toJson(results);
}

void addOptions(Options& bench, LocalityBenchOptions& options) {
  bench.add("--models,--model", options.models, cloudFormats().namesRead() + " files").typeName("FILE...");
  bench.add("--sizes", options.sizes, "points of the built-in clouds (default: 15000)")
      .check(wholeBetween(1, 2e9))
      .typeName("N...");
  for (const std::string_view name : unevenCloudNames()) options.clouds.emplace_back(name);
  std::vector<std::string> clouds = options.clouds;
  clouds.emplace_back("none");
  bench.add("--clouds", options.clouds, "built-in uneven clouds of --sizes points; none: only --models")
      .check(oneOf(std::move(clouds)))
      .separatedBy(',')
      .showDefault();
  options.brushes = namesOf(kBrushKinds);
  addListOption(bench, "--brushes", options.brushes, "brushes to test");
  addListOption(bench, "--gestures", options.gestures, "press: pressed and held; slide: a slide of 20 mm");
  bench.add("--hold", options.hold_s, "duration of a press, s").check(between(0, 60)).showDefault();
  bench.add("--brush-radius", options.brushRadius_mm, "radius of the brush, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  bench.add("--depth", options.depth_mm, "depth of the HIP below the original surface, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  addFrictionOption(bench, options);
  options.backends = {"vulkan", "cpu"};
  addBackendsOption(bench, options, {"vulkan", "cpu"});  // cuda does not report its edits
  addRadiusOption(bench, options.backend);
  addEngineOptions(bench, options.backend);
}

}  // namespace

void addLocalityBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("locality", "judge whether edits change points that they must not change");
  const auto options = std::make_shared<LocalityBenchOptions>();
  options->backend.surface = "average";
  addOptions(sub, *options);
  sub.footer(
      "Each brush presses and slides; then the hand is lifted until nothing changes. Violations: points moved "
      "or removed farther from the brush's path than its radius; new points farther than that plus a support radius, "
      "closer than 0.4 local spacings to another, or, when carving, outside the old surface; normals that face the "
      "wrong way; changes by a brush without effect, before and after. The judge measures spacings and heights itself. "
      "It tolerates one point, or 2 % of the new points too close, 1 % of carved points outside and 1 % of the "
      "normals; the JSON's strictly_broken tolerates none. Exit code 1 if an edit exceeds the tolerance.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      const Json found = measureAlone(context, *options, "locality", [&] { return benchLocality(context, *options); });
      if (found["broken"].get<std::uint64_t>() > 0)
        throw Error("bench locality: {} of {} strokes broke a promise of edits; see the table",
                    found["broken"].get<std::uint64_t>(), found["strokes"].size());
    };
  });
}

}  // namespace palpate

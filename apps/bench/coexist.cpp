#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/cli/context.hpp"
#include "apps/cli/look.hpp"
#include "apps/cli/parse_list.hpp"
#include "apps/cli/picture.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/statistics.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/render/frame.hpp"
#include "engine/spatial/hash_update.hpp"
#include "engine/touch/gpu_points.hpp"
#include "haptics/session/sculpting_hand.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

namespace {

/// Results of `bench coexist`: touch beside pictures that are drawn as fast as possible.
/// The pictures drawn during the stroke.
struct SightPace {
  std::string gpu;
  std::uint64_t pictures = 0;
  double perSecond = 0;
  Summary picture_ms;               ///< from reading the edits until the picture is complete
  Summary follow_ms;                ///< the part of picture_ms spent on the edits: points and discs
  std::uint64_t statesSeen = 0;     ///< states of edited points, as the pictures received them
  std::uint64_t changedPixels = 0;  ///< pixels that differ between the first picture and the last
};

/// A stroke in real time on one model, by one arrangement of queues.
struct Coexistence {
  std::string subject, backend, queues, situation;
  std::size_t points = 0;
  double rate_Hz = 0, duration_s = 0;
  std::uint64_t ticks = 0, contactTicks = 0;
  std::uint64_t missedTicks = 0;            ///< dropped because their time had passed
  double freshShare = 0;                    ///< fraction of the ticks that were answered in time
  Summary step_us;                          ///< from pose to force
  double lateP999_us = 0, lateMost_us = 0;  ///< from the time a tick was due to its start
  bool realtimePriority = false;            ///< granted to the servo thread
  std::uint64_t edits = 0, leftOut = 0;
  std::uint64_t statesMade = 0;  ///< states of points that the edits produced
  double brushRadius_mm = 0;     ///< 0 without edits
  std::optional<SightPace> sight;
};

struct CoexistenceResults {
  std::uint32_t width = 0, height = 0, samples = 1;  ///< of the pictures; samples of a pixel
  std::vector<Coexistence> rows;
};

using Value = std::optional<Json>;

template <auto member>
Value upperQuantiles(decltype(ownerOf(member)) report) {
  const Summary& s = report.*member;
  return Json{{"n", s.count}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

constexpr Reported<SightPace> kSight[]{
    {"gpu", "", "GPU that drew", field<&SightPace::gpu>},
    {"pictures", "", "pictures drawn", field<&SightPace::pictures>},
    {"fps", "1/s", "pictures per second", field<&SightPace::perSecond>},
    {"picture_ms", "ms", "time from reading the edits until the picture is complete",
     upperQuantiles<&SightPace::picture_ms>},
    {"follow_ms", "ms", "the part of it spent on the edits", upperQuantiles<&SightPace::follow_ms>},
    {"states_seen", "", "states of edited points received", field<&SightPace::statesSeen>},
    {"changed_pixels", "", "pixels that differ between the first picture and the last",
     field<&SightPace::changedPixels>},
};

constexpr Reported<Coexistence> kCoexistence[]{
    {"subject", "", "model", field<&Coexistence::subject>},
    {"points", "", "its points", field<&Coexistence::points>},
    {"backend", "", "back end", field<&Coexistence::backend>},
    {"queues", "", "arrangement of the GPU's queues", field<&Coexistence::queues>},
    {"situation", "", "whether the hand sculpts and pictures are drawn", field<&Coexistence::situation>},
    {"rate_Hz", "Hz", "ticks per second", field<&Coexistence::rate_Hz>},
    {"duration_s", "s", "duration of the stroke", field<&Coexistence::duration_s>},
    {"ticks", "", "ticks of the stroke", field<&Coexistence::ticks>},
    {"missed_ticks", "", "ticks skipped because their time had passed", field<&Coexistence::missedTicks>},
    {"contact_ticks", "", "ticks in contact", field<&Coexistence::contactTicks>},
    {"fresh_fraction", "1", "fraction of ticks answered in time", field<&Coexistence::freshShare>},
    {"step_us", "us", "time from pose to force", upperQuantiles<&Coexistence::step_us>},
    {"late_us.p999", "us", "99.9th percentile of the wake-up latency", field<&Coexistence::lateP999_us>},
    {"late_us.max", "us", "its maximum", field<&Coexistence::lateMost_us>},
    {"realtime_priority", "", "whether the servo thread had real-time priority", field<&Coexistence::realtimePriority>},
    {"edits", "", "edits of the stroke", field<&Coexistence::edits>},
    {"dropped_edits", "", "dropped edits", field<&Coexistence::leftOut>},
    {"states_made", "", "states of points that the edits produced", field<&Coexistence::statesMade>},
    {"brush_radius_mm", "mm", "radius of the brush; 0: no edits", field<&Coexistence::brushRadius_mm>},
    {"sight", "", "the pictures, if any were drawn",
     [](const Coexistence& c) -> Value { return partBy(kSight, c.sight); }},
};

constexpr Reported<CoexistenceResults> kCoexist[]{
    {"size", "px", "width and height of a picture",
     [](const CoexistenceResults& r) -> Value {
       return Json{r.width, r.height};
     }},
    {"samples", "", "samples of a pixel", field<&CoexistenceResults::samples>},
    {"rows", "", "one for each stroke",
     [](const CoexistenceResults& r) -> Value { return arrayBy(kCoexistence, r.rows); }},
};

Json toJson(const CoexistenceResults& results) { return jsonBy(kCoexist, results); }

constexpr double kUsualDuration_s = 10;

struct CoexistBenchOptions : BenchOptions {
  std::vector<std::string> queues, situations;
  std::string sightGpu;         // GPU that draws; empty: the one that touches
  std::int64_t touched = 1000;  // points that an edit should touch
  double duration_s = kUsualDuration_s;
  std::string size = "1920x1080";
  std::uint32_t samples = 1;
};

struct Situation {
  std::string_view name;
  bool sculpts, draws;
};
constexpr std::array<Situation, 4> kSituations{{{"alone", false, false},
                                                {"alone-sculpting", true, false},
                                                {"drawn", false, true},
                                                {"drawn-sculpting", true, true}}};

constexpr std::chrono::milliseconds kDrawnBefore{500};  // before the first tick: an idle GPU has a low clock

// Passes each answer to the hand; on the servo thread.
class FeelingHand final : public OneHandQuery {
 public:
  FeelingHand(TouchBackend& backend, SculptingHand& hand) : backend_(backend), hand_(hand) {}

  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    const Contact contact = backend_.ask({&pose, 1}, budget_us).front();
    hand_.felt(contact);
    return contact;
  }
  void endTick() noexcept override { backend_.endTick(); }

 private:
  TouchBackend& backend_;
  SculptingHand& hand_;
};

struct SightSize {
  std::uint32_t width = 0, height = 0, supersample = 1;
};

// Draws the cloud as fast as possible on its own thread. Follows the edits through the log, or through host memory if
// another machine touches.
class Sight {
 public:
  Sight(Device& device, const Model& model, TouchBackend& backend, const SightSize& size, bool sculpts)
      : device_(device),
        backend_(backend),
        sculpts_(sculpts),
        drawn_(device, model.cloud,
               {.spare = spareFor(backend.report().scope, model), .spacing = model.spacing, .edited = sculpts}),
        frame_(device, size.width, size.height, size.supersample),
        camera_(Camera::fitting(model.cloud, static_cast<double>(size.width) / size.height, 45,
                                framingOf(model, model.upright.up))),
        list_(device, device.throughputQueue(), "frame") {
    EditLog* const log = backend.gpuPoints() ? backend.gpuPoints()->editLogOn(device) : nullptr;
    if (sculpts && log)
      reader_.emplace(*log);
    else if (sculpts)
      backend.edits()->keep();
    draw();  // pipelines are created at their first use
    first_ = frame_.readColor();
  }

  // Returns once the GPU is warm; pictures drawn from then on count.
  void begin() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      try {
        Stopwatch session;
        while (!stop.stop_requested()) {
          if (!counts_) session = Stopwatch();
          const Stopwatch watch;
          follow();
          const double follow_us = watch.elapsed_us();
          draw();
          if (!counts_) continue;
          follow_ms_.push_back(1e-3 * follow_us);
          picture_ms_.push_back(1e-3 * watch.elapsed_us());
        }
        duration_s_ = session.elapsed_s();
      } catch (...) {
        failure_ = std::current_exception();
      }
    });
    std::this_thread::sleep_for(kDrawnBefore);
    counts_ = true;
  }
  // Rethrows the thread's exception.
  void end() {
    thread_ = {};
    if (failure_) std::rethrow_exception(failure_);
  }
  // The results, with the last edit drawn and counted.
  SightPace pace() {
    follow();
    draw();
    const Image last = frame_.readColor();
    SightPace pace{.gpu = device_.name(),
                   .pictures = picture_ms_.size(),
                   .perSecond = static_cast<double>(picture_ms_.size()) / duration_s_,
                   .picture_ms = summarize(std::move(picture_ms_)),
                   .follow_ms = summarize(std::move(follow_ms_)),
                   .statesSeen = statesSeen_};
    for (std::size_t i = 0; i < last.rgba.size(); ++i) pace.changedPixels += last.rgba[i] != first_.rgba[i];
    return pace;
  }

 private:
  static std::uint32_t spareFor(const EditScope& scope, const Model& model) {
    return scope.newPoints ? *scope.newPoints : HashUpdate::spareSlots(model.cloud.size());
  }
  void follow() {
    if (!sculpts_) return;
    if (reader_) {
      statesSeen_ += drawn_.catchUp(*reader_);
    } else {
      batch_.clear();
      backend_.edits()->take(batch_);
      statesSeen_ += drawn_.catchUp(batch_.points);
    }
    drawn_.closeSurface();
  }
  void draw() {
    list_.begin();
    frame_.record(list_, drawn_, camera_, {});
    list_.end();
    device_.throughputQueue().run(list_);
  }

  Device& device_;
  TouchBackend& backend_;
  bool sculpts_;
  DrawnCloud drawn_;
  Frame frame_;
  Camera camera_;
  CommandList list_;
  std::optional<EditLog::Reader> reader_;
  EditBatch batch_;
  Image first_;
  std::vector<double> picture_ms_, follow_ms_;
  double duration_s_ = 0;
  std::uint64_t statesSeen_ = 0;
  std::atomic<bool> counts_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;
};

// Shared by all strokes on one model.
struct CoexistScene {
  Context& context;
  const Subject& subject;
  const CoexistBenchOptions& options;
  std::vector<SurfaceSpot> places;
  Stroke stroke;
};

Coexistence touchIn(const CoexistScene& scene, const Situation& situation, const std::string& queues) {
  const CoexistBenchOptions& options = scene.options;
  const Model& model = scene.subject.model;
  BenchBackend way = options.backend;
  way.backend = options.backends.front();
  way.realtime = true;
  if (!options.methods.empty()) way.method = options.methods.front();
  const double rate_Hz = realtimeRate_Hz(options);
  Session session =
      startSession(scene.context, model, way,
                   {.brush = situation.sculpts ? std::optional(scene.stroke.brush) : std::nullopt, .rate_Hz = rate_Hz});
  TouchBackend& backend = session.backend();
  std::optional<Sight> sight;
  if (situation.draws) {
    const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
    const std::string& gpu = options.sightGpu;
    sight.emplace(gpu.empty() ? scene.context.device() : scene.context.sightDevice(gpu), model, backend,
                  SightSize{width, height, options.samples > 1 ? 2u : 1u}, situation.sculpts);
  }
  SculptingHand hand(model, scene.places, scene.stroke, session.surface().radius);
  FeelingHand feeling(backend, hand);
  Coexistence found{.subject = scene.subject.name,
                    .backend = way.backend,
                    .queues = queues,
                    .situation = std::string(situation.name),
                    .points = model.cloud.size(),
                    .rate_Hz = rate_Hz,
                    .duration_s = options.duration_s};
  const OpenHand open = hand.hand(plannedTicks(found.rate_Hz, found.duration_s), found.rate_Hz);
  if (sight) sight->begin();
  const ServoResult result = session.run({&open, 1}, {.query = &feeling});
  if (sight) sight->end();
  session.finish();

  const TraceSummary trace = summarize(result.trace());
  found.ticks = trace.ticks;
  found.contactTicks = trace.contactTicks;
  found.missedTicks = trace.missedTicks;
  found.freshShare = trace.freshFraction;
  found.step_us = trace.step_us;
  found.realtimePriority = result.realtimePriority;
  found.lateP999_us = result.late_us.quantile_us(0.999);
  found.lateMost_us = result.late_us.max_us();
  found.edits = backend.report().editTimes_us.size();
  const TouchShortfalls& shortfalls = backend.report().shortfalls;
  found.leftOut = shortfalls.editsLogFull + shortfalls.editsTooSlow + shortfalls.editsHeldUp;
  found.statesMade = backend.report().costs.states;
  if (situation.sculpts) found.brushRadius_mm = scene.stroke.brush.radius_mm;
  if (sight) found.sight = sight->pace();
  return found;
}

std::vector<Situation> situationsOf(const CoexistBenchOptions& options) {
  std::vector<Situation> situations;
  for (const Situation& situation : kSituations)
    if (std::ranges::find(options.situations, situation.name) != options.situations.end())
      situations.push_back(situation);
  return situations;
}

Json benchCoexist(Context& context, const CoexistBenchOptions& options) {
  if (options.backends.size() != 1) throw UsageError("bench coexist: one --backend, vulkan or cpu");
  const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
  Frame::checkSize(width, height);
  // The CPU has no queues to share.
  const std::size_t arrangements = options.wants("cpu") ? 1 : options.queues.size();
  std::vector<Coexistence> all;
  for (const SubjectMaker& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    const std::vector<SurfaceSpot> places = sculptingPlaces(subject.model);
    const auto touched = static_cast<std::size_t>(options.touched);
    const CoexistScene scene{
        context, subject, options, places,
        strokeThatReaches(touched, BrushKind::push, subject.model, places.front(), realtimeRate_Hz(options))};
    for (const std::string& queues : std::span(options.queues).first(arrangements)) {
      context.arrange(*valueNamed(kQueueArrangements, queues));
      for (const Situation& situation : situationsOf(options)) {
        context.log().say("coexist: {}, {} points, {} queues, {}", subject.name, subject.model.cloud.size(), queues,
                          situation.name);
        all.push_back(touchIn(scene, situation, queues));
      }
    }
  }
  Json json = toJson({width, height, options.samples, std::move(all)});
  printTables(context.tables(), "coexist", json);
  return json;
}

void addOptions(Options& bench, CoexistBenchOptions& options) {
  addSubjectOptions(bench, options);
  for (const Situation& situation : kSituations) options.situations.emplace_back(situation.name);
  options.queues = namesOf(kQueueArrangements);
  addListOption(
      bench, "--queues", options.queues,
      "how touch and drawing share a GPU: separate queues, touch first; separate queues without priorities; or "
      "one queue; several are compared");
  addListOption(bench, "--situations", options.situations,
                "touch alone or while the cloud is drawn, with or without sculpting");
  bench.add("--touched", options.touched, "points that an edit should touch; sets the size of the brush")
      .check(wholeBetween(1, 1e8))
      .showDefault();
  bench.add("--duration", options.duration_s, "duration of each stroke, s")
      .check(between(bounds::kShortest_s, bounds::kLongest_s))
      .showDefault();
  addRateOption(bench, options);
  bench.add("--size", options.size, "size of the pictures, WIDTHxHEIGHT in pixels").showDefault();
  addSamplesOption(bench, options.samples);
  bench.add("--sight-gpu", options.sightGpu,
            "draw on this GPU, by number or part of its name; edits reach it through the host");
  addBackendsOption(bench, options, {"vulkan", "cpu"});  // cuda does not report its edits
  addMethodsOption(bench, options, "how neighbours are found (default: fused)");
  addRadiusOption(bench, options.backend);
  addEngineOptions(bench, options.backend);
}

}  // namespace

void listCoexistBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "coexist", ".", kCoexist);
  listAlone(all, "coexist", ".rows[].", kCoexistence);
  listAlone(all, "coexist", ".rows[].sight.", kSight);
}

void addCoexistBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("coexist", "touch while pictures are drawn as fast as possible");
  const auto options = std::make_shared<CoexistBenchOptions>();
  options->backend.surface = "average";
  addOptions(sub, *options);
  sub.footer(
      "A brush slides over the surface in real time (at 1000 ticks per second unless --rate says otherwise), alone and "
      "beside a thread that draws one picture after another, with and without sculpting; on 1, 5 and 20 million "
      "points unless --sizes or --models say otherwise. Tables of us from pose to force, missed ticks, pictures per "
      "second and ms per picture.\n");
  sub.whenNamed([&, options] {
    if (options->sizes.empty() && options->models.empty()) options->sizes = {1'000'000, 5'000'000, 20'000'000};
    command = measuringAlone(context, options, "coexist", benchCoexist);
  });
}

}  // namespace palpate

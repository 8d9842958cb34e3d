#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/edit_cost.hpp"
#include "apps/cli/setting_options.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/session/sculpting_hand.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

namespace {

struct EditBenchOptions : BenchOptions {
  std::string brush = "push", symmetry;
  std::vector<std::string> indexes{"incremental", "rebuild"};
  std::vector<std::int64_t> touched{100, 1000, 10'000};
  double duration_s = 0;  // duration of a stroke in real time; 0: virtual time
};

constexpr std::uint64_t kWarmUpEdits = 10;    // edits before the first measured one, in virtual time
constexpr std::uint64_t kTicksPerEdit = 4;    // maximum in virtual time, on a surface that is worth measuring
constexpr std::uint64_t kTicksToLand = 1000;  // maximum
constexpr std::uint64_t kFewest = 5;
constexpr int kTrials = 2, kMoreTrials = 6;  // strokes to find the brush, and as long as it is far off
constexpr std::int64_t kTrialEdits = 10;
constexpr double kCloseEnough = 0.05, kFarOff = 0.3;  // relative errors of the number of touched points
constexpr double kRealtimeRate_Hz = 1000, kHighestRate_Hz = 1e5;

// What happened in one tick.
struct ObservedTick {
  bool sculpts = false;  // at full depth, and the surface was felt
  std::uint32_t edits = 0;
  std::uint32_t touched = 0;
  double edit_us = 0, requests_us = 0;
  bool compacts = false;                      // a compaction began, ran or ended in this tick
  std::uint64_t builds = 0, compactions = 0;  // so far
};

// Queries the back end, gives the hand the answer, and records the tick; on the servo thread.
class EditObserver final : public OneHandQuery {
 public:
  EditObserver(TouchBackend& backend, SculptingHand& hand, std::uint64_t ticks) : backend_(backend), hand_(hand) {
    ticks_.reserve(ticks);
  }

  const std::vector<ObservedTick>& ticks() const { return ticks_; }

  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    isReady_ = hand_.sculpts();
    const Contact contact = backend_.ask({&pose, 1}, budget_us).front();
    hand_.felt(contact);
    isTouching_ = contact.touching;
    if (budget_us <= 0) backend_.endTick();  // the step of a tick in virtual time contains its edit
    return contact;
  }
  // Notes the tick here, so that no report delays its force.
  void endTick() noexcept override {
    const BackendReport after = backend_.report();
    note(after);
    backend_.endTick();
    const BackendReport next = backend_.report();
    wasCompacting_ = next.isCompacting;
    compactions_ = next.compactions;
  }

 private:
  void note(const BackendReport& report) {
    ObservedTick noted{.sculpts = isReady_ && isTouching_,
                       .compacts = wasCompacting_ || report.isCompacting || report.compactions > compactions_,
                       .builds = report.index.built,
                       .compactions = report.compactions};
    const std::span<const double> times = report.editTimes_us;
    if (seen_ < times.size()) {
      noted.touched = report.costs.lastTouched;
      for (; seen_ < times.size(); ++seen_, ++noted.edits) {
        noted.edit_us += times[seen_];
        if (seen_ < report.costs.requests_us.size()) noted.requests_us += report.costs.requests_us[seen_];
      }
    }
    if (ticks_.size() < ticks_.capacity()) ticks_.push_back(noted);
  }

  TouchBackend& backend_;
  SculptingHand& hand_;
  std::vector<ObservedTick> ticks_;
  std::size_t seen_ = 0;
  bool isReady_ = false, isTouching_ = false, wasCompacting_ = false;
  std::uint64_t compactions_ = 0;
};

// Ends the session after the number of measured edits that the options ask for; in virtual time.
class StopAfterEdits {
 public:
  StopAfterEdits(const EditBenchOptions& options, const EditObserver& observer)
      : options_(options), observer_(observer) {}

  const std::atomic<bool>& enough() const { return enough_; }
  void ticked() {
    const ObservedTick& noted = observer_.ticks().back();
    edits_ += noted.sculpts && noted.edits > 0;
    if (edits_ == kWarmUpEdits) watch_ = Stopwatch();
    const std::uint64_t measured = edits_ < kWarmUpEdits ? 0 : edits_ - kWarmUpEdits;
    const bool late = options_.limit_s > 0 && watch_.elapsed_s() > options_.limit_s;
    enough_ = measured >= static_cast<std::uint64_t>(options_.repeat) || (late && measured >= kFewest);
    while (session_.elapsed_s() * options_.rate_Hz < static_cast<double>(observer_.ticks().size()))
      std::this_thread::yield();
  }

 private:
  const EditBenchOptions& options_;
  const EditObserver& observer_;
  std::uint64_t edits_ = 0;
  std::atomic<bool> enough_ = false;
  Stopwatch watch_, session_;
};

// Summarizes the ticks. In virtual time only ticks with an edit count; the edit is then a part of its tick.
void summarizeTicks(EditCost& cost, const std::vector<ObservedTick>& noted, const Trace& trace) {
  const bool realtime = cost.stroke.has_value();
  const std::uint64_t warmUp = realtime ? 0 : kWarmUpEdits;
  std::vector<double> touched, query, edit, indexed, requests, step, compacting;
  std::uint64_t edits = 0, buildsBefore = 0, compactionsBefore = 0, fresh = 0;
  for (std::size_t i = 0; i < std::min(noted.size(), trace.rows.size()); ++i) {
    const ObservedTick& tick = noted[i];
    const TraceRow& row = trace.rows[i];
    const bool counts = tick.sculpts && edits >= warmUp;
    if (tick.sculpts && tick.edits > 0) ++edits;
    if (!counts) {
      if (cost.edits == 0) {
        buildsBefore = tick.builds;
        compactionsBefore = tick.compactions;
      }
      continue;
    }
    cost.compactions = tick.compactions - compactionsBefore;
    if (realtime || tick.edits > 0) {
      step.push_back(row.step_us);
      if (tick.compacts) compacting.push_back(row.step_us);
      fresh += row.fresh;
      if (row.gpu_us > 0) query.push_back(row.gpu_us);
    }
    if (tick.edits == 0) continue;
    ++cost.edits;
    cost.builds = tick.builds - buildsBefore;
    touched.push_back(tick.touched);
    edit.push_back(tick.edit_us);
    requests.push_back(tick.requests_us);
    if (!realtime && row.gpu_us > 0) indexed.push_back(row.gpu_us + tick.edit_us);
  }
  if (realtime && !step.empty()) {
    cost.stroke->freshShare = static_cast<double>(fresh) / static_cast<double>(step.size());
    cost.stroke->editsPerSecond =
        static_cast<double>(cost.edits) * cost.stroke->rate_Hz / static_cast<double>(step.size());
  }
  cost.touched = summarize(std::move(touched));
  cost.query_us = summarize(std::move(query));
  cost.edit_us = summarize(std::move(edit));
  cost.indexed_us = summarize(std::move(indexed));
  cost.requests_us = summarize(std::move(requests));
  cost.step_us = summarize(std::move(step));
  cost.compactingStep_us = summarize(std::move(compacting));
}

// For a stroke that made no edit in real time, although it edited in virtual time, where the brush was chosen: answers
// and edits that are not ready in time do not reach the hand.
[[noreturn]] void refusePace(const Trace& trace, const TouchShortfalls& shortfalls, double rate_Hz) {
  throw Error(
      "{} of {} ticks were answered in time, and {} edits were dropped as too slow; this machine is too slow for "
      "--rate {:g}",
      std::ranges::count_if(trace.rows, &TraceRow::fresh), trace.rows.size() + trace.missedTicks,
      shortfalls.editsTooSlow, rate_Hz);
}

// Memory of the same cloud without edits. On the CPU points and index are the same.
std::uint64_t plainBytes(const Session& session, const std::string& backend) {
  if (backend == "vulkan") {
    const GpuMemory plain = predictGpuMemory(session.model().cloud.size(), false);
    return plain.liveCloud + plain.index;
  }
  const BackendMemory before = session.backend().report().memory;
  return before.points + before.index;
}

// Shared by all measurements on one model.
struct EditScene {
  Context& context;
  const Subject& subject;
  std::vector<SurfaceSpot> places;
};

double ticksPerSecond(const EditBenchOptions& options) {
  if (options.duration_s == 0) return kRealtimeRate_Hz;  // of virtual time
  return realtimeRate_Hz(options);
}

EditCost sculpt(const EditScene& scene, const EditBenchOptions& options, const Stroke& stroke,
                const std::string& backend, const std::string& index) {
  const bool realtime = options.duration_s > 0;
  const double rate_Hz = ticksPerSecond(options);
  const Model& model = scene.subject.model;
  BenchBackend way = options.backend;
  way.backend = backend;
  way.index = index;
  way.realtime = realtime;
  const std::vector<std::string> offered = methodChoices(scene.context, backend);
  const auto method = std::ranges::find_first_of(options.methods, offered);
  if (method != options.methods.end()) way.method = *method;
  Session session = startSession(scene.context, model, way, {.brush = stroke.brush, .rate_Hz = rate_Hz});

  EditCost cost{.subject = scene.subject.name,
                .backend = backend,
                .brush = options.brush,
                .symmetry = options.symmetry,
                .index = index,
                .points = model.cloud.size(),
                .brushRadius_mm = stroke.brush.radius_mm,
                .spacing_mm = model.scale.toMm(model.spacing)};
  cost.memory.plain = plainBytes(session, backend);
  if (realtime) cost.stroke = EditStroke{.rate_Hz = rate_Hz, .duration_s = options.duration_s};
  const std::uint64_t longest =
      (static_cast<std::uint64_t>(options.repeat) + kWarmUpEdits) * kTicksPerEdit + kTicksToLand;
  const std::uint64_t ticks = realtime ? plannedTicks(rate_Hz, options.duration_s) : longest;
  SculptingHand hand(model, scene.places, stroke, session.surface().radius);
  EditObserver observer(session.backend(), hand, ticks);
  StopAfterEdits stop(options, observer);
  const OpenHand open = hand.hand(ticks, rate_Hz);
  const ServoResult result = session.run(
      {&open, 1}, {.stop = &stop.enough(), .observer = [&](const TraceRow&) { stop.ticked(); }, .query = &observer});
  session.finish();
  summarizeTicks(cost, observer.ticks(), result.trace());
  const TouchShortfalls& shortfalls = session.backend().report().shortfalls;
  if (cost.edits < (realtime ? 1 : kFewest)) {
    if (realtime) refusePace(result.trace(), shortfalls, rate_Hz);
    throw Error("{}: {} of {} ticks edited; the stylus found no surface that a brush of {:.3g} mm changes",
                cost.subject, cost.edits, result.trace().rows.size(), cost.brushRadius_mm);
  }
  cost.landings = hand.landings();
  cost.longestCompactionEnd_us = session.backend().report().costs.longestCompactionEnd_us;
  cost.memory.edited = session.backend().report().memory;
  if (cost.stroke) {
    cost.stroke->missedTicks = result.trace().missedTicks;
    cost.stroke->leftOut = shortfalls.editsTooSlow + shortfalls.editsLogFull;
    cost.stroke->heldUp = shortfalls.editsHeldUp;
  }
  return cost;
}

// The stroke that touches that many points: the best of a few short ones. The points around a spot give a first guess,
// which is wrong where the surface bends under the brush.
Stroke strokeFor(const EditScene& scene, const EditBenchOptions& options, const std::string& backend,
                 std::size_t touched) {
  const BrushKind brush = *valueNamed(kBrushKinds, options.brush);
  EditBenchOptions trial = options;
  trial.repeat = kTrialEdits;
  trial.limit_s = 0;  // the same brush on every machine
  trial.rate_Hz = kHighestRate_Hz;
  trial.duration_s = 0;
  const auto reaching = [&](double count, const EditBenchOptions& at) {
    return strokeThatReaches(static_cast<std::size_t>(std::max(1.0, count)), brush, scene.subject.model,
                             scene.places.front(), ticksPerSecond(at));
  };
  const auto wanted = static_cast<double>(touched);
  double count = wanted, best = wanted, leastOff = std::numeric_limits<double>::max();
  double tooFew = 0, tooMany = static_cast<double>(scene.subject.model.cloud.size());  // counts tried so far
  for (int k = 0; k < kMoreTrials && leastOff > (k < kTrials ? kCloseEnough : kFarOff); ++k) {
    const double reached = sculpt(scene, trial, reaching(count, trial), backend, "incremental").touched.p50;
    const double ratio = std::max(1.0, reached) / wanted;
    if (std::abs(std::log(ratio)) < leastOff) {
      leastOff = std::abs(std::log(ratio));
      best = count;
    }
    (ratio < 1 ? tooFew : tooMany) = count;
    count /= ratio;
    if (count <= tooFew || count >= tooMany) count = std::sqrt(std::max(1.0, tooFew) * tooMany);
  }
  return reaching(best, options);
}

Json benchEdit(Context& context, const EditBenchOptions& options) {
  std::vector<EditCost> costs;
  for (const SubjectMaker& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    const std::size_t points = subject.model.cloud.size();
    const EditScene scene{context, subject, sculptingPlaces(subject.model)};
    for (const std::int64_t asked : options.touched) {
      const auto touched = static_cast<std::size_t>(asked);
      if (2 * touched > points) {
        context.log().say("edit: {}, {} of {} points: skipped, the brush would be larger than the model", subject.name,
                          touched, points);
        continue;
      }
      context.log().say("edit: {}, {} of {} points", subject.name, touched, points);
      for (const std::string& backend : options.backends) {
        Stroke stroke = strokeFor(scene, options, backend, touched);
        stroke.brush.symmetry = options.symmetry;  // the same brush with and without
        for (const std::string& index : options.indexes) {
          costs.push_back(sculpt(scene, options, stroke, backend, index));
          costs.back().asked = touched;
        }
      }
    }
  }
  if (costs.empty()) throw UsageError("bench edit: --touched exceeds half the points of each model");
  Json result = toJson(costs);
  printTables(context.tables(), "edit", result);
  return result;
}

void addOptions(Options& bench, EditBenchOptions& options) {
  addSubjectOptions(bench, options);
  bench.add("--edit", options.brush, "the brush").check(oneOf(namesOf(kBrushKinds))).showDefault();
  addSettingFor<BrushConfig>(bench, options.symmetry, "symmetry");
  addListOption(bench, "--index", options.indexes, "how the index follows edits");
  bench
      .add("--touched", options.touched, "numbers of points that an edit should touch; each sets the size of the brush")
      .check(wholeBetween(1, 1e8))
      .typeName("K...")
      .showDefault();
  bench
      .add("--spare", options.backend.spareSlots,
           "free slots for new points and growing buckets, which compactions reclaim: the fewer, the more compactions "
           "(default: a tenth of the points)")
      .check(wholeBetween(1, 1e8))
      .typeName("SLOTS");
  bench
      .add("--duration", options.duration_s,
           "duration of a stroke in real time, s, at --rate ticks per second (1000 by default); 0: virtual time, "
           "--repeat edits")
      .check(between(0, bounds::kLongest_s))
      .showDefault();
  addRateOption(bench, options);
  addRepeatOptions(bench, options);
  // CUDA reports neither how many points an edit touched nor its times.
  addBackendsOption(bench, options, {"vulkan", "cpu"});
  addMethodsOption(bench, options, "how neighbours are found (default: fused; direct on cpu)");
  addRadiusOption(bench, options.backend);
  addEngineOptions(bench, options.backend);
  addPlotOption(bench, options, "plot step times against points in the model and against touched points");
}

}  // namespace

void addEditBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("edit", "a tick that sculpts");
  const auto options = std::make_shared<EditBenchOptions>();
  options->backend.surface = "average";
  addOptions(sub, *options);
  sub.footer(
      "A brush slides over the surface at 50 mm/s and sculpts at every tick. Tables of us on the GPU or CPU and from "
      "pose to "
      "force (in virtual time with the whole edit), touched points, full builds of the index, MiB of index and lists, "
      "and the memory of points, index and lists relative to the same cloud without edits; the fraction of touched "
      "points above which a full build is cheaper.\n");
  sub.whenNamed([&, options] { command = measuringAlone(context, options, "edit", benchEdit, PlotScript::edit); });
}

}  // namespace palpate

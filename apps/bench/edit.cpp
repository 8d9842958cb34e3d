#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/edit_cost.hpp"
#include "apps/bench/sculpting_hand.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

namespace {

struct EditBenchOptions : BenchOptions {
  std::string brush = "push";
  std::vector<std::string> indexes{"incremental", "rebuild"};
  std::vector<std::int64_t> touched{100, 1000, 10'000};
  double duration_s = 0;  // of a stroke in real time; 0: virtual time
  std::optional<std::uint32_t> spareSlots;
};

constexpr std::uint64_t kWarmUpEdits = 10;    // edits before the first that is measured, in virtual time
constexpr std::uint64_t kTicksPerEdit = 4;    // in virtual time, at most, on a surface that is worth measuring
constexpr std::uint64_t kTicksToLand = 1000;  // at most
constexpr std::uint64_t kFewest = 5;
constexpr int kTrials = 2;  // strokes to find the brush
constexpr std::int64_t kTrialEdits = 10;
constexpr double kCloseEnough = 0.05;  // of the points that are asked for
constexpr double kRealtimeRate_Hz = 1000, kHighestRate_Hz = 1e5;

// What happened in one tick.
struct ObservedTick {
  bool sculpts = false;  // at full depth, and the surface was felt
  std::uint32_t edits = 0;
  std::uint32_t touched = 0;
  double edit_us = 0, requests_us = 0;
  bool compacts = false;                      // the index, at its beginning or its end, or all within it
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
    const bool ready = hand_.sculpts(), compacting = backend_.isCompacting();
    const std::uint64_t before = backend_.compactions();
    const Contact contact = backend_.query(pose, budget_us);
    hand_.felt(contact);
    ObservedTick noted{.sculpts = ready && contact.touching,
                       .compacts = compacting || backend_.isCompacting() || backend_.compactions() > before,
                       .builds = backend_.indexWork().built,
                       .compactions = backend_.compactions()};
    const auto& times = backend_.editTimes_us();
    if (seen_ < times.size()) {
      const EditCosts costs = backend_.editCosts();
      noted.touched = costs.lastTouched;
      for (; seen_ < times.size(); ++seen_, ++noted.edits) {
        noted.edit_us += times[seen_];
        if (seen_ < costs.requests_us.size()) noted.requests_us += costs.requests_us[seen_];
      }
    }
    if (ticks_.size() < ticks_.capacity()) ticks_.push_back(noted);
    return contact;
  }
  void prepare() noexcept override { backend_.prepare(); }

 private:
  TouchBackend& backend_;
  SculptingHand& hand_;
  std::vector<ObservedTick> ticks_;
  std::size_t seen_ = 0;
};

// Ends the session once there are as many measured edits as the options ask for; in virtual time.
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

// What the ticks say together; in virtual time of those with an edit, which is then a part of its tick.
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

// Of a stroke in real time that has edited nothing, though it edits in virtual time, by which the brush was chosen:
// what is not answered in time, or edited in time, passes the hand by.
[[noreturn]] void refusePace(const Trace& trace, const TouchShortfalls& shortfalls, double rate_Hz) {
  throw Error(
      "{} of {} ticks were answered in time, and {} edits left out since one takes too long; this machine is too "
      "slow for --rate {:g}",
      std::ranges::count_if(trace.rows, &TraceRow::fresh), trace.rows.size() + trace.missedTicks,
      shortfalls.editsTooSlow, rate_Hz);
}

EditMemory memoryOf(const Session& session) {
  const GpuMemory plain = predictGpuMemory(session.model().cloud.size(), false);
  return {.edited = session.backend().memory(), .plain = plain.liveCloud + plain.index};
}

// What all measurements on one model share.
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
                const std::string& index) {
  const bool realtime = options.duration_s > 0;
  const double rate_Hz = ticksPerSecond(options);
  const Model& model = scene.subject.model;
  BackendOptions way = options.backend;
  way.index = index;
  way.realtime = realtime;
  way.spareSlots = options.spareSlots;
  if (!options.methods.empty()) way.method = options.methods.front();
  SessionConfig config = sessionConfig(way, stroke.brush);
  config.rate_Hz = rate_Hz;
  Session session = startSession(scene.context, model, config);

  EditCost cost{.subject = scene.subject.name,
                .brush = options.brush,
                .index = index,
                .points = model.cloud.size(),
                .brushRadius_mm = stroke.brush.radius_mm,
                .spacing_mm = model.scale.toMm(model.spacing)};
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
  const TouchShortfalls& shortfalls = session.backend().shortfalls();
  if (cost.edits < (realtime ? 1 : kFewest)) {
    if (realtime) refusePace(result.trace(), shortfalls, rate_Hz);
    throw Error("{}: {} of {} ticks edited; the stylus finds no surface there that yields to a brush of {:.3g} mm",
                cost.subject, cost.edits, result.trace().rows.size(), cost.brushRadius_mm);
  }
  cost.landings = hand.landings();
  cost.longestCompactionEnd_us = session.backend().editCosts().longestCompactionEnd_us;
  cost.memory = memoryOf(session);
  if (cost.stroke) {
    cost.stroke->missedTicks = result.trace().missedTicks;
    cost.stroke->leftOut = shortfalls.editsTooSlow + shortfalls.editsLogFull;
    cost.stroke->heldUp = shortfalls.editsHeldUp;
  }
  return cost;
}

// The stroke that touches so many points: of a few short ones the nearest. What lies around a place is a first guess,
// which is off where the surface bends under the brush.
Stroke strokeFor(const EditScene& scene, const EditBenchOptions& options, std::size_t touched) {
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
  for (int k = 0; k < kTrials && leastOff > kCloseEnough; ++k) {
    const double reached = sculpt(scene, trial, reaching(count, trial), "incremental").touched.p50;
    const double ratio = std::max(1.0, reached) / wanted;
    if (std::abs(std::log(ratio)) < leastOff) {
      leastOff = std::abs(std::log(ratio));
      best = count;
    }
    count /= ratio;
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
        context.log().say("edit: {}, {} of {} points: left out, a brush would swallow the model", subject.name, touched,
                          points);
        continue;
      }
      context.log().say("edit: {}, {} of {} points", subject.name, touched, points);
      const Stroke stroke = strokeFor(scene, options, touched);
      for (const std::string& index : options.indexes) {
        costs.push_back(sculpt(scene, options, stroke, index));
        costs.back().asked = touched;
      }
    }
  }
  if (costs.empty()) throw UsageError("bench edit: --touched asks for more points than the models have");
  printEditTables(context.tables(), costs);
  Json result{{"costs", Json::array()}, {"growths", Json::array()}, {"crossovers", Json::array()}};
  for (const EditCost& cost : costs) result["costs"].push_back(toJson(cost));
  for (const EditGrowth& growth : growths(costs)) result["growths"].push_back(toJson(growth));
  for (const EditCrossover& crossover : crossovers(costs)) result["crossovers"].push_back(toJson(crossover));
  return result;
}

void addOptions(Options& bench, EditBenchOptions& options) {
  addSubjectOptions(bench, options);
  bench.add("--edit", options.brush, "the brush").check(oneOf(namesOf(kBrushKinds))).showDefault();
  addListOption(bench, "--index", options.indexes, "how the index follows");
  bench
      .add("--touched", options.touched,
           "numbers of points that an edit is to touch; the brush is as large as that takes")
      .check(wholeBetween(1, 1e8))
      .typeName("K...")
      .showDefault();
  bench
      .add("--spare", options.spareSlots,
           "slots to spare, into which new points and buckets that grow go, and which compactions win back: the "
           "fewer, the more compactions (default: a tenth of the points)")
      .check(wholeBetween(1, 1e8))
      .typeName("SLOTS");
  bench
      .add("--duration", options.duration_s,
           "s of a stroke in real time, at --rate ticks per second (1000 unless it says otherwise); 0: virtual "
           "time, --repeat edits")
      .check(between(0, bounds::kLongest_s))
      .showDefault();
  addRateOption(bench, options);
  addRepeatOptions(bench, options);
  // No other tells how many points an edit touched, and what it took.
  addBackendsOption(bench, options, {"vulkan"});
  addMethodsOption(bench, options, "how neighbours are found (default: fused)");
  addRadiusOption(bench, options.backend);
  addIndexOptions(bench, options.backend);
  addPlotOption(bench, options, "draw steps against points, and against those that are touched");
}

}  // namespace

void addEditBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("edit", "a tick that sculpts");
  const auto options = std::make_shared<EditBenchOptions>();
  options->backend.surface = "average";
  addOptions(sub, *options);
  sub.footer(
      "A brush slides over the surface at 50 mm/s and sculpts at every tick. Tables of us on the GPU and from pose to "
      "force (in virtual time with the whole edit), points that were touched, full builds of the index, MiB of index "
      "and lists, and all memory of points, index and lists over that of the same cloud without edits; from which "
      "share of the points on a full build is cheaper.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      measureAlone(
          context, *options, "edit", [&] { return benchEdit(context, *options); }, PlotScript::edit);
    };
  });
}

}  // namespace palpate

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "apps/bench.hpp"
#include "apps/edit_cost.hpp"
#include "apps/sculpting_hand.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {

namespace {

struct EditBenchOptions : BenchOptions {
  std::string brush = "push";
  std::vector<std::string> indexes{"incremental", "rebuild"};
  std::vector<std::int64_t> touched{100, 1000, 10'000};
  double duration_s = 0;  // of a stroke in real time; 0: virtual time
  std::optional<std::uint32_t> spareSlots;
};

constexpr std::uint64_t kWarmUp = 10;         // edits before the first that is measured, in virtual time
constexpr std::uint64_t kTicksPerEdit = 4;    // in virtual time, at most, on a surface that is worth measuring
constexpr std::uint64_t kTicksToLand = 1000;  // at most
constexpr std::uint64_t kFewest = 5;
constexpr int kTrials = 2;  // strokes to find the tool
constexpr std::int64_t kTrialEdits = 10;
constexpr double kCloseEnough = 0.05;  // of the points that are asked for
constexpr double kRealtimeRate_Hz = 1000, kHighestRate_Hz = 1e5;

// What happened in one tick.
struct Noted {
  bool sculpts = false;  // at full depth, and the surface was felt
  std::uint32_t edits = 0;
  std::uint32_t touched = 0;
  double edit_us = 0, wishes_us = 0;
  bool compacts = false;                      // the index, at its beginning or its end, or all within it
  std::uint64_t builds = 0, compactions = 0;  // so far
};

// Asks the touch side, tells the hand the answer, and notes what came of it; on the servo thread.
class Witness final : public ContactQuery {
 public:
  Witness(TouchSide& side, SculptingHand& hand) : side_(side), hand_(hand) {}

  void reserve(std::uint64_t ticks) { noted_.reserve(ticks); }
  const std::vector<Noted>& noted() const { return noted_; }

  Contact query(const Pose& pose, double budget_us) noexcept override {
    const bool ready = hand_.sculpts(), compacting = side_.isCompacting();
    const std::uint64_t before = side_.compactions();
    const Contact contact = side_.query(pose, budget_us);
    hand_.felt(contact);
    Noted noted{.sculpts = ready && contact.touching,
                .compacts = compacting || side_.isCompacting() || side_.compactions() > before,
                .builds = side_.fullBuilds(),
                .compactions = side_.compactions()};
    const auto& times = side_.editTimes_us();
    for (; seen_ < times.size(); ++seen_, ++noted.edits) {
      noted.edit_us += times[seen_];
      noted.wishes_us += side_.wishTimes_us()[seen_];
    }
    if (noted.edits > 0) noted.touched = side_.edits()->report().changed + side_.edits()->report().gone;
    if (noted_.size() < noted_.capacity()) noted_.push_back(noted);
    return contact;
  }
  void prepare() noexcept override { side_.prepare(); }

 private:
  TouchSide& side_;
  SculptingHand& hand_;
  std::vector<Noted> noted_;
  std::size_t seen_ = 0;
};

// Ends the session once there are as many measured edits as the options ask for; in virtual time.
class Umpire {
 public:
  Umpire(const EditBenchOptions& options, const Witness& witness) : options_(options), witness_(witness) {}

  const std::atomic<bool>& enough() const { return enough_; }
  void ticked() {
    const Noted& noted = witness_.noted().back();
    edits_ += noted.sculpts && noted.edits > 0;
    if (edits_ == kWarmUp) watch_ = Stopwatch();
    const std::uint64_t measured = edits_ < kWarmUp ? 0 : edits_ - kWarmUp;
    const bool late = options_.limit_s > 0 && watch_.elapsed_s() > options_.limit_s;
    enough_ = measured >= static_cast<std::uint64_t>(options_.repeat) || (late && measured >= kFewest);
    while (session_.elapsed_s() * options_.rate_Hz < static_cast<double>(witness_.noted().size()))
      std::this_thread::yield();
  }

 private:
  const EditBenchOptions& options_;
  const Witness& witness_;
  std::uint64_t edits_ = 0;
  std::atomic<bool> enough_ = false;
  Stopwatch watch_, session_;
};

// What the ticks say together; in virtual time of those with an edit, which is then a part of its tick.
void summarizeTicks(EditCost& cost, const std::vector<Noted>& noted, const Trace& trace) {
  const bool realtime = cost.stroke.has_value();
  const std::uint64_t warmUp = realtime ? 0 : kWarmUp;
  std::vector<double> touched, query, edit, indexed, wishes, step, compacting;
  std::uint64_t edits = 0, buildsBefore = 0, compactionsBefore = 0, fresh = 0;
  for (std::size_t i = 0; i < std::min(noted.size(), trace.rows.size()); ++i) {
    const Noted& tick = noted[i];
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
    wishes.push_back(tick.wishes_us);
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
  cost.wishes_us = summarize(std::move(wishes));
  cost.step_us = summarize(std::move(step));
  cost.compactingStep_us = summarize(std::move(compacting));
}

EditMemory memoryOf(const TouchSide& side) {
  const GpuMemory plain = predictGpuMemory(side.live().count(), false);
  constexpr std::uint64_t kBytesPerSlot = 2 * 2 * sizeof(Vec4);
  return {.points = kBytesPerSlot * side.live().slots(),
          .index = side.hash().bytes(),
          .lists = side.edits()->bytes(),
          .plain = plain.liveCloud + plain.index};
}

// What all measurements on one model share.
struct Scene {
  Context& context;
  const Subject& subject;
  std::vector<SurfaceSpot> places;
};

double ticksPerSecond(const EditBenchOptions& options) {
  if (options.duration_s == 0) return kRealtimeRate_Hz;  // of virtual time
  return realtimeRate_Hz(options);
}

EditCost sculpt(const Scene& scene, const EditBenchOptions& options, const Stroke& stroke, const std::string& index) {
  const bool realtime = options.duration_s > 0;
  const double rate_Hz = ticksPerSecond(options);
  const Model& model = scene.subject.model;
  BackendOptions way = options.backend;
  way.index = index;
  way.realtime = realtime;
  way.spareSlots = options.spareSlots;
  if (!options.methods.empty()) way.method = options.methods.front();
  const auto backend = makeBackend(scene.context, model, way, stroke.brush);
  auto& side = dynamic_cast<TouchSide&>(*backend);

  EditCost cost{.subject = scene.subject.name,
                .brush = options.brush,
                .index = index,
                .points = model.cloud.size(),
                .toolRadius_mm = model.scale.toMm(stroke.brush.toolRadius),
                .spacing_mm = model.scale.toMm(model.spacing)};
  if (realtime) cost.stroke = EditStroke{.rate_Hz = rate_Hz, .duration_s = options.duration_s};
  SculptingHand hand(model, scene.places, stroke, surfaceOptions(model, way).radius);
  Witness witness(side, hand);
  Umpire umpire(options, witness);
  const std::uint64_t longest = (static_cast<std::uint64_t>(options.repeat) + kWarmUp) * kTicksPerEdit + kTicksToLand;
  ServoLoop loop(hand, witness, ForceLaw({}, model.scale),
                 {.rate_Hz = rate_Hz,
                  .duration_s = realtime ? options.duration_s : static_cast<double>(longest) / rate_Hz,
                  .realtime = realtime,
                  .stop = &umpire.enough()});
  witness.reserve(loop.plannedTicks());
  const ServoResult result = loop.run([&](const TraceRow&) { umpire.ticked(); });
  side.finish();
  summarizeTicks(cost, witness.noted(), result.trace);
  if (cost.edits < (realtime ? 1 : kFewest))
    throw Error("{}: {} of {} ticks edited; the stylus finds no surface there that yields to a tool of {:.3g} mm",
                cost.subject, cost.edits, result.trace.rows.size(), cost.toolRadius_mm);
  cost.landings = hand.landings();
  cost.longestCompactionEnd_us = side.longestCompactionEnd_us();
  cost.memory = memoryOf(side);
  if (cost.stroke) {
    cost.stroke->missedTicks = result.trace.missedTicks;
    cost.stroke->leftOut = side.shortfalls().editsTooSlow + side.shortfalls().editsLogFull;
    cost.stroke->heldUp = side.shortfalls().editsHeldUp;
  }
  return cost;
}

// The stroke that touches so many points: of a few short ones the nearest. What lies around a place is a first guess,
// which is off where the surface bends under the tool.
Stroke strokeFor(const Scene& scene, const EditBenchOptions& options, std::size_t touched) {
  const auto* const brush = std::ranges::find(kBrushKinds, options.brush, [](const auto& b) { return b.first; });
  EditBenchOptions trial = options;
  trial.repeat = kTrialEdits;
  trial.limit_s = 0;  // the same tool on every machine
  trial.rate_Hz = kHighestRate_Hz;
  trial.duration_s = 0;
  const auto reaching = [&](double count, const EditBenchOptions& at) {
    return strokeThatReaches(static_cast<std::size_t>(std::max(1.0, count)), brush->second, scene.subject.model,
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
    const Scene scene{context, subject, sculptingPlaces(subject.model)};
    for (const std::int64_t asked : options.touched) {
      const auto touched = static_cast<std::size_t>(asked);
      if (2 * touched > points) {
        context.log().say("edit: {}, {} of {} points: left out, a tool would swallow the model", subject.name, touched,
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

void addOptions(CLI::App& bench, EditBenchOptions& options) {
  addSubjectOptions(bench, options);
  std::vector<std::string> brushes;
  for (const auto& [name, kind] : kBrushKinds) brushes.emplace_back(name);
  bench.add_option("--edit", options.brush, "the brush")->check(CLI::IsMember(brushes))->capture_default_str();
  addListOption(bench, "--index", options.indexes, "how the index follows");
  bench
      .add_option("--touched", options.touched,
                  "numbers of points that an edit is to touch; the tool is as large as that takes")
      ->check(wholeBetween(1, 1e8))
      ->type_name("K...")
      ->capture_default_str();
  bench
      .add_option("--spare", options.spareSlots,
                  "slots to spare, into which new points and buckets that grow go, and which compactions win back: the "
                  "fewer, the more compactions (default: a tenth of the points)")
      ->check(wholeBetween(1, 1e8))
      ->type_name("SLOTS");
  bench
      .add_option("--duration", options.duration_s,
                  "s of a stroke in real time, at --rate ticks per second (1000 unless it says otherwise); 0: virtual "
                  "time, --repeat edits")
      ->check(between(0, bounds::kLongest_s))
      ->capture_default_str();
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

void addEditBench(CLI::App& bench, Context& context, Command& command) {
  CLI::App* sub = bench.add_subcommand("edit", "a tick that sculpts");
  const auto options = std::make_shared<EditBenchOptions>();
  options->backend.surface = "average";
  addOptions(*sub, *options);
  sub->footer(
      "A tool slides over the surface at 50 mm/s and sculpts at every tick. Tables of us on the GPU and from pose to "
      "force (in virtual time with the whole edit), points that were touched, full builds of the index, MiB of index "
      "and lists, and all memory of points, index and lists over that of the same cloud without edits; from which "
      "share of the points on a full build is cheaper.\n");
  sub->callback([&, options] {
    command = [&context, options] {
      measureAlone(
          context, *options, "edit", [&] { return benchEdit(context, *options); }, PlotScript::edit);
    };
  });
}

}  // namespace palpate

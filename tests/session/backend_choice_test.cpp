// `auto` in real time: the back end that answers sooner, measured and remembered.
#include "haptics/session/backend_choice.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "engine/core/clock.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::backend_choice_test {

namespace {

BackendTimes timesOf(std::optional<double> gpu_us, std::optional<double> cpu_us) {
  return {.gpu = {.p99_us = gpu_us, .failure = {}},
          .cpu = {.p99_us = cpu_us, .failure = {}},
          .gpuName = "Intel UHD 630",
          .edits = true,
          .measured_s = 0.6};
}

/// Delays each answer, of the first `for_s` seconds.
class LateTouch final : public TouchDecorator {
 public:
  LateTouch(std::unique_ptr<TouchBackend> inner, double by_us, double for_s)
      : TouchDecorator(std::move(inner)), by_us_(by_us), for_s_(for_s) {}
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    const Stopwatch watch;
    const std::span<const Contact> answers = inner().ask(poses, budget_us);
    while (watch.elapsed_us() < by_us_ && since_.elapsed_s() < for_s_) {
    }
    return answers;
  }

 private:
  double by_us_, for_s_;
  Stopwatch since_;
};

/// Gives no valid answer.
class FaultyTouch final : public TouchDecorator {
 public:
  using TouchDecorator::TouchDecorator;
  std::span<const Contact> ask(std::span<const Pose>, double) noexcept override { return {&answer_, 1}; }

 private:
  Contact answer_;
};

/// A GPU or a CPU of any speed, which counts the back ends made on it; all of them are the CPU's.
class MadeUpKind final : public BackendKind {
 public:
  MadeUpKind(std::string_view name, double late_us, std::string failure = {})
      : name_(name), late_us_(late_us), failure_(std::move(failure)) {}

  std::string_view name() const override { return name_; }
  const std::vector<std::string>& methods() const override { return cpu_->methods(); }
  std::string machine(unsigned) const override { return fmt::format("made-up {}", name_); }
  std::unique_ptr<TouchBackend> make(const BackendRequest& request) const override {
    ++made;
    brushed = request.brush.has_value();
    points = request.model.cloud.size();
    if (failure_ == kNoAnswer) return std::make_unique<FaultyTouch>(cpu_->make(request));
    if (!failure_.empty()) throw GpuError("{}", failure_);
    return std::make_unique<LateTouch>(cpu_->make(request), late_us_, cold_s > 0 ? cold_s : 1e9);
  }
  double warmUp_s() const override { return cold_s; }

  static constexpr std::string_view kNoAnswer = "gave no valid answer";
  double cold_s = 0;  // so long it is late; 0: always
  mutable int made = 0;
  mutable bool brushed = false;
  mutable std::size_t points = 0;

 private:
  std::string_view name_;
  double late_us_;
  std::string failure_;
  std::unique_ptr<BackendKind> cpu_ = cpuBackend();
};

/// A choice with all that it says.
struct Chosen final : LogListener {
  explicit Chosen(const MadeUpKind& gpu, const MadeUpKind& cpu, const std::filesystem::path& memory,
                  const SessionConfig& config = {}, const Model& model = sphereModel(), bool mayEdit = false) {
    log.listen(this);
    name = soonerBackend(config, model,
                         {.gpu = gpu,
                          .cpu = cpu,
                          .log = log,
                          .memory = MeasuredBackends(memory),
                          .laterBrush = mayEdit ? std::optional(BrushConfig{}) : std::nullopt})
               .name();
  }
  void said(std::string_view line) override { text += std::string(line) + "\n"; }
  void progressed(std::string_view, double) override {}

  Log log{true};
  std::string text, name;
};

constexpr double kLate_us = 2000;  // far more than a query or an edit of the sphere takes

}  // namespace

TEST_CASE("auto takes the back end that answers sooner, the GPU in a tie within a tenth, and says so in one line") {
  const BackendChoice cpu = soonerOf(timesOf(140, 12));
  CHECK(!cpu.gpu);
  CHECK(cpu.sentence == "Back end: cpu (12 us; Intel UHD 630: 140 us; p99 of a tick with an edit, measured for 0.6 s)");
  const BackendChoice gpu = soonerOf(timesOf(18, 973));
  CHECK(gpu.gpu);
  CHECK(gpu.sentence == "Back end: Intel UHD 630 (18 us; cpu: 973 us; p99 of a tick with an edit, measured for 0.6 s)");
  CHECK(soonerOf(timesOf(109, 100)).gpu);
  CHECK(!soonerOf(timesOf(111, 100)).gpu);
  BackendTimes earlier = timesOf(10, 20);
  earlier.edits = false;
  earlier.measured_s.reset();
  CHECK(soonerOf(earlier).sentence ==
        "Back end: Intel UHD 630 (10 us; cpu: 20 us; p99 of a query, measured earlier; palpate doctor --forget "
        "measures again)");
}

TEST_CASE("auto takes the back end that does not fail while it is measured, and gives the reason") {
  BackendTimes times = timesOf({}, 900);
  times.gpu.failure = "the GPU was lost";
  CHECK(!soonerOf(times).gpu);
  CHECK(says(soonerOf(times).sentence, "cpu (900 us; Intel UHD 630: not usable: the GPU was lost;"));
  times = timesOf(900, {});
  times.cpu.failure = "out of memory";
  CHECK(soonerOf(times).gpu);
  times.gpu.failure = "the GPU was lost";
  CHECK(soonerOf(times).gpu);  // whose own error then ends the session
}

TEST_CASE("a GPU is measured once it has reached its usual clock") {
  const ScratchFolder folder;
  MadeUpKind gpu("vulkan", kLate_us);
  const MadeUpKind cpu("cpu", kLate_us / 4);
  gpu.cold_s = 0.5;
  CHECK(Chosen(gpu, cpu, folder / "backends").name == "vulkan");
}

TEST_CASE("the measurement finds the sooner back end with the session's own brush, once for each kind of session") {
  const ScratchFolder folder;
  const auto memory = folder / "palpate" / "backends";
  const MadeUpKind slow("vulkan", kLate_us), fast("vulkan", 0), cpu("cpu", 0), slowCpu("cpu", kLate_us);
  SessionConfig sculpting;
  sculpting.brush = BrushConfig{};

  const Chosen first(slow, cpu, memory);
  CHECK(first.name == "cpu");
  CHECK(says(first.text, "p99 of a query, measured for"));
  CHECK(slow.made == 1);
  CHECK(cpu.made == 1);
  CHECK(!cpu.brushed);
  const Chosen again(slow, cpu, memory);
  CHECK(again.name == "cpu");
  CHECK(says(again.text, "measured earlier"));
  CHECK(slow.made == 1);

  const Chosen edited(slow, cpu, memory, sculpting);
  CHECK(edited.name == "cpu");
  CHECK(says(edited.text, "p99 of a tick with an edit, measured for"));
  CHECK(slow.made == 2);
  CHECK(cpu.brushed);
  CHECK(says(Chosen(slow, cpu, memory, {}, sphereModel(), true).text, "a tick with an edit, measured earlier"));
  CHECK(says(Chosen(slow, cpu, memory, {}, sphereModel(20'000)).text, "measured for"));  // ten times the points

  CHECK(MeasuredBackends(memory).count() == 3);
  CHECK(MeasuredBackends(memory).forget());
  CHECK(!MeasuredBackends(memory).forget());
  CHECK(Chosen(fast, slowCpu, memory).name == "vulkan");
}

TEST_CASE("a GPU that fails while it is measured leaves the session to the CPU, and is tried again at the next start") {
  const ScratchFolder folder;
  const MadeUpKind cpu("cpu", kLate_us);
  for (const std::string why : {"the driver refused a pipeline", "gave no valid answer"}) {
    const MadeUpKind broken("vulkan", 0, why);
    for (int start = 1; start <= 2; ++start) {
      const Chosen chosen(broken, cpu, folder / "backends");
      CHECK(chosen.name == "cpu");
      CHECK(says(chosen.text, "made-up vulkan: not usable: "));
      CHECK(says(chosen.text, why));
      CHECK(broken.made == start);
    }
  }
}

TEST_CASE("a damaged memory of measured back ends is ignored with a sentence, and replaced") {
  const ScratchFolder folder;
  const auto memory = folder / "backends";
  const MadeUpKind gpu("vulkan", kLate_us), cpu("cpu", 0);
  Chosen(gpu, cpu, memory);
  const std::string whole = contentOf(memory);
  const std::string head = whole.substr(0, whole.find('\n') + 1), line = whole.substr(head.size());
  int made = gpu.made;
  for (const auto& [content, why] : {std::pair<std::string, std::string>{"what is this\n", "is not a file of measured"},
                                     {head + "x12.5 " + line, "is damaged in line 2"},
                                     {head + line + "-3 4 a\n", "is damaged in line 3"},
                                     {head + line + "nan 4 a\n", "is damaged in line 3"},
                                     {head + "1e400" + line, "is damaged in line 2"},
                                     {whole.substr(0, head.size() + 4), "is damaged in line 2"}}) {
    CAPTURE(content);
    std::ofstream(memory, std::ios::binary) << content;
    const Chosen chosen(gpu, cpu, memory);
    CHECK(chosen.name == "cpu");
    CHECK(says(chosen.text, memory.string()));
    CHECK(says(chosen.text, why));
    CHECK(gpu.made == ++made);
    CHECK(says(Chosen(gpu, cpu, memory).text, "measured earlier"));
  }
}

TEST_CASE("the memory of measured back ends is bounded, and a folder that cannot be written costs nothing") {
  const ScratchFolder folder;
  const MeasuredBackends memory(folder / "backends");
  for (int i = 0; i < 100; ++i) memory.remember(fmt::format("machine {}", i), {1.0 + i, 2.0});
  CHECK(memory.count() == MeasuredBackends::kMax);
  const auto none = [](std::string_view what) { FAIL(what); };
  CHECK(!memory.recall("machine 3", none));
  REQUIRE(memory.recall("machine 99", none));
  CHECK(memory.recall("machine 99", none)->gpu_us == 100);
  std::ofstream(folder / "file") << "x";
  const MeasuredBackends nowhere(folder / "file" / "backends");
  nowhere.remember("machine", {1, 2});
  CHECK(nowhere.count() == 0);
  const MadeUpKind gpu("vulkan", kLate_us), cpu("cpu", 0);
  CHECK(Chosen(gpu, cpu, folder / "file" / "backends").name == "cpu");
  CHECK(Chosen(gpu, cpu, {}).name == "cpu");
}

TEST_CASE("auto measures nothing, and keeps the GPU, where points move or the CPU lacks what is configured") {
  const ScratchFolder folder;
  const MadeUpKind gpu("vulkan", kLate_us), cpu("cpu", 0);
  SessionConfig moving, timed;
  moving.motion = MotionConfig{};
  timed.backend.timesPasses = true;
  for (const SessionConfig& config : {moving, timed}) {
    const Chosen chosen(gpu, cpu, folder / "backends", config);
    CHECK(chosen.name == "vulkan");
    CHECK(chosen.text.empty());
  }
  CHECK(gpu.made + cpu.made == 0);
}

TEST_CASE("a large cloud is measured on the points around the hand, so that the index of all is not built for it") {
  const ScratchFolder folder;
  const MadeUpKind gpu("vulkan", kLate_us), cpu("cpu", 0);
  const Chosen chosen(gpu, cpu, folder / "backends", {}, sphereModel(600'000));
  CHECK(chosen.name == "cpu");
  CHECK(cpu.points > 100'000);
  CHECK(cpu.points <= 200'000);
}

}  // namespace palpate::backend_choice_test

#include "apps/view/loader.hpp"

#include <filesystem>
#include <utility>

#include "apps/cli/backend.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

namespace {

constexpr double kReading = 0.7;  // share of reading in the whole time, estimated

struct ExceedsMemory {
  MemoryNeed need;
};

}  // namespace

Loader::~Loader() { cancel(); }

void Loader::open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel) {
  cancel();
  given_.reset();
  const std::string name = std::filesystem::path(options.config.model.file).filename().string();
  const bool isHeard = isRosModel(options.config.model.file);
  const std::string what = (options.config.model.join ? "joining " : isHeard ? "receiving " : "reading ") + name;
  begin(std::move(options), brush, feel, what);
}

void Loader::open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel, Model model) {
  cancel();
  given_ = std::move(model);
  begin(std::move(options), brush, feel, "preparing touch and sight");
}

void Loader::begin(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel,
                   const std::string& what) {
  options_ = std::move(options);
  brush_ = brush;
  feel_ = feel;
  cancelled_ = isRead_ = isLet_ = false;
  mayBuild_ = {};
  enter(what, 0);
  context_.log().listen(this);
  result_ = std::async(std::launch::async, [this] { return load(); });
}

void Loader::stop() {
  cancelled_ = true;
  build();
}

void Loader::cancel() {
  if (!result_.valid()) return;
  stop();
  result_.wait();
  result_ = {};
  isRead_ = false;
  context_.log().listen(nullptr);
}

void Loader::build() {
  if (!std::exchange(isLet_, true)) mayBuild_.set_value();
}

Loader::Result Loader::load() {
  const JobStopScope stops({.flag = &cancelled_, .mayCut = true});
  try {
    std::function<void(const MemoryNeed&)> exceeds;
    if (!options_.exceedsMemory) exceeds = [](const MemoryNeed& need) { throw ExceedsMemory{need}; };
    // Normals are estimated on the CPU: the present session still uses the GPU's queues.
    Model model = given_ ? std::move(*given_)
                         : loadModel(options_.config.model, {.log = context_.log(),
                                                             .threads = context_.threads(),
                                                             .join = joiningHand(options_.hand),
                                                             .fetch = rosFetcher(options_.network),
                                                             .watch = rosWatcher(options_.network, context_.threads()),
                                                             .exceeds = exceeds});
    requirePoints(model, options_.config.model.file);
    if (options_.live.left) options_.live.left->requireModel(model);
    isRead_ = true;
    mayBuild_.get_future().wait();
    if (cancelled_) return {};
    enter("preparing touch and sight", kReading);
    if (options_.backendIsOpen)
      options_.config.backend.name = soonerBackend(context_, options_.config, model, BrushConfig{});
    auto session = std::make_unique<WindowSession>(context_, sight_, std::move(model), options_, brush_, feel_);
    throwIfStopWanted();
    return {std::move(session), {}};
  } catch (const Stopped&) {
    return {};
  } catch (const ExceedsMemory& exceeds) {
    return {.session = nullptr, .failure = {}, .need = exceeds.need};
  } catch (const std::bad_alloc&) {
    return {nullptr, options_.config.model.file + ": out of memory", true};
  } catch (const OutOfGpuMemory& error) {
    return {nullptr, error.what(), true};
  } catch (const std::exception& error) {
    return {nullptr, error.what()};
  }
}

std::optional<Loader::Result> Loader::take() {
  if (!result_.valid() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  Result result = result_.get();
  isRead_ = false;
  context_.log().listen(nullptr);
  return result;
}

void Loader::enter(std::string stage, double progress) {
  const std::scoped_lock hold(lock_);
  stage_ = std::move(stage);
  progress_ = progress;
}

std::string Loader::stage() const {
  const std::scoped_lock hold(lock_);
  return stage_;
}

void Loader::said(std::string_view line) {
  const std::scoped_lock hold(lock_);
  remarks_.emplace_back(line);
}

void Loader::progressed(std::string_view, double fraction) { progress_ = kReading * fraction; }

std::vector<std::string> Loader::takeRemarks() {
  const std::scoped_lock hold(lock_);
  return std::exchange(remarks_, {});
}

}  // namespace palpate

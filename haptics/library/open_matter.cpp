#include "haptics/library/open_matter.hpp"

#include "engine/matter/matter_parameters.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/matter_scenes.hpp"

namespace palpate::library {

namespace {

constexpr float kUnits_per_m = 1e3f;  // model units of a scene are millimetres

// Soft bodies are moved by the CPU unless the program asks for a GPU.
std::string backendFor(const MatterScene& scene, const pp_matter_options& options) {
  return backendOf(options.backend, {options.gpu, options.vulkan}, scene.matter != Matter::soft && hasRealGpu());
}

}  // namespace

MatterScene sceneNamed(const std::string& name) {
  if (const auto scene = matterScene(name)) return *scene;
  std::error_code ignored;
  const bool isThere = std::filesystem::exists(name, ignored);
  throw UsageError("scene: '{}' is neither a JSON file nor one of {}{}", name, builtInScenes(),
                   isThere ? "; to use the file of a cloud, read it first" : "");
}

pp_parameter parameterOf(const SimulationParameter& parameter) {
  pp_parameter told{};
  putText(parameter.name, told.name);
  putText(parameter.label, told.label);
  putText(parameter.unit, told.unit);
  told.value = parameter.value;
  told.low = parameter.low;
  told.high = parameter.high;
  return told;
}

OpenMatter::OpenMatter(const std::string& name, const pp_matter_options& options, std::shared_ptr<Watch> watch)
    : watch_(std::move(watch)), gpu_({options.gpu, options.vulkan}) {
  const MatterScene scene = sceneNamed(name);
  backend_ = backendFor(scene, options) == "cpu" ? cpuBackend() : gpu_.backend();
  machine_ = backend_->machine(options.threads);
  Messages messages(options.log, options.log_user, *watch_);
  SessionConfig config{.model = {.file = name}};
  config.matter = scene;
  planOf(scene, backend_->matterMemory_bytes());
  model_ = loadModel(config, {.log = messages.sink(), .threads = options.threads});
  MatterOptions matter{.threads = options.threads, .model = model_.fluid() ? model_.fluid()->standing : nullptr};
  if (const SoftPoints* const soft = model_.as<SoftPoints>()) matter.soft = soft->body;
  world_ = backend_->simulate(scene, matter);
}

void OpenMatter::step(std::uint64_t steps) {
  const auto require = [this] {
    if (world_->state() == MatterState::running) return;
    throw SimulationError(
        "the simulation {} after {:.3f} s; use more substeps, and reset it",
        world_->state() == MatterState::diverged ? "has diverged" : "has too many particles in one place",
        world_->time_s());
  };
  require();
  for (std::uint64_t k = 0; k < steps; ++k) {
    if (isStopWanted()) throw Stopped("stopped after {} of {} ms", k, steps);
    world_->step();
    require();
    watch_->progressed("simulating", static_cast<double>(k + 1) / static_cast<double>(steps));
  }
}

std::vector<SimulationParameter> OpenMatter::parameters() const { return parametersOf(world_->scene()); }

void OpenMatter::setParameter(std::string_view name, double value) {
  MatterScene scene = world_->scene();
  try {
    palpate::setParameter(scene, name, value);
    world_->change(scene);
  } catch (const Error& error) {
    throw UsageError("{}", error.what());
  }
}

std::shared_ptr<const FrameObject> OpenMatter::frame() {
  CloudFrame now;
  world_->makeFrame(now);
  auto frame = std::make_shared<FrameObject>();
  frame->cloud.positions = std::move(now.positions);
  frame->cloud.normals = std::move(now.normals);
  frame->velocities = std::move(now.velocities);
  for (Vec3& position : frame->cloud.positions) position *= kUnits_per_m;
  for (Vec3& velocity : frame->velocities) velocity *= kUnits_per_m;
  frame->velocities.resize(frame->cloud.size(), Vec3(0));
  frame->moving = frame->cloud.size();
  frame->time_s = world_->time_s();
  return frame;
}

pp_matter_state OpenMatter::state() const {
  pp_matter_state state = usual<pp_matter_state>();
  const MatterObservation seen = world_->observe();
  state.failed = world_->state() != MatterState::running;
  state.substeps = world_->plan().substeps;
  state.particles = seen.particles;
  state.inside_model = world_->model() ? world_->insideModel() : 0;
  state.t_s = seen.time_s;
  state.kinetic_J = seen.kinetic_J;
  state.potential_J = seen.potential_J;
  putVector(seen.momentum, state.momentum_kg_m_s);
  state.max_compression = seen.maxCompression;
  state.front_mm = static_cast<double>(kUnits_per_m) * seen.front_m;
  if (world_->model()) putVector(world_->onModel().force_N, state.on_model_N);
  putText(machine_, state.machine);
  return state;
}

}  // namespace palpate::library

#include "haptics/library/open_matter.hpp"

#include "haptics/library/failures.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate::library {

namespace {

// Soft bodies are moved by the CPU unless the program asks for a GPU.
std::string backendFor(const SimulatedScene& scene, const pp_matter_options& options) {
  const auto never = [] { return false; };
  return backendOf(options.backend, {options.gpu, options.vulkan}, scene.isSoft() ? never : hasRealGpu);
}

}  // namespace

SceneRef openScene(const std::string& name) {
  if (SceneRef scene = sceneNamed(name)) return scene;
  if (!canSimulate()) throw NotBuilt(fmt::format("'{}' is opened as a scene and", name), "PALPATE_SIMULATION");
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
  const SceneRef scene = openScene(name);
  backend_ = backendFor(*scene, options) == "cpu" ? cpuBackend() : gpu_.backend();
  machine_ = backend_->machine(options.threads);
  Messages messages(options.log, options.log_user, *watch_);
  world_ = scene->run(*backend_, name, {.log = messages.sink(), .threads = options.threads});
}

void OpenMatter::step(std::uint64_t steps) {
  const auto require = [this] {
    const std::string failure = world_->failure();
    if (!failure.empty())
      throw SimulationError("the simulation {} after {:.3f} s; use more substeps, and reset it", failure,
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

void OpenMatter::setParameter(std::string_view name, double value) {
  try {
    world_->setParameter(name, value);
  } catch (const Error& error) {
    throw UsageError("{}", error.what());
  }
}

std::shared_ptr<const FrameObject> OpenMatter::frame() {
  CloudFrame now = world_->frame();
  auto frame = std::make_shared<FrameObject>();
  frame->cloud.positions = std::move(now.positions);
  frame->cloud.normals = std::move(now.normals);
  frame->velocities = std::move(now.velocities);
  frame->moving = frame->cloud.size();
  frame->time_s = now.time_s;
  return frame;
}

pp_matter_state OpenMatter::state() const {
  pp_matter_state state = usual<pp_matter_state>();
  const FreeSimulation::Totals totals = world_->totals();
  state.failed = !world_->failure().empty();
  state.substeps = world_->substeps();
  state.particles = totals.particles;
  state.inside_model = totals.insideModel;
  state.t_s = world_->time_s();
  state.kinetic_J = totals.kinetic_J;
  state.potential_J = totals.potential_J;
  putVector(totals.momentum_kg_m_s, state.momentum_kg_m_s);
  state.max_compression = totals.maxCompression;
  state.front_mm = totals.front_mm;
  putVector(totals.onModel_N, state.on_model_N);
  putText(machine_, state.machine);
  return state;
}

}  // namespace palpate::library

// The C interface: scenes of matter, in sessions and alone, and their points.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/library/claims.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/held_session.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/options.hpp"
#include "haptics/library/watch.hpp"
#include "haptics/session/simulated_scene.hpp"
#include "haptics/session/simulation.hpp"

#include <palpate/palpate.h>

using namespace palpate;
using namespace palpate::library;

namespace {

// Soft bodies are moved by the CPU unless the program asks for a GPU.
std::string backendFor(const SimulatedScene& scene, const pp_matter_options& options) {
  const auto never = [] { return false; };
  return backendOf(options.backend, {options.gpu, options.vulkan}, scene.isSoft() ? never : hasRealGpu);
}

/// A scene by its name, or from a file. Throws UsageError that lists the built-in scenes, FileError, NotBuilt, and
/// Error for what cannot be simulated.
SceneRef openScene(const std::string& name) {
  if (SceneRef scene = sceneNamed(name)) return scene;
  if (!canSimulate()) throw NotBuilt(fmt::format("'{}' is opened as a scene and", name), "PALPATE_SIMULATION");
  std::error_code ignored;
  const bool isThere = std::filesystem::exists(name, ignored);
  throw UsageError("scene: '{}' is neither a JSON file nor one of {}{}", name, builtInScenes(),
                   isThere ? "; to use the file of a cloud, read it first" : "");
}

/// Converts a parameter for programs; long texts are cut off.
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

}  // namespace

namespace palpate::library {

/// A scene of matter without hands, for the C interface. Calls require an exclusive claim of the calling thread.
class OpenMatter {
 public:
  /// Throws Error.
  OpenMatter(const std::string& name, const pp_matter_options& options, std::shared_ptr<Watch> watch)
      : watch_(std::move(watch)), gpu_({options.gpu, options.vulkan}) {
    const SceneRef scene = openScene(name);
    backend_ = backendFor(*scene, options) == "cpu" ? cpuBackend() : gpu_.backend();
    machine_ = backend_->machine(options.threads);
    Messages messages(options.log, options.log_user, *watch_);
    world_ = scene->run(*backend_, name, {.log = messages.sink(), .threads = options.threads});
  }

  Claims& claims() { return claims_; }
  Watch& watch() { return *watch_; }
  /// Advances by `steps` milliseconds, or until it is stopped. Throws Stopped, and SimulationError if the scene fails
  /// meanwhile or has failed before.
  void step(std::uint64_t steps) {
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

  void reset() { world_->reset(); }
  std::vector<SimulationParameter> parameters() const { return world_->parameters(); }
  /// Throws UsageError, without effect.
  void setParameter(std::string_view name, double value) {
    try {
      world_->setParameter(name, value);
    } catch (const Error& error) {
      throw UsageError("{}", error.what());
    }
  }

  std::shared_ptr<const FrameObject> frame() {
    CloudFrame now = world_->frame();
    auto frame = std::make_shared<FrameObject>();
    frame->cloud.positions = std::move(now.positions);
    frame->cloud.normals = std::move(now.normals);
    frame->velocities = std::move(now.velocities);
    frame->moving = frame->cloud.size();
    frame->time_s = now.time_s;
    return frame;
  }

  pp_matter_state state() const {
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

 private:
  std::shared_ptr<Watch> watch_;
  Claims claims_;
  GpuHalf gpu_;
  std::unique_ptr<BackendKind> backend_;
  std::string machine_;
  std::unique_ptr<FreeSimulation> world_;
};

}  // namespace palpate::library

namespace {

template <class Do>
pp_status with(pp_matter matter, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenMatter>(matter.id);
    const Claims::Held held(found->claims(), Claim::all);
    act(*found);
  });
}

pp_frame opened(std::shared_ptr<const FrameObject> frame) {
  return library::opened<pp_frame>(std::const_pointer_cast<FrameObject>(std::move(frame)));
}

void giveParameter(const std::vector<SimulationParameter>& all, std::uint64_t index, pp_parameter* parameter) {
  if (index >= all.size())
    throw UsageError("index: {} is out of range; the scene has {} parameters", index, all.size());
  required(parameter, "parameter") = parameterOf(all[index]);
}

// Matter may be controlled while another thread touches, even without a budget.
template <class Do>
pp_status governing(pp_session session, Do&& act) {
  return library::with(session, Claim::look, [&](OpenSession& open) { act(open); });
}

}  // namespace

uint32_t pp_can_simulate(void) { return canSimulate() ? 1 : 0; }

pp_status pp_session_open_matter(const char* scene, const pp_session_options* options, pp_session* session) {
  clear(session);
  return guarded([&] {
    const std::string name = &required(scene, "scene");
    openSession(options, session, [&] {
      Subject subject;
      subject.model = {.file = name, .matter = openScene(name)};
      return subject;
    });
  });
}

pp_status pp_session_frame(pp_session session, pp_frame* frame) {
  clear(frame);
  return looking(session, [&](OpenSession& open) { required(frame, "frame") = opened(open.frame()); });
}

pp_status pp_frame_view(pp_frame frame, pp_moving_points* points) {
  clear(points);
  return guarded([&] {
    const auto found = objectOf<FrameObject>(frame.id);
    pp_moving_points view{};
    view.points = viewOf(found->cloud);
    if (!found->velocities.empty()) view.velocities = &found->velocities.front().x;
    view.moving = found->moving;
    view.t_s = found->time_s;
    required(points, "points") = view;
  });
}

pp_status pp_frame_close(pp_frame frame) {
  return guarded([&] { handles().remove(HandleKind::frame, frame.id); });
}

pp_status pp_session_pause(pp_session session, uint32_t on) {
  return governing(session, [&](OpenSession& open) { open.simulation().pause(on != 0); });
}

pp_status pp_session_reset(pp_session session) {
  return governing(session, [&](OpenSession& open) { open.reset(); });
}

pp_status pp_session_parameter_count(pp_session session, uint64_t* count) {
  clear(count);
  return governing(session, [&](OpenSession& open) {
    const std::size_t there = open.simulation().parameters().size();
    required(count, "count") = there;
  });
}

pp_status pp_session_get_parameter(pp_session session, uint64_t index, pp_parameter* parameter) {
  clear(parameter);
  return governing(session,
                   [&](OpenSession& open) { giveParameter(open.simulation().parameters(), index, parameter); });
}

pp_status pp_session_set_parameter(pp_session session, const char* name, double value) {
  return governing(session, [&](OpenSession& open) { open.setParameter(&required(name, "name"), value); });
}

pp_status pp_session_get_motion(pp_session session, pp_motion* motion) {
  clear(motion);
  return governing(session, [&](OpenSession& open) { giveInfo(motion, open.motion(), "motion"); });
}

pp_status pp_matter_open(const char* scene, const pp_matter_options* options, pp_matter* matter) {
  clear(matter);
  return guarded([&] {
    const std::string name = &required(scene, "scene");
    required(matter, "matter");
    const pp_matter_options given = optionsFrom(options, "options");
    const auto watch = std::make_shared<Watch>(given.watch);
    std::shared_ptr<OpenMatter> made;
    watch->runCut([&] { made = std::make_shared<OpenMatter>(name, given, watch); });
    *matter = library::opened<pp_matter>(std::move(made));
  });
}

pp_status pp_matter_close(pp_matter matter) {
  return guarded([&] {
    const auto found = objectOf<OpenMatter>(matter.id);
    if (!found->claims().home().isThis()) return handles().abandon(HandleKind::matter, matter.id);
    const Claims::Held held(found->claims(), Claim::all);
    handles().remove(HandleKind::matter, matter.id);
  });
}

pp_status pp_matter_step(pp_matter matter, uint64_t steps) {
  return with(matter, [&](OpenMatter& open) { open.watch().run([&] { open.step(steps); }); });
}

pp_status pp_matter_reset(pp_matter matter) {
  return with(matter, [](OpenMatter& open) { open.reset(); });
}

pp_status pp_matter_frame(pp_matter matter, pp_frame* frame) {
  clear(frame);
  return with(matter, [&](OpenMatter& open) { required(frame, "frame") = opened(open.frame()); });
}

pp_status pp_matter_parameter_count(pp_matter matter, uint64_t* count) {
  clear(count);
  return with(matter, [&](OpenMatter& open) { required(count, "count") = open.parameters().size(); });
}

pp_status pp_matter_get_parameter(pp_matter matter, uint64_t index, pp_parameter* parameter) {
  clear(parameter);
  return with(matter, [&](OpenMatter& open) { giveParameter(open.parameters(), index, parameter); });
}

pp_status pp_matter_set_parameter(pp_matter matter, const char* name, double value) {
  return with(matter, [&](OpenMatter& open) { open.setParameter(&required(name, "name"), value); });
}

pp_status pp_matter_get_state(pp_matter matter, pp_matter_state* state) {
  clear(state);
  return with(matter, [&](OpenMatter& open) { giveInfo(state, open.state(), "state"); });
}

// Matter in Python: scenes in sessions and alone, and their points.
#include "apps/python/session.hpp"

namespace palpate::python {

using namespace py::literals;

namespace {

class PyFrame {
 public:
  explicit PyFrame(pp::Frame frame) : frame_(std::move(frame)) {}
  pp_moving_points view() const { return frame_.view(); }

 private:
  pp::Frame frame_;
};

using FramePointer = std::shared_ptr<PyFrame>;

template <class Get>
auto viewed(Get&& get) {
  return [get = std::forward<Get>(get)](const py::object& self) -> py::object {
    const pp_moving_points points = self.cast<FramePointer>()->view();
    return viewOf(get(points), {static_cast<py::ssize_t>(points.points.count), 3}, self);
  };
}

/// Tuples of name, value, low, high, unit, label.
py::list told(const std::vector<pp_parameter>& parameters) {
  py::list all;
  for (const pp_parameter& each : parameters)
    all.append(py::make_tuple(std::string(each.name), each.value, each.low, each.high, std::string(each.unit),
                              std::string(each.label)));
  return all;
}

/// Only one thread at a time uses it; others wait.
class PyMatter {
 public:
  PyMatter(const std::string& scene, const std::optional<std::string>& gpu, std::uint32_t threads,
           const std::string& backend) {
    pp_matter_options options = pp_default_matter_options();
    options.gpu = gpu ? gpu->c_str() : nullptr;
    options.backend = backend.c_str();
    options.threads = threads;
    options.watch = interruption_.watch();
    const WithoutGil released;
    matter_ = interruption_.during([&] { return pp::Matter(scene, options); });
  }

  template <class Do>
  auto with(Do&& act) {
    home_.require();
    const WithoutGil released;
    const std::scoped_lock lock(inUse_);
    return interruption_.during([&] { return act(matter_); });
  }

  bool isHere() const { return home_.isHere(); }

 private:
  Home home_;
  Interruption interruption_;
  std::mutex inUse_;
  pp::Matter matter_;
};

py::dict stateOf(const pp_matter_state& state) {
  const auto three = [](const double(&v)[3]) { return py::make_tuple(v[0], v[1], v[2]); };
  return py::dict("t_s"_a = state.t_s, "particles"_a = state.particles, "substeps"_a = state.substeps,
                  "kinetic_J"_a = state.kinetic_J, "potential_J"_a = state.potential_J,
                  "momentum_kg_m_s"_a = three(state.momentum_kg_m_s), "max_compression"_a = state.max_compression,
                  "front_mm"_a = state.front_mm, "on_model_N"_a = three(state.on_model_N),
                  "inside_model"_a = state.inside_model, "failed"_a = state.failed != 0,
                  "machine"_a = std::string(state.machine));
}

}  // namespace

void bindMatter(py::module_& module) {
  module.def(
      "can_simulate", [] { return pp_can_simulate() != 0; },
      "can_simulate() -> bool\n\n"
      "True if this palpate was built with PALPATE_SIMULATION. Otherwise Matter() and a Session of a scene raise\n"
      "Error with the status \"unsupported\".");
  py::class_<PyFrame, FramePointer>(
      module, "Frame", "Moving points at one time, immutable; views are read-only and keep the frame alive.")
      .def("__len__", [](const PyFrame& frame) { return frame.view().points.count; })
      .def("__repr__",
           [](const PyFrame& frame) {
             const pp_moving_points points = frame.view();
             return "<palpate.Frame of " + std::to_string(points.points.count) + " points at " +
                    py::str("{:.6g}").format(points.t_s).cast<std::string>() + " s>";
           })
      .def_property_readonly(
          "t_s", [](const PyFrame& frame) { return frame.view().t_s; }, "Time of the points, s.")
      .def_property_readonly(
          "moving", [](const PyFrame& frame) { return frame.view().moving; },
          "Number of moving points, which come first; the rest belong to bodies standing in the scene.")
      .def_property_readonly("positions", viewed([](const pp_moving_points& p) { return p.points.positions; }),
                             "(N, 3) float32 view, model units; mm for a scene of matter.")
      .def_property_readonly("velocities", viewed([](const pp_moving_points& p) { return p.velocities; }),
                             "(N, 3) float32 view, model units per second.")
      .def_property_readonly("normals", viewed([](const pp_moving_points& p) { return p.points.normals; }),
                             "(N, 3) float32 view, unit length; None without normals.");

  py::class_<PyMatter>(module, "_Matter")
      .def(py::init<const std::string&, const std::optional<std::string>&, std::uint32_t, const std::string&>(),
           py::arg("scene"), py::arg("gpu") = py::none(), py::arg("threads") = 0, py::arg("backend") = "auto")
      .def("_repr_png_", [](const py::object& self) { return helper("picture_of_matter")(self); })
      .def(
          "close",
          [](PyMatter& self) {
            if (self.isHere()) self.with([](pp::Matter& matter) { matter.close(); });
          },
          "close()\n\n"
          "Closes the scene; later calls raise ClosedError. A with statement does it.")
      .def(
          "step",
          [](PyMatter& self, std::uint64_t steps) { self.with([&](pp::Matter& matter) { matter.step(steps); }); },
          py::arg("steps") = 1,
          "step(steps=1)\n\n"
          "Advances the scene by this number of steps, each of a millisecond. Raises Error with the status\n"
          "\"simulation\" if it diverges: it stays at that time until reset().")
      .def(
          "reset", [](PyMatter& self) { self.with([](pp::Matter& matter) { matter.reset(); }); },
          "reset()\n\n"
          "Restarts the scene, with the parameters that were set.")
      .def(
          "frame",
          [](PyMatter& self) {
            return std::make_shared<PyFrame>(self.with([](pp::Matter& matter) { return matter.frame(); }));
          },
          "frame() -> Frame\n\n"
          "The present particles, or the surface of a soft body.")
      .def(
          "set",
          [](PyMatter& self, const std::string& name, double value) {
            self.with([&](pp::Matter& matter) { matter.setParameter(name, value); });
          },
          py::arg("name"), py::arg("value"),
          "set(name, value)\n\n"
          "Sets the parameter with this name to the value, in its unit, from the next step on. Raises\n"
          "UsageError, without effect, if it is unknown or out of bounds.")
      .def("_parameters",
           [](PyMatter& self) { return told(self.with([](pp::Matter& matter) { return matter.parameters(); })); })
      .def(
          "state", [](PyMatter& self) { return stateOf(self.with([](pp::Matter& matter) { return matter.state(); })); },
          "state() -> dict\n\n"
          "State of all particles: t_s, particles, substeps, kinetic_J, potential_J, momentum_kg_m_s,\n"
          "max_compression, front_mm, on_model_N, inside_model, failed, machine.");
}

void bindSessionsMatter(py::class_<PySession>& session) {
  session
      .def(
          "frame",
          [](PySession& self) {
            return std::make_shared<PyFrame>(self.with([](pp::Session& open) { return open.frame(); }));
          },
          "frame() -> Frame\n\n"
          "The present points of a scene of matter, or the newest frame of moving points.")
      .def(
          "pause", [](PySession& self) { self.with([](pp::Session& open) { open.pause(true); }); },
          "pause()\n\n"
          "Pauses a scene of matter until resume(): it stands still, and no hand feels it.")
      .def(
          "resume", [](PySession& self) { self.with([](pp::Session& open) { open.pause(false); }); },
          "resume()\n\n"
          "Continues a paused scene of matter.")
      .def(
          "reset", [](PySession& self) { self.with([](pp::Session& open) { open.reset(); }); },
          "reset()\n\n"
          "Restarts a scene of matter with the next tick.")
      .def(
          "set",
          [](PySession& self, const std::string& name, double value) {
            self.with([&](pp::Session& open) { open.setParameter(name, value); });
          },
          py::arg("name"), py::arg("value"),
          "set(name, value)\n\n"
          "Sets the parameter with this name of a scene of matter to the value, in its unit, from the next\n"
          "step on, also while it is live. Raises UsageError, without effect, if it is unknown or out of\n"
          "bounds.")
      .def("_parameters",
           [](PySession& self) { return told(self.with([](pp::Session& open) { return open.parameters(); })); })
      .def("_motion", [](PySession& self) {
        const pp_motion motion = self.with([](pp::Session& open) { return open.motion(); });
        py::list energies;
        for (std::uint32_t i = 0; i < motion.hands; ++i)
          energies.append(py::make_tuple(motion.energy_J[i], motion.min_energy_J[i]));
        return py::dict("paused"_a = motion.paused != 0, "failure"_a = std::string(motion.failure),
                        "dropped_s"_a = motion.dropped_s, "energies_J"_a = energies);
      });
}

}  // namespace palpate::python

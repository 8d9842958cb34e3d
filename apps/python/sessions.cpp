// Sessions in Python. No Python code runs on a servo thread.
#include "apps/python/session.hpp"

#include <algorithm>

namespace palpate::python {

using namespace py::literals;

using Vector = std::array<double, 3>;

namespace {

constexpr std::array<std::pair<std::string_view, pp_mask>, 5> kMasks{{{"selected", PP_MASK_SELECTED},
                                                                      {"hidden", PP_MASK_HIDDEN},
                                                                      {"locked", PP_MASK_LOCKED},
                                                                      {"within", PP_MASK_WITHIN},
                                                                      {"lock_weights", PP_MASK_LOCK_WEIGHTS}}};

pp_mask maskNamed(const std::string& name) {
  for (const auto& [known, mask] : kMasks)
    if (name == known) return mask;
  refuse("unknown mask '" + name + "'; choose selected, hidden, locked, within, lock_weights");
}

std::vector<std::uint8_t> maskBytes(const py::array& mask) {
  refuseMasked(mask, "mask");
  if (mask.ndim() != 1 || mask.dtype().kind() != 'b')
    refuse("mask: a bool for each point is expected, not " + shapeOf(mask) + " of " +
           std::string(py::str(mask.dtype())));
  const py::array_t<bool, py::array::c_style | py::array::forcecast> bools(mask);
  return {bools.data(), bools.data() + bools.size()};
}

std::vector<std::uint8_t> weightBytes(const py::array& weights) {
  refuseMasked(weights, "mask");
  if (weights.ndim() != 1 || !weights.dtype().is(py::dtype::of<std::uint8_t>()))
    refuse("mask: a uint8 for each point is expected, not " + shapeOf(weights) + " of " +
           std::string(py::str(weights.dtype())));
  const py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast> bytes(weights);
  return {bytes.data(), bytes.data() + bytes.size()};
}

void bindTouch(py::class_<PySession>& session) {
  session
      .def("touch", &PySession::touch, py::arg("path"), py::arg("surface") = py::none(),
           "touch(path, surface=None) -> structured array\n\n"
           "Follows the path in virtual time and only feels. path: (N, 3), model units, one row for each\n"
           "tick; or (N, 4), seconds first. surface: \"average\", \"sphere\" or \"sharp\", from now on. Returns\n"
           "one row for each tick: t_s (s), hip, proxy, normal (3, model units), force_N (3),\n"
           "penetration_mm, contact, neighbours, fresh; with a tool of many points also torque_mNm (3, about\n"
           "the HIP). The same path gives the same rows.\n\n"
           "With several hands: a path for each, (hands, N, 3) or a list of arrays; the longest one\n"
           "determines the duration, and the result has the shape (ticks, hands). The time of a scene of\n"
           "matter continues from path to path, until reset(). Raises Error with the status \"simulation\" if\n"
           "the scene diverges.")
      .def("set_contact", &PySession::setContact, py::arg("surface") = py::none(), py::arg("friction") = py::none(),
           py::arg("stiffness_N_per_mm") = py::none(), py::arg("damping_N_s_per_mm") = py::none(),
           py::arg("max_force_N") = py::none(), py::arg("hand_gain") = py::none(),
           "set_contact(surface=None, friction=None, stiffness_N_per_mm=None, damping_N_s_per_mm=None,\n"
           "            max_force_N=None, hand_gain=None)\n\n"
           "From now on the surface and the force of contacts; None: as before. surface, friction,\n"
           "stiffness_N_per_mm, damping_N_s_per_mm and max_force_N are as for Session. A live session takes\n"
           "them between two ticks. hand_gain: motion of the stylus for a motion of a held device, 0.05 to 4\n"
           "(default 1); neither the stylus nor the force jumps.")
      .def("stroke", &PySession::stroke, py::arg("path"), py::arg("kind"),
           "stroke(path, kind, **brush) -> structured array\n\n"
           "As touch(), with a brush for this path. kind: a brush, as in palpate touch --edit.\n"
           "Settings of the brush: radius_mm and yield_depth_mm (depth of the hand from which the surface yields),\n"
           "mm in the hand, or radius and yield_depth, in model units; push_rate (push: share of the distance to its\n"
           "target that a point moves in one tick, 0 to 1), strength (share of the full effect in one tick,\n"
           "0 to 1), falloff (0 to 16), resample (points are inserted where the surface is stretched\n"
           "and merged where it is crowded), accumulate (inflate: a stroke raises points on where it passes again), "
           "color (three of 0 to 255), symmetry (each edit is also made mirrored, at\n"
           "the plane across \"x\", \"y\" or \"z\" through the middle of the model, or at\n"
           "\"PX,PY,PZ,NX,NY,NZ\", a position and the plane's normal). Of several hands the first one sculpts.")
      .def(
          "set_brush",
          [](PySession& self, const std::optional<std::string>& kind, const py::kwargs& settings) {
            if (!kind) return self.with([](pp::Session& open) { open.setNoBrush(); });
            const Brush brush(*kind, settings, self.mm_per_unit());
            self.with([&](pp::Session& open) { open.setBrush(brush.brush); });
          },
          py::arg("kind"),
          "set_brush(kind, **brush)\n\n"
          "Sets the brush of touch_pose() and touch_poses(), and of the present or next live hand, as for stroke(); "
          "kind None: they only "
          "feel. The first brush of a session is set before it is live.")
      .def(
          "set_mask",
          [](PySession& self, const std::string& which, const py::array& mask) {
            const pp_mask role = maskNamed(which);
            const std::vector<std::uint8_t> bytes = role == PP_MASK_LOCK_WEIGHTS ? weightBytes(mask) : maskBytes(mask);
            self.with([&](pp::Session& open) { open.setMask(role, bytes); });
          },
          py::arg("which"), py::arg("mask"),
          "set_mask(which, mask)\n\n"
          "Sets a mask of the present points: a bool for each point of cloud(). which: \"selected\"; \"hidden\"\n"
          "(neither drawn nor felt, and saved as all others are); \"locked\" (felt, and no brush changes them);\n"
          "\"within\" (if there are any, brushes change no others). \"lock_weights\": a uint8 for each point; brushes\n"
          "move a point by the rest of what they would move it, and none that has 255, as \"locked\" has. undo()\n"
          "undoes it as a stroke. The first mask of a session is set before it is live.")
      .def(
          "soften_lock",
          [](PySession& self, double radius_mm) { self.with([&](pp::Session& open) { open.softenLock(radius_mm); }); },
          py::arg("radius_mm"),
          "soften_lock(radius_mm)\n\n"
          "Softens the rims of what is locked, outwards: each weight below 255 becomes the mean of the weights of\n"
          "the points nearer than radius_mm, in the hand. undo() undoes it as a stroke.")
      .def(
          "remove_points",
          [](PySession& self, const py::array& mask) {
            const std::vector<std::uint8_t> bytes = maskBytes(mask);
            self.with([&](pp::Session& open) { open.removePoints(bytes); });
          },
          py::arg("mask"),
          "remove_points(mask)\n\n"
          "Removes points, as one stroke that undo() undoes: a bool for each point of cloud(), as for set_mask().")
      .def(
          "move_points",
          [](PySession& self, const py::array& mask, const std::array<double, 3>& offset,
             const std::array<double, 4>& rotation, double scale) {
            const std::vector<std::uint8_t> bytes = maskBytes(mask);
            self.with([&](pp::Session& open) { open.movePoints(bytes, offset, rotation, scale); });
          },
          py::arg("mask"), py::arg("offset") = std::array<double, 3>{},
          py::arg("rotation") = std::array<double, 4>{1, 0, 0, 0}, py::arg("scale") = 1.0,
          "move_points(mask, offset=(0, 0, 0), rotation=(1, 0, 0, 0), scale=1)\n\n"
          "Moves points, as one stroke that undo() undoes: to offset + scale * (rotation * position), in model\n"
          "units and the coordinates of cloud(); normals rotate. mask: as for set_mask(); rotation: a unit\n"
          "quaternion w, x, y, z; scale: positive.")
      .def(
          "mask",
          [](PySession& self, const std::string& which) -> py::array {
            const pp_mask role = maskNamed(which);
            std::vector<std::uint8_t> bytes;
            self.with([&](pp::Session& open) { bytes = open.mask(role, open.cloud().size()); });
            if (role == PP_MASK_LOCK_WEIGHTS)
              return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(bytes.size()), bytes.data());
            py::array_t<bool> mask(static_cast<py::ssize_t>(bytes.size()));
            std::ranges::copy(bytes, mask.mutable_data());
            return mask;
          },
          py::arg("which"), "mask(which) -> array\n\nA mask of the present points, as for set_mask().")
      .def(
          "open_layer",
          [](PySession& self, const std::string& name) { self.with([&](pp::Session& open) { open.openLayer(name); }); },
          py::arg("name"),
          "open_layer(name)\n\n"
          "Makes the layer of strokes of that name, or opens it again at strength 1: all strokes become part of it, "
          "until another\n"
          "one is opened, close_layer(), or until it slides, is hidden or merged. The first layer of a session is\n"
          "made before it is live. undo() undoes this and the changes below as a stroke.")
      .def(
          "close_layer", [](PySession& self) { self.with([](pp::Session& open) { open.closeLayer(); }); },
          "close_layer()\n\nStrokes become part of no layer.")
      .def(
          "slide_layer",
          [](PySession& self, const std::string& name, double strength, bool continues) {
            self.with([&](pp::Session& open) { open.slideLayer(name, strength, continues); });
          },
          py::arg("name"), py::arg("strength"), py::arg("continues") = false,
          "slide_layer(name, strength, continues=False)\n\n"
          "Gives the strokes of the layer of that name another strength, from -1 to 2: with 0 the points are as before "
          "them, with 1\n"
          "as after them, to the last bit, and in between on a closed surface; deep cuts or pulls have a\n"
          "smaller range, beyond which it raises Error. What they cut away is gone from 0.5 on. What other\n"
          "strokes did since goes along, and locked points\n"
          "stay as they are. continues: adds to the slide before, as one change to be undone.")
      .def(
          "hide_layer",
          [](PySession& self, const std::string& name, bool hidden) {
            self.with([&](pp::Session& open) { open.hideLayer(name, hidden); });
          },
          py::arg("name"), py::arg("hidden") = true,
          "hide_layer(name, hidden=True)\n\nHides the layer of strokes of that name, as with strength 0, or shows it "
          "again (hidden False).")
      .def(
          "merge_layer",
          [](PySession& self, const std::string& name) {
            self.with([&](pp::Session& open) { open.mergeLayer(name); });
          },
          py::arg("name"), "merge_layer(name)\n\nMakes the layer of that name part of the model, as strong as it is.")
      .def(
          "layer",
          [](PySession& self, const std::string& name) {
            const auto layer = self.with([&](pp::Session& open) { return open.layer(name); });
            return py::make_tuple(layer.strength, layer.isHidden, layer.points);
          },
          py::arg("name"),
          "layer(name) -> tuple\n\n"
          "Strength of the layer of strokes of that name, whether it is hidden, and the number of points that its "
          "strokes changed.")
      .def(
          "undo",
          [](PySession& self, std::uint64_t strokes) {
            return self.with([&](pp::Session& open) { return open.undo(strokes); });
          },
          py::arg("strokes") = 1,
          "undo(strokes=1) -> int\n\n"
          "Undoes the last strokes, each point to the last bit, and returns their number. A stroke consists\n"
          "of all edits in one contact, with gaps of up to 0.3 s. Raises Error, with the status \"network\", if the\n"
          "server of a joined session has not confirmed it within timeout_s; it is undone here all the same.")
      .def(
          "cancel_stroke",
          [](PySession& self) { return self.with([](pp::Session& open) { return open.cancelStroke(); }); },
          "cancel_stroke() -> bool\n\n"
          "Takes the stroke in progress back, each point to the last bit, as if it had never been made: it cannot be\n"
          "redone, and the hand makes no other before it has left the surface. Between two calls of touch_pose(), or\n"
          "of a live hand. False where no stroke is in progress. Raises Error as undo() does, and for a stroke larger\n"
          "than undo_memory_MiB, which stays.")
      .def(
          "redo",
          [](PySession& self, std::uint64_t strokes) {
            return self.with([&](pp::Session& open) { return open.redo(strokes); });
          },
          py::arg("strokes") = 1,
          "redo(strokes=1) -> int\n\n"
          "Redoes the strokes undone last, and returns their number.")
      .def(
          "cloud",
          [](PySession& self) {
            const bool isSingle = self.isSingle();
            return std::make_shared<PyCloud>(self.with([](pp::Session& open) { return open.cloud(); }), isSingle);
          },
          "cloud() -> Cloud\n\n"
          "A copy of the present points.");
}

void bindLive(py::class_<PySession>& session) {
  session
      .def("add_frame", &PySession::addFrame, py::arg("t_s"), py::arg("xyz"), py::arg("normals"),
           py::arg("velocities") = py::none(),
           "add_frame(t_s, xyz, normals, velocities=None)\n\n"
           "For a session of Session.of_frames(): the points are felt there from t_s on. t_s: s, time of\n"
           "the session's ticks, later than that of the frame before; a live session begins at 0. xyz,\n"
           "normals: (N, 3). velocities: (N, 3), model units per second, with which positions are\n"
           "extrapolated for up to 50 ms. May be called from any thread.")
      .def(
          "record",
          [](PySession& self, const py::object& path) {
            const std::string file = fileOf(path);
            self.with([&](pp::Session& open) { open.record(file); });
          },
          py::arg("file"),
          "record(file)\n\n"
          "Records the next path, or the next live session, up to its end, or from now on a live session, to this\n"
          "file, a session log (read_recording(), replay()). A log begins with the points as they were opened, and\n"
          "holds one hand without its own force law.")
      .def("_live_start", &PySession::startLive, py::arg("device"), py::arg("rate"), py::arg("builtin"),
           py::arg("path"), py::arg("law"), py::arg("allow_python_law"), py::arg("others"), py::arg("axes"))
      .def("_live_raise", &PySession::raiseOfLaw)
      .def("_live_late", &PySession::lateLaws)
      .def("_live_read_ticks", &PySession::readTicks)
      .def("_live_missed",
           [](PySession& self) { return self.with([](pp::Session& open) { return open.liveState().missed; }); })
      .def("_is_here", [](const PySession& self) { return self.isHere(); })
      .def("_live_running",
           [](PySession& self) { return self.with([](pp::Session& open) { return open.liveState().running != 0; }); })
      .def("_live_forces", [](PySession& self, bool on) { pp::check(pp_live_set_forces(self.session().handle(), on)); })
      .def("_live_stop", &PySession::stopLive);
}

void bindSource(py::module_& module) {
  py::class_<Source>(module, "_Source")
      .def(py::init([](const CloudPointer& cloud, const std::optional<std::string>& scene,
                       const std::optional<std::string>& folder, bool moving, bool stable_rows,
                       std::uint64_t max_points, double speed, bool loop, bool fuse,
                       const std::optional<JoinTuple>& join, const decltype(Source::clouds)& clouds) {
             return Source{cloud, moving, stable_rows, max_points, scene, folder, speed, loop, fuse, join, clouds};
           }),
           py::arg("cloud") = py::none(), py::arg("scene") = py::none(), py::arg("folder") = py::none(),
           py::arg("moving") = false, py::arg("stable_rows") = false, py::arg("max_points") = 0, py::arg("speed") = 1.0,
           py::arg("loop") = false, py::arg("fuse") = false, py::arg("join") = py::none(),
           py::arg("clouds") = py::list())
      .def_property_readonly("is_scene", [](const Source& self) { return self.scene.has_value(); })
      .def_property_readonly("is_joined", [](const Source& self) { return self.join.has_value(); });
}

void bindOpening(py::class_<PySession>& session) {
  const pp_contact_options contact = pp_default_contact_options();
  const pp_session_options usual = pp_default_session_options();
  const pp_tool tools = pp_default_tool();
  session
      .def(py::init([](const Source& source, const std::optional<std::string>& gpu, std::optional<double> mm_per_unit,
                       const std::string& backend, const std::string& surface, std::optional<double> radius_mm,
                       double friction, double stiffness, double damping, double max_force, double rate,
                       bool estimate_normals, std::uint32_t threads, double undo_memory_MiB, std::uint32_t hands,
                       const std::string& tool, std::uint32_t tool_points, double tool_size_mm, const Vector& tool_axis,
                       const py::object& law, bool allow_python_law, double budget_us, const py::object& on_message) {
             pp_contact_options felt = pp_default_contact_options();
             felt.radius_mm = radius_mm.value_or(0);
             felt.friction = friction;
             felt.stiffness_N_per_mm = stiffness;
             felt.damping_N_s_per_mm = damping;
             felt.max_force_N = max_force;
             pp_tool held = pp_default_tool();
             held.kind = tool.c_str();
             held.points = tool_points;
             held.size_mm = tool_size_mm;
             std::ranges::copy(tool_axis, held.axis);
             pp_session_options options = pp_default_session_options();
             options.gpu = gpu ? gpu->c_str() : nullptr;
             options.backend = backend.c_str();
             options.mm_per_unit = mm_per_unit.value_or(0);
             options.rate_Hz = rate;
             options.budget_us = budget_us;
             options.estimate_normals = estimate_normals ? 1 : 0;
             options.threads = threads;
             options.undo_memory_MiB = undo_memory_MiB;
             options.hands = hands;
             options.tool = &held;
             return std::make_unique<PySession>(source, options, felt, surface, Law(law, allow_python_law), on_message);
           }),
           py::arg("source"), py::arg("gpu") = py::none(), py::arg("mm_per_unit") = py::none(),
           py::arg("backend") = "auto", py::arg("surface") = "average", py::arg("radius_mm") = py::none(),
           py::arg("friction") = contact.friction, py::arg("stiffness_N_per_mm") = contact.stiffness_N_per_mm,
           py::arg("damping_N_s_per_mm") = contact.damping_N_s_per_mm, py::arg("max_force_N") = contact.max_force_N,
           py::arg("rate_Hz") = usual.rate_Hz, py::arg("estimate_normals") = false, py::arg("threads") = 0,
           py::arg("undo_memory_MiB") = usual.undo_memory_MiB, py::arg("hands") = usual.hands,
           py::arg("tool") = "point", py::arg("tool_points") = tools.points, py::arg("tool_size_mm") = tools.size_mm,
           py::arg("tool_axis") = Vector{tools.axis[0], tools.axis[1], tools.axis[2]}, py::arg("law") = py::none(),
           py::arg("allow_python_law") = false, py::arg("budget_us") = usual.budget_us,
           py::arg("on_message") = py::none())
      .def("close", &PySession::close,
           "close()\n\n"
           "Closes the session, and ends its live session; later calls raise ClosedError. A with statement\n"
           "does it.")
      .def_property_readonly(
          "messages", &PySession::messages,
          "Messages since the session was opened, one line each: what of a file is not kept, which GPU\n"
          "answers.")
      .def("_info", [](PySession& self) {
        const pp_session_info info = self.with([](pp::Session& open) { return open.info(); });
        return py::dict("points"_a = info.points, "mm_per_unit"_a = info.mm_per_unit, "spacing_mm"_a = info.spacing_mm,
                        "radius_mm"_a = info.radius_mm, "rate_Hz"_a = info.rate_Hz, "undo_count"_a = info.undo_count,
                        "redo_count"_a = info.redo_count, "live"_a = info.live != 0,
                        "blocked_moves"_a = info.blocked_moves, "blocked_edits"_a = info.blocked_edits,
                        "bridged_ticks"_a = info.bridged_ticks, "thinned_ticks"_a = info.thinned_ticks,
                        "backend"_a = std::string(info.backend), "machine"_a = std::string(info.machine));
      });
}

// Null while it is opened, and once that has failed.
PySession* openedIn(PyObject* self) {
  auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  return static_cast<PySession*>(instance->get_value_and_holder().value_ptr());
}

void collect(PyHeapTypeObject* heap) {
  PyTypeObject& type = heap->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const PySession* const session = openedIn(self);
    return session ? session->visit(visit, arg) : 0;
  };
  type.tp_clear = [](PyObject* self) {
    if (PySession* const session = openedIn(self)) session->forget();
    return 0;
  };
}

}  // namespace

void bindSessions(py::module_& module) {
  bindSource(module);
  py::class_<PySession> session(module, "_Session", py::custom_type_setup(collect));
  bindOpening(session);
  bindSessionsPictures(session);
  bindTouch(session);
  bindLive(session);
  bindSessionsTicks(session);
  bindSessionsQueries(session);
  bindSessionsMatter(session);
  bindSessionsSharing(session);
}

}  // namespace palpate::python

// Session logs in Python.
#include <cstddef>

#include "apps/python/session.hpp"

namespace palpate::python {

using namespace py::literals;

namespace {

class PyLog {
 public:
  explicit PyLog(pp::Recording log) : log_(std::move(log)) {}
  pp_recording_content view() const { return log_.view(); }

 private:
  pp::Recording log_;
};

using LogPointer = std::shared_ptr<PyLog>;

/// NumPy fields at the offsets of a struct of the library.
class Fields {
 public:
  Fields& add(const char* name, const char* format, std::size_t offset) {
    names_.append(name);
    formats_.append(format);
    offsets_.append(offset);
    return *this;
  }
  py::dtype type(std::size_t bytes) const {
    return py::dtype(names_, formats_, offsets_, static_cast<py::ssize_t>(bytes));
  }

 private:
  py::list names_, formats_, offsets_;
};

py::dtype logTickType() {
  Fields fields;
  fields.add("t_s", "f8", offsetof(pp_recording_tick, t_s))
      .add("device", "3f8", offsetof(pp_recording_tick, device))
      .add("orientation", "4f8", offsetof(pp_recording_tick, orientation))
      .add("proxy", "3f8", offsetof(pp_recording_tick, proxy))
      .add("force_N", "3f8", offsetof(pp_recording_tick, force_N))
      .add("edits", "u8", offsetof(pp_recording_tick, edits))
      .add("neighbours", "u4", offsetof(pp_recording_tick, neighbours))
      .add("buttons", "u4", offsetof(pp_recording_tick, buttons))
      .add("contact", "?", offsetof(pp_recording_tick, contact))
      .add("fresh", "?", offsetof(pp_recording_tick, fresh))
      .add("valid", "?", offsetof(pp_recording_tick, valid))
      .add("put_down", "?", offsetof(pp_recording_tick, put_down))
      .add("forceless", "?", offsetof(pp_recording_tick, forceless))
      .add("edit_dropped", "?", offsetof(pp_recording_tick, edit_dropped));
  return fields.type(sizeof(pp_recording_tick));
}

py::dtype logEditType() {
  Fields fields;
  fields.add("point", "u4", offsetof(pp_recording_edit, point))
      .add("parent", "u4", offsetof(pp_recording_edit, parent))
      .add("position", "3f4", offsetof(pp_recording_edit, position))
      .add("normal", "3f4", offsetof(pp_recording_edit, normal))
      .add("color", "4u1", offsetof(pp_recording_edit, color))
      .add("gone", "u4", offsetof(pp_recording_edit, gone));
  return fields.type(sizeof(pp_recording_edit));
}

py::array rowsOf(const py::dtype& type, const void* rows, std::uint64_t count, const py::object& owner) {
  if (count == 0) return py::array(type, 0);
  py::array view(type, {count}, {}, rows, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::dict replayed(const py::object& log, const std::optional<std::shared_ptr<PyCloud>>& cloud, const py::object& model,
                  const std::optional<std::string>& gpu, std::uint32_t threads, double tolerance) {
  const std::string file = fileOf(log), name = model.is_none() ? std::string() : fileOf(model);
  pp_replay_options options = pp_default_replay_options();
  options.threads = threads;
  options.gpu = gpu ? gpu->c_str() : nullptr;
  options.model = name.empty() ? nullptr : name.c_str();
  if (cloud) options.cloud = (*cloud)->cloud().handle();
  options.tolerance = tolerance;
  pp_replay_result result = pp_default_replay_result();
  {
    Interruption interruption;
    options.watch = interruption.watch();
    const WithoutGil released;
    result = interruption.during([&] { return pp::replay(file, options); });
  }
  return py::dict(
      "identical"_a = result.identical != 0, "ticks"_a = result.ticks, "compared"_a = result.compared,
      "force_ticks"_a = result.force_ticks, "largest_force_N"_a = result.largest_force_N,
      "edit_ticks"_a = result.edit_ticks,
      "points"_a = result.ends_compared != 0 ? py::object(py::int_(result.points)) : py::object(py::none()),
      "first_difference_s"_a =
          result.first_difference_s < 0 ? py::object(py::none()) : py::object(py::float_(result.first_difference_s)),
      "recorded_edits_agree"_a =
          result.recorded_edits == 0 ? py::object(py::none()) : py::object(py::bool_(result.recorded_edits == 1)),
      "reason"_a = std::string(result.reason), "machine"_a = std::string(result.machine),
      "recorded_on"_a = std::string(result.recorded_on));
}

}  // namespace

void bindLogs(py::module_& module) {
  py::class_<PyLog, LogPointer>(module, "_Log")
      .def(py::init([](const py::object& path) {
             const std::string file = fileOf(path);
             const WithoutGil released;
             return std::make_shared<PyLog>(pp::Recording::read(file));
           }),
           py::arg("file"))
      .def_property_readonly(
          "ticks",
          [](const py::object& self) {
            const pp_recording_content log = self.cast<LogPointer>()->view();
            return rowsOf(logTickType(), log.tick, log.ticks, self);
          },
          "A structured view, one row for each tick: t_s, device (3, the device's own unit), turn (w x y\n"
          "z), proxy (3, model units), force_N (3), edits (number of edits before the tick's answer),\n"
          "neighbours, buttons, contact, fresh, valid, put_down, forceless, edit_dropped.")
      .def_property_readonly(
          "edits",
          [](const py::object& self) {
            const pp_recording_content log = self.cast<LogPointer>()->view();
            return rowsOf(logEditType(), log.edit, log.edits, self);
          },
          "A structured view, one row for each state of a point: point, parent, position and normal (3,\n"
          "relative to the origin of the cloud), color (4), gone.")
      .def_property_readonly(
          "points", [](const PyLog& log) { return log.view().points; }, "Number of points of the model.")
      .def_property_readonly(
          "ended", [](const PyLog& log) { return log.view().ended != 0; },
          "True if the log includes the end of the session.")
      .def_property_readonly(
          "lost_ticks", [](const PyLog& log) { return log.view().lost_ticks; },
          "Ticks that are not in the log, because they could not be written in time.")
      .def_property_readonly(
          "merged_edits", [](const PyLog& log) { return log.view().merged_edits; },
          "States of points that were superseded by later ones of the same point.")
      .def_property_readonly(
          "map",
          [](const PyLog& log) {
            const pp_recording_content view = log.view();
            return std::pair(view.map_scale,
                             std::array<double, 3>{view.map_offset[0], view.map_offset[1], view.map_offset[2]});
          },
          "Scale and offset: model units = scale * device + offset, until a clutch was used.")
      .def("_header", [](const PyLog& log) { return std::string(log.view().header); })
      .def("_missing", [](const PyLog& log) { return std::string(log.view().missing); });
  module.def("_replay", &replayed, py::arg("file"), py::arg("cloud"), py::arg("model"), py::arg("gpu"),
             py::arg("threads"), py::arg("tolerance"));
}

}  // namespace palpate::python

// The Python module palpate._palpate, over the C interface.
#include "apps/python/session.hpp"

namespace {

using namespace palpate::python;

/// A class of palpate/_errors.py.
py::object classNamed(const char* name) { return py::module_::import("palpate._errors").attr(name); }

const char* classOf(pp_status status) {
  if (status == PP_ERROR_ARGUMENT) return "UsageError";
  return status == PP_ERROR_HANDLE ? "ClosedError" : "Error";
}

void translate(const Refusal& refusal) {
  const py::object kind = classNamed(refusal.kind());
  const py::object made = kind(textOf(refusal.what()), py::arg("status") = pp_status_name(refusal.status()));
  PyErr_SetObject(kind.ptr(), made.ptr());
}

/// The library's messages begin with the name of an option in C; the keywords in Python are shorter.
std::string inPython(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> kNames[]{{"tool.kind", "tool"},
                                                                   {"tool.", "tool_"},
                                                                   {"surface.kind", "surface"},
                                                                   {"contact.", ""},
                                                                   {"brush.", ""},
                                                                   {"model.", ""},
                                                                   {"hands.", ""},
                                                                   {"network.", ""},
                                                                   {"surface.", ""},
                                                                   {"force.max_N", "max_force_N"},
                                                                   {"force.", ""},
                                                                   {"undo.", "undo_"}};
  for (const auto& [name, ours] : kNames)
    if (text.starts_with(name)) return text.replace(0, name.size(), ours);
  return text;
}

void translate(const pp::Error& error) {
  const py::object kind = classNamed(classOf(error.status()));
  const py::object file = error.file().empty() ? py::object(py::none()) : py::object(textOf(error.file()));
  const py::object line = error.line() == 0 ? py::object(py::none()) : py::object(py::int_(error.line()));
  const py::object made = kind(textOf(inPython(error.what())), py::arg("status") = pp_status_name(error.status()),
                               py::arg("file") = file, py::arg("line") = line);
  PyErr_SetObject(kind.ptr(), made.ptr());
}

std::vector<std::string> gpuNames() {
  std::uint32_t count = 0;
  pp::check(pp_gpu_count(&count));
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<char, 256> name{};
    pp::check(pp_gpu_name(i, name.data(), name.size()));
    names.emplace_back(name.data());
  }
  return names;
}

}  // namespace

PYBIND11_MODULE(_palpate, module) {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the type that pybind11 takes
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const pp::Error& error) {
      translate(error);
    } catch (const Refusal& refusal) {
      translate(refusal);
    }
  });
  py::options options;
  options.disable_function_signatures();
  module.def("version", &pp::version,
             "version() -> str\n\n"
             "Version of the library at run time, such as \"0.1.0\".");
  module.def("_end_gil", &endGil);
  module.def("gpus", &gpuNames, py::call_guard<WithoutGil>(),
             "gpus() -> list of str\n\n"
             "Names of the GPUs that Vulkan finds here, including software drivers; empty without Vulkan. A\n"
             "session selects one by its index or by a part of its name.");
  module.def("formats_read", &pp_formats_read,
             "formats_read() -> str\n\n"
             "Extensions of files, and kinds of folders, that read() accepts: \".ply, .las, ...\".");
  module.def("formats_written", &pp_formats_written,
             "formats_written() -> str\n\n"
             "Extensions of files that write() accepts: \".ply, .las, ...\". Only meshes can be written as .obj,\n"
             ".stl and .off.");
  module.def("_brush_settings", &palpate::python::brushSettings);
  module.def("_tick_dtype", &palpate::python::tickType);
  module.def("_live_tick_dtype", &palpate::python::liveTickType);
  module.def("_tool_tick_dtype", &palpate::python::toolTickType);
  bindClouds(module);
  bindContacts(module);
  bindLaws(module);
  bindLogs(module);
  bindMatter(module);
  bindSessions(module);
  bindSharing(module);
}

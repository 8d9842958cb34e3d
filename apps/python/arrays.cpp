#include "apps/python/arrays.hpp"

#include <cstddef>

namespace palpate::python {

namespace {

Doubles pathRows(const py::object& given) {
  Doubles rows = Doubles::ensure(given);
  if (!rows) {
    PyErr_Clear();
    refuse("path: is no array of numbers");
  }
  if (rows.ndim() != 2 || (rows.shape(1) != 3 && rows.shape(1) != 4))
    refuse("path: has shape " + shapeOf(rows) + ", not (N, 3), a row for each tick, or (N, 4), seconds first");
  return rows;
}

}  // namespace

py::str textOf(std::string_view text) {
  PyObject* const made = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
  if (!made) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

pp_rows rowsOf(const py::array& array) {
  const bool single = array.dtype().is(py::dtype::of<float>());
  return single ? pp::rows(static_cast<const float*>(array.data()))
                : pp::rows(static_cast<const double*>(array.data()));
}

[[noreturn]] void refuse(const std::string& what) { throw py::value_error(what); }

std::string shapeOf(const py::array& array) { return py::str(array.attr("shape")); }

py::array threeColumns(const py::object& given, const char* name, std::optional<py::ssize_t> rows) {
  const py::array any = py::array::ensure(given);
  if (!any) {
    PyErr_Clear();
    refuse(std::string(name) + ": is no array of numbers");
  }
  if (any.ndim() != 2 || any.shape(1) != 3 || (rows && any.shape(0) != *rows))
    refuse(std::string(name) + ": has shape " + shapeOf(any) + ", not (" + (rows ? std::to_string(*rows) : "N") +
           ", 3)");
  if (any.dtype().is(py::dtype::of<float>())) return py::array_t<float, py::array::c_style>(any);
  Doubles doubles = Doubles::ensure(any);
  if (!doubles) {
    PyErr_Clear();
    refuse(std::string(name) + ": is no array of numbers");
  }
  return py::array(std::move(doubles));
}

namespace {

py::dtype typeOf(bool hasTorques) {
  py::dict fields;
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const py::object& format, std::size_t offset) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  };
  const py::str number("f8"), three("3f8"), flag("?"), whole("u4");
  add("t_s", number, offsetof(pp_tick, t_s));
  add("hip", three, offsetof(pp_tick, hip));
  add("proxy", three, offsetof(pp_tick, proxy));
  add("normal", three, offsetof(pp_tick, normal));
  add("force_N", three, offsetof(pp_tick, force_N));
  add("penetration_mm", number, offsetof(pp_tick, penetration_mm));
  add("contact", flag, offsetof(pp_tick, contact));
  add("neighbours", whole, offsetof(pp_tick, neighbours));
  add("fresh", flag, offsetof(pp_tick, fresh));
  if (hasTorques) add("torque_mNm", three, sizeof(pp_tick));
  return py::dtype(names, formats, offsets, hasTorques ? kToolTickBytes : sizeof(pp_tick));
}

}  // namespace

py::dtype tickType() { return typeOf(false); }
py::dtype toolTickType() { return typeOf(true); }

PathArray::PathArray(const py::object& given) : rows(pathRows(given)), path(pp_default_path()) {
  path.columns = static_cast<std::uint32_t>(rows.shape(1));
  path.rows = static_cast<std::uint64_t>(rows.shape(0));
  path.data = rows.data();
}

std::string fileOf(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

}  // namespace palpate::python

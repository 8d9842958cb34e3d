#include "apps/python/arrays.hpp"

#include <cstddef>
#include <cstring>

namespace palpate::python {

namespace {

// Truth values, texts, times and complex numbers can be cast to numbers, but are a mistake.
void refuseOthers(const py::array& any, const char* name) {
  const char kind = any.dtype().kind();
  if (any.size() > 0 && std::string_view("bcSUVMm").find(kind) != std::string_view::npos)
    refuse(std::string(name) + ": must be real numbers, not of the type " +
           std::string(py::str(static_cast<const py::object&>(any.dtype()))));
}

Doubles pathRows(const py::object& given) {
  refuseMasked(given, "path");
  if (const py::array any = py::array::ensure(given))
    refuseOthers(any, "path");
  else
    PyErr_Clear();
  Doubles rows = Doubles::ensure(given);
  if (!rows) {
    PyErr_Clear();
    refuse("path: must be an array of numbers, not " + described(given));
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
  const bool single = array.dtype().equal(py::dtype::of<float>());
  return single ? pp::rows(static_cast<const float*>(array.data()))
                : pp::rows(static_cast<const double*>(array.data()));
}

std::string described(const py::handle& given) {
  return py::module_::import("palpate._errors").attr("described")(given).cast<std::string>();
}

void refuseMasked(const py::object& given, const char* name) {
  if (!py::hasattr(given, "mask") || !py::isinstance<py::array>(given)) return;
  const auto hidden = py::array(given.attr("mask")).attr("sum")().cast<std::size_t>();
  if (hidden > 0)
    refuse(std::string(name) + ": " + std::to_string(hidden) + " numbers are masked; remove these rows, or pass .data");
}

std::string shapeOf(const py::array& array) { return py::str(array.attr("shape")); }

py::array threeColumns(const py::object& given, const char* name, std::optional<py::ssize_t> rows) {
  refuseMasked(given, name);
  const py::array any = py::array::ensure(given);
  if (!any) {
    PyErr_Clear();
    refuse(std::string(name) + ": must be an array of numbers, not " + described(given));
  }
  refuseOthers(any, name);
  if (any.ndim() != 2 || any.shape(1) != 3 || (rows && any.shape(0) != *rows))
    refuse(std::string(name) + ": has shape " + shapeOf(any) + ", not (" + (rows ? std::to_string(*rows) : "N") +
           ", 3)");
  if (any.dtype().equal(py::dtype::of<float>())) return py::array_t<float, py::array::c_style>(any);
  Doubles doubles = Doubles::ensure(any);
  if (!doubles) {
    PyErr_Clear();
    refuse(std::string(name) + ": must be an array of numbers, not " + described(given));
  }
  return py::array(std::move(doubles));
}

std::array<double, 3> threeNumbers(const py::object& given, const char* name) {
  refuseMasked(given, name);
  const auto wrong = [&](const std::string& what) {
    refuseType(std::string(name) + ": must be three numbers, not " + what);
  };
  const py::array any = py::array::ensure(given);
  if (!any) {
    PyErr_Clear();
    wrong(described(given));
  }
  if (any.ndim() != 1 || any.shape(0) != 3)
    wrong(py::isinstance<py::array>(given) ? "an array of shape " + shapeOf(any) : described(given));
  refuseOthers(any, name);
  const Doubles numbers = Doubles::ensure(any);
  if (!numbers) {
    PyErr_Clear();
    wrong(described(given));
  }
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

namespace {

enum class Ticks { point, tool, live };

py::dtype typeOf(Ticks ticks, std::size_t size) {
  py::dict fields;
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const py::object& format, std::size_t offset) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  };
  const py::str number("f8"), three("3f8"), flag("?"), whole("u4");
  add("t_s", number, offsetof(TickRow, t_s));
  add("hip", three, offsetof(TickRow, hip));
  add("proxy", three, offsetof(TickRow, proxy));
  add("normal", three, offsetof(TickRow, normal));
  add("force_N", three, offsetof(TickRow, force_N));
  add("penetration_mm", number, offsetof(TickRow, penetration_mm));
  add("contact", flag, offsetof(TickRow, contact));
  add("neighbours", whole, offsetof(TickRow, neighbours));
  add("fresh", flag, offsetof(TickRow, fresh));
  if (ticks != Ticks::point) add("torque_mNm", three, offsetof(ToolTickRow, torque_mNm));
  if (ticks == Ticks::live) {
    add("age_s", number, offsetof(LiveTickRow, age_s));
    add("valid", flag, offsetof(LiveTickRow, valid));
    add("withheld", flag, offsetof(LiveTickRow, withheld));
  }
  return py::dtype(names, formats, offsets, size);
}

}  // namespace

TickRow rowOf(const pp_tick& tick) {
  TickRow row{};
  static_assert(offsetof(TickRow, contact) == offsetof(pp_tick, neighbours));
  std::memcpy(&row, &tick, offsetof(TickRow, contact));
  row.contact = tick.contact != 0;
  row.neighbours = tick.neighbours;
  row.fresh = tick.fresh != 0;
  return row;
}

py::dtype tickType() { return typeOf(Ticks::point, sizeof(TickRow)); }
py::dtype toolTickType() { return typeOf(Ticks::tool, sizeof(ToolTickRow)); }
py::dtype liveTickType() { return typeOf(Ticks::live, sizeof(LiveTickRow)); }

PathArray::PathArray(const py::object& given) : rows(pathRows(given)), path(pp_default_path()) {
  path.columns = static_cast<std::uint32_t>(rows.shape(1));
  path.rows = static_cast<std::uint64_t>(rows.shape(0));
  path.data = rows.data();
}

std::string fileOf(const py::object& path) {
  try {
    // As the system has it: a name that is not UTF-8 is bytes, or a text with surrogates.
    const auto file = py::module_::import("os").attr("fsencode")(path).cast<std::string>();
    if (file.empty()) refuse("file: the name is empty");
    if (file.find('\0') != std::string::npos) refuse("file: contains a NUL, which no file name can have");
    return file;
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError)) throw;
    refuseType("file: must be a path, not " + described(path));
  }
}

}  // namespace palpate::python

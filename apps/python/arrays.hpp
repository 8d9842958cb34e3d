// Conversion of NumPy arrays to and from the C interface.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <palpate/palpate.hpp>

#include "apps/python/gil.hpp"

namespace palpate::python {

namespace py = pybind11;

/// Any numbers, as contiguous doubles; copied if they are not.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Text of the library as a Python string. Names that other programs have sent may be invalid UTF-8, or cut off within
/// a character.
py::str textOf(std::string_view text);

pp_rows rowsOf(const py::array& array);
inline std::array<double, 3> vectorOf(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

/// Refusal of an argument before the library is called; `kind` is a class of palpate/_errors.py.
class Refusal : public std::runtime_error {
 public:
  Refusal(const char* kind, const std::string& what, pp_status status = PP_ERROR_ARGUMENT)
      : std::runtime_error(what), kind_(kind), status_(status) {}
  const char* kind() const { return kind_; }
  pp_status status() const { return status_; }

 private:
  const char* kind_;
  pp_status status_;
};
/// Throws palpate.UsageError.
[[noreturn]] inline void refuse(const std::string& what) { throw Refusal("UsageError", what); }
/// Throws palpate.ArgumentTypeError.
[[noreturn]] inline void refuseType(const std::string& what) { throw Refusal("ArgumentTypeError", what); }
/// The value as a message names it: "the text 'a'", "1.5", "a list".
std::string described(const py::handle& given);
/// Throws palpate.UsageError for an array with masked numbers.
void refuseMasked(const py::object& given, const char* name);
std::string shapeOf(const py::array& array);

/// Contiguous rows of three: float32 as they are, all other types as float64.
py::array threeColumns(const py::object& given, const char* name, std::optional<py::ssize_t> rows = std::nullopt);

/// Three numbers in a row, such as a list or an array of shape (3,).
std::array<double, 3> threeNumbers(const py::object& given, const char* name);

/// A read-only view of memory that `owner` keeps alive.
template <class Number>
py::object viewOf(const Number* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  if (!data && shape[0] > 0) return py::none();
  static const Number kNothing{};
  py::array_t<Number> view(std::move(shape), data ? data : &kNothing, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

/// A tick with the columns of a trace, in their order: NumPy writes only fields that are in order in memory.
struct TickRow {
  double t_s;
  double hip[3], proxy[3], normal[3], force_N[3];
  double penetration_mm;
  bool contact;
  std::uint32_t neighbours;
  bool fresh;
};
/// A tick of a tool of many points.
struct ToolTickRow {
  TickRow tick;
  double torque_mNm[3];
};
/// A tick of a live session.
struct LiveTickRow {
  ToolTickRow tool;
  double age_s;
  bool valid, withheld;
};
TickRow rowOf(const pp_tick& tick);
py::dtype tickType();
py::dtype liveTickType();
py::dtype toolTickType();

/// A path that refers to the numbers of an array.
struct PathArray {
  Doubles rows;
  pp_path path;

  explicit PathArray(const py::object& given);
};

/// Name of a file given as str or as any object that os.fspath() accepts.
std::string fileOf(const py::object& path);

class PyCloud {
 public:
  /// `isSingle`: made of float32 positions. `lost`: what of its file is not kept.
  explicit PyCloud(pp::Cloud cloud, bool isSingle = false, std::vector<std::string> lost = {})
      : cloud_(std::move(cloud)), isSingle_(isSingle), lost_(std::move(lost)) {}

  static std::shared_ptr<PyCloud> of(const py::object& xyz, const py::object& normals, const py::object& colors);

  const pp::Cloud& cloud() const { return cloud_; }
  pp_points view() const { return cloud_.view(); }
  bool isSingle() const { return isSingle_; }
  const std::vector<std::string>& lost() const { return lost_; }

 private:
  pp::Cloud cloud_;
  bool isSingle_;
  std::vector<std::string> lost_;
};

class PyMesh {
 public:
  explicit PyMesh(pp::Mesh mesh) : mesh_(std::move(mesh)) {}
  const pp::Mesh& mesh() const { return mesh_; }

 private:
  pp::Mesh mesh_;
};

/// A function of palpate/_notebook.py.
py::object helper(const char* name);

void bindClouds(py::module_& module);
void bindMatter(py::module_& module);
void bindSessions(py::module_& module);

}  // namespace palpate::python

// NumPy's arrays on their way into the C interface and out of it.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <palpate/palpate.hpp>

namespace palpate::python {

namespace py = pybind11;

/// Any numbers, as doubles that follow one another; copied where they are not.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Text of the library's as Python has it. What others have called themselves may be no UTF-8, or cut off in a
/// character.
py::str textOf(std::string_view text);

pp_rows rowsOf(const py::array& array);

/// Throws ValueError.
[[noreturn]] void refuse(const std::string& what);
std::string shapeOf(const py::array& array);

/// Rows of three that follow one another: float32 as they are, everything else as float64.
py::array threeColumns(const py::object& given, const char* name, std::optional<py::ssize_t> rows = std::nullopt);

/// A view of memory that `owner` keeps, which nobody can write to.
template <class Number>
py::object viewOf(const Number* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  if (!data && shape[0] > 0) return py::none();
  static const Number kNothing{};
  py::array_t<Number> view(std::move(shape), data ? data : &kNothing, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

/// The trace's columns, where a pp_tick has them.
py::dtype tickType();
/// The same, and torque_mNm behind it: of a tool of many points.
constexpr std::size_t kToolTickBytes = sizeof(pp_tick) + 3 * sizeof(double);
py::dtype toolTickType();

/// The path of an array, which outlives it.
struct PathArray {
  Doubles rows;
  pp_path path;

  explicit PathArray(const py::object& given);
};

/// Of a str or whatever os.fspath() knows.
std::string fileOf(const py::object& path);

class PyCloud {
 public:
  explicit PyCloud(pp::Cloud cloud) : cloud_(std::move(cloud)) {}

  static std::shared_ptr<PyCloud> of(const py::object& xyz, const py::object& normals, const py::object& colors);

  const pp::Cloud& cloud() const { return cloud_; }
  pp_points view() const { return cloud_.view(); }

 private:
  pp::Cloud cloud_;
};

class PyMesh {
 public:
  explicit PyMesh(pp::Mesh mesh) : mesh_(std::move(mesh)) {}
  const pp::Mesh& mesh() const { return mesh_; }

 private:
  pp::Mesh mesh_;
};

void bindClouds(py::module_& module);
void bindMatter(py::module_& module);
void bindSessions(py::module_& module);

}  // namespace palpate::python

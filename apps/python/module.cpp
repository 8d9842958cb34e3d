// The Python module: NumPy arrays in and out of the C interface. Nothing of Python runs on a servo thread.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

#include <palpate/palpate.hpp>

namespace py = pybind11;

namespace {

using Vector = std::array<double, 3>;
using Color = std::array<std::uint8_t, 3>;

/// Any numbers, as doubles that follow one another; copied where they are not.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

pp_rows rowsOf(const py::array& array) {
  const bool single = array.dtype().is(py::dtype::of<float>());
  return single ? pp::rows(static_cast<const float*>(array.data())) : pp::rows(static_cast<const double*>(array.data()));
}

[[noreturn]] void refuse(const std::string& what) { throw py::value_error(what); }

std::string shapeOf(const py::array& array) { return py::str(array.attr("shape")); }

/// Rows of three that follow one another: float32 as they are, everything else as float64.
py::array threeColumns(const py::object& given, const char* name, std::optional<py::ssize_t> rows = std::nullopt) {
  const py::array any = py::array::ensure(given);
  if (!any) {
    PyErr_Clear();
    refuse(std::string(name) + ": is no array of numbers");
  }
  if (any.ndim() != 2 || any.shape(1) != 3 || (rows && any.shape(0) != *rows))
    refuse(std::string(name) + ": has shape " + shapeOf(any) + ", not (" + (rows ? std::to_string(*rows) : "N") + ", 3)");
  if (any.dtype().is(py::dtype::of<float>())) return py::array_t<float, py::array::c_style>(any);
  Doubles doubles = Doubles::ensure(any);
  if (!doubles) {
    PyErr_Clear();
    refuse(std::string(name) + ": is no array of numbers");
  }
  return std::move(doubles);
}

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
py::dtype tickType() {
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
  return py::dtype(names, formats, offsets, sizeof(pp_tick));
}

py::array ticksOf(std::size_t count) { return py::array(tickType(), count); }

/// The path of an array, which outlives it.
struct PathArray {
  Doubles rows;
  pp_path path;

  explicit PathArray(const py::object& given) : rows(ensured(given)), path(pp_default_path()) {
    path.columns = static_cast<std::uint32_t>(rows.shape(1));
    path.rows = static_cast<std::uint64_t>(rows.shape(0));
    path.data = rows.data();
  }

 private:
  static Doubles ensured(const py::object& given) {
    Doubles rows = Doubles::ensure(given);
    if (!rows) {
      PyErr_Clear();
      refuse("path: is no array of numbers");
    }
    if (rows.ndim() != 2 || (rows.shape(1) != 3 && rows.shape(1) != 4))
      refuse("path: has shape " + shapeOf(rows) + ", not (N, 3), a row for each tick, or (N, 4), seconds first");
    return rows;
  }
};

/// "libmine.so:law", or the address of a compiled function (numba's cfunc.address); never a Python function.
struct Law {
  std::string library;
  pp_force_law function = nullptr;

  explicit Law(const py::object& given) {
    if (given.is_none()) return;
    if (py::isinstance<py::str>(given)) {
      library = given.cast<std::string>();
      return;
    }
    const py::object address = py::hasattr(given, "address") ? py::object(given.attr("address")) : given;
    if (!py::isinstance<py::int_>(address))
      throw py::type_error(
          "law: a compiled function is wanted, as \"libmine.so:law\" or a numba cfunc; one in Python would come too late "
          "for a servo thread");
    function = reinterpret_cast<pp_force_law>(address.cast<std::uintptr_t>());
  }
  const char* name() const { return library.empty() ? nullptr : library.c_str(); }
};

/// Of a str or whatever os.fspath() knows.
std::string fileOf(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

const char* orNull(const std::optional<std::string>& text) { return text ? text->c_str() : nullptr; }

class PyCloud {
 public:
  explicit PyCloud(pp::Cloud cloud) : cloud_(std::move(cloud)) {}

  static std::shared_ptr<PyCloud> of(const py::object& xyz, const py::object& normals, const py::object& colors) {
    const py::array places = threeColumns(xyz, "xyz");
    pp_cloud_arrays arrays = pp_default_cloud_arrays();
    arrays.count = static_cast<std::uint64_t>(places.shape(0));
    arrays.positions = rowsOf(places);
    py::array facing, painted;  // kept until they are copied
    if (!normals.is_none()) {
      facing = threeColumns(normals, "normals", places.shape(0));
      arrays.normals = rowsOf(facing);
    }
    if (!colors.is_none()) arrays.colors = colorsOf(painted, colors, places.shape(0));
    py::gil_scoped_release released;
    return std::make_shared<PyCloud>(pp::Cloud(arrays));
  }

  const pp::Cloud& cloud() const { return cloud_; }
  pp_points view() const { return cloud_.view(); }

 private:
  static pp_rows colorsOf(py::array& kept, const py::object& given, py::ssize_t count) {
    const py::array any = py::array::ensure(given);
    if (!any) PyErr_Clear();
    const auto keep = [&]<class Number>(Number) {
      kept = py::array_t<Number, py::array::c_style>(any);
      return pp::rows(static_cast<const Number*>(kept.data()));
    };
    if (any && any.ndim() == 2 && any.shape(0) == count && any.shape(1) == 3) {
      if (any.dtype().is(py::dtype::of<std::uint8_t>())) return keep(std::uint8_t{});
      if (any.dtype().is(py::dtype::of<std::uint16_t>())) return keep(std::uint16_t{});
    }
    if (any && any.dtype().kind() != 'f')
      throw py::type_error("colors: uint8 (0 to 255), uint16 (0 to 65535) or float (0 to 1) is wanted, not " +
                           std::string(py::str(any.dtype())));
    kept = threeColumns(given, "colors", count);
    return rowsOf(kept);
  }

  pp::Cloud cloud_;
};
using CloudPointer = std::shared_ptr<PyCloud>;

class PyMesh {
 public:
  explicit PyMesh(pp::Mesh mesh) : mesh_(std::move(mesh)) {}
  const pp::Mesh& mesh() const { return mesh_; }

 private:
  pp::Mesh mesh_;
};

/// Whatever brush.
struct Brush {
  std::string kind;
  pp_brush brush = pp_default_brush();

  Brush(const std::string& name, const py::kwargs& settings) : kind(name) {
    for (const auto& [key, value] : settings) set(key.cast<std::string>(), value);
    brush.kind = kind.c_str();
  }
  Brush(const Brush&) = delete;
  Brush& operator=(const Brush&) = delete;

 private:
  void set(const std::string& key, const py::handle& value) {
    if (key == "radius_mm") brush.radius_mm = value.cast<double>();
    else if (key == "tau_mm") brush.tau_mm = value.cast<double>();
    else if (key == "beta") brush.beta = value.cast<double>();
    else if (key == "strength") brush.strength = value.cast<double>();
    else if (key == "falloff") brush.falloff = value.cast<std::uint32_t>();
    else if (key == "keeps_density") brush.keeps_density = value.cast<bool>() ? 1 : 0;
    else if (key == "color") setColor(value.cast<Color>());
    else
      throw py::type_error("a brush has no " + key +
                           "; it has radius_mm, tau_mm, beta, strength, falloff, keeps_density and color");
  }
  void setColor(const Color& color) {
    for (std::size_t k = 0; k < 3; ++k) brush.color[k] = color[k];
  }
};

struct SessionSettings {
  std::optional<std::string> gpu;
  std::optional<double> mm_per_unit;
  std::string surface = "average";
  std::optional<double> radius_mm;
  double friction = 0, stiffness_N_per_mm = 0, damping_N_s_per_mm = 0, max_force_N = 0, rate_Hz = 1000;
  bool estimate_normals = false;
  std::uint32_t threads = 0;
  double undo_memory_MiB = 0;
};

/// One thread at a time is in it; others wait.
class PySession {
 public:
  PySession(CloudPointer cloud, const SessionSettings& settings, const Law& law) : cloud_(std::move(cloud)) {
    feel_ = pp_default_feel();
    surface_ = settings.surface;
    feel_.friction = settings.friction;
    feel_.radius_mm = settings.radius_mm.value_or(0);
    feel_.stiffness_N_per_mm = settings.stiffness_N_per_mm;
    feel_.damping_N_s_per_mm = settings.damping_N_s_per_mm;
    feel_.max_force_N = settings.max_force_N;
    const pp_feel feel = feelWith(surface_);
    pp_session_options options = pp_default_session_options();
    options.feel = &feel;
    options.gpu = orNull(settings.gpu);
    options.mm_per_unit = settings.mm_per_unit.value_or(0);
    options.rate_Hz = settings.rate_Hz;
    options.estimate_normals = settings.estimate_normals ? 1 : 0;
    options.threads = settings.threads;
    options.undo_memory_MiB = settings.undo_memory_MiB;
    options.law = law.function;
    options.law_library = law.name();
    options.log = [](void* user, const char* line) { static_cast<PySession*>(user)->hear(line); };
    options.log_user = this;
    py::gil_scoped_release released;
    session_ = pp::Session(cloud_->cloud(), options);
  }

  /// With the session to oneself, and without Python's lock.
  template <class Do>
  auto with(Do&& act) {
    py::gil_scoped_release released;
    const std::scoped_lock lock(inUse_);
    return act(session_);
  }

  pp_feel feelWith(const std::string& surface) const {
    pp_feel feel = feel_;
    feel.surface = surface.c_str();
    return feel;
  }

  py::array touch(const py::object& given, const std::optional<std::string>& surface) {
    const PathArray path(given);
    if (surface && *surface != surface_) {
      const pp_feel feel = feelWith(*surface);
      with([&](pp::Session& session) { session.setFeel(feel); });
      surface_ = *surface;
    }
    return along(path, [&](pp::Session& session, pp_tick* ticks, std::uint64_t capacity, std::uint64_t& count) {
      pp::check(pp_session_touch(session.handle(), &path.path, ticks, capacity, &count));
    });
  }

  py::array stroke(const py::object& given, const std::string& kind, const py::kwargs& settings) {
    const PathArray path(given);
    const Brush brush(kind, settings);
    return along(path, [&](pp::Session& session, pp_tick* ticks, std::uint64_t capacity, std::uint64_t& count) {
      pp::check(pp_session_stroke(session.handle(), &path.path, &brush.brush, ticks, capacity, &count));
    });
  }

  py::array render(const std::pair<std::uint32_t, std::uint32_t>& size, const pp_picture_options& options) {
    py::array_t<std::uint8_t> picture(
        std::vector<py::ssize_t>{static_cast<py::ssize_t>(size.second), static_cast<py::ssize_t>(size.first), 4});
    std::uint8_t* const rgba = picture.mutable_data();
    const auto bytes = static_cast<std::uint64_t>(picture.size());
    with([&](pp::Session& session) { pp::check(pp_session_render(session.handle(), &options, rgba, bytes)); });
    return picture;
  }

  py::array takeTicks() {
    constexpr std::size_t kMost = 1 << 15;
    auto ticks = std::make_unique<pp_tick[]>(kMost);
    std::uint64_t count = 0;
    with([&](pp::Session& session) { pp::check(pp_live_take(session.handle(), ticks.get(), kMost, &count)); });
    py::array taken = ticksOf(count);
    std::copy_n(ticks.get(), count, static_cast<pp_tick*>(taken.mutable_data()));
    return taken;
  }

  void close() {
    with([](pp::Session& session) {
      if (session.isOpen()) pp::check(pp_session_close(session.handle()));
      session = pp::Session();
    });
  }

  const CloudPointer& given() const { return cloud_; }
  const std::string& surface() const { return surface_; }
  std::vector<std::string> remarks() const {
    const std::scoped_lock lock(heard_);
    return remarks_;
  }
  pp::Session& session() { return session_; }

 private:
  void hear(const char* line) {
    const std::scoped_lock lock(heard_);
    remarks_.emplace_back(line);
  }

  template <class Follow>
  py::array along(const PathArray& path, Follow&& follow) {
    std::uint64_t count = 0;
    with([&](pp::Session& session) { pp::check(pp_path_ticks(session.handle(), &path.path, &count)); });
    py::array ticks = ticksOf(count);
    auto* const to = static_cast<pp_tick*>(ticks.mutable_data());
    with([&](pp::Session& session) {
      std::uint64_t done = 0;
      follow(session, to, count, done);
    });
    return ticks;
  }

  CloudPointer cloud_;
  mutable std::mutex heard_;
  std::vector<std::string> remarks_;
  std::string surface_;
  pp_feel feel_{};
  std::mutex inUse_;
  pp::Session session_;  // goes first
};

py::object fieldOf(const CloudPointer& cloud, const py::object& owner, const char* name) {
  std::uint64_t count = 0;
  pp::check(pp_cloud_attribute_count(cloud->cloud().handle(), &count));
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_attribute attribute{};
    pp::check(pp_cloud_get_attribute(cloud->cloud().handle(), i, &attribute));
    if (std::string(attribute.name) != name) continue;
    py::array view(py::dtype(std::string(attribute.type)), {cloud->view().count}, {}, attribute.data, owner);
    view.attr("setflags")(py::arg("write") = false);
    return view;
  }
  throw py::key_error(name);
}

std::vector<std::string> attributesOf(const CloudPointer& cloud) {
  std::uint64_t count = 0;
  pp::check(pp_cloud_attribute_count(cloud->cloud().handle(), &count));
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_attribute attribute{};
    pp::check(pp_cloud_get_attribute(cloud->cloud().handle(), i, &attribute));
    names.emplace_back(attribute.name);
  }
  return names;
}

/// File coordinates: where the points lie as floats, if those are all there is to know, else a copy in doubles.
py::object placesOf(const py::object& self) {
  const auto cloud = self.cast<CloudPointer>();
  const pp_points points = cloud->view();
  const auto count = static_cast<py::ssize_t>(points.count);
  const bool atOrigin = points.origin[0] == 0 && points.origin[1] == 0 && points.origin[2] == 0;
  py::array_t<double> places(std::vector<py::ssize_t>{count, 3});
  double* const to = places.mutable_data();
  bool asFloats = atOrigin;
  {
    py::gil_scoped_release released;
    pp::check(pp_cloud_copy_places(cloud->cloud().handle(), to, points.count));
    for (std::uint64_t i = 0; asFloats && i < 3 * points.count; ++i)
      asFloats = to[i] == static_cast<double>(points.positions[i]);
  }
  if (asFloats) return viewOf(points.positions, {count, 3}, self);
  places.attr("setflags")(py::arg("write") = false);
  return places;
}

std::optional<Vector> vectorOr(const std::optional<Vector>& given, std::uint32_t& has, double (&to)[3]) {
  has = given ? 1 : 0;
  for (std::size_t k = 0; given && k < 3; ++k) to[k] = (*given)[k];
  return given;
}

/// Python's own class of errors, in palpate/_errors.py.
void translate(const pp::Error& error) {
  const py::object errors = py::module_::import("palpate._errors");
  const py::object kind = errors.attr(error.status() == PP_ERROR_ARGUMENT ? "UsageError" : "Error");
  const py::object file = error.file().empty() ? py::object(py::none()) : py::object(py::str(error.file()));
  const py::object line = error.line() == 0 ? py::object(py::none()) : py::object(py::int_(error.line()));
  const py::object made = kind(error.what(), py::arg("status") = pp_status_name(error.status()), py::arg("file") = file,
                               py::arg("line") = line);
  PyErr_SetObject(kind.ptr(), made.ptr());
}

void bindClouds(py::module_& module) {
  py::class_<PyCloud, CloudPointer>(module, "Cloud",
                                     "Cloud(xyz, normals=None, colors=None)\n\n"
                                     "Points, never changed once they are made. xyz: (N, 3), model units; doubles keep their\n"
                                     "precision. normals: (N, 3), made unit length. colors: (N, 3), uint8 0 to 255, uint16 0 to\n"
                                     "65535 or float 0 to 1. All are copied; what is shown is a view of palpate's own memory,\n"
                                     "which cannot be written to and keeps the cloud.")
      .def(py::init(&PyCloud::of), py::arg("xyz"), py::arg("normals") = py::none(), py::arg("colors") = py::none())
      .def("__repr__", [](const PyCloud& cloud) {
        const pp_points p = cloud.view();
        const auto side = [&](int k) { return py::str("{:.6g}").format(p.max[k] - p.min[k]).cast<std::string>(); };
        return "<palpate.Cloud of " + std::to_string(p.count) + " points" + (p.normals ? ", normals" : "") +
               (p.colors ? ", colors" : "") + ", " + side(0) + " x " + side(1) + " x " + side(2) + ">";
      })
      .def("__len__", [](const PyCloud& cloud) { return cloud.view().count; })
      .def_property_readonly("xyz", &placesOf,
                             "(N, 3), file coordinates: a float32 view where that is all there is to know, else float64.")
      .def_property_readonly("positions",
                             [](const py::object& self) {
                               const pp_points points = self.cast<CloudPointer>()->view();
                               return viewOf(points.positions, {static_cast<py::ssize_t>(points.count), 3}, self);
                             },
                             "(N, 3) float32 view, relative to origin.")
      .def_property_readonly("origin",
                             [](const PyCloud& cloud) {
                               const pp_points points = cloud.view();
                               return Vector{points.origin[0], points.origin[1], points.origin[2]};
                             })
      .def_property_readonly("normals",
                             [](const py::object& self) -> py::object {
                               const pp_points points = self.cast<CloudPointer>()->view();
                               if (!points.normals) return py::none();
                               return viewOf(points.normals, {static_cast<py::ssize_t>(points.count), 3}, self);
                             })
      .def_property_readonly("colors",
                             [](const py::object& self) -> py::object {
                               const pp_points points = self.cast<CloudPointer>()->view();
                               if (!points.colors) return py::none();
                               return viewOf(points.colors, {static_cast<py::ssize_t>(points.count), 4}, self);
                             })
      .def_property_readonly("bounds",
                             [](const PyCloud& cloud) {
                               const pp_points p = cloud.view();
                               return std::pair(Vector{p.min[0], p.min[1], p.min[2]}, Vector{p.max[0], p.max[1], p.max[2]});
                             })
      .def_property_readonly("attributes", &attributesOf)
      .def("attribute", [](const py::object& self, const std::string& name) {
        return fieldOf(self.cast<CloudPointer>(), self, name.c_str());
      }, py::arg("name"));

  module.def("read", [](const py::object& path, bool all_points, bool normals_from_faces) {
    const std::string file = fileOf(path);
    pp_read_options options = pp_default_read_options();
    options.all_points = all_points ? 1 : 0;
    options.normals_from_faces = normals_from_faces ? 1 : 0;
    py::gil_scoped_release released;
    return std::make_shared<PyCloud>(pp::Cloud::read(file, options));
  }, py::arg("file"), py::arg("all_points") = false, py::arg("normals_from_faces") = false,
      "read(file, all_points=False, normals_from_faces=False) -> Cloud\n\n"
      "A cloud from a file of any format in formats_read(). all_points: of a reconstruction also those that its own\n"
      "measures tell to be unreliable. Raises Error with file and line.");
  module.def("write", [](const py::object& path, const PyCloud& cloud, bool ascii, bool keep) {
    const std::string file = fileOf(path);
    pp_write_options options = pp_default_write_options();
    options.ascii = ascii ? 1 : 0;
    options.keep = keep ? 1 : 0;
    py::gil_scoped_release released;
    cloud.cloud().write(file, options);
  }, py::arg("file"), py::arg("cloud"), py::arg("ascii") = false, py::arg("keep") = false,
      "write(file, cloud, ascii=False, keep=False)\n\n"
      "By the file's ending, one of formats_written(). It appears under its name only when it is whole; keep: a file that is\n"
      "there already is kept as NAME.EXT.bak. Raises Error with the file.");
}

void bindMeshes(py::module_& module) {
  py::class_<PyMesh, std::shared_ptr<PyMesh>>(module, "Mesh")
      .def_property_readonly("vertices",
                             [](const py::object& self) -> py::object {
                               const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
                               const auto count = static_cast<py::ssize_t>(mesh.vertices.count);
                               return viewOf(mesh.vertices.positions, {count, 3}, self);
                             })
      .def_property_readonly("origin",
                             [](const PyMesh& mesh) {
                               const pp_points points = mesh.mesh().view().vertices;
                               return Vector{points.origin[0], points.origin[1], points.origin[2]};
                             })
      .def_property_readonly("normals",
                             [](const py::object& self) -> py::object {
                               const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
                               const auto count = static_cast<py::ssize_t>(mesh.vertices.count);
                               return viewOf(mesh.vertices.normals, {count, 3}, self);
                             })
      .def_property_readonly("triangles",
                             [](const py::object& self) -> py::object {
                               const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
                               return viewOf(mesh.triangles, {static_cast<py::ssize_t>(mesh.count), 3}, self);
                             })
      .def_property_readonly("closed", [](const PyMesh& mesh) { return mesh.mesh().view().closed != 0; })
      .def("save", [](const PyMesh& mesh, const py::object& path, bool ascii) {
        const std::string file = fileOf(path);
        pp_write_options options = pp_default_write_options();
        options.ascii = ascii ? 1 : 0;
        py::gil_scoped_release released;
        mesh.mesh().write(file, options);
      }, py::arg("file"), py::arg("ascii") = false,
           "save(file, ascii=False)\n\nVertices with normals, and triangles.")
      .def("__repr__", [](const PyMesh& mesh) {
        const pp_triangles triangles = mesh.mesh().view();
        return "<palpate.Mesh of " + std::to_string(triangles.count) + " triangles, " +
               (triangles.closed ? "closed>" : "open>");
      });
}

void bindTouch(py::class_<PySession>& session) {
  session
      .def("touch", &PySession::touch, py::arg("path"), py::arg("surface") = py::none(),
           "touch(path, surface=None) -> structured array\n\n"
           "Follows the path in virtual time and only feels. path: (N, 3), model units, a row for each tick; or (N, 4), seconds\n"
           "first. surface: from now on \"average\", \"sphere\" or \"sharp\". One row a tick: t_s (s), hip, proxy, normal (3,\n"
           "model units), force_N (3), penetration_mm, contact, neighbours, fresh. The same path gives the same rows.")
      .def("stroke", &PySession::stroke, py::arg("path"), py::arg("kind"),
           "stroke(path, kind, **brush) -> structured array\n\n"
           "The same with a brush: push, carve, inflate, smooth, grab, paint or flatten. Of the brush: radius_mm, tau_mm (how\n"
           "deep a hand may stand before the surface yields), beta (push: share of the way that a point goes in one tick),\n"
           "strength (0 to 1), falloff (0 to 16), keeps_density, color (three of 0 to 255).")
      .def("set_brush", [](PySession& self, const std::optional<std::string>& kind, const py::kwargs& settings) {
        if (!kind) return self.with([](pp::Session& open) { open.setNoBrush(); });
        const Brush brush(*kind, settings);
        self.with([&](pp::Session& open) { open.setBrush(brush.brush); });
      }, py::arg("kind"),
           "set_brush(kind, **brush)\n\nWhat a live hand sculpts with from now on, as of stroke(); None: it only feels.")
      .def("undo", [](PySession& self, std::uint64_t strokes) {
        return self.with([&](pp::Session& open) { return open.undo(strokes); });
      }, py::arg("strokes") = 1,
           "undo(strokes=1) -> int\n\nTakes the last strokes back, each point to the last bit; says how many there were. A stroke\n"
           "is all that is done in one contact.")
      .def("redo", [](PySession& self, std::uint64_t strokes) {
        return self.with([&](pp::Session& open) { return open.redo(strokes); });
      }, py::arg("strokes") = 1, "redo(strokes=1) -> int\n\nDoes again what was taken back last; says how many there were.")
      .def("cloud", [](PySession& self) {
        return std::make_shared<PyCloud>(self.with([](pp::Session& open) { return open.cloud(); }));
      }, "cloud() -> Cloud\n\nThe points as they are.")
      .def("_live_start", [](PySession& self, const std::optional<std::string>& device, double rate,
                             const std::optional<std::string>& builtin, const py::object& path, const py::object& law) {
        const std::optional<PathArray> rows = path.is_none() ? std::nullopt : std::optional<PathArray>(path);
        const Law own(law);
        pp_live_options options = pp_default_live_options();
        options.device = orNull(device);
        options.builtin = orNull(builtin);
        options.path = rows ? &rows->path : nullptr;
        options.rate_Hz = rate;
        options.law = own.function;
        options.law_library = own.name();
        self.with([&](pp::Session& open) { open.startLive(options); });
      })
      .def("_live_take", &PySession::takeTicks)
      .def("_live_missed", [](PySession& self) {
        return self.with([](pp::Session& open) { return open.liveState().missed; });
      })
      .def("_live_running", [](PySession& self) {
        return self.with([](pp::Session& open) { return open.liveState().running != 0; });
      })
      .def("_live_forces", [](PySession& self, bool on) { pp::check(pp_live_set_forces(self.session().handle(), on)); })
      .def("_live_stop", [](PySession& self) { self.with([](pp::Session& open) { open.stopLive(); }); });
}

void bindSessions(py::module_& module) {
  const pp_feel feel = pp_default_feel();
  const pp_session_options usual = pp_default_session_options();
  py::class_<PySession> session(module, "_Session");
  session
      .def(py::init([](CloudPointer cloud, const std::optional<std::string>& gpu, std::optional<double> mm_per_unit,
                       const std::string& surface, std::optional<double> radius_mm, double friction, double stiffness,
                       double damping, double max_force, double rate, bool estimate_normals, std::uint32_t threads,
                       double undo_memory_MiB, const py::object& law) {
             return std::make_unique<PySession>(std::move(cloud),
                                                SessionSettings{gpu, mm_per_unit, surface, radius_mm, friction, stiffness,
                                                                damping, max_force, rate, estimate_normals, threads,
                                                                undo_memory_MiB},
                                                Law(law));
           }),
           py::arg("cloud"), py::arg("gpu") = py::none(), py::arg("mm_per_unit") = py::none(),
           py::arg("surface") = "average", py::arg("radius_mm") = py::none(), py::arg("friction") = feel.friction,
           py::arg("stiffness_N_per_mm") = feel.stiffness_N_per_mm, py::arg("damping_N_s_per_mm") = feel.damping_N_s_per_mm,
           py::arg("max_force_N") = feel.max_force_N, py::arg("rate_Hz") = usual.rate_Hz,
           py::arg("estimate_normals") = false, py::arg("threads") = 0,
           py::arg("undo_memory_MiB") = usual.undo_memory_MiB, py::arg("law") = py::none())
      .def("close", &PySession::close)
      .def_property_readonly("remarks", &PySession::remarks)
      .def("_info", [](PySession& self) {
        const pp_session_info info = self.with([](pp::Session& open) { return open.info(); });
        py::dict told;
        told["points"] = info.points;
        told["mm_per_unit"] = info.mm_per_unit;
        told["spacing_mm"] = info.spacing_mm;
        told["radius_mm"] = info.radius_mm;
        told["rate_Hz"] = info.rate_Hz;
        told["undoable"] = info.undoable;
        told["redoable"] = info.redoable;
        told["live"] = info.live != 0;
        told["backend"] = std::string(info.backend);
        told["machine"] = std::string(info.machine);
        return told;
      })
      .def("render", [](PySession& self, const std::pair<std::uint32_t, std::uint32_t>& size,
                        const std::optional<Vector>& eye, const std::optional<Vector>& target,
                        const std::optional<Vector>& up, double fov, const std::string& color,
                        const std::optional<Color>& background, std::uint32_t samples) {
        pp_picture_options options = pp_default_picture_options();
        options.width = size.first;
        options.height = size.second;
        options.samples = samples;
        options.fov_deg = fov;
        options.color = color.c_str();
        vectorOr(eye, options.has_eye, options.eye);
        vectorOr(target, options.has_target, options.target);
        vectorOr(up, options.has_up, options.up);
        options.has_background = background ? 1 : 0;
        for (std::size_t k = 0; background && k < 3; ++k) options.background[k] = (*background)[k];
        return self.render(size, options);
      }, py::arg("size") = std::pair(1280, 720), py::arg("eye") = py::none(), py::arg("target") = py::none(),
         py::arg("up") = py::none(), py::arg("fov") = 45.0, py::arg("color") = "rgb", py::arg("background") = py::none(),
         py::arg("samples") = 4,
         "render(size=(1280, 720), eye=None, target=None, up=None, fov=45, color='rgb', background=None, samples=4)\n\n"
         "The points as they are: uint8, height x width x 4, rows from the top. size: width, height. eye, target, up: model\n"
         "units; what is not given fits the model. fov: vertical, degrees. color: rgb, normal, depth, height. background: three\n"
         "of 0 to 255.")
      .def("mesh", [](PySession& self, std::uint32_t lattice, const std::string& surface, std::optional<double> radius_mm) {
        pp_mesh_options options = pp_default_mesh_options();
        options.lattice = lattice;
        options.surface = surface.c_str();
        options.radius_mm = radius_mm.value_or(0);
        return std::make_shared<PyMesh>(self.with([&](pp::Session& open) { return open.mesh(options); }));
      }, py::arg("lattice") = 128, py::arg("surface") = "sphere", py::arg("radius_mm") = py::none(),
         "mesh(lattice=128, surface='sphere', radius_mm=None) -> Mesh\n\n"
         "Triangles around the points as they are, by marching cubes. lattice: cells along the longest side. surface: sphere,\n"
         "average, sharp or density.");
  bindTouch(session);
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
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const pp::Error& error) {
      translate(error);
    }
  });
  py::options options;
  options.disable_function_signatures();
  module.def("version", &pp::version);
  module.def("gpus", &gpuNames, py::call_guard<py::gil_scoped_release>());
  module.def("formats_read", &pp_formats_read);
  module.def("formats_written", &pp_formats_written);
  module.def("_tick_dtype", &tickType);
  bindClouds(module);
  bindMeshes(module);
  bindSessions(module);
}

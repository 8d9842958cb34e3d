// Sessions in Python. Nothing of Python runs on a servo thread.
#include <algorithm>
#include <mutex>
#include <utility>

#include "apps/python/arrays.hpp"

namespace palpate::python {

using CloudPointer = std::shared_ptr<PyCloud>;
using Vector = std::array<double, 3>;
using Color = std::array<std::uint8_t, 3>;

namespace {

py::array ticksOf(std::size_t count) { return py::array(tickType(), count); }

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

const char* orNull(const std::optional<std::string>& text) { return text ? text->c_str() : nullptr; }

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

std::optional<Vector> vectorOr(const std::optional<Vector>& given, std::uint32_t& has, double (&to)[3]) {
  has = given ? 1 : 0;
  for (std::size_t k = 0; given && k < 3; ++k) to[k] = (*given)[k];
  return given;
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

}  // namespace

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

}  // namespace palpate::python

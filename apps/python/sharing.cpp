// Shared sessions in Python: served, listed, joined.
#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "apps/python/session.hpp"

namespace palpate::python {

using namespace py::literals;

Network::Network(NetworkTuple given) : given_(std::move(given)) {
  const auto& [interface, peers, domain, security] = given_;
  for (const std::string& peer : peers) peers_.push_back(peer.c_str());
  network_.interface_name = interface ? interface->c_str() : nullptr;
  network_.peers = peers_.data();
  network_.peer_count = peers_.size();
  network_.domain = domain;
  network_.security = security ? security->c_str() : nullptr;
  network_.stop = &Interruption::isAsked;
  network_.stop_user = &interruption_;
}

pp::Session join(const JoinTuple& how, const pp_session_options& options) {
  const auto& [name, network, handName, readOnly, timeout_s, partial] = how;
  const Network on(network);
  pp_join_options join = pp_default_join_options();
  join.network = on.get();
  join.hand_name = handName ? handName->c_str() : nullptr;
  join.read_only = readOnly ? 1 : 0;
  join.timeout_s = timeout_s;
  join.partial = partial ? 1 : 0;
  return pp::Session::joined(name, join, options);
}

namespace {

struct ServeSettings {
  NetworkTuple network;
  bool read_only = false, estimate_normals = false;
  std::optional<std::string> model, journal, save;
  std::optional<double> mm_per_unit;
  std::uint32_t threads = 0;
};

/// Thread-safe.
class PyServer {
 public:
  PyServer(const PyCloud& cloud, const std::string& name, const ServeSettings& settings) {
    Network on(settings.network);
    pp_serve_options options = pp_default_serve_options();
    options.network = on.get();
    options.read_only = settings.read_only ? 1 : 0;
    options.estimate_normals = settings.estimate_normals ? 1 : 0;
    options.model = settings.model ? settings.model->c_str() : nullptr;
    options.journal = settings.journal ? settings.journal->c_str() : nullptr;
    options.save = settings.save ? settings.save->c_str() : nullptr;
    options.mm_per_unit = settings.mm_per_unit.value_or(0);
    options.threads = settings.threads;
    options.log = &Heard::hear;
    options.log_user = &heard_;
    Interruption interruption;
    options.watch = interruption.watch();
    const WithoutGil released;
    pp_server server{};
    interruption.during([&] { pp::check(pp_serve(cloud.cloud().handle(), name.c_str(), &options, &server)); });
    id_ = server.id;
  }
  ~PyServer() {
    const WithoutGil released;
    if (const std::uint64_t id = id_.exchange(0)) pp_server_close({id});
  }
  PyServer(const PyServer&) = delete;
  PyServer& operator=(const PyServer&) = delete;

  void close() {
    if (!home_.isHere()) return;
    const WithoutGil released;
    if (const std::uint64_t id = id_.exchange(0)) pp::check(pp_server_close({id}));
  }
  pp_server_info info() const {
    home_.require();
    const WithoutGil released;
    pp_server_info info = pp_default_server_info();
    pp::check(pp_server_get_info({id_}, &info));
    return info;
  }
  std::shared_ptr<PyCloud> cloud() const {
    home_.require();
    const WithoutGil released;
    pp_cloud cloud{};
    pp::check(pp_server_cloud({id_}, &cloud));
    return std::make_shared<PyCloud>(pp::Cloud(cloud));
  }
  py::list messages() const { return told(heard_); }

 private:
  Home home_;
  Heard heard_;
  std::atomic<std::uint64_t> id_ = 0;
};

py::dict told(const pp_server_info& info) {
  return py::dict("serving"_a = info.serving != 0, "points"_a = info.points, "clients"_a = info.clients,
                  "sculptors"_a = info.sculptors, "pieces"_a = info.pieces, "states"_a = info.states,
                  "sent"_a = info.sent, "refused"_a = info.refused, "mm_per_unit"_a = info.mm_per_unit,
                  "access"_a = textOf(info.access), "fault"_a = textOf(info.fault));
}

// None for a negative round trip.
py::object tripOf(double round_trip_ms) {
  return round_trip_ms < 0 ? py::object(py::none()) : py::object(py::float_(round_trip_ms));
}

py::dict told(const pp_sharing& sharing) {
  return py::dict("name"_a = textOf(sharing.name), "host"_a = textOf(sharing.host), "model"_a = textOf(sharing.model),
                  "sculptable"_a = sharing.sculptable != 0, "connected"_a = sharing.connected != 0,
                  "silent_s"_a = sharing.silent_s, "longest_silent_s"_a = sharing.longest_silent_s,
                  "round_trip_ms"_a = tripOf(sharing.round_trip_ms), "pings"_a = sharing.pings,
                  "answered"_a = sharing.answered, "sent"_a = sharing.sent, "received"_a = sharing.received,
                  "resent"_a = sharing.resent, "resumed"_a = sharing.resumed, "delivered"_a = sharing.delivered != 0,
                  "idle"_a = sharing.idle != 0, "same"_a = sharing.same != 0, "restarts"_a = sharing.restarts,
                  "fault"_a = textOf(sharing.fault));
}

py::list discover(const NetworkTuple& network, double seconds) {
  std::vector<pp_served_session> seen;
  {
    const WithoutGil released;
    Network on(network);
    seen = on.waiting([&] { return pp::discover(*on.get(), seconds); });
  }
  py::list all;
  for (const pp_served_session& one : seen)
    all.append(py::make_tuple(textOf(one.name), textOf(one.host), textOf(one.model), one.points,
                              tripOf(one.round_trip_ms), one.version, one.compatible != 0, one.pings, one.answered));
  return all;
}

py::tuple vector(const double (&v)[3]) { return py::make_tuple(v[0], v[1], v[2]); }

py::list othersOf(PySession& self) {
  const std::vector<pp_other_hand> hands = self.with([](pp::Session& open) { return open.otherHands(); });
  py::list all;
  for (const pp_other_hand& hand : hands)
    all.append(py::make_tuple(textOf(hand.name), hand.number, vector(hand.position), vector(hand.proxy),
                              hand.touching != 0, hand.sculpts != 0, hand.age_s));
  return all;
}

py::list camerasOf(PySession& self) {
  const std::vector<pp_other_camera> cameras = self.with([](pp::Session& open) { return open.cameras(); });
  py::list all;
  for (const pp_other_camera& camera : cameras) {
    const auto& [w, x, y, z] = camera.place.orientation;
    all.append(py::make_tuple(textOf(camera.name), camera.number, vector(camera.place.position),
                              py::make_tuple(w, x, y, z), camera.place.fov_deg, camera.place.aspect, camera.age_s));
  }
  return all;
}

void publishCamera(PySession& self, const std::array<double, 3>& position, const std::array<double, 4>& orientation,
                   double fov_deg, double aspect) {
  pp_camera_place camera{};
  std::ranges::copy(position, camera.position);
  std::ranges::copy(orientation, camera.orientation);
  camera.fov_deg = fov_deg;
  camera.aspect = aspect;
  self.with([&](pp::Session& open) { open.publishCamera(camera); });
}

}  // namespace

void bindSessionsSharing(py::class_<PySession>& session) {
  session
      .def(
          "settle",
          [](PySession& self, double seconds) {
            return self.with([&](pp::Session& open) { return open.settle(seconds); });
          },
          py::arg("seconds") = 10.0,
          "settle(seconds=10) -> bool\n\n"
          "For a joined session: requests the server's state, and exchanges edits until all that the server\n"
          "had taken before this call is in effect here, and the server has all edits made here; waits at\n"
          "most `seconds`. True if so and the points are the server's, bit by bit; False also if the server\n"
          "does not answer. Not while the session is live. Raises Error with the status \"network\" if this\n"
          "hand's part has ended permanently.")
      .def(
          "_save_at_server",
          [](PySession& self, double seconds) {
            const pp_server_save save = self.with([&](pp::Session& open) { return open.saveAtServer(seconds); });
            return py::make_tuple(save.written != 0, save.points, textOf(save.text));
          },
          py::arg("seconds"))
      .def("_sharing",
           [](PySession& self) { return told(self.with([](pp::Session& open) { return open.sharing(); })); })
      .def("_other_hands", &othersOf)
      .def("_cameras", &camerasOf)
      .def("publish_camera", &publishCamera, py::arg("position"), py::arg("orientation"), py::arg("fov_deg") = 45.0,
           py::arg("aspect") = 1.0,
           "publish_camera(position, orientation, fov_deg=45, aspect=1)\n\n"
           "For a joined session: shows this camera to the others from now on, at most 30 times a second.\n"
           "position: x, y, z, model units. orientation: unit quaternion w x y z of the axes to the right of\n"
           "the picture, down in it and in the direction of view. fov_deg: vertical. aspect: width / height.\n"
           "Pictures of render() are not shown unless this is called.")
      .def(
          "hide_camera", [](PySession& self) { self.with([](pp::Session& open) { open.hideCamera(); }); },
          "hide_camera()\n\n"
          "Stops showing a camera of this session to the others.");
}

void bindSharing(py::module_& module) {
  module.def(
      "can_share", [] { return pp_can_share() != 0; },
      "can_share() -> bool\n\n"
      "True if this palpate was built with PALPATE_NETWORK. Otherwise serve(), discover() and Session.join()\n"
      "raise Error with the status \"unsupported\".");
  module.def("_discover", &discover, py::arg("network"), py::arg("seconds"));
  py::class_<PyServer>(module, "_Server")
      .def(py::init([](const PyCloud& cloud, const std::string& name, const NetworkTuple& network, bool read_only,
                       const std::optional<std::string>& model, std::optional<double> mm_per_unit,
                       bool estimate_normals, const std::optional<std::string>& journal,
                       const std::optional<std::string>& save, std::uint32_t threads) {
             return std::make_unique<PyServer>(
                 cloud, name,
                 ServeSettings{network, read_only, estimate_normals, model, journal, save, mm_per_unit, threads});
           }),
           py::arg("cloud"), py::arg("name"), py::arg("network"), py::arg("read_only") = false,
           py::arg("model") = py::none(), py::arg("mm_per_unit") = py::none(), py::arg("estimate_normals") = false,
           py::arg("journal") = py::none(), py::arg("save") = py::none(), py::arg("threads") = 0)
      .def("close", &PyServer::close,
           "close()\n\n"
           "Stops serving; later calls raise ClosedError. A with statement does it. Programs that have\n"
           "joined keep their points.")
      .def("cloud", &PyServer::cloud,
           "cloud() -> Cloud\n\n"
           "A copy of the present points, with all strokes taken.")
      .def("_info", [](const PyServer& self) { return told(self.info()); })
      .def_property_readonly("messages", &PyServer::messages,
                             "Messages, such as of programs that have joined, one line each.");
}

}  // namespace palpate::python

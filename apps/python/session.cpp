#include "apps/python/session.hpp"

#include <algorithm>
#include <span>

namespace palpate::python {

namespace {

const char* orNull(const std::optional<std::string>& text) { return text ? text->c_str() : nullptr; }

// One path, or one for each of several hands.
std::vector<std::unique_ptr<PathArray>> pathsOf(const py::object& given, std::uint32_t hands) {
  std::vector<std::unique_ptr<PathArray>> paths;
  if (hands == 1) {
    paths.push_back(std::make_unique<PathArray>(given));
    return paths;
  }
  if (!py::isinstance<py::sequence>(given) && !py::isinstance<py::array>(given))
    refuse("path: a session of " + std::to_string(hands) + " hands needs a path for each, as a list of arrays");
  for (const py::handle& path : given)
    paths.push_back(std::make_unique<PathArray>(py::reinterpret_borrow<py::object>(path)));
  if (paths.size() != hands)
    refuse("path: a session of " + std::to_string(hands) + " hands needs a path for each, and " +
           std::to_string(paths.size()) + (paths.size() == 1 ? " is given" : " are given"));
  return paths;
}

py::array rowsOf(std::span<const pp_tick> ticks, const std::vector<py::ssize_t>& shape) {
  py::array rows(tickType(), shape);
  std::ranges::transform(ticks, static_cast<TickRow*>(rows.mutable_data()), rowOf);
  return rows;
}

}  // namespace

namespace {

struct BrushSetting {
  const char* name;
  const char* kind;  ///< type of its value, for error messages
  void (*set)(pp_brush& brush, const py::handle& value, double mm_per_unit);
};
constexpr BrushSetting kBrushSettings[]{
    {"radius_mm", "a number", [](pp_brush& b, const py::handle& v, double) { b.radius_mm = v.cast<double>(); }},
    {"yield_depth_mm", "a number",
     [](pp_brush& b, const py::handle& v, double) { b.yield_depth_mm = v.cast<double>(); }},
    {"radius", "a number", [](pp_brush& b, const py::handle& v, double mm) { b.radius_mm = v.cast<double>() * mm; }},
    {"yield_depth", "a number",
     [](pp_brush& b, const py::handle& v, double mm) { b.yield_depth_mm = v.cast<double>() * mm; }},
    {"push_rate", "a number", [](pp_brush& b, const py::handle& v, double) { b.push_rate = v.cast<double>(); }},
    {"strength", "a number", [](pp_brush& b, const py::handle& v, double) { b.strength = v.cast<double>(); }},
    {"falloff", "a whole number of 0 or more",
     [](pp_brush& b, const py::handle& v, double) { b.falloff = v.cast<std::uint32_t>(); }},
    {"resample", "True or False",
     [](pp_brush& b, const py::handle& v, double) { b.resample = v.cast<bool>() ? 1 : 0; }},
    {"accumulate", "True or False",
     [](pp_brush& b, const py::handle& v, double) { b.accumulate = v.cast<bool>() ? 1 : 0; }},
    {"color", "three whole numbers from 0 to 255",
     [](pp_brush& b, const py::handle& v, double) {
       std::ranges::copy(v.cast<std::array<std::uint8_t, 3>>(), b.color);
     }},
    {"symmetry", "a text",
     [](pp_brush& b, const py::handle& v, double) {
       if (!py::isinstance<py::str>(v)) throw py::cast_error();
       b.symmetry = PyUnicode_AsUTF8(v.ptr());
     }},
};

}  // namespace

py::list brushSettings() {
  py::list names;
  for (const BrushSetting& setting : kBrushSettings) names.append(setting.name);
  return names;
}

Brush::Brush(const std::string& name, const py::kwargs& settings, double mm_per_unit) : kind(name) {
  for (const auto& [length, length_mm] : {std::pair("radius", "radius_mm"), std::pair("yield_depth", "yield_depth_mm")})
    if (settings.contains(length) && settings.contains(length_mm))
      refuse(std::string("brush: has ") + length + ", in model units, and " + length_mm + "; give one of them");
  for (const BrushSetting& setting : kBrushSettings) {
    if (!settings.contains(setting.name)) continue;
    const py::object value = settings[setting.name];
    try {
      setting.set(brush, value, mm_per_unit);
    } catch (const py::cast_error&) {
      refuseType(std::string(setting.name) + ": must be " + setting.kind + ", not " + described(value));
    }
  }
  brush.kind = kind.c_str();
}

PySession::PySession(const Source& source, pp_session_options options, const pp_contact_options& contact,
                     const std::string& surface, Law law, py::object onMessage)
    : cloud_(source.cloud),
      heard_(std::move(onMessage)),
      surface_(surface),
      contact_(contact),
      hands_(options.hands),
      hasTorques_(std::string_view(options.tool->kind) != "point"),
      law_(std::move(law)),
      budget_us_(options.budget_us) {
  if (options.hands == 0) refuse("hands: is 0; a session has 1 to 8");
  const pp_contact_options felt = contactWith(surface_);
  options.contact = &felt;
  options.law = law_.function();
  options.law_user = law_.user();
  options.law_library = law_.library();
  options.log = &Heard::hear;
  options.log_user = &heard_;
  options.watch = interruption_.watch();
  const Heard::Delivery delivery(heard_);
  const WithoutGil released;
  session_ = interruption_.during([&] { return opened(source, options); });
  handle_ = session_.handle();
}

pp::Session PySession::opened(const Source& source, const pp_session_options& options) {
  if (source.join) return join(*source.join, options);
  if (source.moving) {
    pp_frames_options frames = pp_default_frames_options();
    frames.stable_rows = source.stable_rows ? 1 : 0;
    frames.max_points = source.max_points;
    return pp::Session::ofFrames(source.cloud->cloud(), frames, options);
  }
  if (!source.clouds.empty()) {
    std::vector<pp_placed_cloud> placed;
    for (const auto& [cloud, position, orientation] : source.clouds) {
      pp_placed_cloud& given = placed.emplace_back();
      given.cloud = cloud->cloud().handle();
      std::ranges::copy(position, given.position);
      std::ranges::copy(orientation, given.orientation);
    }
    return pp::Session::ofClouds(placed, options);
  }
  if (source.cloud) return pp::Session(source.cloud->cloud(), options);
  if (source.scene) return pp::Session::ofMatter(*source.scene, options);
  pp_stream_options stream = pp_default_stream_options();
  stream.speed = source.speed;
  stream.loop = source.loop ? 1 : 0;
  stream.fuse = source.fuse ? 1 : 0;
  return pp::Session::ofStream(source.folder.value_or(""), stream, options);
}

PySession::~PySession() {
  const WithoutGil released;  // a thread of palpate may be waiting for it
  session_ = pp::Session();
}

pp_contact_options PySession::contactWith(const std::string& surface) const {
  pp_contact_options contact = contact_;
  contact.surface = surface.c_str();
  return contact;
}

py::array PySession::touch(const py::object& path, const std::optional<std::string>& surface) {
  if (surface && *surface != surface_) {
    const pp_contact_options contact = contactWith(*surface);
    with([&](pp::Session& session) { session.setContact(contact); });
    surface_ = *surface;
  }
  return along(path, nullptr);
}

void PySession::setContact(const std::optional<std::string>& surface, std::optional<double> friction,
                           std::optional<double> stiffness, std::optional<double> damping,
                           std::optional<double> max_force, std::optional<double> hand_gain) {
  const std::string name = surface.value_or(surface_);
  pp_contact_options contact = contactWith(name);
  contact.friction = friction.value_or(contact.friction);
  contact.stiffness_N_per_mm = stiffness.value_or(contact.stiffness_N_per_mm);
  contact.damping_N_s_per_mm = damping.value_or(contact.damping_N_s_per_mm);
  contact.max_force_N = max_force.value_or(contact.max_force_N);
  contact.hand_gain = hand_gain.value_or(contact.hand_gain);
  with([&](pp::Session& session) { session.setContact(contact); });
  contact_ = contact;
  surface_ = name;
}

py::array PySession::stroke(const py::object& path, const std::string& kind, const py::kwargs& settings) {
  const Brush brush(kind, settings, mm_per_unit());
  return along(path, &brush.brush);
}

py::array PySession::along(const py::object& given, const pp_brush* brush) {
  const auto paths = pathsOf(given, hands_);
  refuseDeaf();
  if (law_.python()) law_.python()->begin();
  std::vector<const pp_path*> pointers;
  pointers.reserve(paths.size());
  for (const auto& path : paths) pointers.push_back(&path->path);
  std::uint64_t ticks = 0;
  with([&](pp::Session& session) {
    for (const pp_path* path : pointers) {
      std::uint64_t count = 0;
      pp::check(pp_path_ticks(session.handle(), path, &count));
      ticks = std::max(ticks, count);
    }
  });
  const std::uint64_t rows = ticks * hands_;
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(ticks)};
  if (hands_ > 1) shape.push_back(hands_);
  std::vector<pp_tick> felt(rows);
  std::vector<double> torques_mNm(hasTorques_ ? 3 * rows : 0);
  try {
    with([&](pp::Session& session) {
      std::uint64_t done = 0;
      pp::check(pp_session_touch_hands(session.handle(), pointers.data(), hands_, brush, felt.data(),
                                       hasTorques_ ? torques_mNm.data() : nullptr, rows, &done));
    });
  } catch (const pp::Error&) {
    if (law_.python()) law_.python()->raise();
    throw;
  }
  if (law_.python()) law_.python()->raise();
  if (listener_) listener_->raise();
  if (!hasTorques_) return rowsOf(felt, shape);
  py::array all(toolTickType(), shape);
  auto* row = static_cast<ToolTickRow*>(all.mutable_data());
  for (std::uint64_t i = 0; i < rows; ++i, ++row) {
    *row = {.tick = rowOf(felt[i]), .torque_mNm = {}};
    std::copy_n(&torques_mNm[3 * i], 3, row->torque_mNm);
  }
  return all;
}

void PySession::addFrame(double t_s, const py::object& xyz, const py::object& normals, const py::object& velocities) {
  const py::array places = threeColumns(xyz, "xyz");
  const py::array facing = threeColumns(normals, "normals", places.shape(0));
  py::array speeds;  // kept alive until they are copied
  pp_frame_arrays frame = pp_default_frame_arrays();
  frame.count = static_cast<std::uint64_t>(places.shape(0));
  frame.t_s = t_s;
  frame.positions = rowsOf(places);
  frame.normals = rowsOf(facing);
  if (!velocities.is_none()) {
    speeds = threeColumns(velocities, "velocities", places.shape(0));
    frame.velocities = rowsOf(speeds);
  }
  home_.require();
  const WithoutGil released;
  session_.pushFrame(frame);  // at the same time as any other call
}

py::array PySession::render(const std::pair<std::uint32_t, std::uint32_t>& size, const pp_picture_options& options) {
  // What is too large gets no memory: the call below says the maximum.
  const bool fits = std::max(size.first, size.second) <= PP_MAX_PICTURE_SIDE;
  const py::ssize_t width = fits ? size.first : 0, height = fits ? size.second : 0;
  py::array_t<std::uint8_t> picture(std::vector<py::ssize_t>{height, width, 4});
  std::uint8_t* const rgba = picture.mutable_data();
  const auto bytes = static_cast<std::uint64_t>(picture.size());
  with([&](pp::Session& session) { pp::check(pp_session_render(session.handle(), &options, rgba, bytes)); });
  return picture;
}

void PySession::startLive(const std::optional<std::string>& device, double rate,
                          const std::optional<std::string>& builtin, const py::object& path, const py::object& law,
                          bool allowPython, const py::list& others, const std::optional<std::string>& axes) {
  using Text = std::optional<std::string>;
  struct Hand {
    Text device, builtin, axes;
    std::unique_ptr<PathArray> path;
    pp_live_options options = pp_default_live_options();
  };
  std::vector<Hand> hands;
  const auto add = [&](const Text& its, const Text& way, const py::object& rows, const Text& turned) {
    hands.push_back({its, way, turned, rows.is_none() ? nullptr : std::make_unique<PathArray>(rows)});
  };
  add(device, builtin, path, axes);
  for (const py::handle& other : others) {
    const auto [its, way, rows, turned] = other.cast<std::tuple<Text, Text, py::object, Text>>();
    add(its, way, rows, turned);
  }
  for (std::size_t i = hands.size(); i-- > 0;) {
    pp_live_options& options = hands[i].options;
    options.device = orNull(hands[i].device);
    options.builtin = orNull(hands[i].builtin);
    options.axes = orNull(hands[i].axes);
    options.path = hands[i].path ? &hands[i].path->path : nullptr;
    if (i + 1 < hands.size()) options.next = &hands[i + 1].options;
  }
  refuseDeaf();
  Law own(law, allowPython);
  pp_live_options& first = hands.front().options;
  first.rate_Hz = rate;
  const auto name = [&](const Law& asked) {
    first.law = asked.function();
    first.law_user = asked.user();
    first.law_library = asked.library();
  };
  name(own);
  if (with([](pp::Session& session) { return session.liveState().running != 0; }))
    with([&](pp::Session& session) { session.startLive(first); });  // refused with the library's message
  const bool hasOwn = static_cast<bool>(own);
  liveLaw_ = hasOwn ? std::move(own) : law_;
  if (hasOwn) name(liveLaw_);  // its text may have moved
  PythonLaw* const slow = liveLaw_.python();
  if (slow) slow->setLive(true);
  try {
    with([&](pp::Session& session) { session.startLive(first); });
  } catch (...) {
    if (slow) slow->setLive(false);
    throw;
  }
}

void PySession::refuseDeaf() const {
  if (listener_ && listener_->hasFailed()) throw Refusal("Error", listener_->sentence(), PP_ERROR_STATE);
}

void PySession::stopLive() {
  with([](pp::Session& session) { session.stopLive(); });
  if (liveLaw_.python()) liveLaw_.python()->setLive(false);
}

void PySession::raiseOfLaw() {
  if (liveLaw_.python()) liveLaw_.python()->raise();
}

py::array PySession::readTicks() {
  constexpr std::size_t kMax = 1 << 15;
  std::vector<std::array<double, 3>> torques_mNm;
  std::vector<double> ages_s;
  const std::vector<pp_tick> ticks =
      with([&](pp::Session& session) { return session.readTicks(kMax, &torques_mNm, &ages_s); });
  if (listener_ && listener_->hasFailed()) {
    stopLive();
    Heard::hear(&heard_, PP_LOG_WARNING, listener_->sentence().c_str());
    listener_->raise();
  }
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(ticks.size() / hands_)};
  if (hands_ > 1) shape.push_back(hands_);
  py::array all(liveTickType(), shape);
  auto* row = static_cast<LiveTickRow*>(all.mutable_data());
  for (std::size_t i = 0; i < ticks.size(); ++i, ++row) {
    *row = {.tool = {.tick = rowOf(ticks[i]), .torque_mNm = {}},
            .age_s = ages_s[i],
            .valid = ticks[i].valid != 0,
            .withheld = ticks[i].withheld != 0};
    std::ranges::copy(torques_mNm[i], row->tool.torque_mNm);
  }
  return all;
}

int PySession::visit(visitproc call, void* data) const {
  for (PyObject* const function : {heard_.function(), listener_ ? listener_->function() : nullptr,
                                   law_.python() ? law_.python()->function() : nullptr,
                                   liveLaw_.python() ? liveLaw_.python()->function() : nullptr})
    if (const int found = function ? call(function, data) : 0) return found;
  return 0;
}

void PySession::forget() {
  heard_.forget();
  if (listener_) listener_->forget();
  for (const Law* law : {&law_, &liveLaw_})
    if (law->python()) law->python()->forget();
}

double PySession::mm_per_unit() {
  return with([](pp::Session& session) { return session.info().mm_per_unit; });
}

void PySession::close() {
  if (!home_.isHere()) return;
  with([](pp::Session& session) {
    if (!session.isOpen()) return;
    try {
      pp::check(pp_session_close(session.handle()));
    } catch (const pp::Error& error) {
      if (error.status() == PP_ERROR_NETWORK) session = pp::Session();  // closed, though strokes may be lost
      throw;
    }
    session = pp::Session();
  });
  if (liveLaw_.python()) liveLaw_.python()->setLive(false);
}

}  // namespace palpate::python

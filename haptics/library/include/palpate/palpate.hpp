/// @file
/// palpate: feel, see and sculpt point clouds in real time. The C interface with lifetimes and exceptions, for C++17;
/// palpate.h documents units, threads and all options. Every call throws Error if that of the C interface fails.
/// Header-only: it is compiled into the program, and only the C interface is called across the library boundary.
#ifndef PALPATE_HPP
#define PALPATE_HPP

#include <palpate/palpate.h>
#include <palpate/clouds.hpp>
#include <palpate/handles.hpp>

#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// palpate's C interface with lifetimes and exceptions.
namespace pp {

/// How far an answer of touch() can be relied on (pp_contact).
enum class Validity {
  fresh,  ///< from the pose's own query
  held,   ///< bridged within the budget
  none    ///< a fault: there is no force
};
/// Validity of an answer.
inline Validity validityOf(const pp_contact& contact) {
  if (!contact.valid) return Validity::none;
  return contact.fresh ? Validity::fresh : Validity::held;
}

/// Moving points at one time; immutable.
class Frame : public detail::Owned<pp_frame, pp_frame_close> {
 public:
  using Owned::Owned;
  /// Read-only view, valid while this is open; nothing is copied.
  pp_moving_points view() const { return detail::written<pp_moving_points>(pp_frame_view, handle()); }
};

/// A session log in memory; immutable.
class Recording : public detail::Owned<pp_recording, pp_recording_close> {
 public:
  using Owned::Owned;
  /// Reads a log. Of one that is damaged or cut off, all complete parts are read.
  static Recording read(const std::string& file) {
    return Recording(detail::written<pp_recording>(pp_recording_read, file.c_str()));
  }
  /// Read-only view of its ticks and edits, valid while this is open; nothing is copied.
  pp_recording_content view() const { return detail::written<pp_recording_content>(pp_recording_view, handle()); }
};

/// Replays a recorded session and compares it with the log (pp_recording_replay()).
inline pp_replay_result replay(const std::string& file,
                               const pp_replay_options& options = pp_default_replay_options()) {
  pp_replay_result result = pp_default_replay_result();
  check(pp_recording_replay(file.c_str(), &options, &result));
  return result;
}

/// A scene of moving matter without hands. Only one thread may use it at a time.
class Matter : public detail::Owned<pp_matter, pp_matter_close> {
 public:
  using Owned::Owned;
  /// Opens a scene by its name, or from a file (pp_session_open_matter()).
  explicit Matter(const std::string& scene, const pp_matter_options& options = pp_default_matter_options()) {
    *this = Matter(detail::written<pp_matter>(pp_matter_open, scene.c_str(), &options));
  }
  /// Advances by `steps` milliseconds. Throws Error with PP_ERROR_SIMULATION if the scene fails meanwhile.
  void step(std::uint64_t steps = 1) { check(pp_matter_step(handle(), steps)); }
  /// Restarts the scene, with the parameters that were set.
  void reset() { check(pp_matter_reset(handle())); }
  /// Copies the present particles, or the surface of a soft body, in mm.
  Frame frame() const { return Frame(detail::written<pp_frame>(pp_matter_frame, handle())); }
  /// Parameters of the scene, which setParameter() changes.
  std::vector<pp_parameter> parameters() const {
    std::uint64_t count = 0;
    check(pp_matter_parameter_count(handle(), &count));
    std::vector<pp_parameter> all(count);
    for (std::uint64_t i = 0; i < count; ++i) check(pp_matter_get_parameter(handle(), i, &all[i]));
    return all;
  }
  /// From the next step on. Throws Error, without effect, for an unknown name or a value out of bounds.
  void setParameter(const std::string& name, double value) {
    check(pp_matter_set_parameter(handle(), name.c_str(), value));
  }
  /// Computes the state, from all particles.
  pp_matter_state state() const {
    pp_matter_state state = pp_default_matter_state();
    check(pp_matter_get_state(handle(), &state));
    return state;
  }
};

/// Sessions served on a network (pp_network_discover()); at most 256.
inline std::vector<pp_served_session> discover(const pp_network& network = pp_default_network(), double seconds = 2) {
  std::vector<pp_served_session> sessions(256);
  std::uint64_t count = 0;
  check(pp_network_discover(&network, seconds, sessions.data(), sessions.size(), &count));
  if (count < sessions.size()) sessions.resize(count);
  return sessions;
}

/// Serves a cloud while this is open (pp_serve()). Any number of threads may use it.
class Server : public detail::Owned<pp_server, pp_server_close> {
 public:
  using Owned::Owned;
  /// Serves the cloud under this name, which no other session of the network has.
  Server(const Cloud& cloud, const std::string& name, const pp_serve_options& options = pp_default_serve_options()) {
    *this = Server(detail::written<pp_server>(pp_serve, cloud.handle(), name.c_str(), &options));
  }
  /// Present state of the server.
  pp_server_info info() const {
    pp_server_info info = pp_default_server_info();
    check(pp_server_get_info(handle(), &info));
    return info;
  }
  /// Copies the present points.
  Cloud cloud() const { return Cloud(detail::written<pp_cloud>(pp_server_cloud, handle())); }
};

/// A cloud, or a scene of matter, that is felt, seen and sculpted.
class Session : public detail::Owned<pp_session, pp_session_close> {
 public:
  using Owned::Owned;
  /// Opens a cloud (pp_session_open()).
  explicit Session(const Cloud& cloud, const pp_session_options& options = pp_default_session_options())
      : Owned(made(cloud, options)) {}
  Session() = default;                    ///< closed
  Session(Session&&) noexcept = default;  ///< Leaves the other one closed.
  /// Exchanges the sessions.
  Session& operator=(Session&& other) noexcept {
    std::swap(listener_, other.listener_);
    Owned::operator=(std::move(other));
    return *this;
  }

  /// Opens several clouds as one (pp_session_open_clouds()).
  static Session ofClouds(const std::vector<pp_placed_cloud>& clouds,
                          const pp_session_options& options = pp_default_session_options()) {
    return Session(detail::written<pp_session>(pp_session_open_clouds, clouds.data(), clouds.size(), &options));
  }
  /// Opens a scene of moving matter (pp_session_open_matter()).
  static Session ofMatter(const std::string& scene, const pp_session_options& options = pp_default_session_options()) {
    return Session(detail::written<pp_session>(pp_session_open_matter, scene.c_str(), &options));
  }

  /// Opens a cloud whose frames the program provides (pp_session_open_frames()).
  static Session ofFrames(const Cloud& cloud, const pp_frames_options& frames = pp_default_frames_options(),
                          const pp_session_options& options = pp_default_session_options()) {
    return Session(detail::written<pp_session>(pp_session_open_frames, cloud.handle(), &frames, &options));
  }
  /// Opens a recorded depth camera (pp_session_open_stream()).
  static Session ofStream(const std::string& folder, const pp_stream_options& stream = pp_default_stream_options(),
                          const pp_session_options& options = pp_default_session_options()) {
    return Session(detail::written<pp_session>(pp_session_open_stream, folder.c_str(), &stream, &options));
  }
  /// Joins a session that another program serves, by its name (pp_session_join()).
  static Session joined(const std::string& name, const pp_join_options& join = pp_default_join_options(),
                        const pp_session_options& options = pp_default_session_options()) {
    return Session(detail::written<pp_session>(pp_session_join, name.c_str(), &join, &options));
  }
  /// Adds a frame (pp_session_push_frame()). May be called from any thread.
  void pushFrame(const pp_frame_arrays& frame) { check(pp_session_push_frame(handle(), &frame)); }

  /// Present state of the session.
  pp_session_info info() const {
    pp_session_info info = pp_default_session_info();
    check(pp_session_get_info(handle(), &info));
    return info;
  }

  /// Follows the path in virtual time and only feels.
  std::vector<pp_tick> touch(const pp_path& path) {
    std::vector<pp_tick> ticks(ticksOf(path));
    std::uint64_t count = 0;
    told(pp_session_touch(handle(), &path, ticks.data(), ticks.size(), &count));
    ticks.resize(count);
    return ticks;
  }
  /// One tick of a servo loop of the program.
  pp_contact touch(const pp_pose& pose) {
    pp_contact contact;
    told(pp_touch(handle(), &pose, &contact));
    return contact;
  }
  /// One tick for all hands. `orientations`: rotations of their tools, w x y z each; null: no rotation.
  std::vector<pp_contact> touch(const std::vector<pp_pose>& poses, const double* orientations = nullptr) {
    std::vector<pp_contact> contacts(poses.size());
    told(pp_touch_hands(handle(), poses.data(), orientations, static_cast<std::uint32_t>(poses.size()), contacts.data(),
                        nullptr));
    return contacts;
  }
  /// Notifies the session that all hands were lifted (pp_touch_lift()).
  void lift() { told(pp_touch_lift(handle())); }
  /// Sets the function that is called at the beginning and the end of each contact (pp_session_on_contact()), or
  /// removes it. What it throws is thrown by the call that delivers the event, which then returns no contact or tick.
  void onContact(std::function<void(const pp_contact_event&)> function) {
    auto listener = function ? std::make_unique<Listener>(Listener{std::move(function), nullptr}) : nullptr;
    check(pp_session_on_contact(handle(), listener ? &Listener::hear : nullptr, listener.get()));
    listener_ = std::move(listener);
  }
  /// Each hand follows its path; the first one sculpts if `brush` is not null. Returns the rows of all hands in one
  /// tick, then those of the next tick.
  std::vector<pp_tick> touchHands(const std::vector<pp_path>& paths, const pp_brush* brush = nullptr) {
    std::vector<const pp_path*> given;
    std::uint64_t most = 0;
    for (const pp_path& path : paths) {
      given.push_back(&path);
      const std::uint64_t ticks = ticksOf(path);
      if (ticks > most) most = ticks;
    }
    std::vector<pp_tick> ticks(most * paths.size());
    std::uint64_t count = 0;
    told(pp_session_touch_hands(handle(), given.data(), static_cast<std::uint32_t>(given.size()), brush, ticks.data(),
                                nullptr, ticks.size(), &count));
    ticks.resize(count);
    return ticks;
  }

  /// Sets the brush of touch() and of live hands (pp_session_set_brush()).
  void setBrush(const pp_brush& brush) { check(pp_session_set_brush(handle(), &brush)); }
  /// Removes that brush.
  void setNoBrush() { check(pp_session_set_brush(handle(), nullptr)); }
  /// Changes surface and force; not the support radius (pp_session_set_contact()).
  void setContact(const pp_contact_options& contact) { check(pp_session_set_contact(handle(), &contact)); }
  /// Follows the path with a brush.
  std::vector<pp_tick> stroke(const pp_path& path, const pp_brush& brush = pp_default_brush()) {
    std::vector<pp_tick> ticks(ticksOf(path));
    std::uint64_t count = 0;
    told(pp_session_stroke(handle(), &path, &brush, ticks.data(), ticks.size(), &count));
    ticks.resize(count);
    return ticks;
  }
  /// Undoes the last strokes, and returns their number.
  std::uint64_t undo(std::uint64_t strokes = 1) {
    return detail::written<std::uint64_t>(pp_session_undo, handle(), strokes);
  }
  /// Takes the stroke in progress back; false where there is none (pp_session_cancel_stroke()).
  bool cancelStroke() { return detail::written<std::uint32_t>(pp_session_cancel_stroke, handle()) != 0; }
  /// Redoes the strokes undone last, and returns their number.
  std::uint64_t redo(std::uint64_t strokes = 1) {
    return detail::written<std::uint64_t>(pp_session_redo, handle(), strokes);
  }
  /// Sets a mask of the present points: a byte for each of them (pp_session_set_mask()).
  void setMask(pp_mask which, const std::vector<std::uint8_t>& mask) {
    check(pp_session_set_mask(handle(), which, mask.data(), mask.size()));
  }
  /// Softens the rims of what is locked (pp_session_soften_lock()).
  void softenLock(double radius_mm) { check(pp_session_soften_lock(handle(), radius_mm)); }
  /// Removes the points of such a mask, as one stroke (pp_session_remove_points()).
  void removePoints(const std::vector<std::uint8_t>& mask) {
    check(pp_session_remove_points(handle(), mask.data(), mask.size()));
  }
  /// Moves them, as one stroke (pp_session_move_points()). `rotation`: a unit quaternion w, x, y, z.
  void movePoints(const std::vector<std::uint8_t>& mask, const std::array<double, 3>& offset,
                  const std::array<double, 4>& rotation = {1, 0, 0, 0}, double scale = 1) {
    check(pp_session_move_points(handle(), mask.data(), mask.size(), rotation.data(), scale, offset.data()));
  }
  /// Strokes become part of the layer of that name (pp_session_open_layer()), or with closeLayer() of none.
  void openLayer(const std::string& name) { check(pp_session_open_layer(handle(), name.c_str())); }
  /// Strokes become part of no layer.
  void closeLayer() { check(pp_session_open_layer(handle(), nullptr)); }
  /// Gives its strokes another strength, from -1 to 2 (pp_session_slide_layer()).
  void slideLayer(const std::string& name, double strength, bool continues = false) {
    check(pp_session_slide_layer(handle(), name.c_str(), strength, continues));
  }
  /// Hides a layer, or shows it again (pp_session_hide_layer()).
  void hideLayer(const std::string& name, bool hidden = true) {
    check(pp_session_hide_layer(handle(), name.c_str(), hidden));
  }
  /// Makes a layer part of the model (pp_session_merge_layer()).
  void mergeLayer(const std::string& name) { check(pp_session_merge_layer(handle(), name.c_str())); }
  /// How it is set, and the number of points that its strokes have changed.
  struct Layer {
    double strength = 0;       ///< from -1 to 2
    bool isHidden = false;     ///< as with strength 0
    std::uint64_t points = 0;  ///< that its strokes have changed
  };
  /// The layer of that name (pp_session_layer()).
  Layer layer(const std::string& name) {
    Layer layer;
    std::uint32_t hidden = 0;
    check(pp_session_layer(handle(), name.c_str(), &layer.strength, &hidden, &layer.points));
    layer.isHidden = hidden != 0;
    return layer;
  }
  /// A byte for each of the `points` present points.
  std::vector<std::uint8_t> mask(pp_mask which, std::uint64_t points) {
    std::vector<std::uint8_t> mask(points);
    check(pp_session_mask(handle(), which, mask.data(), mask.size()));
    return mask;
  }
  /// Takes in pending edits; call it some thirty times a second (pp_session_apply_edits()).
  void applyEdits() { check(pp_session_apply_edits(handle())); }
  /// Copies the present points.
  Cloud cloud() { return Cloud(detail::written<pp_cloud>(pp_session_cloud, handle())); }

  /// Draws the present points: rows from the top, RGBA.
  std::vector<std::uint8_t> render(const pp_picture_options& options = pp_default_picture_options()) {
    std::vector<std::uint8_t> rgba(std::size_t{4} * options.width * options.height);
    check(pp_session_render(handle(), &options, rgba.data(), rgba.size()));
    return rgba;
  }
  /// Meshes the present points by marching cubes (pp_session_mesh()).
  Mesh mesh(const pp_mesh_options& options = pp_default_mesh_options()) {
    return Mesh(detail::written<pp_mesh>(pp_session_mesh, handle(), &options));
  }

  /// Nearest positions of the surface: one for each `x y z` of `positions` (pp_session_nearest()).
  std::vector<pp_surface_point> nearest(const std::vector<double>& positions,
                                        double max_distance = std::numeric_limits<double>::infinity()) {
    std::vector<pp_surface_point> found(positions.size() / 3);
    const pp_rows from = rows(positions.data());
    check(pp_session_nearest(handle(), &from, found.size(), max_distance, found.data()));
    return found;
  }
  /// Nearest points themselves: likewise (pp_session_nearest_points()).
  std::vector<pp_surface_point> nearestPoints(const std::vector<double>& positions,
                                              double max_distance = std::numeric_limits<double>::infinity()) {
    std::vector<pp_surface_point> found(positions.size() / 3);
    const pp_rows from = rows(positions.data());
    check(pp_session_nearest_points(handle(), &from, found.size(), max_distance, found.data()));
    return found;
  }
  /// First positions of the surface on rays: x y z of each origin, and of each direction (pp_session_raycast()). Throws
  /// std::invalid_argument unless there is a direction for each origin.
  std::vector<pp_surface_point> raycast(const std::vector<double>& origins, const std::vector<double>& directions,
                                        double max_distance = std::numeric_limits<double>::infinity()) {
    if (origins.size() != directions.size()) throw std::invalid_argument("raycast: each origin needs a direction");
    std::vector<pp_surface_point> found(origins.size() / 3);
    const pp_rows from = rows(origins.data()), along = rows(directions.data());
    check(pp_session_raycast(handle(), &from, &along, found.size(), max_distance, found.data()));
    return found;
  }
  /// Where each row of cloud() comes from (pp_session_rows()).
  std::vector<pp_row> sourceRows() {
    std::uint64_t count = 0;
    check(pp_session_rows(handle(), nullptr, 0, &count));
    std::vector<pp_row> all(count);
    check(pp_session_rows(handle(), all.data(), all.size(), &count));
    return all;
  }

  // For joined sessions.
  /// State of the exchange with the other programs.
  pp_sharing sharing() const {
    pp_sharing sharing = pp_default_sharing();
    check(pp_session_get_sharing(handle(), &sharing));
    return sharing;
  }
  /// Hands of the other programs; at most 256.
  std::vector<pp_other_hand> otherHands() const {
    std::vector<pp_other_hand> hands(256);
    std::uint64_t count = 0;
    check(pp_session_other_hands(handle(), hands.data(), hands.size(), &count));
    if (count < hands.size()) hands.resize(count);
    return hands;
  }
  /// Cameras of the other programs' pictures; at most 256.
  std::vector<pp_other_camera> cameras() const {
    std::vector<pp_other_camera> cameras(256);
    std::uint64_t count = 0;
    check(pp_session_cameras(handle(), cameras.data(), cameras.size(), &count));
    if (count < cameras.size()) cameras.resize(count);
    return cameras;
  }
  /// Shows a camera to the others (pp_session_publish_camera()).
  void publishCamera(const pp_camera_place& camera) { check(pp_session_publish_camera(handle(), &camera)); }
  /// Stops showing it.
  void hideCamera() { check(pp_session_publish_camera(handle(), nullptr)); }
  /// Asks the server to write its file (pp_session_save_at_server()).
  pp_server_save saveAtServer(double seconds = 30) {
    pp_server_save save = pp_default_server_save();
    check(pp_session_save_at_server(handle(), seconds, &save));
    return save;
  }
  /// Waits at most `seconds` until this session has the server's points (pp_session_settle()). True if it has.
  bool settle(double seconds = 10) {
    std::uint32_t same = 0;
    check(pp_session_settle(handle(), seconds, &same));
    return same != 0;
  }

  // For scenes of matter.
  /// Copies the present points (pp_session_frame()).
  Frame frame() const { return Frame(detail::written<pp_frame>(pp_session_frame, handle())); }
  /// Pauses the scene, or continues it.
  void pause(bool on = true) { check(pp_session_pause(handle(), on ? 1 : 0)); }
  /// Restarts the scene with the next tick.
  void reset() { check(pp_session_reset(handle())); }
  /// Parameters of the scene, which setParameter() changes.
  std::vector<pp_parameter> parameters() const {
    std::uint64_t count = 0;
    check(pp_session_parameter_count(handle(), &count));
    std::vector<pp_parameter> all(count);
    for (std::uint64_t i = 0; i < count; ++i) check(pp_session_get_parameter(handle(), i, &all[i]));
    return all;
  }
  /// From the next step on. Throws Error, without effect, for an unknown name or a value out of bounds.
  void setParameter(const std::string& name, double value) {
    check(pp_session_set_parameter(handle(), name.c_str(), value));
  }
  /// State of the scene's motion (pp_session_get_motion()).
  pp_motion motion() const {
    pp_motion motion = pp_default_motion();
    check(pp_session_get_motion(handle(), &motion));
    return motion;
  }

  /// Records the next path, or the next live session, to a session log (pp_session_record()).
  void record(const std::string& file) { check(pp_session_record(handle(), file.c_str())); }

  /// Starts ticks against the wall clock, on a thread of palpate (pp_live_start()).
  void startLive(const pp_live_options& options) { check(pp_live_start(handle(), &options)); }
  /// Ticks since the last call, at most `most` rows: one row for each hand in each tick. The other arrays, unless null,
  /// get as many rows: torques of tools, and ages of the contacts (pp_live_rows).
  std::vector<pp_tick> readTicks(std::size_t most = 4096, std::vector<std::array<double, 3>>* torques_mNm = nullptr,
                                 std::vector<double>* ages_s = nullptr) {
    std::vector<pp_tick> ticks(most);
    if (torques_mNm) torques_mNm->resize(most);
    if (ages_s) ages_s->resize(most);
    pp_live_rows rows = pp_default_live_rows();
    rows.capacity = most;
    rows.ticks = ticks.data();
    rows.torques_mNm = torques_mNm && most > 0 ? torques_mNm->front().data() : nullptr;
    rows.ages_s = ages_s ? ages_s->data() : nullptr;
    std::uint64_t count = 0;
    told(pp_live_read_rows(handle(), &rows, &count));
    ticks.resize(count);
    if (torques_mNm) torques_mNm->resize(count);
    if (ages_s) ages_s->resize(count);
    return ticks;
  }
  /// State of the present or last live session (pp_live_get_state()).
  pp_live_state liveState() const {
    pp_live_state state = pp_default_live_state();
    check(pp_live_get_state(handle(), &state));
    return state;
  }
  /// Switches the force off, or on again with a ramp. May be called from any thread.
  void setForces(bool on) { check(pp_live_set_forces(handle(), on ? 1 : 0)); }
  /// Stops after the tick in progress; ticks not read yet can still be read.
  void stopLive() { check(pp_live_stop(handle())); }

 private:
  struct Listener {
    std::function<void(const pp_contact_event&)> function;
    std::exception_ptr raised;
    static void hear(void* user, const pp_contact_event* event) {
      auto& self = *static_cast<Listener*>(user);
      try {
        if (!self.raised) self.function(*event);
      } catch (...) {
        self.raised = std::current_exception();
      }
    }
  };
  // Checks a call that may deliver events: rethrows what the listener threw.
  void told(pp_status status) {
    if (listener_ && listener_->raised) std::rethrow_exception(std::exchange(listener_->raised, nullptr));
    check(status);
  }

  static pp_session made(const Cloud& cloud, const pp_session_options& options) {
    return detail::written<pp_session>(pp_session_open, cloud.handle(), &options);
  }
  std::uint64_t ticksOf(const pp_path& path) const {
    return detail::written<std::uint64_t>(pp_path_ticks, handle(), &path);
  }

  std::unique_ptr<Listener> listener_;
};

}  // namespace pp

#endif

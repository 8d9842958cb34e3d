// The C interface: sessions, touched by path or tick by tick, sculpted, drawn, meshed and live.
#include "engine/core/counted.hpp"
#include "haptics/library/held_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/tool_shape.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/mesh/mesh.hpp"
#include "haptics/library/options.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

/// Output of a path: the rows of all hands in a tick, tick after tick.
struct TickRoom {
  pp_tick* ticks;
  std::uint64_t capacity;
  std::uint64_t* count;
  double* torques_mNm = nullptr;  ///< 3 for each row; null: not wanted
};

void runInto(const TickRoom& room, OpenSession& session, const std::vector<Path>& paths,
             const std::optional<BrushConfig>& brush) {
  if (paths.size() != session.hands())
    throw UsageError("paths: {} were given to a session of {}; give one for each hand", paths.size(),
                     counted(session.hands(), "hand"));
  session.takeLawFault();
  std::uint64_t ticks = 0;
  for (const Path& path : paths) ticks = std::max(ticks, ticksOf(path, session.config().rate_Hz));
  const std::size_t hands = paths.size();
  if (ticks * hands > room.capacity)
    throw UsageError("capacity: the path takes {}, but there is room for {}", counted(ticks, "tick"),
                     room.capacity / hands);
  required(room.ticks, "ticks");
  required(room.count, "count");
  const ServoResult result = session.run(paths, brush);
  const std::size_t done = result.trace().rows.size();
  std::size_t faults = 0;
  for (std::size_t i = 0; i < done * hands; ++i) {
    const TraceRow& row = result.hands[i % hands].trace.rows[i / hands];
    room.ticks[i] = tickOf(row);
    putRow(row.torque_mNm, room.torques_mNm, i);
    faults += row.valid ? 0 : 1;
  }
  *room.count = done * hands;
  for (std::size_t i = 0; i < done * hands; ++i) session.events().felt(i % hands, room.ticks[i]);
  session.events().endAll();
  if (const auto fault = session.takeLawFault()) throw Error("{}", *fault);
  if (done < ticks && isStopWanted()) throw Stopped("stopped after {} of {} ticks", done, ticks);
  if (faults > 0) throw GpuError("{} of {} ticks had no valid answer; their force was zero", faults, done * hands);
}

/// Rows of a call that fails are zero, not those of the call before.
void clearRows(pp_tick* ticks, std::uint64_t capacity, double* torques_mNm = nullptr) {
  if (ticks) std::fill_n(ticks, capacity, pp_tick{});
  if (torques_mNm) std::fill_n(torques_mNm, 3 * capacity, 0.0);
}

std::vector<Path> onePath(const OpenSession& session, const pp_path* path) {
  std::vector<Path> paths;
  paths.push_back(pathFrom(path, session.config().rate_Hz));
  return paths;
}

std::optional<BrushConfig> brushOr(const pp_brush* brush) {
  if (!brush) return std::nullopt;
  return brushFrom(optionsFrom(brush, "brush"));
}

Pose poseFrom(const pp_pose& pose, const double* orientation) {
  Pose asked{.time_s = pose.t_s, .hip = {pose.hip[0], pose.hip[1], pose.hip[2]}, .sculpts = pose.no_edit == 0};
  if (orientation) asked.turn = {orientation[0], orientation[1], orientation[2], orientation[3]};
  if (!isFinite(asked.hip) || !std::isfinite(asked.time_s)) throw UsageError("pose: its numbers are not all finite");
  if (!isTurn(asked.turn))
    throw UsageError("orientations: {}, {}, {}, {} is not a unit quaternion", orientation[0], orientation[1],
                     orientation[2], orientation[3]);
  return asked;
}

}  // namespace

pp_status pp_session_open(pp_cloud cloud, const pp_session_options* options, pp_session* session) {
  clear(session);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    openSession(options, session, [&] { return Subject{.model = found->source, .cloud = &found->cloud}; });
  });
}

pp_status pp_session_close(pp_session session) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    if (!found->claims().home().isThis()) return handles().abandon(HandleKind::session, session.id);
    const Claims::Held held(found->claims(), Claim::all);
    const bool isDelivered = found->end();  // another thread may hold it a little longer
    handles().remove(HandleKind::session, session.id);
    if (!isDelivered)
      throw NetworkError(
          "the server has not confirmed all strokes of this hand, which may be lost; the session is closed");
  });
}

pp_status pp_session_get_info(pp_session session, pp_session_info* info) {
  clear(info);
  return looking(session, [&](OpenSession& open) { giveInfo(info, open.info(), "info"); });
}

pp_status pp_path_ticks(pp_session session, const pp_path* path, uint64_t* count) {
  clear(count);
  return with(session, Claim::all, [&](OpenSession& open) {
    const double rate_Hz = open.config().rate_Hz;
    required(count, "count") = ticksOf(pathFrom(path, rate_Hz), rate_Hz);
  });
}

pp_status pp_session_touch(pp_session session, const pp_path* path, pp_tick* ticks, uint64_t capacity,
                           uint64_t* count) {
  clear(count);
  clearRows(ticks, capacity);
  return lasting(session, [&](OpenSession& open) {
    runInto({ticks, capacity, count}, open, onePath(open, path), std::nullopt);
  });
}

pp_status pp_session_stroke(pp_session session, const pp_path* path, const pp_brush* brush, pp_tick* ticks,
                            uint64_t capacity, uint64_t* count) {
  clear(count);
  clearRows(ticks, capacity);
  return lasting(session, [&](OpenSession& open) {
    runInto({ticks, capacity, count}, open, onePath(open, path), brushFrom(optionsFrom(brush, "brush")));
  });
}

pp_status pp_session_touch_hands(pp_session session, const pp_path* const* paths, uint32_t hands, const pp_brush* brush,
                                 pp_tick* ticks, double* torques_mNm, uint64_t capacity, uint64_t* count) {
  clear(count);
  clearRows(ticks, capacity, torques_mNm);
  return lasting(session, [&](OpenSession& open) {
    if (hands > PP_MAX_HANDS) throw UsageError("hands: {} exceed the maximum of {}", hands, PP_MAX_HANDS);
    if (hands > 0) required(paths, "paths");
    std::vector<Path> all;
    for (std::uint32_t i = 0; i < hands; ++i) all.push_back(pathFrom(paths[i], open.config().rate_Hz));
    runInto({ticks, capacity, count, torques_mNm}, open, all, brushOr(brush));
  });
}

pp_status pp_touch(pp_session session, const pp_pose* pose, pp_contact* contact) {
  return pp_touch_hands(session, pose, nullptr, 1, contact, nullptr);
}

pp_status pp_touch_hands(pp_session session, const pp_pose* poses, const double* orientations, uint32_t hands,
                         pp_contact* contacts, double* torques_mNm) {
  for (std::size_t i = 0; i < std::min<std::size_t>(hands, PP_MAX_HANDS); ++i) {
    if (contacts) clear(contacts + i);
    for (std::size_t k = 0; torques_mNm && k < 3; ++k) torques_mNm[3 * i + k] = 0;
  }
  return with(session, Claim::touch, [&](OpenSession& open) {
    if (hands != open.hands())
      throw UsageError("hands: {} poses were given to a session of {}", hands, counted(open.hands(), "hand"));
    required(poses, "pose");
    required(contacts, "contact");
    std::array<Pose, PP_MAX_HANDS> asked;
    for (std::size_t i = 0; i < hands; ++i) {
      asked[i] = poseFrom(poses[i], orientations ? orientations + 4 * i : nullptr);
      asked[i].time_s = asked[0].time_s;
    }
    open.touch({asked.data(), hands}, {contacts, hands}, torques_mNm);
    if (const auto fault = open.takeLawFault()) {
      std::for_each_n(contacts, hands, [](pp_contact& contact) { contact.valid = 0; });
      throw Error("{}", *fault);
    }
  });
}

pp_status pp_touch_lift(pp_session session) {
  return with(session, Claim::touch, [](OpenSession& open) { open.lift(); });
}

pp_status pp_session_on_contact(pp_session session, pp_contact_function function, void* user) {
  return with(session, Claim::all, [&](OpenSession& open) {
    if (open.isLive()) throw StateError("the session is live; stop it first");
    open.events().listen(function, user);
  });
}

pp_status pp_session_set_brush(pp_session session, const pp_brush* brush) {
  return commanding(session, [&](OpenSession& open) { open.setBrush(brushOr(brush)); });
}

pp_status pp_session_set_contact(pp_session session, const pp_contact_options* contact) {
  return commanding(session, [&](OpenSession& open) {
    const pp_contact_options given = optionsFrom(&required(contact, "contact"), "contact");
    open.setContact(surfaceFrom(given), forceFrom(given));
  });
}

pp_status pp_session_undo(pp_session session, uint64_t strokes, uint64_t* done) {
  clear(done);
  return commanding(session, [&](OpenSession& open) {
    const std::uint64_t undone = open.undo(strokes);
    if (done) *done = undone;
    open.requireDelivered("this undo");
  });
}

pp_status pp_session_cancel_stroke(pp_session session, uint32_t* cancelled) {
  clear(cancelled);
  return commanding(session, [&](OpenSession& open) {
    const bool isCancelled = open.cancelStroke();
    if (cancelled) *cancelled = isCancelled;
    open.requireDelivered("this cancelled stroke");
  });
}

pp_status pp_session_redo(pp_session session, uint64_t strokes, uint64_t* done) {
  clear(done);
  return commanding(session, [&](OpenSession& open) {
    const std::uint64_t redone = open.redo(strokes);
    if (done) *done = redone;
    open.requireDelivered("this redo");
  });
}

pp_status pp_session_set_mask(pp_session session, pp_mask which, const uint8_t* mask, uint64_t points) {
  return commanding(session, [&](OpenSession& open) {
    if (points > 0) required(mask, "mask");
    if (which == PP_MASK_LOCK_WEIGHTS) return open.setLockWeights({mask, points});
    open.setMask(roleFrom(which), {mask, points});
  });
}

pp_status pp_session_remove_points(pp_session session, const uint8_t* mask, uint64_t points) {
  return commanding(session, [&](OpenSession& open) {
    if (points > 0) required(mask, "mask");
    open.changePoints({mask, points}, RemovePoints());
  });
}

pp_status pp_session_move_points(pp_session session, const uint8_t* mask, uint64_t points, const double* rotation,
                                 double scale, const double* offset) {
  return commanding(session, [&](OpenSession& open) {
    if (points > 0) required(mask, "mask");
    MovePoints move{.scale = scale};
    if (rotation) move.rotation = {rotation[0], rotation[1], rotation[2], rotation[3]};
    if (offset) move.offset = {offset[0], offset[1], offset[2]};
    open.changePoints({mask, points}, move);
  });
}

pp_status pp_session_mask(pp_session session, pp_mask which, uint8_t* mask, uint64_t points) {
  return commanding(session, [&](OpenSession& open) {
    if (points > 0) required(mask, "mask");
    if (which == PP_MASK_LOCK_WEIGHTS) return open.copyLockWeights({mask, points});
    open.copyMask(roleFrom(which), {mask, points});
  });
}

pp_status pp_session_soften_lock(pp_session session, double radius_mm) {
  return commanding(session, [&](OpenSession& open) { open.softenLock(radius_mm); });
}

pp_status pp_session_open_layer(pp_session session, const char* name) {
  return commanding(
      session, [&](OpenSession& open) { open.openLayer(name ? std::optional<std::string_view>(name) : std::nullopt); });
}

pp_status pp_session_slide_layer(pp_session session, const char* name, double strength, uint32_t continues) {
  return commanding(session, [&](OpenSession& open) {
    if (!(strength >= kMinLayerStrength && strength <= kMaxLayerStrength))
      throw UsageError("strength: {} is not between {} and {}", strength, kMinLayerStrength, kMaxLayerStrength);
    open.setLayer(&required(name, "name"), continues != 0, [&](StrokeLayer& layer) { layer.strength = strength; });
  });
}

pp_status pp_session_hide_layer(pp_session session, const char* name, uint32_t hidden) {
  return commanding(session, [&](OpenSession& open) {
    open.setLayer(&required(name, "name"), false, [&](StrokeLayer& layer) { layer.isHidden = hidden != 0; });
  });
}

pp_status pp_session_merge_layer(pp_session session, const char* name) {
  return commanding(session, [&](OpenSession& open) {
    open.setLayer(&required(name, "name"), false, [](StrokeLayer& layer) { layer.isMerged = true; });
  });
}

pp_status pp_session_layer(pp_session session, const char* name, double* strength, uint32_t* hidden, uint64_t* points) {
  clear(strength), clear(hidden), clear(points);
  return commanding(session, [&](OpenSession& open) {
    const std::uint32_t number = open.layerNamed(&required(name, "name"));
    const StrokeLayers& layers = open.layers();
    if (strength) *strength = layers[number].strength;
    if (hidden) *hidden = layers[number].isHidden;
    if (points) *points = layers.pointsOf(number);
  });
}

pp_status pp_session_apply_edits(pp_session session) {
  return looking(session, [](OpenSession& open) {
    open.takeIn();
    open.checkShared();
  });
}

pp_status pp_session_cloud(pp_session session, pp_cloud* cloud) {
  clear(cloud);
  return commanding(session, [&](OpenSession& open) {
    required(cloud, "cloud") = opened<pp_cloud>(std::make_shared<CloudObject>(open.points()));
  });
}

pp_status pp_session_render(pp_session session, const pp_picture_options* options, uint8_t* rgba, uint64_t bytes) {
  return lookingLong(session, [&](OpenSession& open) {
    const PictureRequest request = pictureFrom(optionsFrom(options, "options"));
    const std::uint64_t needed = std::uint64_t{4} * request.width * request.height;
    required(rgba, "rgba");
    if (bytes < needed) throw UsageError("bytes: the picture requires {}, but there is room for {}", needed, bytes);
    const Image image = open.draw(request);
    std::memcpy(rgba, image.rgba.data(), needed);
  });
}

pp_status pp_image_write(const char* file, const uint8_t* rgba, uint32_t width, uint32_t height) {
  return guarded([&] {
    const std::string name = &required(file, "file");
    required(rgba, "rgba");
    constexpr std::uint32_t kMax = 1 << 16;
    if (width == 0 || height == 0 || width > kMax || height > kMax)
      throw UsageError("size: {} x {} pixels are not between 1 and {} each way", width, height, kMax);
    Image image{.width = width, .height = height, .rgba = {}};
    image.rgba.resize(std::size_t{width} * height);
    std::memcpy(image.rgba.data(), rgba, 4 * image.rgba.size());
    writePicture(name, image);
  });
}

pp_status pp_session_mesh(pp_session session, const pp_mesh_options* options, pp_mesh* mesh) {
  clear(mesh);
  return lookingLong(session, [&](OpenSession& open) {
    required(mesh, "mesh");
    const pp_mesh_options given = optionsFrom(options, "options");
    auto made = std::make_shared<MeshObject>(MeshObject{.mesh = open.mesh(given)});
    const Mesh& result = made->mesh;
    if (result.triangles.empty())
      throw Error("the points show no surface: they are farther apart than the support radius; try a larger radius_mm");
    made->cell = boundsOf(result.vertices).longestSide() / given.resolution;
    made->view.vertices = viewOf(result.vertices);
    made->view.count = result.triangles.size();
    made->view.triangles = result.triangles.front().data();
    made->view.closed = examine(result).closed();
    *mesh = opened<pp_mesh>(std::move(made));
  });
}

pp_status pp_mesh_view(pp_mesh mesh, pp_triangles* triangles) {
  clear(triangles);
  return guarded([&] { required(triangles, "triangles") = objectOf<MeshObject>(mesh.id)->view; });
}

pp_status pp_mesh_write(pp_mesh mesh, const char* file, const pp_write_options* options) {
  return guarded([&] {
    const auto found = objectOf<MeshObject>(mesh.id);
    const std::string name = &required(file, "file");
    const pp_write_options given = optionsFrom(options, "options");
    std::filesystem::path kept;
    writeMesh(name, found->mesh, found->cell, given.ascii != 0, given.backup ? &kept : nullptr);
  });
}

pp_status pp_mesh_close(pp_mesh mesh) {
  return guarded([&] { handles().remove(HandleKind::mesh, mesh.id); });
}

pp_status pp_live_start(pp_session session, const pp_live_options* options) {
  return lasting(session, [&](OpenSession& open) { open.startLive(optionsFrom(options, "options")); });
}

pp_status pp_live_read_rows(pp_session session, const pp_live_rows* rows, uint64_t* count) {
  clear(count);
  return looking(session, [&](OpenSession& open) {
    required(count, "count");
    const pp_live_rows given = optionsFrom(&required(rows, "rows"), "rows");
    if (given.capacity > 0) required(given.ticks, "ticks");
    if (!open.live()) throw StateError("the session was never live; start it first");
    open.takeIn();
    *count = open.live()->take(given, open.events());
    open.reportLaw();
    open.checkShared();
  });
}

pp_status pp_live_read_ticks(pp_session session, pp_tick* ticks, uint64_t capacity, uint64_t* count) {
  pp_live_rows rows = usual<pp_live_rows>();
  rows.capacity = capacity;
  rows.ticks = ticks;
  return pp_live_read_rows(session, &rows, count);
}

pp_status pp_live_get_state(pp_session session, pp_live_state* state) {
  clear(state);
  return looking(session, [&](OpenSession& open) {
    pp_live_state now = usual<pp_live_state>();
    if (LiveHands* const live = open.live()) {
      now.running = live->isRunning();
      now.ticks = live->ticks();
      now.missed = live->missed();
    }
    giveInfo(state, now, "state");
  });
}

pp_status pp_live_set_forces(pp_session session, uint32_t on) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    found->claims().home().require();
    found->setForces(on != 0);
  });
}

pp_status pp_live_stop(pp_session session) {
  return commanding(session, [](OpenSession& open) { open.stopLive(); });
}

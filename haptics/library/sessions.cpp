// The C interface: sessions, touched by a path or tick by tick, sculpted, seen, meshed and live.
#include "haptics/library/open_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/io/cloud_formats.hpp"
#include "engine/mesh/mesh.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/options.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

/// A session, and the claim of this thread on it while a call lasts.
template <class Do>
pp_status with(pp_session session, Claim claim, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), claim);
    act(*found);
  });
}

template <class Do>
pp_status looking(pp_session session, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), found->looking());
    act(*found);
  });
}

struct TickRoom {
  pp_tick* ticks;
  std::uint64_t capacity;
  std::uint64_t* count;
};

void runInto(const TickRoom& room, OpenSession& session, const pp_path* given, const std::optional<BrushConfig>& brush) {
  Path path = pathFrom(given, session.config().rate_Hz);
  const std::uint64_t wanted = ticksOf(path, session.config().rate_Hz);
  if (wanted > room.capacity)
    throw UsageError("capacity: the path takes {} ticks, and there is room for {}", wanted, room.capacity);
  required(room.ticks, "ticks");
  required(room.count, "count") = 0;
  const ServoResult result = session.run(std::move(path), brush);
  const auto& rows = result.trace().rows;
  std::ranges::transform(rows, room.ticks, tickOf);
  *room.count = rows.size();
  const auto faults = std::ranges::count_if(rows, [](const TraceRow& row) { return !row.valid; });
  if (faults > 0) throw GpuError("{} of {} ticks had no valid answer; their force was zero", faults, rows.size());
}

}  // namespace

pp_status pp_session_open(pp_cloud cloud, const pp_session_options* options, pp_session* session) {
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    required(session, "session");
    const pp_session_options given = optionsFrom(options, pp_default_session_options(), "options");
    *session = opened<pp_session>(std::make_shared<OpenSession>(found->cloud, given));
  });
}

pp_status pp_session_close(pp_session session) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), Claim::all);
    handles().remove(HandleKind::session, session.id);
  });
}

pp_status pp_session_get_info(pp_session session, pp_session_info* info) {
  return looking(session, [&](OpenSession& open) { giveInfo(info, open.info(), "info"); });
}

pp_status pp_path_ticks(pp_session session, const pp_path* path, uint64_t* count) {
  return with(session, Claim::all, [&](OpenSession& open) {
    const double rate_Hz = open.config().rate_Hz;
    required(count, "count") = ticksOf(pathFrom(path, rate_Hz), rate_Hz);
  });
}

pp_status pp_session_touch(pp_session session, const pp_path* path, pp_tick* ticks, uint64_t capacity, uint64_t* count) {
  return with(session, Claim::all,
              [&](OpenSession& open) { runInto({ticks, capacity, count}, open, path, std::nullopt); });
}

pp_status pp_session_stroke(pp_session session, const pp_path* path, const pp_brush* brush, pp_tick* ticks,
                            uint64_t capacity, uint64_t* count) {
  return with(session, Claim::all, [&](OpenSession& open) {
    runInto({ticks, capacity, count}, open, path, brushFrom(optionsFrom(brush, pp_default_brush(), "brush")));
  });
}

pp_status pp_touch(pp_session session, const pp_pose* pose, pp_contact* contact) {
  return with(session, Claim::touch, [&](OpenSession& open) {
    const pp_pose& given = required(pose, "pose");
    required(contact, "contact");
    const Pose asked{.time_s = given.t_s, .hip = {given.hip[0], given.hip[1], given.hip[2]}, .sculpts = given.feels == 0};
    if (!isFinite(asked.hip) || !std::isfinite(asked.time_s)) throw UsageError("pose: is not finite");
    const AskedTick tick = open.touch(asked);
    *contact = contactOf(tick.contact, asked.hip, tick.force_N, open.model().scale.mm_per_unit);
  });
}

pp_status pp_touch_lift(pp_session session) {
  return with(session, Claim::touch, [](OpenSession& open) { open.lift(); });
}

pp_status pp_session_set_brush(pp_session session, const pp_brush* brush) {
  return with(session, Claim::all, [&](OpenSession& open) {
    std::optional<BrushConfig> wanted;
    if (brush) wanted = brushFrom(optionsFrom(brush, pp_default_brush(), "brush"));
    open.setBrush(wanted);
  });
}

pp_status pp_session_set_feel(pp_session session, const pp_feel* feel) {
  return with(session, Claim::all, [&](OpenSession& open) {
    const pp_feel given = optionsFrom(&required(feel, "feel"), pp_default_feel(), "feel");
    open.setFeel(surfaceFrom(given), forceFrom(given));
  });
}

pp_status pp_session_undo(pp_session session, uint64_t strokes, uint64_t* done) {
  return with(session, Claim::all, [&](OpenSession& open) {
    const std::uint64_t undone = open.undo(strokes);
    if (done) *done = undone;
  });
}

pp_status pp_session_redo(pp_session session, uint64_t strokes, uint64_t* done) {
  return with(session, Claim::all, [&](OpenSession& open) {
    const std::uint64_t redone = open.redo(strokes);
    if (done) *done = redone;
  });
}

pp_status pp_session_follow(pp_session session) {
  return looking(session, [](OpenSession& open) { open.takeIn(); });
}

pp_status pp_session_cloud(pp_session session, pp_cloud* cloud) {
  return with(session, Claim::all, [&](OpenSession& open) {
    required(cloud, "cloud") = opened<pp_cloud>(std::make_shared<CloudObject>(open.points()));
  });
}

pp_status pp_session_render(pp_session session, const pp_picture_options* options, uint8_t* rgba, uint64_t bytes) {
  return looking(session, [&](OpenSession& open) {
    const PictureRequest request = pictureFrom(optionsFrom(options, pp_default_picture_options(), "options"));
    const std::uint64_t needed = std::uint64_t{4} * request.width * request.height;
    required(rgba, "rgba");
    if (bytes < needed) throw UsageError("bytes: the picture takes {}, and there is room for {}", needed, bytes);
    const Image image = open.draw(request);
    std::memcpy(rgba, image.rgba.data(), needed);
  });
}

pp_status pp_image_write(const char* file, const uint8_t* rgba, uint32_t width, uint32_t height) {
  return guarded([&] {
    const std::string name = &required(file, "file");
    required(rgba, "rgba");
    constexpr std::uint32_t kMost = 1 << 16;
    if (width == 0 || height == 0 || width > kMost || height > kMost)
      throw UsageError("size: {} x {} pixels are not between 1 and {} each way", width, height, kMost);
    Image image{.width = width, .height = height, .rgba = {}};
    image.rgba.resize(std::size_t{width} * height);
    std::memcpy(image.rgba.data(), rgba, 4 * image.rgba.size());
    writePicture(name, image);
  });
}

pp_status pp_session_mesh(pp_session session, const pp_mesh_options* options, pp_mesh* mesh) {
  return looking(session, [&](OpenSession& open) {
    required(mesh, "mesh");
    const pp_mesh_options given = optionsFrom(options, pp_default_mesh_options(), "options");
    auto made = std::make_shared<MeshObject>(MeshObject{.mesh = open.mesh(given)});
    const Mesh& result = made->mesh;
    if (result.triangles.empty())
      throw Error("the points show no surface: they are farther apart than the support radius; try a larger radius_mm");
    made->cell = boundsOf(result.vertices).longestSide() / given.lattice;
    made->view.vertices = viewOf(result.vertices);
    made->view.count = result.triangles.size();
    made->view.triangles = result.triangles.front().data();
    made->view.closed = examine(result).closed();
    *mesh = opened<pp_mesh>(std::move(made));
  });
}

pp_status pp_mesh_view(pp_mesh mesh, pp_triangles* triangles) {
  return guarded([&] { required(triangles, "triangles") = objectOf<MeshObject>(mesh.id)->view; });
}

pp_status pp_mesh_write(pp_mesh mesh, const char* file, const pp_write_options* options) {
  return guarded([&] {
    const auto found = objectOf<MeshObject>(mesh.id);
    const std::string name = &required(file, "file");
    const pp_write_options given = optionsFrom(options, pp_default_write_options(), "options");
    cloudFormats().toWrite(name);  // refuses an ending that nobody knows
    std::filesystem::path kept;
    writeMesh(name, found->mesh, found->cell, given.ascii != 0, given.keep ? &kept : nullptr);
  });
}

pp_status pp_mesh_close(pp_mesh mesh) {
  return guarded([&] { handles().remove(HandleKind::mesh, mesh.id); });
}

pp_status pp_live_start(pp_session session, const pp_live_options* options) {
  return with(session, Claim::all, [&](OpenSession& open) {
    open.startLive(optionsFrom(options, pp_default_live_options(), "options"));
  });
}

pp_status pp_live_take(pp_session session, pp_tick* ticks, uint64_t capacity, uint64_t* count) {
  return looking(session, [&](OpenSession& open) {
    required(count, "count") = 0;
    if (capacity > 0) required(ticks, "ticks");
    if (!open.live()) throw StateError("the session was never live; pp_live_start() comes first");
    open.takeIn();
    *count = open.live()->take(ticks, capacity);
  });
}

pp_status pp_live_get_state(pp_session session, pp_live_state* state) {
  return looking(session, [&](OpenSession& open) {
    pp_live_state now = pp_default_live_state();
    if (LiveHand* const live = open.live()) {
      now.running = live->isRunning();
      now.ticks = live->ticks();
      now.missed = live->missed();
    }
    giveInfo(state, now, "state");
  });
}

pp_status pp_live_set_forces(pp_session session, uint32_t on) {
  return guarded([&] { objectOf<OpenSession>(session.id)->setForces(on != 0); });
}

pp_status pp_live_stop(pp_session session) {
  return with(session, Claim::all, [](OpenSession& open) {
    if (open.live()) open.live()->stop();
    open.takeIn();
  });
}

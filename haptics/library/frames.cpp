// The C interface: clouds whose frames the program provides, and recorded depth cameras.

#include "engine/io/rgbd_folder.hpp"
#include "haptics/library/held_session.hpp"
#include "haptics/library/options.hpp"

using namespace palpate;
using namespace palpate::library;

pp_status pp_session_open_frames(pp_cloud cloud, const pp_frames_options* frames, const pp_session_options* options,
                                 pp_session* session) {
  clear(session);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    openSession(options, session, [&] {
      Subject subject;
      subject.model = found->source;
      subject.cloud = &found->cloud;
      subject.frames = optionsFrom(frames, "frames");
      return subject;
    });
  });
}

pp_status pp_session_open_stream(const char* folder, const pp_stream_options* stream, const pp_session_options* options,
                                 pp_session* session) {
  clear(session);
  return guarded([&] {
    const std::string name = &required(folder, "folder");
    if (!isRgbdFolder(name)) throw FileError(name, fmt::format("is not {}", rgbdFoldersRead()));
    const pp_stream_options given = optionsFrom(stream, "stream");
    openSession(options, session, [&] {
      Subject subject;
      subject.model.file = name;
      subject.model.stream = StreamConfig{.speed = given.speed,
                                          .loop = given.loop != 0,
                                          .fuse = given.fuse != 0,
                                          .depthScale = given.depth_scale,
                                          .intrinsics = textOf(given.intrinsics)};
      return subject;
    });
  });
}

pp_status pp_session_push_frame(pp_session session, const pp_frame_arrays* frame) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    found->claims().home().require();
    const pp_frame_arrays given = optionsFrom(&required(frame, "frame"), "frame");
    if (given.count == 0) throw UsageError("count: is 0; a frame requires at least one point");
    if (!given.normals.data) throw UsageError("normals: are missing; each frame requires them");
    const CloudArrays arrays{.count = given.count,
                             .positions = rowsFrom(given.positions, false, "positions"),
                             .normals = rowsFrom(given.normals, false, "normals"),
                             .colors = {}};
    found->pushFrame(cloudFrom(arrays), vectorsFrom(given.velocities, given.count, "velocities"), given.t_s);
  });
}

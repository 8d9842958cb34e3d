// The C interface: clouds whose frames a program brings, and the points of what moves.
#include "haptics/library/held_session.hpp"
#include "haptics/library/options.hpp"

using namespace palpate;
using namespace palpate::library;

pp_status pp_session_open_frames(pp_cloud cloud, const pp_frames_options* frames, const pp_session_options* options,
                                 pp_session* session) {
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    required(session, "session");
    Subject subject;
    subject.model = found->source;
    subject.cloud = &found->cloud;
    subject.frames = optionsFrom(frames, "frames");
    *session = opened<pp_session>(std::make_shared<OpenSession>(subject, optionsFrom(options, "options")));
  });
}

pp_status pp_session_push_frame(pp_session session, const pp_frame_arrays* frame) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const pp_frame_arrays given = optionsFrom(&required(frame, "frame"), "frame");
    if (given.count == 0) throw UsageError("count: a frame without points has no surface");
    if (!given.normals.data) throw UsageError("normals: a frame brings its own");
    const CloudArrays arrays{.count = given.count,
                             .positions = rowsFrom(given.positions, false, "positions"),
                             .normals = rowsFrom(given.normals, false, "normals"),
                             .colors = {}};
    found->pushFrame(cloudOf(arrays, nullptr), vectorsFrom(given.velocities, given.count, "velocities"), given.t_s);
  });
}

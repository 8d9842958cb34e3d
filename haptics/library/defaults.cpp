#include "haptics/library/defaults.hpp"

#include <algorithm>
#include <cstring>

#include "engine/mesh/mesh_plan.hpp"
#include "haptics/library/linked_fields.hpp"
#include "haptics/session/picture_request.hpp"
#include "haptics/sharing/session_joiner.hpp"

namespace palpate::library {

namespace {

/// Writes the defaults of the fields that the program knows; fields that this library does not know are zero.
template <class Options>
void init(Options* to, std::uint32_t size) {
  if (!to) return;
  Options options = usual<Options>();
  options.size = size;
  std::memset(to, 0, size);
  std::memcpy(to, &options, std::min<std::size_t>(size, sizeof options));
}

template <class Options>
Options sized() {
  Options options{};
  options.size = sizeof(Options);
  return options;
}

}  // namespace

template <>
pp_contact_options usual() {
  auto contact = sized<pp_contact_options>();
  toFields(kForceFields, contact, ForceOptions{});
  toFields(kSurfaceFields, contact, SurfaceConfig{});
  return contact;
}

template <>
pp_tool usual() {
  auto options = sized<pp_tool>();
  toFields(kToolFields, options, ToolConfig{});
  return options;
}

template <>
pp_session_options usual() {
  auto options = sized<pp_session_options>();
  toFields(kSessionFields, options, SessionConfig{});
  toFields(kUndoFields, options, UndoConfig{});
  options.hands = 1;
  return options;
}

template <>
pp_path usual() {
  auto path = sized<pp_path>();
  path.type = PP_FLOAT64;
  path.columns = 3;
  return path;
}

template <>
pp_brush usual() {
  auto brush = sized<pp_brush>();
  toFields(kBrushFields, brush, BrushConfig{});
  return brush;
}

template <>
pp_picture_options usual() {
  const PictureRequest usual;
  auto options = sized<pp_picture_options>();
  options.width = usual.width;
  options.height = usual.height;
  options.samples = usual.samples;
  options.fov_deg = 45;
  return options;
}

template <>
pp_mesh_options usual() {
  auto options = sized<pp_mesh_options>();
  options.resolution = MeshOptions{}.resolution;
  return options;
}

template <>
pp_stream_options usual() {
  auto options = sized<pp_stream_options>();
  toFields(kStreamFields, options, StreamConfig{});
  return options;
}

template <>
pp_join_options usual() {
  auto options = sized<pp_join_options>();
  options.timeout_s = Joining{}.timeout_s;
  return options;
}

}  // namespace palpate::library

// A program of any version passes the size of the struct that it knows.
#define PALPATE_INIT(name) \
  void pp_init_##name(pp_##name* options, uint32_t size) { palpate::library::init(options, size); }

PALPATE_INIT(cloud_arrays)
PALPATE_INIT(read_options)
PALPATE_INIT(write_options)
PALPATE_INIT(prepare_options)
PALPATE_INIT(contact_options)
PALPATE_INIT(tool)
PALPATE_INIT(vulkan_device)
PALPATE_INIT(session_options)
PALPATE_INIT(session_info)
PALPATE_INIT(path)
PALPATE_INIT(brush)
PALPATE_INIT(picture_options)
PALPATE_INIT(mesh_options)
PALPATE_INIT(live_options)
PALPATE_INIT(live_rows)
PALPATE_INIT(live_state)
PALPATE_INIT(motion)
PALPATE_INIT(matter_options)
PALPATE_INIT(matter_state)
PALPATE_INIT(replay_options)
PALPATE_INIT(frames_options)
PALPATE_INIT(frame_arrays)
PALPATE_INIT(stream_options)
PALPATE_INIT(replay_result)
PALPATE_INIT(network)
PALPATE_INIT(join_options)
PALPATE_INIT(sharing)
PALPATE_INIT(serve_options)
PALPATE_INIT(server_info)
PALPATE_INIT(server_save)

#undef PALPATE_INIT

#include "haptics/library/options.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/core/packed_state.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/linked_fields.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate::library {

namespace {

constexpr const char* kAxes[]{"x", "y", "z"};

std::size_t bytesOf(std::int32_t type) {
  switch (type) {
    case PP_FLOAT32:
      return sizeof(float);
    case PP_FLOAT64:
      return sizeof(double);
    case PP_UINT8:
      return sizeof(std::uint8_t);
    case PP_UINT16:
      return sizeof(std::uint16_t);
    default:
      return 0;
  }
}

DVec3 vectorFrom(const double (&v)[3], std::string_view name) {
  const DVec3 vector(v[0], v[1], v[2]);
  if (!isFinite(vector)) throw UsageError("{}: {}, {}, {} are not finite numbers", name, v[0], v[1], v[2]);
  return vector;
}

double numberAt(const std::byte* row, std::int32_t type, std::size_t column) {
  if (type == PP_FLOAT32) return loadScalar<float>(row + column * sizeof(float));
  return loadScalar<double>(row + column * sizeof(double));
}

void checkPath(const pp_path& path) {
  if (path.type != PP_FLOAT32 && path.type != PP_FLOAT64)
    throw UsageError("path: its type is {}; expected PP_FLOAT32 or PP_FLOAT64", path.type);
  if (path.columns != 3 && path.columns != 4)
    throw UsageError("path: has {} columns; expected 3 (x y z, a row for each tick) or 4 (seconds first)",
                     path.columns);
  if (path.rows == 0 || !path.data) throw UsageError("path: has no rows; it requires at least one pose");
}

}  // namespace

void checkSize(std::uint32_t size, std::size_t known, std::size_t alignment, std::string_view name) {
  if (size >= kMinSize && size <= known && size % alignment == 0) return;
  throw UsageError("{}: its size is {}, and this palpate, {}, knows {} bytes; fill it by its pp_default function", name,
                   size, PALPATE_VERSION, known);
}

void checkThreads(std::uint32_t threads) {
  if (threads > bounds::kMaxThreads)
    throw UsageError("threads: {} is above the maximum, {}; 0: one per core", threads,
                     static_cast<unsigned>(bounds::kMaxThreads));
}

std::string textOf(const char* text) { return text ? text : ""; }

NumberRows rowsFrom(const pp_rows& rows, bool mayBeWhole, std::string_view name) {
  if (!rows.data) return {};
  const bool real = rows.type == PP_FLOAT32 || rows.type == PP_FLOAT64;
  if (!real && !(mayBeWhole && bytesOf(rows.type) > 0))
    throw UsageError("{}: {} is not a valid type here", name, rows.type);
  constexpr ScalarType kTypes[]{ScalarType::f32, ScalarType::f64, ScalarType::u8, ScalarType::u16};
  return {static_cast<const std::byte*>(rows.data), kTypes[rows.type], static_cast<std::ptrdiff_t>(rows.stride)};
}

CloudArrays arraysFrom(const pp_cloud_arrays& arrays) {
  constexpr std::uint64_t kMaxPoints = PackedState::kGone - 1;
  if (arrays.count > kMaxPoints) throw UsageError("count: {} exceeds the maximum of {}", arrays.count, kMaxPoints);
  return {.count = arrays.count,
          .positions = rowsFrom(arrays.positions, false, "positions"),
          .normals = rowsFrom(arrays.normals, false, "normals"),
          .colors = rowsFrom(arrays.colors, true, "colors")};
}

PointCloud cloudFrom(const CloudArrays& arrays) {
  PointCloud cloud = cloudOf(arrays, nullptr);
  if (arrays.normals.data && arrays.count > 0 && !cloud.hasNormals())
    throw UsageError("normals: are zero for more than a tenth of the points");
  return cloud;
}

ToolConfig toolFrom(const pp_tool& given) {
  ToolConfig tool{.kind = chosen(kToolKinds, given.kind, ToolKind::point, "tool.kind")};
  vectorFrom(given.axis, "tool.axis");
  fromFields(kToolFields, given, tool);
  return tool;
}

std::string backendOf(const char* backend, const GpuChoice& choice, bool (*automaticIsGpu)()) {
  const std::string word = backend ? backend : "auto", gpu = choice.gpu ? choice.gpu : "";
  constexpr std::array<std::string_view, 3> kWords{"auto", "vulkan", "cpu"};
  if (std::ranges::find(kWords, word) == kWords.end())
    throw UsageError("backend: {}", unknownName("value", word, kWords));
  const bool namesGpu = choice.lent || (!gpu.empty() && gpu != "cpu");
  if (word == "vulkan" && gpu == "cpu")
    throw UsageError("backend: vulkan conflicts with gpu 'cpu'; leave one of them out");
  if (word == "cpu" && namesGpu)
    throw UsageError("backend: cpu conflicts with {}; leave one of them out",
                     choice.lent ? "the given device" : "gpu '" + gpu + "'");
  return word != "auto" ? word : gpu != "cpu" && (namesGpu || automaticIsGpu()) ? "vulkan" : "cpu";
}

std::vector<Vec3> vectorsFrom(const pp_rows& rows, std::uint64_t count, std::string_view name) {
  const NumberRows given = rowsFrom(rows, false, name);
  std::vector<Vec3> vectors;
  if (!given.data) return vectors;
  vectors.reserve(count);
  const auto stride = given.stride != 0 ? given.stride : static_cast<std::ptrdiff_t>(3 * bytesOf(rows.type));
  const std::byte* row = given.data;
  for (std::uint64_t i = 0; i < count; ++i, row += stride) {
    Vec3 vector(0);
    for (int k = 0; k < 3; ++k) {
      vector[k] = static_cast<float>(numberAt(row, rows.type, static_cast<std::size_t>(k)));
      if (!std::isfinite(vector[k]))
        throw UsageError("{}: row {} of {}, counted from 0: {} is {}; expected a finite number", name, i, count,
                         kAxes[k], vector[k]);
    }
    vectors.push_back(vector);
  }
  return vectors;
}

SurfaceConfig surfaceFrom(const pp_contact_options& contact) {
  SurfaceConfig surface{.kind = chosen(kSurfaceKinds, contact.surface, SurfaceKind::average, "contact.surface")};
  fromFields(kSurfaceFields, contact, surface);
  if (contact.radius_mm != 0) surface.radius_mm = contact.radius_mm;
  return surface;
}

MaskRole roleFrom(pp_mask which) {
  const auto role = static_cast<std::size_t>(which);
  if (role >= kMaskRoles) throw UsageError("mask: {} is not a pp_mask", role);
  return static_cast<MaskRole>(role);
}

ForceOptions forceFrom(const pp_contact_options& contact) {
  ForceOptions force;
  fromFields(kForceFields, contact, force);
  return force;
}

BrushConfig brushFrom(const pp_brush& given) {
  BrushConfig brush{.kind = chosen(kBrushKinds, given.kind, BrushKind::push, "brush.kind")};
  fromFields(kBrushFields, given, brush);
  if (given.symmetry) brush.symmetry = given.symmetry;
  return brush;
}

std::optional<ModelSide> sideFrom(const char* given) {
  std::array<std::pair<std::string_view, std::optional<ModelSide>>, 1 + kModelSides.size()> choices{{{"auto", {}}}};
  std::ranges::copy(kModelSides, choices.begin() + 1);
  return chosen(choices, given, std::optional<ModelSide>(), "side");
}

PictureRequest pictureFrom(const pp_picture_options& options) {
  if (options.samples != 1 && options.samples != 4) throw UsageError("samples: {} is neither 1 nor 4", options.samples);
  static_assert(PP_MAX_PICTURE_SIDE == kMaxSide_px);
  for (const std::uint32_t side : {options.width, options.height})
    if (side < 1 || side > kMaxSide_px) throw UsageError("size: {} pixels is not between 1 and {}", side, kMaxSide_px);
  PictureRequest request{.width = options.width, .height = options.height, .samples = options.samples};
  if (options.has_eye) request.camera.eye = vectorFrom(options.eye, "eye");
  if (options.has_target) request.camera.target = vectorFrom(options.target, "target");
  if (options.has_up) request.camera.up = vectorFrom(options.up, "up");
  request.camera.fov_deg = options.fov_deg;
  if (options.color) request.color.by = options.color;
  request.color.map = chosen(kColorMapChoices, options.color_map, std::optional<ColorMap>(), "color_map");
  if (options.color_range) request.color.range = options.color_range;
  validate(request.color, kPictureColors);
  request.light.material = chosen(kMaterialChoices, options.material, std::optional<Material>(), "material");
  const auto isOn = [](const char* given, const char* name) {
    return chosen(kSwitchChoices, given, std::optional<bool>(), name);
  };
  request.light.occlusion = isOn(options.occlusion, "occlusion");
  request.light.cavity = isOn(options.cavity, "cavity");
  request.light.ground = isOn(options.ground, "ground");
  request.light.eyeDome = isOn(options.eye_dome, "eye_dome");
  request.light.gaussians = chosen(kSplatChoices, options.splats, std::optional<bool>(), "splats");
  request.light.hidesBacks = chosen(kBackChoices, options.backs, std::optional<bool>(), "backs");
  if (!(options.ortho_height >= 0 && std::isfinite(options.ortho_height)))
    throw UsageError("ortho_height: {} is not a length, model units", options.ortho_height);
  enum class Projection { perspective, orthographic, isometric };
  static constexpr std::array<std::pair<std::string_view, Projection>, 3> kProjections{
      {{"perspective", Projection::perspective},
       {"orthographic", Projection::orthographic},
       {"isometric", Projection::isometric}}};
  const Projection projection = chosen(kProjections, options.projection, Projection::perspective, "projection");
  if (projection == Projection::perspective && options.ortho_height > 0)
    throw UsageError("ortho_height: the projection is perspective");
  if (projection != Projection::perspective) request.camera.ortho = options.ortho_height;
  request.camera.side = sideFrom(options.side);
  if (projection == Projection::isometric) request.camera.side = ModelSide::isometric;
  request.transparent = options.transparent != 0;
  if (options.has_background)
    request.background = {options.background[0], options.background[1], options.background[2]};
  return request;
}

MeshOptions meshFrom(const pp_mesh_options& options, const ModelScale& scale) {
  if (options.resolution < 1 || options.resolution > kMaxResolution)
    throw UsageError("resolution: {} is not between 1 and {}", options.resolution, kMaxResolution);
  if (!(options.radius_mm >= 0 && options.radius_mm <= bounds::kLongest_mm))
    throw UsageError("radius_mm: {} is not between 0 and {}", options.radius_mm, bounds::kLongest_mm);
  return {.resolution = options.resolution,
          .surface = chosen(kMeshSurfaces, options.surface, MeshSurface::sphere, "surface"),
          .radius = scale.toUnits(options.radius_mm)};
}

Path pathFrom(const pp_path* given, double rate_Hz) {
  const pp_path path = optionsFrom(&required(given, "path"), "path");
  checkPath(path);
  const auto stride = path.stride != 0 ? path.stride : static_cast<std::int64_t>(path.columns * bytesOf(path.type));
  const auto* row = static_cast<const std::byte*>(path.data);
  std::vector<PathKey> keys;
  keys.reserve(path.rows);
  const std::size_t first = path.columns - 3;
  for (std::uint64_t i = 0; i < path.rows; ++i, row += stride) {
    PathKey key{.t_s = first ? numberAt(row, path.type, 0) : static_cast<double>(i) / rate_Hz};
    for (std::size_t k = 0; k < 3; ++k) key.position[static_cast<int>(k)] = numberAt(row, path.type, first + k);
    const auto refuse = [&](const std::string& why) {
      throw UsageError("path: pose {} of {}, counted from 0: {}", i, path.rows, why);
    };
    const auto requireFinite = [&](double value, const char* column) {
      if (!std::isfinite(value)) refuse(fmt::format("{} is {}; expected a finite number", column, value));
    };
    requireFinite(key.t_s, "the time");
    for (int k = 0; k < 3; ++k) requireFinite(key.position[k], kAxes[k]);
    if (key.t_s < 0) refuse(fmt::format("its time is {} s; times begin at 0", key.t_s));
    if (!keys.empty() && !(keys.back().t_s < key.t_s))
      refuse(fmt::format("its time is {} s, and that of the pose before it {} s; times have to increase", key.t_s,
                         keys.back().t_s));
    keys.push_back(key);
  }
  return Path(std::move(keys));
}

std::uint64_t ticksOf(const Path& path, double rate_Hz) {
  return plannedTicks(rate_Hz, path.duration_s() + 1 / rate_Hz);
}

}  // namespace palpate::library

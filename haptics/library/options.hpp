// Reads and validates the arguments of a program: structs that begin with their size, arrays, paths.
#pragma once

#include <palpate/palpate.h>

#include <cstring>
#include <string>
#include <string_view>

#include "engine/core/attribute_change.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/io/cloud_arrays.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "haptics/library/defaults.hpp"
#include "haptics/path.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/picture_request.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate::library {

/// Throws UsageError for null.
template <class T>
T& required(T* given, std::string_view name) {
  if (!given) throw UsageError("{}: is null", name);
  return *given;
}

constexpr std::size_t kMinSize = 8;  ///< minimum size of any struct that begins with its size

/// Throws UsageError for a size that no version of palpate up to this one can have used: every version's is a multiple
/// of the alignment, so none ends within a number or a pointer. The size is the first field of such a struct.
void checkSize(std::uint32_t size, std::size_t known, std::size_t alignment, std::string_view name);

/// Throws UsageError for more threads than any machine can use.
void checkThreads(std::uint32_t threads);

/// The given fields, as far as the program knows the struct, and defaults for the rest, or for all if it is null.
template <class Options>
Options optionsFrom(const Options* given, std::string_view name) {
  Options options = usual<Options>();
  if (!given) return options;
  checkSize(given->size, sizeof(Options), alignof(Options), name);
  std::memcpy(&options, given, given->size);
  options.size = sizeof(Options);
  if constexpr (requires { options.threads; }) checkThreads(options.threads);
  return options;
}

/// Writes as much of `value` as the program knows of the struct.
template <class Info>
void giveInfo(Info* to, Info value, std::string_view name) {
  checkSize(required(to, name).size, sizeof(Info), alignof(Info), name);
  value.size = to->size;
  std::memcpy(to, &value, to->size);
}

/// Clears an output before anything can fail, so that a caller that ignores the status finds no force, count or handle
/// of an earlier call. Does nothing for null, which the call refuses.
template <class Out>
void clear(Out* to) {
  if constexpr (requires { to->size; }) {
    if (to && to->size >= kMinSize && to->size <= sizeof(Out) && to->size % alignof(Out) == 0)
      giveInfo(to, usual<Out>(), {});
  } else {
    if (to) *to = Out{};
  }
}

inline void putVector(const DVec3& vector, double (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = vector[k];
}
/// Into a row of an array with three numbers each; null: not wanted.
inline void putRow(const DVec3& vector, double* rows, std::size_t row) {
  for (int k = 0; rows && k < 3; ++k) rows[3 * row + static_cast<std::size_t>(k)] = vector[k];
}

/// Cuts the text off if it does not fit.
template <std::size_t kSize>
void putText(std::string_view text, char (&to)[kSize]) {
  const std::size_t length = text.size() < kSize ? text.size() : kSize - 1;
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

/// Empty for null.
std::string textOf(const char* text);

/// Value of a table by its name; `usual` if the name is null. Throws UsageError that lists the names.
template <class Table>
auto chosen(const Table& table, const char* name, typename Table::value_type::second_type usual,
            std::string_view field) {
  if (!name) return usual;
  if (const auto value = valueNamed(table, name)) return *value;
  throw UsageError("{}: {}", field, unknownName("value", name, namesOf(table)));
}

ToolConfig toolFrom(const pp_tool& tool);
/// `mayBeWhole`: accepts integers. Throws UsageError.
NumberRows rowsFrom(const pp_rows& rows, bool mayBeWhole, std::string_view name);
CloudArrays arraysFrom(const pp_cloud_arrays& arrays);
/// The cloud of a program's arrays. Throws UsageError, also if it has normals of which more than a tenth are zero.
PointCloud cloudFrom(const CloudArrays& arrays);
/// Vectors of `count` points; empty if none are given. Throws UsageError for numbers that are not finite.
std::vector<Vec3> vectorsFrom(const pp_rows& rows, std::uint64_t count, std::string_view name);
SurfaceConfig surfaceFrom(const pp_contact_options& contact);
/// Throws UsageError.
MaskRole roleFrom(pp_mask which);
ForceOptions forceFrom(const pp_contact_options& contact);
BrushConfig brushFrom(const pp_brush& brush);
PictureRequest pictureFrom(const pp_picture_options& options);
MeshOptions meshFrom(const pp_mesh_options& options, const ModelScale& scale);
/// Converts rows to keys; with three columns each row is one tick. Throws UsageError that names the first invalid row.
Path pathFrom(const pp_path* path, double rate_Hz);
/// Number of ticks of a path; with three columns, one for each of its rows.
std::uint64_t ticksOf(const Path& path, double rate_Hz);

}  // namespace palpate::library

#include "engine/io/pcd_rows.hpp"

#include <fmt/format.h>

namespace palpate {

namespace {

bool isPacked(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && field.bytes == 4 && field.count == 1;
}

}  // namespace

std::vector<PcdRows::Column> PcdRows::columnsOf(const PcdHeader& header, PlyElement* element) {
  std::vector<Column> columns;
  std::size_t at = 0;
  const auto add = [&](const std::string& name, ScalarType type, std::size_t where) {
    columns.push_back({where, type});
    if (element) element->properties.push_back({.name = name, .type = type});
  };
  for (const PcdField& field : header.fields) {
    const std::size_t begin = at;
    at += field.bytes * field.count;
    if (field.name == "_") continue;
    if (isPacked(field)) {
      constexpr std::array<const char*, 4> kBytes{"blue", "green", "red", "alpha"};
      for (std::size_t k = 0; k < (field.name == "rgba" ? 4 : 3); ++k) add(kBytes[k], ScalarType::u8, begin + k);
      continue;
    }
    for (std::size_t k = 0; k < field.count; ++k) {
      const char* kind = field.type == 'I' ? "int" : field.type == 'U' ? "uint" : "float";
      add(field.count == 1 ? field.name : fmt::format("{}_{}", field.name, k),
          *scalarTypeFromPly(fmt::format("{}{}", kind, 8 * field.bytes)), begin + k * field.bytes);
    }
  }
  return columns;
}

PlyElement PcdRows::elementOf(const PcdHeader& header) {
  PlyElement element{.name = "vertex", .count = header.points, .properties = {}, .line = header.line};
  columnsOf(header, &element);
  return element;
}

PcdRows::PcdRows(const std::filesystem::path& file, const PcdHeader& header, Log* log)
    : columns_(columnsOf(header, nullptr)), rowBytes_(header.rowBytes()), vertices_(file, elementOf(header), log) {}

void PcdRows::appendRow(const std::byte* row) {
  const auto put = [&](auto value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    packed_.insert(packed_.end(), bytes, bytes + sizeof value);
  };
  for (const Column& column : columns_)
    visitScalar(column.type, [&]<class T>(std::type_identity<T>) { put(loadScalar<T>(row + column.at)); });
}

std::optional<PcdRows::Bad> PcdRows::append(const std::byte* rows, std::size_t count) {
  packed_.clear();
  for (std::size_t r = 0; r < count; ++r) appendRow(rows + r * rowBytes_);
  if (const auto bad = vertices_.append(packed_.data(), count, false)) return Bad{bad->row, bad->what};
  return std::nullopt;
}

}  // namespace palpate

// Names of point columns in files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/length_unit.hpp"

namespace palpate {

/// Meaning of text columns without names, determined by all rows.
/// The columns behind x y z are normals (unit length throughout), colours (0 to 1 or whole numbers to 255 throughout)
/// and a scalar, each at most once and in any order.
class UnnamedColumns {
 public:
  enum class Group { normal, color, scalar };
  using Layout = std::vector<Group>;

  /// `columns`: including x y z. `scalarFirst`: a scalar precedes colours if it may also follow them, as in PTS.
  UnnamedColumns(std::size_t columns, bool scalarFirst);

  /// Whether that number of columns can have a meaning at all.
  bool isPossible() const { return !layouts_.empty(); }
  void take(const std::vector<std::string_view>& words);
  /// The meaning. `why` receives the reason if there is none or more than one, in words; the layout is then empty.
  Layout layout(std::string& why) const;
  /// Whether the colours of layout() are whole numbers.
  bool hasWholeColors() const;

 private:
  struct Column {
    bool shares = true, bytes = true, whole = true;  // whole: written without a decimal point
    double most = 0;
  };
  struct Triple {
    bool unit = true, any = false;
  };
  bool allows(const Layout& layout) const;
  bool hasLabel(const Layout& layout) const;

  std::vector<Column> columns_;
  std::vector<Triple> triples_;  // by their first column
  std::vector<Layout> layouts_;
  bool scalarFirst_, countsUp_ = true;
  double number_ = 0;
  std::size_t rows_ = 0;
};

/// The names of the columns: x, y, z, then for example red, green, blue, scalar; a scalar before colours or alone is
/// the intensity.
std::vector<std::string> namesOf(const UnnamedColumns::Layout& layout);

/// The name that all formats share for the meaning of `name`, case-insensitive: x for X, Easting, pos_x; nx for
/// normal_x; red for Red. Other names become lower case, without a unit in brackets.
std::string sharedColumnName(std::string_view name);

/// If x, y or z is missing among shared names, renames those of surveys and scanners that are too short to be meant so
/// in every file: e, n and h; x1, y1 and z1.
void nameShortAxes(std::vector<std::string>& shared);

/// The unit of length that a name contains: "X [mm]", "x_mm", "Points_m_XYZ:0".
LengthUnit unitInName(std::string_view name);

/// The name in UTF-8; bytes of other text are taken for Latin-1.
std::string utf8Name(std::string_view name);

}  // namespace palpate

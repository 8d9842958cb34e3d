// What a format of clouds in files is: its names, and what reads and writes it. A format is a file of its own and a
// line of the table in cloud_formats.cpp; nothing else needs to know which there are.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/log.hpp"
#include "engine/io/file_start.hpp"

namespace palpate {

/// Rows of one kind, as a file announces them. Those of the points are called `vertex`, whatever the format; others are
/// what a cloud cannot keep.
struct FileElement {
  struct Property {
    std::string name;
    bool isList = false;  ///< each row has as many of them as it says
  };
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// What a file says that it holds.
struct FileContents {
  std::vector<FileElement> elements;  ///< in the order of the file
  std::vector<std::string> comments;  ///< as in StoredAs
  /// What the points are made from where they are no rows of the file, in words: "9080 Gaussians of degree 3".
  std::string madeFrom = {};
};

/// A cloud as a file holds it, with what came along.
struct StoredCloud {
  PointCloud cloud;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of its faces; empty where there are none
  /// What the file has and this does not, in words: "12 edge", "normals in double precision".
  std::vector<std::string> lost;
  /// Points of the file that are not in the cloud, and why, in words; empty where all are
  /// (CloudReadOptions::allPoints).
  std::string leftOut = {};
  /// Numbers of the file's rows that are no points and have none of the cloud, from 0 on, in order.
  std::vector<std::uint64_t> leftOutRows = {};
  /// Where pictures of it were taken, in the file's coordinates; empty where the file does not say.
  std::vector<CameraFrustum> cameras = {};
};

/// What a reader spent its time on, where it says so (LAS and LAZ); wall seconds.
struct ReadStages {
  double open_s = 0;    ///< until the first point is known to be there: header and records
  double points_s = 0;  ///< the points come out of the file
  double finish_s = 0;  ///< they get their places, colours and normals
  double waited_s = 0;  ///< of all threads together: waited for memory that another one makes ready
};

struct CloudReadOptions {
  bool normalsFromFaces = false;  ///< area-weighted, in place of any that the file gives
  /// Leaves out the triangles, which need not be right then; what is lost is said through the log, and nowhere else.
  bool pointsOnly = false;
  /// Of a reconstruction also the points that its own measures tell to be unreliable (colmap_reliability.hpp).
  bool allPoints = false;
  /// Of a mesh: how many points are sampled from it; 0: as many as its reader thinks right.
  std::size_t samples = 0;
  /// Of a mesh: its corners and its triangles, in place of points that are sampled from it.
  bool asTriangles = false;
  /// That read LAS and LAZ; 0: one per core. What is read does not depend on it.
  unsigned threads = 0;
  /// Gets what the time was spent on; null: nobody asks.
  ReadStages* stages = nullptr;
  /// Of lines of text: what their columns are, in place of what the file says (CloudFormat::isText); empty: that.
  std::vector<std::string> columns = {};
};
struct CloudWriteOptions {
  bool ascii = false;  ///< shortest decimals that read back as the same number
  /// Faces, by the numbers of their points; null: none.
  const std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;
  bool doubles = false;  ///< positions in double precision, whatever the cloud was stored as
  /// An older file of the name is kept, and its new name is put here (AtomicFile::commitAndKeep()); null: it is
  /// replaced.
  std::filesystem::path* keptAs = nullptr;
  std::function<void(double)> progress = {};  ///< is called with the share of the points that is written
};

/// Functions that a format has not are null: those for reading where it is only written, and the other way round.
struct CloudFormat {
  std::string_view name;
  /// Of file names, lower case, with the dot; the usual one first. Of two that a name ends with the longer one counts.
  std::span<const std::string_view> endings = {};
  /// What a format of folders is called in the help, "a NAME folder"; empty for one of files.
  std::string_view folder = {};
  /// Of a format that no name tells, of folders or of files that share their endings with another one: whether the
  /// path is of it. Throws nothing, and reads nothing that can be read only once.
  bool (*holds)(const std::filesystem::path& path) = nullptr;
  /// Whether a file that begins so is of the format, whatever it is called; null: only its name tells.
  bool (*begins)(const FileStart& start) = nullptr;
  bool isText = false;  ///< lines of columns
  /// Reads no further than it must. Throws FileError.
  FileContents (*contents)(const std::filesystem::path& file) = nullptr;
  /// Throws FileError with the place.
  StoredCloud (*read)(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) = nullptr;
  /// The file appears under its name only when it is whole. Throws FileError.
  void (*write)(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options) = nullptr;
  /// What of a cloud a file of the format cannot hold, in words.
  std::vector<std::string> (*lacks)(const StoredCloud& stored) = nullptr;
  bool hasComments = false;  ///< they are written, and read again
  /// Whose baggage a writer keeps (FormatBaggage::format); empty: of its own name.
  std::string_view family = {};
  /// Files of it are of triangles: read, they become points; without triangles nothing is written or saved.
  bool ofTriangles = false;
  /// What is read from it is not what was written: a cloud is converted to it, and never saved as it.
  bool onlyCopied = false;
};

}  // namespace palpate

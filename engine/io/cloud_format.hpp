// Description of a file format of clouds: its names, and its functions for reading and writing. A format is a file of
// its own and a line of the table in cloud_formats.cpp; no other code depends on it.
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
#include "engine/io/memory_need.hpp"

namespace palpate {

/// Rows of one kind, as declared by a file. Those of the points are called `vertex` in every format; a cloud cannot
/// keep the others.
struct FileElement {
  struct Property {
    std::string name;
    bool isList = false;  ///< each row declares its number of values
  };
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// Contents that a file declares.
struct FileContents {
  std::vector<FileElement> elements;  ///< in the order of the file
  std::vector<std::string> comments;  ///< as in StoredAs
  /// Source of the points if they are not rows of the file, in words: "9080 Gaussians of degree 3".
  std::string madeFrom = {};
};

/// A cloud as stored in a file, with additional data.
struct StoredCloud {
  PointCloud cloud;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< faces; may be empty
  /// Contents of the file that were not read, in words: "12 edge", "normals in double precision".
  std::vector<std::string> lost;
  /// For text whose columns have no names: the names that were assumed, "x,y,z,intensity"; else empty.
  std::string assumed = {};
  /// Points of the file that were left out, and why, in words; empty if none (CloudReadOptions::keepUnreliable).
  std::string leftOut = {};
  /// Row numbers (from 0, ascending) of the file that were left out of the cloud.
  std::vector<std::uint64_t> leftOutRows = {};
  /// Frusta of pictures of the object, in file coordinates; may be empty.
  std::vector<CameraFrustum> cameras = {};
};

/// Time spent by a reader, if it measures it (LAS and LAZ); wall seconds.
struct ReadStages {
  double open_s = 0;    ///< header and records, until the first point
  double points_s = 0;  ///< reading points
  double finish_s = 0;  ///< final positions, colours and normals
  double waited_s = 0;  ///< sum over all threads: waiting for memory prepared by another thread
};

struct CloudReadOptions {
  bool normalsFromFaces = false;  ///< area-weighted, replacing any in the file
  /// Leaves out the triangles, which then may be invalid; losses are reported only through the log.
  bool pointsOnly = false;
  /// For a reconstruction: also points that are unreliable by its own measures (colmap_reliability.hpp).
  bool keepUnreliable = false;
  /// For a mesh: number of points sampled from it; 0: chosen by the reader.
  std::size_t samples = 0;
  /// For a mesh: its corners and triangles instead of sampled points.
  bool asTriangles = false;
  /// Threads that read LAS and LAZ; 0: one per core. The result does not depend on it.
  unsigned threads = 0;
  /// Receives the times; may be null.
  ReadStages* stages = nullptr;
  /// For text: names of the columns, replacing those of the file (CloudFormat::isText); empty: those of the file.
  std::vector<std::string> columns = {};
  MemoryLimit memory = {};
};
struct CloudWriteOptions {
  bool ascii = false;  ///< shortest decimals that read back as the same number
  /// Faces, as point numbers; may be null.
  const std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;
  bool doubles = false;  ///< positions in double precision, even if the cloud was not stored so
  /// Keeps an existing file and stores its new path here (AtomicFile::commitAndKeep()); null: replaces it.
  std::filesystem::path* keptAs = nullptr;
  std::function<void(double)> progress = {};  ///< called with the share of points written
};

/// Unsupported functions are null: those for reading if a format can only be written, and vice versa.
struct CloudFormat {
  std::string_view name;
  /// File name endings, lower case, with the dot; the usual one first. The longest matching ending counts.
  std::span<const std::string_view> endings = {};
  /// Name of a folder format in the help, "a NAME folder"; empty for file formats.
  std::string_view folder = {};
  /// For formats that a name cannot identify (folders, or files that share their ending with another format): whether
  /// the path is of this format. Throws nothing, and does not read pipes.
  bool (*holds)(const std::filesystem::path& path) = nullptr;
  /// Whether a file with that beginning is of the format, independent of its name; null: only the name tells.
  bool (*begins)(const FileStart& start) = nullptr;
  bool isText = false;  ///< lines of columns
  /// Reads only as much as necessary. Throws FileError.
  FileContents (*contents)(const std::filesystem::path& file) = nullptr;
  /// Throws FileError with the location.
  StoredCloud (*read)(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) = nullptr;
  /// The file appears under its name only when it is complete. Throws FileError.
  void (*write)(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options) = nullptr;
  /// Parts of a cloud other than triangles that the format cannot store, in words.
  std::vector<std::string> (*lacks)(const PointCloud& cloud) = nullptr;
  /// Attributes that the format stores beside positions, normals and colours; null: attributesBeside().
  std::vector<const Attribute*> (*attributes)(const PointCloud& cloud) = nullptr;
  bool keepsNormals = true, keepsColors = true;
  bool hasComments = false;  ///< comments are written and read
  /// Format family whose baggage the writer keeps (FormatBaggage::format); empty: its own name.
  std::string_view family = {};
  /// The files contain triangles: reading converts them to points; writing and saving require triangles.
  bool ofTriangles = false;
  /// The files can contain triangles beside points.
  bool keepsTriangles = false;
  /// Reading it does not give back what was written: clouds are converted to this format, but never saved as it.
  bool onlyCopied = false;
};

}  // namespace palpate

// The table of formats that clouds are read from and written to, and lookup functions.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Content to write: a copy of a file in another format, a mesh with its triangles, or only the points of a cloud.
enum class Written { copy, mesh, points };

/// View of a table, which must outlive the object.
class CloudFormats {
 public:
  /// The first format is that of files with an unknown ending, and must support reading and writing.
  explicit CloudFormats(std::span<const CloudFormat> formats);

  /// By the content of a folder or file, independent of its name, else by the file's ending in any case; the first
  /// format if unknown.
  const CloudFormat& toRead(const std::filesystem::path& file) const;
  /// By the file's ending. Throws UsageError, listing the known endings, for an unknown one and for a format that
  /// cannot hold the content; a device or a pipe, whose name has no meaning, gets the first format.
  const CloudFormat& toWrite(const std::filesystem::path& file, Written what = Written::copy) const;
  /// By the file's ending; the first format, as for reading, if it is unknown, or if the format requires triangles and
  /// `triangles` is false: whatever can be opened can be saved.
  const CloudFormat& toSave(const std::filesystem::path& file, bool triangles = false) const;
  /// Ending for a file beside this one in the format toSave(): its own ending, or that of the first format if it
  /// belongs to a format that cannot be saved.
  std::string endingToSave(const std::filesystem::path& file) const;

  /// Like toRead(), but null if the format is unknown.
  const CloudFormat* recognised(const std::filesystem::path& file) const;
  std::span<const CloudFormat> all() const { return formats_; }
  std::string namesRead() const;                                   ///< "PLY, XYZ, COLMAP, COLMAP dense, 3DGS"
  std::string endingsRead() const;                                 ///< ".ply, .xyz, a COLMAP folder"
  std::string endingsWritten(Written what = Written::copy) const;  ///< as above

 private:
  std::span<const CloudFormat> formats_;
};

/// The table of all formats.
const CloudFormats& cloudFormats();

/// Whether the format writes the baggage of the cloud, if it has any.
bool keepsBaggage(const CloudFormat& format, const PointCloud& cloud);

/// Parts of a file that was read which writing in the format `to` loses, in words.
std::vector<std::string> lostOnTheWay(const StoredCloud& stored, const CloudFormat& to);
/// The same of a cloud that was read without losses, or whose losses are known.
std::vector<std::string> lostOnTheWay(const PointCloud& cloud, const CloudFormat& to);

/// Names of what a file in the format `to` then has: "positions", "colours", "intensity", "12 triangles".
std::vector<std::string> keptOnTheWay(const StoredCloud& stored, const CloudFormat& to);

/// Contents that the file declares. Throws FileError.
FileContents contentsOf(const std::filesystem::path& file, const CloudFormats& formats = cloudFormats());

/// Throws FileError with the location of the error.
StoredCloud readCloud(const std::filesystem::path& file, Log* log = nullptr, const CloudReadOptions& options = {},
                      const CloudFormats& formats = cloudFormats());

/// The file appears under its name only when it is complete. Throws FileError.
void writeCloud(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options = {},
                const CloudFormats& formats = cloudFormats());

}  // namespace palpate

// The table of formats that clouds are read from and written to, and the ways through it.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// What is written: a copy of a file in another format, a mesh with its triangles, or the points of a cloud alone.
enum class Written { copy, mesh, points };

/// A view of a table, which must outlive it.
class CloudFormats {
 public:
  /// The first one is that of files whose ending nobody knows, and both reads and writes.
  explicit CloudFormats(std::span<const CloudFormat> formats);

  /// By what a folder or a file holds, whatever it is called, or else by the file's ending, in any case; where nobody
  /// knows it the first one.
  const CloudFormat& toRead(const std::filesystem::path& file) const;
  /// By the file's ending. Throws UsageError, naming the endings that there are, for another one, and for one of a
  /// format that does not hold what is written; a device or a pipe, whose name says nothing, gets the first one.
  const CloudFormat& toWrite(const std::filesystem::path& file, Written what = Written::copy) const;
  /// By the file's ending; where nobody knows it, or it is of one that holds no points but `triangles`, and there are
  /// none, the first one, as for reading: what was opened can be saved.
  const CloudFormat& toSave(const std::filesystem::path& file, bool triangles = false) const;
  /// That of a file beside this one which is of the format toSave(): its own, or where that is another one's the first
  /// one's.
  std::string endingToSave(const std::filesystem::path& file) const;

  /// The same, or null where nobody knows the file.
  const CloudFormat* recognised(const std::filesystem::path& file) const;
  std::span<const CloudFormat> all() const { return formats_; }
  std::string namesRead() const;                                   ///< "PLY, XYZ, COLMAP, COLMAP dense, 3DGS"
  std::string endingsRead() const;                                 ///< ".ply, .xyz, a COLMAP folder"
  std::string endingsWritten(Written what = Written::copy) const;  ///< as above

 private:
  std::span<const CloudFormat> formats_;
};

/// All that there are.
const CloudFormats& cloudFormats();

/// What of a file that was read is not in one that is written in the format `to`, in words.
std::vector<std::string> lostOnTheWay(const StoredCloud& stored, const CloudFormat& to);

/// What the file says that it holds. Throws FileError.
FileContents contentsOf(const std::filesystem::path& file, const CloudFormats& formats = cloudFormats());

/// Throws FileError with the place of what is wrong.
StoredCloud readCloud(const std::filesystem::path& file, Log* log = nullptr, const CloudReadOptions& options = {},
                      const CloudFormats& formats = cloudFormats());

/// The file appears under its name only when it is whole. Throws FileError.
void writeCloud(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options = {},
                const CloudFormats& formats = cloudFormats());

}  // namespace palpate

// Saves a sculpted cloud where a file may exist: losses are known in advance, and that file is kept.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

/// An existing file under the name of a cloud that is about to be saved.
struct FileInTheWay {
  std::string name;        ///< without its folder; empty: there is no such file
  bool byPalpate = false;  ///< a comment in it says that palpate wrote it
  std::string more;        ///< contents that a cloud cannot keep: "69451 faces, 12 edges"; empty: none

  /// If true, the file must not be replaced without notice.
  bool losesSomething() const { return !name.empty() && (!byPalpate || !more.empty()); }
  /// Description of the loss for the user.
  std::string sentence() const;
};
/// Reads only its header. A file of unknown format counts as not written by palpate.
FileInTheWay fileInTheWay(const std::filesystem::path& file, const CloudFormats& formats = cloudFormats());

/// Logs what saving a sculpted cloud as `file` loses, and the name under which the existing file is kept; nothing if
/// there is none.
void sayWhatIsLost(const std::filesystem::path& file, Log& log);

/// Whether the comments of a file say that palpate wrote it.
bool isOurs(std::span<const std::string> comments);

/// Adds the comment that palpate wrote the file to `cloud`.
void markAsOurs(PointCloud& cloud);

/// Where writeCloud() and writeMesh() store the name under which they keep an existing file: `kept`, which is logged
/// now; null if there is none.
std::filesystem::path* whereToKeep(const std::filesystem::path& file, std::filesystem::path& kept, Log& log);

/// Call after writing, with the name of the kept file. Of kept files that palpate wrote only the newest stays, under
/// the first of their names; all others stay. Returns its name.
std::filesystem::path keepNewest(const std::filesystem::path& kept, const CloudFormats& formats = cloudFormats());

/// Writes `cloud`, marked as ours, and without normals that are marked as estimates; keeps an existing file
/// (keepNewest()). Returns the kept file's new path, or an empty path. Throws FileError.
std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud,
                                  const CloudFormats& formats = cloudFormats());

/// Default path for saving a sculpted cloud of `file`: the same, or beside it if its format is read only, and saving
/// would convert it.
std::filesystem::path whereToSave(const std::filesystem::path& file);

/// NAME-sculpted.EXT beside `file`, or NAME-sculpted-2.EXT and so on: the first name that does not exist.
std::filesystem::path nameBeside(const std::filesystem::path& file);

}  // namespace palpate

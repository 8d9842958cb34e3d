// Saves a sculpted cloud where a file may exist: losses are known in advance, and that file is kept.
#pragma once

#include <filesystem>
#include <functional>
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

/// What one session saved last.
struct OwnSave {
  std::filesystem::path file;
  std::filesystem::file_time_type written;  ///< of the file, after this save; another program may change it
  std::filesystem::path kept;               ///< its version before, if the session wrote that too
};

struct SaveOptions {
  OwnSave* own = nullptr;           ///< of this session; becomes this save
  std::filesystem::path like = {};  ///< file that the cloud was read from: if it is ASCII, `file` will be
  const CloudFormats& formats = cloudFormats();
  std::string* notKept = nullptr;  ///< becomes what the format does not keep, in words; empty: it keeps all
};
/// Writes `cloud`, marked as ours, and without normals that are marked as estimates; keeps an existing file as
/// AtomicFile::commitAndKeep() does. Of the versions that a session wrote itself only the newest is kept. Returns the
/// kept file's new path, or an empty path. Throws FileError.
std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud, const SaveOptions& options = {});

/// Saves the points of one session to `file` again and again, by saveKeeping(); returns its name. Empty for no file.
std::function<std::string(const PointCloud&)> saverTo(const std::string& file);

/// Default path for saving a sculpted cloud of `file`: the same, or beside it if it would be saved in another format.
std::filesystem::path whereToSave(const std::filesystem::path& file);

/// NAME-sculpted.EXT beside `file`, or NAME-sculpted-2.EXT and so on: the first name that does not exist.
std::filesystem::path nameBeside(const std::filesystem::path& file);

}  // namespace palpate

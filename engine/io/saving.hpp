// Saving a sculpted cloud where a file may be already: what would be lost is known before, and kept.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

/// A file under whose name a cloud is about to be saved.
struct FileInTheWay {
  std::string name;        ///< without its folder; empty: there is none
  bool byPalpate = false;  ///< a comment in it says that palpate wrote it
  std::string more;        ///< what it has that a cloud does not carry: "69451 faces, 12 edges"; empty: nothing

  /// It must not be replaced without a word, and is kept when it is.
  bool losesSomething() const { return !name.empty() && (!byPalpate || !more.empty()); }
  /// What is lost, for a person.
  std::string sentence() const;
};
/// Reads no more of it than its head. What is in no format that is known was not written by palpate.
FileInTheWay fileInTheWay(const std::filesystem::path& file, const CloudFormats& formats = cloudFormats());

/// Says what saving a sculpted cloud as `file` is going to cost, and as what the file that is there is kept; nothing
/// where it costs nothing, or the name is empty.
void sayWhatIsLost(const std::filesystem::path& file, Log& log);

/// Whether the comments of a file say that palpate wrote it.
bool isOurs(std::span<const std::string> comments);

/// Says in the header of what is written from `cloud` that palpate wrote it.
void markAsOurs(PointCloud& cloud);

/// Writes `cloud`, marked as ours; a file that loses something by it is kept. Says as what; empty where none was.
/// Throws FileError.
std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud,
                                  const CloudFormats& formats = cloudFormats());

/// Where a sculpted cloud of `file` is saved unless a person says otherwise: there, or beside it where it is of a
/// format that is only read, and so would become something else.
std::filesystem::path whereToSave(const std::filesystem::path& file);

/// NAME-sculpted.EXT beside `file`, or NAME-sculpted-2.EXT and so on: the first that is not there.
std::filesystem::path nameBeside(const std::filesystem::path& file);

}  // namespace palpate

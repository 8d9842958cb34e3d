#include "engine/io/foreign_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/rgbd_folder.hpp"

namespace palpate {

namespace {

constexpr int kDeepest = 2;               // folders below the one that was named: sparse/0
constexpr std::size_t kMaxEntries = 500;  // that are looked at
constexpr std::size_t kMaxNamed = 3;

bool isFolderOfFormat(const std::filesystem::path& path, const CloudFormats& formats) {
  return isRgbdFolder(path) || std::ranges::any_of(formats.all(), [&](const CloudFormat& format) {
           return !format.folder.empty() && format.holds && format.holds(path);
         });
}

/// Whether a name ends as a format's files do; the content of the files is not checked.
bool hasKnownEnding(const std::filesystem::path& file, const CloudFormats& formats) {
  const std::string ending = file.extension().string();
  return !ending.empty() && std::ranges::any_of(formats.all(), [&](const CloudFormat& format) {
    return format.read && std::ranges::find(format.endings, ending) != format.endings.end();
  });
}

/// Files and folders in it that can be read, folders first.
std::vector<std::string> readableIn(const std::filesystem::path& folder, const CloudFormats& formats) {
  std::vector<std::string> folders, files;
  std::error_code ended;
  std::size_t seen = 0;
  for (std::filesystem::recursive_directory_iterator at(
           folder, std::filesystem::directory_options::skip_permission_denied, ended);
       !ended && at != std::filesystem::recursive_directory_iterator() && seen < kMaxEntries; at.increment(ended)) {
    ++seen;
    std::error_code ignored;
    if (at->is_directory(ignored)) {
      if (isFolderOfFormat(at->path(), formats)) folders.push_back(at->path().string());
      if (at.depth() + 1 >= kDeepest) at.disable_recursion_pending();
    } else if (at.depth() == 0 && hasKnownEnding(at->path(), formats)) {
      files.push_back(at->path().string());
    }
  }
  std::ranges::sort(folders);
  std::ranges::sort(files);
  folders.insert(folders.end(), files.begin(), files.end());
  if (folders.size() > kMaxNamed) folders.resize(kMaxNamed);
  return folders;
}

using std::string_view_literals::operator""sv;

constexpr std::string_view kBag =
    "is a bag of ROS or of a RealSense camera, which is not read; Open3D can write a bag of a RealSense camera as a "
    "folder, which is read (open3d.t.io.RGBDVideoReader.create(BAG).save_frames(FOLDER)); ROS's image_view extracts "
    "pictures";
constexpr std::string_view kPacked = "is packed; unpack it first";

struct Magic {
  std::size_t at;  ///< offset in the file
  std::string_view bytes;
  std::string_view what;
};

// Bags of ROS 1, whose format RealSense cameras share, and of ROS 2 (MCAP and SQLite).
constexpr std::array kMagics{
    Magic{0, "#ROSBAG V", kBag},
    Magic{0, "\x89MCAP", kBag},
    Magic{0, "SQLite format 3", kBag},
    Magic{0, "version https://git-lfs", "is a pointer of Git LFS, and not the file itself; run 'git lfs pull'"},
    Magic{0, "DRACO", "is compressed with Draco, which is not read; export it as PLY, OBJ or glTF without compression"},
    Magic{0, "\x89PNG", "is an image (PNG), not a 3D file"},
    Magic{0, "\xff\xd8\xff", "is an image (JPEG), not a 3D file"},
    Magic{0, "GIF8", "is an image (GIF), not a 3D file"},
    Magic{0, "II*\0"sv, "is an image (TIFF), not a 3D file"},
    Magic{0, "MM\0*"sv, "is an image (TIFF), not a 3D file"},
    Magic{0, "II+\0"sv, "is an image (BigTIFF), not a 3D file"},
    Magic{0, "BM", "is an image (BMP), not a 3D file"},
    Magic{8, "WEBP", "is an image (WebP), not a 3D file"},
    Magic{0, "v/1\x01", "is an image (OpenEXR), not a 3D file"},
    Magic{0, "#?RADIANCE", "is an image (HDR), not a 3D file"},
    Magic{0, "8BPS", "is an image (Photoshop), not a 3D file"},
    Magic{4, "ftypheic", "is an image (HEIC), not a 3D file"},
    Magic{4, "ftypavif", "is an image (AVIF), not a 3D file"},
    Magic{4, "ftyp", "is a video, not a 3D file"},
    Magic{0, "\x1a\x45\xdf\xa3", "is a video (Matroska or WebM), not a 3D file"},
    Magic{8, "AVI ", "is a video (AVI), not a 3D file"},
    Magic{8, "WAVE", "is sound (WAV), not a 3D file"},
    Magic{0, "OggS", "is sound or video (Ogg), not a 3D file"},
    Magic{0, "ID3", "is sound (MP3), not a 3D file"},
    Magic{0, "fLaC", "is sound (FLAC), not a 3D file"},
    Magic{0, "%PDF", "is a document (PDF), not a 3D file"},
    Magic{0, "{\\rtf", "is a document (RTF), not a 3D file"},
    Magic{0, "\xd0\xcf\x11\xe0", "is a document of Microsoft Office, not a 3D file"},
    Magic{0,
          "\x7f"
          "ELF",
          "is a program, not a 3D file"},
    Magic{0, "MZ", "is a program of Windows, not a 3D file"},
    Magic{0, "\xcf\xfa\xed\xfe", "is a program of macOS, not a 3D file"},
    Magic{0, "#!", "is a script, not a 3D file"},
    Magic{0, "7z\xbc\xaf\x27\x1c", kPacked},
    Magic{0, "Rar!", kPacked},
    Magic{0, "BZh", kPacked},
    Magic{0,
          "\xfd"
          "7zXZ",
          kPacked},
    Magic{0, "\x28\xb5\x2f\xfd", kPacked},
    Magic{257, "ustar", "is an archive (tar); unpack it first"},
    Magic{0, "\x89HDF", "is HDF5, which is not read; export the points as PLY, LAS, NPY or text"},
    Magic{0, "MATLAB 5.0", "is a file of MATLAB, which is not read; export the points as PLY, or as text"},
    Magic{0, "PAR1", "is Parquet, which is not read; export the points as CSV, PLY or NPY"},
    Magic{0, "Kaydara FBX", "is FBX, which is not read; export it as glTF, OBJ, STL or PLY"},
    Magic{0, "; FBX", "is FBX, which is not read; export it as glTF, OBJ, STL or PLY"},
    Magic{0, "BLENDER", "is a file of Blender, which is not read; export it as glTF, OBJ, STL or PLY"},
    Magic{0, "PXR-USDC", "is USD, which is not read; export it as glTF, OBJ or PLY"},
    Magic{0, "#usda", "is USD, which is not read; export it as glTF, OBJ or PLY"},
    Magic{0, "# vtk DataFile", "is a file of VTK, which is not read; export it as PLY, STL or OBJ"},
    Magic{0, "#VRML", "is VRML, which is not read; export it as PLY, STL or OBJ"},
    Magic{0, "ISO-10303-21", "is STEP or IFC, which is not read; export it as STL, OBJ or glTF"},
    Magic{0, "HEADER    ", "is a molecule (PDB), which is not read; export its surface as OBJ, STL or PLY"},
    Magic{0, "data_", "is a molecule or crystal (CIF), which is not read; export its surface as OBJ, STL or PLY"},
    Magic{0, "# OpenDX", "is a grid of values (OpenDX), which is not read; export a surface of it as OBJ, STL or PLY"},
    Magic{0, "b3dm", "is a tile of 3D Tiles, which is not read; export the scene as glTF, LAS or PLY"},
    Magic{0, "i3dm", "is a tile of 3D Tiles, which is not read; export the scene as glTF, LAS or PLY"},
    Magic{0, "pnts", "is a tile of 3D Tiles, which is not read; export its points as LAS or PLY (py3dtiles export)"},
    Magic{0, "cmpt", "is a tile of 3D Tiles, which is not read; export the scene as glTF, LAS or PLY"},
    Magic{0, "DSAA", "is a grid of heights (Surfer), which is not read; export its points as text (gdal2xyz)"},
    Magic{0, "DSBB", "is a grid of heights (Surfer), which is not read; export its points as text (gdal2xyz)"},
    Magic{0, "DSRB", "is a grid of heights (Surfer), which is not read; export its points as text (gdal2xyz)"},
    Magic{0, "NRRD", "is a volume (NRRD), which is not read; export a surface of it as OBJ, STL or PLY"},
    Magic{344, "n+1\0"sv, "is a volume (NIfTI), which is not read; export a surface of it as OBJ, STL or PLY"},
    Magic{128, "DICM", "is a slice of a volume (DICOM), which is not read; export a surface of it as OBJ, STL or PLY"},
    Magic{0, "AC10", "is a drawing (DWG), which is not read; export its points as text, its surfaces as STL"},
};

/// Describes the content of an archive by its first member's name.
std::string archiveInWords(const FileStart& start) {
  constexpr std::size_t kNameAt = 30;
  const std::string name = start.bytes.size() > kNameAt ? start.bytes.substr(kNameAt, 64) : "";
  const auto has = [&](std::string_view text) { return start.bytes.find(text) != std::string::npos; };
  if (name.starts_with("meta.json") || has(".webp"))
    return "is SOG (packed Gaussian splats), which is not read; export it as an uncompressed PLY";
  if (has("3D/3dmodel.model") || has("3dmodel")) return "is 3MF, which is not read; export it as STL or OBJ";
  if (has(".usdc") || has(".usda")) return "is USDZ, which is not read; export it as glTF, OBJ or PLY";
  if (has("word/") || has("xl/") || has("ppt/") || has("[Content_Types].xml"))
    return "is a document of Microsoft Office, not a 3D file; save a table as CSV";
  if (has("mimetypeapplication/vnd.oasis")) return "is a document of LibreOffice, not a 3D file; save a table as CSV";
  if (has(".kml")) return "is KMZ, which is not read; export it as glTF, OBJ or PLY";
  return "is an archive (ZIP); unpack it first";
}

bool holdsArrays(const FileStart& start) {
  return start.bytes.find(".npy") != std::string::npos;  // NPZ, damaged or not
}

/// Describes text that begins with markup.
std::string_view markupInWords(const FileStart& start) {
  std::string text = start.bytes.substr(std::min(start.bytes.find_first_not_of(" \t\r\n"), start.bytes.size()));
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto has = [&](std::string_view word) { return text.find(word) != std::string::npos; };
  if (!text.starts_with('<')) return {};
  if (has("<!doctype html") || has("<html")) return "is a web page (HTML), not a 3D file; a download may have failed";
  if (has("<collada")) return "is COLLADA, which is not read; export it as glTF, OBJ, STL or PLY";
  if (has("<x3d")) return "is X3D, which is not read; export it as glTF, OBJ, STL or PLY";
  if (has("<vtkfile")) return "is a file of VTK, which is not read; export it as PLY, STL or OBJ";
  if (has("<svg")) return "is an image (SVG), not a 3D file";
  if (has("<amf")) return "is AMF, which is not read; export it as STL or OBJ";
  if (has("<kml")) return "is KML, not a 3D file";
  return "is XML, not a 3D file";
}

/// Describes JSON that is an index of tiles of points.
std::string_view indexInWords(const FileStart& start) {
  const std::size_t first = start.bytes.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || start.bytes[first] != '{') return {};
  const auto has = [&](std::string_view key) { return start.bytes.find(key) != std::string::npos; };
  if (has("\"hierarchyType\"") || (has("\"boundsConforming\"") && has("\"schema\"")))
    return "is the index of an Entwine tree (EPT), whose tiles are not read as a whole; PDAL writes one file of them "
           "(pdal translate ept.json FILE.laz)";
  if (has("\"octreeDir\"") || (has("\"hierarchy\"") && has("\"spacing\"")))
    return "is the index of a Potree octree, whose nodes are not read; read the LAS or LAZ file that it was made from";
  if (has("\"geometricError\"") && has("\"root\""))
    return "is the index of 3D Tiles, which are not read; export the scene as glTF, LAS or PLY";
  return {};
}

/// Names a text format that does not list points, by its first words.
std::string_view textInWords(const FileStart& start) {
  const auto lines = start.lines(4);
  std::vector<std::string> firsts;
  for (const auto& line : lines) {
    std::string& word = firsts.emplace_back(line[0]);
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (firsts.size() >= 2 && firsts[0] == "ncols" && firsts[1] == "nrows")
    return "is a grid of heights (ESRI ASCII), not points; GDAL writes its points as text (gdal2xyz -skipnodata)";
  if (!firsts.empty() && (firsts[0] == "atom" || firsts[0] == "hetatm"))
    return "is a molecule (PDB), which is not read; export its surface as OBJ, STL or PLY";
  return {};
}

std::string lowerEnding(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

/// Kinds that only their names identify.
std::string_view namedInWords(const std::filesystem::path& file) {
  const std::string ending = lowerEnding(file);
  if (ending == ".ksplat")
    return "is .ksplat (packed Gaussian splats), which is not read; export it as an uncompressed PLY or .splat";
  if (ending == ".sog") return "is SOG (packed Gaussian splats), which is not read; export it as an uncompressed PLY";
  if (ending == ".drc")
    return "is compressed with Draco, which is not read; export it as PLY, OBJ or glTF without compression";
  for (const std::string_view scan : {".fls", ".fws", ".rcp", ".rcs", ".zfs", ".zfc", ".rdb", ".rxp", ".cl3", ".clr"})
    if (ending == scan) return "is a scanner's own format, which is not read; export the scan as E57, LAS or PTX";
  return {};
}

/// Whether it is a list in a folder of depth frames; such folders are read as a whole.
bool isListOfFrames(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  constexpr std::array<std::string_view, 5> kLists{"depth.txt", "rgb.txt", "groundtruth.txt", "trajectory.log",
                                                   "traj.txt"};
  return std::ranges::find(kLists, name) != kLists.end() &&
         isRgbdFolder(file.has_parent_path() ? file.parent_path() : ".");
}

}  // namespace

void refuseFolder(const std::filesystem::path& folder, const CloudFormats& formats) {
  std::error_code ignored;
  if (std::filesystem::exists(folder / "metadata.yaml", ignored))
    throw FileError(folder,
                    "is a folder with a bag of ROS 2, which is not read; play it, and name ros:TOPIC as the model");
  const std::vector<std::string> within = readableIn(folder, formats);
  throw FileError(folder, fmt::format("is not a folder of COLMAP, {}; {}", rgbdLayoutsRead(false),
                                      within.empty() ? "name a file in it"
                                                     : fmt::format("name one of {}", fmt::join(within, ", "))));
}

void refuseForeign(const std::filesystem::path& file) {
  const auto start = startOf(file);
  if (!start) return;
  if (isListOfFrames(file)) throw FileError(file, "is a list of depth frames; name the folder that it lies in");
  for (const Magic& magic : kMagics)
    if (start->bytes.size() > magic.at && std::string_view(start->bytes).substr(magic.at).starts_with(magic.bytes) &&
        !(magic.bytes.size() == 2 && start->isText() && magic.what.find("script") == std::string_view::npos))
      throw FileError(file, magic.what);
  if (start->startsWith("PK\3\4") && !holdsArrays(*start)) throw FileError(file, archiveInWords(*start));
  if (const std::string_view markup = markupInWords(*start); !markup.empty()) throw FileError(file, markup);
  if (const std::string_view index = indexInWords(*start); !index.empty()) throw FileError(file, index);
  if (const std::string_view text = textInWords(*start); !text.empty()) throw FileError(file, text);
  if (const std::string_view named = namedInWords(file); !named.empty()) throw FileError(file, named);
}

void refuseUnknown(const std::filesystem::path& file, std::string_view formats) {
  const auto start = startOf(file);
  const std::string begin = start ? start->bytes.substr(0, start->bytes.find_first_of("\r\n")) : "";
  throw FileError(file,
                  fmt::format("is {}, not a 3D file that can be read (it begins with {}); readable formats are {}",
                              start && start->isText() ? "text" : "of an unknown kind", inQuotes(begin), formats));
}

}  // namespace palpate

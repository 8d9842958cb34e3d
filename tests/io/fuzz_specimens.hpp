// Valid files of every format that is read from untrusted sources, to be damaged.
#pragma once

#include <functional>
#include <string>

#include "engine/io/zip_archive.hpp"
#include "tests/io/colmap_bytes.hpp"
#include "tests/io/copc_bytes.hpp"
#include "tests/io/e57_bytes.hpp"
#include "tests/io/gaussian_bytes.hpp"
#include "tests/io/gltf_bytes.hpp"
#include "tests/io/npy_bytes.hpp"

namespace palpate::test {

/// LZF as in compressed PCD files, made by hand for the tests of the reader:
/// compresses repetitions of the preceding four bytes, and nothing else.
inline std::string packedLzf(const std::string& bytes) {
  constexpr std::size_t kBack = 4, kMaxLiteral = 32, kMaxRun = 264, kMinRun = 9;
  std::string out, literal;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literal.size(); at += kMaxLiteral) {
      const std::string piece = literal.substr(at, kMaxLiteral);
      out += static_cast<char>(piece.size() - 1);
      out += piece;
    }
    literal.clear();
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t run = 0;
    while (at >= kBack && at + run < bytes.size() && run < kMaxRun && bytes[at + run] == bytes[at + run - kBack]) ++run;
    if (run < kMinRun) {
      literal += bytes[at++];
      continue;
    }
    flush();
    out += static_cast<char>(7 << 5);
    out += static_cast<char>(run - kMinRun);
    out += static_cast<char>(kBack - 1);
    at += run;
  }
  flush();
  return out;
}

struct Specimen {
  std::string format;  ///< name for PALPATE_FUZZ_ONLY
  std::string name;    ///< name of the file
  std::string text;
  std::size_t head;  ///< number of leading bytes that describe the content
  /// Adds the surrounding bytes and valid checksums; null: `text` is the whole file.
  std::function<std::string(const std::string&)> dressed = {};
  /// Other files of its folder, by name, if a folder is read as a whole or through one of its files.
  std::vector<std::pair<std::string, std::string>> beside = {};
  std::string opened = {};  ///< that file

  std::filesystem::path sourceIn(const std::filesystem::path& folder) const {
    return beside.empty() ? folder / name : folder / opened;
  }
};

inline Specimen specimenOf(std::string format, std::string name, std::string text) {
  const std::size_t head = std::min<std::size_t>(text.size(), 800);
  return {std::move(format), std::move(name), std::move(text), head};
}

inline void addWritten(std::vector<Specimen>& all) {
  PointCloud cloud = reading(variedFile(3, 60).text()).cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.normals.emplace_back(0, 0, i % 2 ? 1 : -1);
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  for (const CloudFormat& format : cloudFormats().all()) {
    if (!format.write) continue;
    const std::string name = "a" + std::string(format.endings.front());
    for (const bool ascii : {false, true}) {
      const ScratchFolder folder;
      format.write(folder / name, cloud, {.ascii = ascii, .triangles = &triangles});
      all.push_back(specimenOf(name.substr(2), name, bytesOf(folder / name)));
    }
  }
}

inline void addLas(std::vector<Specimen>& all) {
  LasBytes las = variedFile(8, 40, 3);
  las.records = lasRecord("LASF_Spec", 4, lasDescriptor("a", 1) + lasDescriptor("b", 3, 24, 0.1, 1)) +
                lasRecord("palpate", 1, "comment units: m\n");
  las.recordCount = 2;
  las.tail = lasLongRecord("x", 1, "yz");
  las.longRecords = 1;
  all.push_back({"las", "a.las", las.text(), 375 + 500});
}

inline void addLaz(std::vector<Specimen>& all) {
  for (const unsigned format : {1u, 3u, 6u, 8u})
    all.push_back({"laz", "a.laz", packedFile(variedFile(format, 200, 2), {.chunks = {50, 150}}), 700});
  all.push_back({"laz", "a.laz", packedFile(variedFile(2, 200), {.chunked = false}), 400});
  const CopcFile copc = copcFile();
  all.push_back({"copc", "a.copc.laz", copc.text, copc.info + 160});
  // The pages of the octree follow the points.
  const std::size_t pages = 4 * CopcFile::kEntry;
  const auto inPlace = [copc](const std::string& text) {
    return std::string(copc.text).replace(copc.root, pages, text);
  };
  all.push_back({"copc", "a.copc.laz", copc.text.substr(copc.root, pages), pages, inPlace});
}

inline void addE57(std::vector<Specimen>& all) {
  E57Bytes e57;
  std::vector<double> ramp(50);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.5 * static_cast<double>(i);
  std::vector<std::int64_t> whole(50, 3);
  e57.add({.points = 50,
           .streams = {floats("cartesianX", ramp, true), floats("cartesianY", ramp, false),
                       integers("cartesianZ", whole, -7, 9, "scale=\"0.25\""), integers("intensity", whole, 0, 1000)},
           .more = "<pose><rotation><w>1</w></rotation></pose>"});
  const std::string logical = E57Bytes::unpaged(e57.text());
  all.push_back({"e57", "a.e57", logical, logical.size(), [](const std::string& text) {
                   return E57Bytes::paged(text + std::string((1020 - text.size() % 1020) % 1020, '\0'));
                 }});
}

inline void addPackedPcd(std::vector<Specimen>& all) {
  std::string columns;
  for (int column = 0; column < 4; ++column)
    for (int i = 0; i < 60; ++i) {
      const float value = static_cast<float>(i / 7);  // in runs, so that they are compressed
      columns.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  const std::string packed = packedLzf(columns);
  std::string text =
      "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 60\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 60\nDATA binary_compressed\n";
  const std::size_t head = text.size();
  for (const std::size_t bytes : {packed.size(), columns.size()})
    text += npy::bytes({static_cast<std::uint32_t>(bytes)});
  text += packed;
  all.push_back({"packed-pcd", "a.pcd", text, head + 8});
  all.push_back({"packed-pcd", "a.pcd", text, text.size()});
}

inline void addText(std::vector<Specimen>& all) {
  std::string rows;
  for (int k = 0; k < 60; ++k) rows += fmt::format("{} 2.5 -3 {} 1 2 {}\n", 0.25 * k, k - 30, 4 * k);
  all.push_back({"pts", "a.pts", "60\n" + rows, 300});
  all.push_back({"csv", "a.csv", "x,y,z,i,r,g,b\n" + rows, 300});
}

inline void addNpz(std::vector<Specimen>& all) {
  std::string rows;
  for (int i = 0; i < 60; ++i) rows += npy::bytes({0.5f * static_cast<float>(i), 1.f, -2.f});
  const std::string places = npy::array("'<f4'", "(60, 3)", rows);
  all.push_back({"npy", "a.npy", npy::array("[('xyz', '<f4', (3,))]", "(60,)", rows), 90});
  const std::string normals = npy::array("'<f4'", "(60, 3)", rows);
  const auto archive = [normals](const std::string& text) {
    return npy::zip({{"xyz.npy", text, ""}, {"normals.npy", normals, npy::plainBlock(normals)}});
  };
  all.push_back(specimenOf("npz", "a.npz", archive(places)));
  const std::string whole = all.back().text;
  all.push_back({"npz", "a.npz", whole, whole.size()});
  all.push_back({"npz", "a.npz", places, 80, archive});
  all.push_back({"npz", "a.npz", npy::plainBlock(places), 80, [places](const std::string& packed) {
                   return npy::zip({{"xyz.npy", places, packed}});
                 }});
}

inline void addGltf(std::vector<Specimen>& all) {
  for (const bool binary : {true, false}) {
    const std::string text = gltfTriangle(binary);
    all.push_back({"gltf", binary ? "a.glb" : "a.gltf", text, text.size()});
  }
}

inline void addGaussians(std::vector<Specimen>& all) {
  for (const PlyFormat format : kAllFormats) {
    const std::string text = gaussian::fileOf(gaussian::square(8), {.format = format});
    all.push_back({"3dgs", "a.ply", text, gaussian::headerOf({.format = format}, 64).size()});
    all.push_back({"3dgs", "a.ply", text, text.size()});
  }
}

inline void addColmap(std::vector<Specimen>& all) {
  for (const std::string form : {"bin", "txt"}) {
    const colmap::Files files = form == "bin" ? colmap::binary() : colmap::text();
    const std::vector<std::pair<std::string, std::string>> parts{
        {"cameras." + form, files.cameras}, {"images." + form, files.images}, {"points3D." + form, files.points}};
    for (const auto& damaged : parts) {
      Specimen specimen = specimenOf("colmap", damaged.first, damaged.second);
      for (const auto& part : parts)
        if (part != damaged) specimen.beside.push_back(part);
      all.push_back(std::move(specimen));
    }
  }
}

inline void addColmapDense(std::vector<Specimen>& all) {
  std::string cloud =
      "ply\nformat ascii 1.0\nelement vertex 100\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  std::string views = npy::bytes<std::uint64_t>({100});
  for (int i = 0; i < 100; ++i) {
    cloud += fmt::format("{} {} 5\n", 0.1 * (i % 10), 0.1 * (i / 10));
    views += i % 3 == 0 ? npy::bytes<std::uint32_t>({2, 0, 1}) : npy::bytes<std::uint32_t>({1, 0});
  }
  const colmap::Files model = colmap::text();
  const std::vector<std::pair<std::string, std::string>> parts{{"fused.ply", cloud},
                                                               {"fused.ply.vis", views},
                                                               {"sparse/cameras.txt", model.cameras},
                                                               {"sparse/images.txt", model.images},
                                                               {"sparse/points3D.txt", model.points}};
  for (std::size_t damaged = 0; damaged < 2; ++damaged) {
    Specimen specimen = specimenOf("colmap-dense", parts[damaged].first, parts[damaged].second);
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (k != damaged) specimen.beside.push_back(parts[k]);
    specimen.opened = "fused.ply";
    all.push_back(std::move(specimen));
  }
}

/// PTX, and packed Gaussians.
inline void addPacked(std::vector<Specimen>& all) {
  std::string ptx;
  for (int scan = 0; scan < 2; ++scan) {
    ptx += "5\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n9 8 7 1\n";
    for (int i = 0; i < 20; ++i) ptx += fmt::format("{} {} 0.5 0.25 {} 2 3\n", i % 5, i / 5, 10 * i);
  }
  all.push_back(specimenOf("ptx", "a.ptx", ptx));
  std::string splat, spz, compressed = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n";
  for (int i = 0; i < 60; ++i) {
    splat += npy::bytes({static_cast<float>(i % 8), static_cast<float>(i / 8), 0.f, 0.4f, 0.4f, 0.1f});
    splat += "\xc8\x64\x32\xff\xff\x80\x80\x80";
  }
  all.push_back(specimenOf("splat", "a.splat", splat));
  spz += npy::bytes({std::uint32_t{0x5053474e}, std::uint32_t{2}, std::uint32_t{60}}) + std::string("\0\x0c\0\0", 4);
  for (int i = 0; i < 60; ++i)
    spz += std::string{0, static_cast<char>(16 * (i % 8)), 0, 0, static_cast<char>(16 * (i / 8)), 0, 0, 0, 0};
  spz += std::string(60, '\xff') + std::string(180, '\x99') + std::string(180, '\x90') + std::string(180, '\x80');
  all.push_back({"spz", "a.spz", spz, 16, [](const std::string& text) {
                   const std::span bytes(reinterpret_cast<const std::byte*>(text.data()), text.size());
                   return std::string("\x1f\x8b\x08\0\0\0\0\0\0\3", 10) + npy::plainBlock(text) +
                          npy::bytes({zipChecksum(bytes), static_cast<std::uint32_t>(text.size())});
                 }});
  const std::string whole = all.back().dressed(spz);
  all.push_back({"spz", "a.spz", whole, whole.size()});
  for (const char* name : {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y",
                           "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z"})
    compressed += fmt::format("property float {}\n", name);
  compressed +=
      "element vertex 60\nproperty uint packed_position\nproperty uint packed_rotation\nproperty uint packed_scale\n"
      "property uint packed_color\nend_header\n";
  const std::size_t head = compressed.size();
  compressed += npy::bytes({0.f, 0.f, 0.f, 8.f, 8.f, 0.f, -1.f, -1.f, -3.f, -1.f, -1.f, -2.f});
  for (std::uint32_t i = 0; i < 60; ++i)
    compressed +=
        npy::bytes({(i % 8) * 255u << 21 | (i / 8) * 127u << 11, 512u << 20 | 512u << 10 | 512u, 0u, 0xc86432ffu});
  all.push_back({"compressed-3dgs", "a.ply", compressed, head + 48});
}

inline std::vector<Specimen> specimens() {
  std::vector<Specimen> all;
  addWritten(all);
  addLas(all);
  addText(all);
  addLaz(all);
  addE57(all);
  addPackedPcd(all);
  addNpz(all);
  addGltf(all);
  addGaussians(all);
  addColmap(all);
  addColmapDense(all);
  addPacked(all);
  return all;
}

}  // namespace palpate::test

#include "engine/io/las_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/las_grid.hpp"
#include "engine/io/las_head.hpp"
#include "engine/io/laz_chunk.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPointsAtOnce = std::size_t{1} << 18;  // points written at a time

void finish(AtomicFile& file, const LasPlan& plan, const CloudWriteOptions& options) {
  if (plan.baggage) file.write(plan.baggage->tail);
  if (options.keptAs)
    *options.keptAs = file.commitAndKeep();
  else
    file.commit();
}

void sayProgress(const CloudWriteOptions& options, std::size_t done, std::size_t all) {
  if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(all));
}

/// Header of a compressed file: LASzip's record follows all others.
std::vector<std::byte> packedHead(const PointCloud& cloud, const LasPlan& plan, const LazLayout& layout) {
  std::vector<std::byte> head = lasHeadFor(cloud, plan);
  const LasHeader header = readLasHeader({}, head);
  std::size_t end = header.size;
  for (const LasRecord& record : lasRecords({}, header, head))
    end = record.at + record.head.size() + record.data.size();
  const std::vector<std::byte> record = lazRecordFor(plan.format, layout);
  head.insert(head.begin() + static_cast<std::ptrdiff_t>(end), record.begin(), record.end());
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  put(96, static_cast<std::uint32_t>(head.size()));
  put(100, header.records + 1);
  put(104, static_cast<std::uint8_t>(plan.format | kLazBit));
  return head;
}

/// Compresses all points, chunk by chunk.
std::vector<std::vector<std::byte>> packPoints(const PointCloud& cloud, const LasPlan& plan, const LazLayout& layout,
                                               const CloudWriteOptions& options) {
  const std::size_t chunkPoints = *layout.chunkPoints, count = (cloud.size() + chunkPoints - 1) / chunkPoints;
  const std::size_t together = 4 * std::size_t{threadCount(0)};
  std::vector<std::vector<std::byte>> packed(count);
  for (std::size_t first = 0; first < count; first += together) {
    sayProgress(options, first, count);
    parallelBlocks(std::min(together, count - first), 1, 0, [&](std::size_t k, std::size_t) {
      const std::size_t begin = (first + k) * chunkPoints, end = std::min(cloud.size(), begin + chunkPoints);
      std::vector<std::byte> rows((end - begin) * plan.pointBytes);
      plan.encode(cloud, begin, end, rows.data());
      packed[first + k] = encodeLazChunk(layout, rows);
    });
  }
  return packed;
}

}  // namespace

void writeLas(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const LasPlan plan(cloud);
  plan.check(path);
  AtomicFile file(path);
  std::vector<std::byte> head = lasHeadFor(cloud, plan);
  putPointsInto(head, plan, cloud, head.size() + std::uint64_t{cloud.size()} * plan.pointBytes);
  file.write(head);
  std::vector<std::byte> rows;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kPointsAtOnce) {
    sayProgress(options, begin, cloud.size());
    const std::size_t count = std::min(kPointsAtOnce, cloud.size() - begin);
    rows.assign(count * plan.pointBytes, std::byte{0});
    parallelBlocks(count, 4096, 0, [&](std::size_t from, std::size_t to) {
      plan.encode(cloud, begin + from, begin + to, rows.data() + from * plan.pointBytes);
    });
    file.write(rows);
  }
  finish(file, plan, options);
}

void writeLaz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const LasPlan plan(cloud);
  plan.check(path);
  if (plan.points.hasWaves) throw FileError(path, "points with wave packets cannot be packed; name the file .las");
  const LazLayout layout = lazLayoutFor(plan.format, plan.pointBytes);
  AtomicFile file(path);
  std::vector<std::byte> head = packedHead(cloud, plan, layout);
  const std::vector<std::vector<std::byte>> packed = packPoints(cloud, plan, layout, options);
  std::vector<LazChunk> chunks;
  std::uint64_t at = head.size() + sizeof(std::int64_t);
  for (const std::vector<std::byte>& chunk : packed) {
    chunks.push_back({at, chunk.size(), 0});
    at += chunk.size();
  }
  const std::vector<std::byte> table = lazChunkTable(chunks);
  putPointsInto(head, plan, cloud, at + table.size());
  file.write(head);
  file.write(std::as_bytes(std::span(&at, 1)));
  for (const std::vector<std::byte>& chunk : packed) file.write(chunk);
  file.write(table);
  finish(file, plan, options);
}

std::vector<const Attribute*> attributesOfLas(const PointCloud& cloud) {
  const std::vector<std::string> givingWay = lasNamesGivingWay(cloud);
  std::vector<const Attribute*> attributes;
  for (const Attribute& attribute : cloud.extra)
    if (std::ranges::find(givingWay, attribute.name) == givingWay.end()) attributes.push_back(&attribute);
  return attributes;
}

std::vector<std::string> lacksOfLas(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  if (const LasGrid grid = lasGridFor(cloud); !grid.exact) {
    const double step = std::abs(grid.grid.step.x);
    const auto& known = cloud.storedAs.grid;
    const bool refined = known && step < std::abs(known->step.x);
    lost.push_back(fmt::format("coordinates finer than {:.3g}", 0.5 * step) +
                   (refined
                        ? fmt::format(" (the scale becomes {:.3g}, as {:.3g} is coarse for the spacing of the points)",
                                      step, std::abs(known->step.x))
                        : ""));
  }
  for (const Attribute& attribute : cloud.extra)
    if (attribute.name.size() > 32) lost.push_back(fmt::format("the end of the name '{}'", attribute.name));
  for (const std::string& name : lasNamesGivingWay(cloud))
    lost.push_back(fmt::format("the attribute '{}', because another one is written under its name", name));
  return lost;
}

}  // namespace palpate

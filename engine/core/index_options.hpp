// How the index of a live cloud is built and kept: choices that a session can be configured with, without Vulkan.
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace palpate {

/// How the index follows an edit: incrementally, at the cost of the touched points, as long as that is cheaper than a
/// rebuild; or by a rebuild each time.
enum class IndexFollow { incremental, rebuild };
inline constexpr std::array<std::pair<std::string_view, IndexFollow>, 2> kIndexFollows{
    {{"incremental", IndexFollow::incremental}, {"rebuild", IndexFollow::rebuild}}};

/// How a build sorts the points into buckets. If stable, all methods give the same order, bit by bit.
enum class SortMethod {
  radix,          ///< sorts (bucket, number) pairs; runs everywhere
  radixLookBack,  ///< the same with half the memory traffic; fastest on points in random order, where measured
  counting        ///< counts the points of each bucket; fastest on points that are almost in order, runs everywhere
};
inline constexpr std::array<std::pair<std::string_view, SortMethod>, 3> kSortMethods{
    {{"counting", SortMethod::counting}, {"radix", SortMethod::radix}, {"radix-lookback", SortMethod::radixLookBack}}};
/// Points are mostly in the order of the last build; no driver is known on which another method is faster then.
inline constexpr SortMethod kDefaultSort = SortMethod::counting;

/// The order of points within a bucket: their previous order, so that the same cloud gives the same index in every run;
/// or the order of arrival, which saves `counting` a pass and the other methods nothing.
enum class BucketOrder { stable, arrival };

/// How cells map to buckets: each cell hashed by Teschner's function (the thesis), or blocks of eight cells a side
/// hashed, with the cells of a block in Morton order.
enum class BucketKey { teschner, morton };
inline constexpr std::array<std::pair<std::string_view, BucketKey>, 2> kBucketKeys{
    {{"teschner", BucketKey::teschner}, {"morton", BucketKey::morton}}};

/// How a thread waits for the GPU. Spinning has the lowest latency and occupies a core; polling yields between two
/// checks; blocking sleeps in the driver, which is the only fair choice where the driver itself needs the cores.
enum class Wait { spin, poll, block };
inline constexpr std::array<std::pair<std::string_view, Wait>, 3> kWaits{
    {{"spin", Wait::spin}, {"poll", Wait::poll}, {"block", Wait::block}}};

}  // namespace palpate

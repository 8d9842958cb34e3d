// How the index of a live cloud is built and kept: choices that a session can be configured with, without Vulkan.
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace palpate {

/// How the index follows an edit: at the cost of what the edit touched, as long as that is less than building it anew;
/// or built anew each time.
enum class IndexFollow { incremental, rebuild };
inline constexpr std::array<std::pair<std::string_view, IndexFollow>, 2> kIndexFollows{
    {{"incremental", IndexFollow::incremental}, {"rebuild", IndexFollow::rebuild}}};

/// How a build brings the points into the order of their buckets. All give the same order, bit by bit, if it is stable.
enum class SortMethod {
  radix,          ///< sorts (bucket, number) pairs; runs everywhere
  radixLookBack,  ///< the same with half the traffic, where canLookBack(); fastest on points in random order
  counting        ///< counts the points of each bucket; fastest on points that stand almost in order, runs everywhere
};
inline constexpr std::array<std::pair<std::string_view, SortMethod>, 3> kSortMethods{
    {{"counting", SortMethod::counting}, {"radix", SortMethod::radix}, {"radix-lookback", SortMethod::radixLookBack}}};
/// Points mostly stand in the order of the last build; no driver is known on which another is faster then.
inline constexpr SortMethod kDefaultSort = SortMethod::counting;

/// The order of points within a bucket: the one in which they stood, so that the same cloud gives the same index run
/// after run; or whichever came first, which saves `counting` a pass and the others nothing.
enum class BucketOrder { stable, arrival };

/// How cells become buckets: each cell scattered by Teschner's hash (the thesis), or blocks of eight cells a side
/// scattered and the cells within a block in Morton order.
enum class BucketKey { teschner, morton };
inline constexpr std::array<std::pair<std::string_view, BucketKey>, 2> kBucketKeys{
    {{"teschner", BucketKey::teschner}, {"morton", BucketKey::morton}}};

/// How a thread waits for the GPU. Spinning answers soonest and burns a core; polling yields between two checks;
/// blocking sleeps in the driver, which is the only fair way where the driver itself needs the cores.
enum class Wait { spin, poll, block };
inline constexpr std::array<std::pair<std::string_view, Wait>, 3> kWaits{
    {{"spin", Wait::spin}, {"poll", Wait::poll}, {"block", Wait::block}}};

}  // namespace palpate

#include "apps/cli/tick_times.hpp"

namespace palpate {

std::string inWords(const TickHistogram& times) {
  return fmt::format("50 % within {:.0f}, 99 % {:.0f}, 99.9 % {:.0f}, all {:.0f} us", times.quantile_us(0.5),
                     times.quantile_us(0.99), times.quantile_us(0.999), times.max_us());
}

Json toJson(const TickHistogram& times) {
  Json from_us = Json::array(), ticks = Json::array();
  for (std::size_t bin = 0; bin < TickHistogram::kBins; ++bin) {
    if (times[bin] == 0) continue;
    from_us.push_back(TickHistogram::from_us(bin));
    ticks.push_back(times[bin]);
  }
  return {{"from", from_us}, {"ticks", ticks}, {"bins_per_octave", TickHistogram::kBinsPerOctave}};
}

std::string inWords(const SchedulingStatistics& scheduling) {
  return fmt::format("{} times by another thread, {:.0f} us without a core in total, {} page faults",
                     scheduling.preemptions, scheduling.waited_us, scheduling.pageFaults);
}

Json toJson(const SchedulingStatistics& scheduling) {
  return {{"preemptions", scheduling.preemptions},
          {"waited_us", scheduling.waited_us},
          {"page_faults", scheduling.pageFaults}};
}

}  // namespace palpate

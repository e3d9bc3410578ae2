// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/ScanRange.h>

#include <sstream>

namespace dyslam
{
namespace
{
constexpr double stamp_tolerance = 1e-6;  // stamps this near are one [s]
constexpr int most_scans = 1000000000;
constexpr double most_seconds = 1e9;
}  // namespace

void ScanRange::describeRange(OptionsVisitor& visitor)
{
  visitor.integer("skip_first_n", skip_first_n, 0, most_scans,
                  "number of first scans that are skipped");
  visitor.integer("only_first_n", only_first_n, 0, most_scans,
                  "most scans that are used, after the skipped ones; 0: all");
  visitor.real("start", start, 0, most_seconds,
               "time since the first scan before which scans are skipped [s]");
  visitor.real("end", end, 0, most_seconds,
               "time since the first scan from which on scans are left out; 0: none [s]");
}

ScanSelection::ScanSelection(const ScanRange& range, int every_n)
    : range_(range), every_n_(static_cast<std::size_t>(every_n))
{
  if (range.end != 0 && range.end <= range.start)
  {
    std::ostringstream text;
    text << "end = " << range.end << " s is not after start = " << range.start << " s";
    throw UserError(text.str());
  }
}

bool ScanSelection::takes(std::size_t index, double stamp)
{
  first_stamp_ = first_stamp_.value_or(stamp);
  const double time = stamp - *first_stamp_ + stamp_tolerance;
  past_end_ = past_end_ || (range_.end != 0 && time >= range_.end);
  const auto first = static_cast<std::size_t>(range_.skip_first_n);
  return !past_end_ && index >= first && (index - first) % every_n_ == 0 && time >= range_.start;
}
}  // namespace dyslam

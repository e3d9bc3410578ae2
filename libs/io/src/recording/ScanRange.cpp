// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/io/ScanRange.h>

#include <algorithm>
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

bool ScanRange::isAll() const
{
  return skip_first_n == 0 && only_first_n == 0 && start == 0 && end == 0;
}

std::string ScanRange::flags() const
{
  std::ostringstream text;
  text.precision(15);
  const auto add = [&text](const char* flag, double value)
  {
    if (value != 0)
    {
      text << (text.tellp() > 0 ? " " : "") << flag << " " << value;
    }
  };
  add("--skip-first-n", skip_first_n);
  add("--only-first-n", only_first_n);
  add("--start", start);
  add("--end", end);
  return text.str();
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
  time_ = stamp - *first_stamp_ + stamp_tolerance;
  past_end_ = past_end_ || (range_.end != 0 && time_ >= range_.end);
  const auto first = static_cast<std::size_t>(range_.skip_first_n);
  past_start_ = past_start_ || time_ >= range_.start;  // for good: clocks may be set back
  const bool takes = !past_end_ && past_start_ && index >= first && (index - first) % every_n_ == 0;
  if (takes && !begin_)
  {
    begin_ = time_;
  }
  return takes;
}

double ScanSelection::progress(double read, std::size_t used)
{
  if (!begin_)
  {
    return 0;
  }
  const bool passes_over = range_.skip_first_n > 0 || range_.start > 0;
  passed_over_ = passed_over_.value_or(passes_over ? read : 0);
  double done = *passed_over_ < 1 ? (read - *passed_over_) / (1 - *passed_over_) : 1;
  if (range_.end != 0)
  {
    done = std::max(done, (time_ - *begin_) / (range_.end - *begin_));
  }
  if (range_.only_first_n > 0)
  {
    done = std::max(done, static_cast<double>(used) / range_.only_first_n);
  }
  return std::clamp(done, 0.0, 1.0);
}

std::string ScanSelection::reasonForNone(std::size_t scans, double duration) const
{
  std::ostringstream text;
  const char* separator = "";
  if (range_.skip_first_n > 0)
  {
    text << "skip_first_n = " << range_.skip_first_n;
    separator = ", ";
  }
  if (range_.start > 0)
  {
    text << separator << "start = " << range_.start << " s";
    separator = ", ";
  }
  if (range_.end > 0)
  {
    text << separator << "end = " << range_.end << " s";
  }
  text << (text.tellp() > 0 ? ": " : "") << "no scan is left";
  if (!past_end_)
  {
    text << "; the file has " << counted(scans, "scan");
    if (range_.start > 0)
    {
      text << ", the last " << duration << " s after the first";
    }
  }
  return text.str();
}
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#include "MotionSampleWriter.h"

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr double largest_age = 0.25;      //!< of a sample at a scan, as motion_sensors.max_gap [s]
constexpr double largest_age_of_fix = 5;  //!< receivers may be slow, and no scan waits for them [s]

double stampOf(const std::variant<ImuSample, WheelSample, GnssFix>& sample)
{
  return std::visit([](const auto& one) { return one.stamp; }, sample);
}
}  // namespace

void MotionSampleWriter::push(const Sample& sample)
{
  waiting_.push_back(sample);
  if (waiting_.size() > most)
  {
    waiting_.pop_front();
  }
}

template <typename OneSample>
bool MotionSampleWriter::hasFrom(double stamp) const
{
  return std::any_of(waiting_.rbegin(), waiting_.rend(),
                     [stamp](const Sample& sample)
                     {
                       return std::holds_alternative<OneSample>(sample) &&
                              stampOf(sample) >= stamp && stampOf(sample) <= stamp + memory;
                     });
}

bool MotionSampleWriter::hasImuFrom(double stamp) const
{
  return hasFrom<ImuSample>(stamp);
}

bool MotionSampleWriter::hasWheelsFrom(double stamp) const
{
  return hasFrom<WheelSample>(stamp);
}

void MotionSampleWriter::writeUpTo(double stamp, ConversionOutput& out)
{
  dropBefore(last_scan_.value_or(stamp) - memory);
  const auto due =
      std::stable_partition(waiting_.begin(), waiting_.end(),
                            [stamp](const Sample& sample) { return stampOf(sample) > stamp; });
  std::stable_sort(due, waiting_.end(),
                   [](const Sample& a, const Sample& b) { return stampOf(a) < stampOf(b); });
  std::for_each(due, waiting_.end(), [&](const Sample& sample) { write(sample, out); });
  waiting_.erase(due, waiting_.end());
  for (Written* written : {&imu_, &wheels_})
  {
    written->scans += stamp - written->newest <= largest_age ? 1 : 0;
  }
  gnss_.scans += stamp - gnss_.newest <= largest_age_of_fix ? 1 : 0;
  last_scan_ = stamp;
}

void MotionSampleWriter::write(const Sample& sample, ConversionOutput& out)
{
  std::visit([&out](const auto& one) { out.write(one); }, sample);
  Written& written = writtenOf(sample);
  ++written.samples;
  written.newest = std::max(written.newest, stampOf(sample));
}

MotionSampleWriter::Written& MotionSampleWriter::writtenOf(const Sample& sample)
{
  return std::holds_alternative<ImuSample>(sample)     ? imu_
         : std::holds_alternative<WheelSample>(sample) ? wheels_
                                                       : gnss_;
}

void MotionSampleWriter::skip(double stamp)
{
  if (!last_scan_)
  {
    dropBefore(stamp - memory);
  }
}

void MotionSampleWriter::dropBefore(double stamp)
{
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(),
                                [stamp](const Sample& sample) { return stampOf(sample) < stamp; }),
                 waiting_.end());
}
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/MotionSamples.h>

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <variant>

#include "ConversionOutput.h"

namespace dyslam
{
/** Writes the samples of IMU, wheel odometry and satellite receiver to the rawlog, each before the
 * first scan that is not older. They may be added in any order, as a bag has them; between two
 * scans they are written in order of time. */
class MotionSampleWriter
{
 public:
  static constexpr std::size_t most = 20000;  //!< samples that wait; of more, those added last
  static constexpr double memory = 1;         //!< how much older than its scan a sample may be [s]

  /** What was written of one sensor. */
  struct Written
  {
    std::size_t samples = 0;
    std::size_t scans = 0;  //!< with a sample from at most 0.25 s before, or a fix of 5 s
    double newest = -std::numeric_limits<double>::infinity();  //!< stamp of a sample [s]
  };

  void add(const ImuSample& sample) { push(sample); }
  void add(const WheelSample& sample) { push(sample); }
  void add(const GnssFix& fix) { push(fix); }

  /** Writes the samples up to the stamp of the scan that is written next [s], those from 1 s before
   * the first scan on. Late samples, up to 1 s older than the last scan, are written as well.
   * \throws UserError if the disk is full. */
  void writeUpTo(double stamp, ConversionOutput& out);
  /** Of a scan that is not written [s]: before the first scan that is, older samples are dropped.
   */
  void skip(double stamp);

  /** Whether a sample waits that is as new as a stamp [s], or up to 1 s newer. */
  [[nodiscard]] bool hasImuFrom(double stamp) const;
  [[nodiscard]] bool hasWheelsFrom(double stamp) const;

  [[nodiscard]] const Written& imu() const { return imu_; }
  [[nodiscard]] const Written& wheels() const { return wheels_; }
  [[nodiscard]] const Written& gnss() const { return gnss_; }

 private:
  using Sample = std::variant<ImuSample, WheelSample, GnssFix>;

  void push(const Sample& sample);
  template <typename OneSample>
  [[nodiscard]] bool hasFrom(double stamp) const;
  void dropBefore(double stamp);
  void write(const Sample& sample, ConversionOutput& out);
  [[nodiscard]] Written& writtenOf(const Sample& sample);

  std::deque<Sample> waiting_;       //!< as they were added
  std::optional<double> last_scan_;  //!< that was written [s]
  Written imu_;
  Written wheels_;
  Written gnss_;
};
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <optional>
#include <string>
#include <vector>

#include "BagOutput.h"

namespace dyslam
{
/** Messages of IMU, satellite receiver and wheels on their way into a bag, in the order of time:
 * they wait until a scan is not older. Samples before 1970, which a message cannot hold, are left
 * out. */
class SampleMessages
{
 public:
  /** Takes the samples of a frame, and places their sensors on the vehicle. */
  void take(const Frame& frame, BagOutput& bag);
  /** Writes those up to a stamp [s]. */
  void writeUpTo(double stamp, BagOutput& bag);

  /** Stamp of the oldest one [s]; nothing if none waits. */
  [[nodiscard]] std::optional<double> oldest() const
  {
    return waiting_.empty() ? std::nullopt : std::optional<double>(waiting_.front().stamp);
  }

 private:
  struct Message
  {
    double stamp = 0;  //!< [s]
    BagOutputTopic topic;
    std::string data;
  };

  void push(double stamp, const BagOutputTopic& topic, std::string data);

  std::vector<Message> waiting_;  //!< in the order of time
};
}  // namespace dyslam

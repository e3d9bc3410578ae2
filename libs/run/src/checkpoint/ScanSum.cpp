// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSum.h"

#include <dyslam/base/Bytes.h>

#include <string_view>

#include "StateFile.h"

namespace dyslam
{
void ScanSum::add(const Frame& frame)
{
  const Scan& scan = frame.scan;
  const auto number = [](const auto& value)
  { return std::string_view(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const std::string_view bytes :
       {number(frame.index), number(scan.stamp), bytesOf(scan.points), bytesOf(scan.intensity),
        bytesOf(scan.time), bytesOf(scan.ring)})
  {
    sum_ = checksum(bytes, sum_);
  }
  ++scans_;
}
}  // namespace dyslam

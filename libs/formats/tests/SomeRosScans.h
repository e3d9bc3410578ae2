// SPDX-License-Identifier: BSD-3-Clause
// A scan, the fields of its points in a message, and what is decoded of them.
#pragma once

#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "RosMessageWriters.h"
#include "SingleMessage.h"

namespace dyslam::test
{
inline constexpr double sweep_stamp = 1600000000.25;

/** Four rings of points that get farther and higher with the ring; a tenth of a second. */
inline Scan sweepOf(std::size_t columns)
{
  Scan scan;
  scan.stamp = sweep_stamp;
  for (std::size_t i = 0; i < columns; ++i)
  {
    for (std::uint16_t ring = 0; ring < 4; ++ring)
    {
      const auto angle = static_cast<float>(i) * 0.1F;
      scan.points.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), ring - 1.5F);
      scan.intensity.push_back(static_cast<float>(i % 256));
      scan.time.push_back(0.1F * static_cast<float>(i) / static_cast<float>(columns));
      scan.ring.push_back(ring);
    }
  }
  return scan;
}

inline std::vector<double> mapped(const Scan& scan, const std::function<double(std::size_t)>& value)
{
  std::vector<double> values;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    values.push_back(value(i));
  }
  return values;
}

inline std::vector<CloudField> coordinates(const Scan& scan)
{
  std::vector<CloudField> fields;
  for (const int axis : {0, 1, 2})
  {
    fields.push_back({std::string(1, "xyz"[axis]), 7,
                      mapped(scan, [&](std::size_t i) { return scan.points[i][axis]; })});
  }
  return fields;
}

inline Scan decoded(RosScanDecoder& decoder,
                    const std::vector<CloudField>& fields,
                    bool cdr = true,
                    std::uint32_t rows = 1)
{
  const std::string data = pointCloud2(cdr, sweep_stamp, fields, rows);
  return decoder.decode(topicOf(cdr, "sensor_msgs/PointCloud2"), messageOf(data));
}

inline void expectSame(const Scan& expected, const Scan& scan, double time_tolerance)
{
  EXPECT_NEAR(expected.stamp, scan.stamp, 1e-6);
  EXPECT_EQ(expected.points, scan.points);
  EXPECT_EQ(expected.intensity, scan.intensity);
  EXPECT_EQ(expected.ring, scan.ring);
  ASSERT_EQ(expected.time.size(), scan.time.size());
  for (std::size_t i = 0; i < scan.time.size(); ++i)
  {
    EXPECT_NEAR(expected.time[i], scan.time[i], time_tolerance);
  }
}
}  // namespace dyslam::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
inline Scan someScan(std::size_t number, std::size_t points)
{
  Scan scan;
  scan.stamp = 100.0 + 0.1 * static_cast<double>(number);
  for (std::size_t i = 0; i < points; ++i)
  {
    const auto value = static_cast<float>(i);
    scan.points.emplace_back(value + 0.25F, -value, static_cast<float>(number));
    scan.intensity.push_back(static_cast<float>(i % 100) / 100.0F);
  }
  scan.T_vehicle_lidar = poseFromYpr(1, 0.5, 1.7, 0.1, -0.05, 0.02);
  scan.sensor_label = "velodyne";
  return scan;
}

inline Pose somePose(std::size_t number)
{
  const auto n = static_cast<double>(number);
  return poseFromYpr(n, 0.1 * n, -0.01 * n, 0.02 * n, 0.01 * n, -0.005 * n);
}

inline std::vector<Frame> framesOf(RawlogSource& source)
{
  std::vector<Frame> frames;
  while (auto frame = source.next())
  {
    frames.push_back(std::move(*frame));
  }
  return frames;
}

inline std::vector<Frame> readAll(const std::string& path)
{
  RawlogSource source(path);
  return framesOf(source);
}

using PartStamps = std::vector<std::vector<double>>;

inline std::vector<std::vector<double>> partStamps(const std::vector<Frame>& frames)
{
  std::vector<std::vector<double>> stamps;
  for (const Frame& frame : frames)
  {
    stamps.emplace_back();
    for (const ScanPart& part : frame.scan.parts)
    {
      stamps.back().push_back(0.001 * std::round(1000 * part.stamp));
    }
  }
  return stamps;
}

/** `count` scans of 50, 51, ... points with truth. */
inline void writeScans(const std::string& path,
                       std::size_t count,
                       const RawlogWriterOptions& options = {})
{
  RawlogWriter writer(path, options);
  for (std::size_t i = 0; i < count; ++i)
  {
    writer.write(someScan(i, 50 + i), somePose(i));
  }
  writer.close();
}

/** Equal bit by bit, so that NaN equals NaN. */
inline bool samePoints(const Scan& a, const Scan& b)
{
  if (a.size() != b.size())
  {
    return false;
  }
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    if (std::memcmp(a.points[i].data(), b.points[i].data(), 3 * sizeof(float)) != 0)
    {
      return false;
    }
  }
  return true;
}
}  // namespace dyslam

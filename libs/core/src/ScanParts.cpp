// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/ScanParts.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t rings_of_lidar = 1024;

/** Appends the values of the added points to those of the first `before` points. Empty unless both
 * have values; with `fill`, missing ones are 0 if one has values. */
template <typename Value>
void appendValues(std::size_t before,
                  std::size_t added,
                  const std::vector<Value>& further,
                  bool fill,
                  std::vector<Value>& values)
{
  const bool has_before = before == 0 || values.size() == before;
  const bool has_added = further.size() == added;
  if ((has_before && has_added) || (fill && (!values.empty() || !further.empty())))
  {
    values.resize(before, Value(0));
    values.insert(values.end(), further.begin(), further.end());
    values.resize(before + added, Value(0));
  }
  else
  {
    values.clear();
  }
}

/** Index of the first point after lidar `i` of the scan; 0: the first lidar. */
std::size_t endOf(const Scan& scan, std::size_t i)
{
  return i < scan.parts.size() ? scan.parts[i].begin : scan.size();
}

LidarRange rangeOf(const Scan& scan, std::size_t i)
{
  LidarRange range;
  range.end = endOf(scan, i);
  range.T_vehicle_lidar = scan.T_vehicle_lidar;
  if (i > 0)
  {
    const ScanPart& part = scan.parts[i - 1];
    range.begin = part.begin;
    range.lidar = part.lidar;
    range.T_vehicle_lidar = scan.T_vehicle_lidar * part.T_scan_lidar;
    range.stamp = part.stamp;
  }
  return range;
}

template <typename Value>
std::vector<Value> slice(const std::vector<Value>& values,
                         const Scan& scan,
                         const LidarRange& range)
{
  return values.size() == scan.size()
             ? std::vector<Value>(values.begin() + static_cast<std::ptrdiff_t>(range.begin),
                                  values.begin() + static_cast<std::ptrdiff_t>(range.end))
             : std::vector<Value>();
}

/** Scan of lidar `i`, in its own frame. \param range its points in `scan` */
Scan partOf(const Scan& scan, std::size_t i, const LidarRange& range)
{
  Scan part;
  part.stamp = scan.stamp;
  part.sensor_label = scan.sensor_label;
  part.T_vehicle_lidar = range.T_vehicle_lidar;
  part.points = slice(scan.points, scan, range);
  part.intensity = slice(scan.intensity, scan, range);
  part.time = slice(scan.time, scan, range);
  part.ring = slice(scan.ring, scan, range);
  if (i > 0)
  {
    const Eigen::Isometry3f T = scan.parts[i - 1].T_scan_lidar.inverse().cast<float>();
    for (Eigen::Vector3f& p : part.points)
    {
      if (isReturn(p))
      {
        p = T * p;
      }
    }
  }
  return part;
}
}  // namespace

void appendScan(const Scan& further, std::size_t lidar, Scan& scan)
{
  const std::size_t before = scan.size();
  ScanPart part;
  part.begin = before;
  part.lidar = lidar;
  part.stamp = further.stamp - scan.stamp;
  part.T_scan_lidar = scan.T_vehicle_lidar.inverse() * further.T_vehicle_lidar;
  part.sensor_label = further.sensor_label;
  const Eigen::Isometry3f T = part.T_scan_lidar.cast<float>();
  scan.points.reserve(before + further.size());
  for (const Eigen::Vector3f& p : further.points)
  {
    scan.points.push_back(isReturn(p) ? Eigen::Vector3f(T * p) : p);
  }
  std::vector<float> time = further.time;
  if (!scan.time.empty())
  {
    time.resize(further.size(), 0.0F);
  }
  for (float& t : time)
  {
    t += static_cast<float>(part.stamp);
  }
  std::vector<std::uint16_t> ring = further.ring;
  for (std::uint16_t& r : ring)
  {
    r = static_cast<std::uint16_t>(r % rings_of_lidar + lidar * rings_of_lidar);
  }
  appendValues(before, further.size(), further.intensity, true, scan.intensity);
  appendValues(before, further.size(), time, false, scan.time);
  appendValues(before, further.size(), ring, false, scan.ring);
  scan.parts.push_back(part);
}

void forEachPart(const Scan& scan,
                 const std::function<void(const Scan& part, const LidarRange& range)>& use)
{
  if (scan.parts.empty())
  {
    use(scan, rangeOf(scan, 0));
    return;
  }
  for (std::size_t i = 0; i < partCount(scan); ++i)
  {
    const LidarRange range = rangeOf(scan, i);
    use(partOf(scan, i, range), range);
  }
}

Scan ownScan(const Scan& scan)
{
  return partOf(scan, 0, rangeOf(scan, 0));
}

std::vector<LidarRange> lidarRanges(const Scan& scan, const Cloud& cloud)
{
  const bool has_sources = cloud.source.size() == cloud.size();
  std::vector<LidarRange> ranges;
  for (std::size_t i = 0; i < partCount(scan); ++i)
  {
    LidarRange range = rangeOf(scan, i);
    range.begin = ranges.empty() ? 0 : ranges.back().end;
    range.end = cloud.size();
    if (has_sources && i < scan.parts.size())
    {
      const auto end =
          std::lower_bound(cloud.source.begin(), cloud.source.end(), scan.parts[i].begin);
      range.end = static_cast<std::size_t>(end - cloud.source.begin());
    }
    ranges.push_back(range);
  }
  return ranges;
}

std::size_t ownPoints(const Scan& scan, const Cloud& cloud)
{
  return scan.parts.empty() ? cloud.size() : lidarRanges(scan, cloud).front().end;
}
}  // namespace dyslam

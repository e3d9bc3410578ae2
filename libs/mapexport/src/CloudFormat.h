// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

namespace dyslam
{
/** Fields of a cloud's header that are known only at the end. */
struct CloudSummary
{
  std::uint64_t count = 0;
  /** Bounds of the coordinates relative to the origin [m]. */
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
};

/** Binary layout of a kind of cloud: a header of fixed length, then the points. */
class CloudFormat
{
 public:
  virtual ~CloudFormat() = default;
  /** Largest number of points of a file. */
  [[nodiscard]] virtual std::uint64_t maxPoints() const
  {
    return std::numeric_limits<std::uint64_t>::max();
  }
  /** Largest coordinate relative to the origin, of either sign [m]. */
  [[nodiscard]] virtual double maxCoordinate() const
  {
    return std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] virtual std::string header(const CloudSummary& summary) const = 0;
  /** Appends point `i`. \pre normals, if the layout has them */
  virtual void append(const MapPoints& points, std::size_t i, std::string& out) const = 0;
};

std::unique_ptr<CloudFormat> makePcdFormat(const CloudDescription& layout);
std::unique_ptr<CloudFormat> makePlyFormat(const CloudDescription& layout);
std::unique_ptr<CloudFormat> makeLasFormat(const CloudDescription& layout);
}  // namespace dyslam

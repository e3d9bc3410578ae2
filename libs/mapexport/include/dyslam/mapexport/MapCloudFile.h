// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace dyslam
{
/** Properties of a cloud file in addition to its points. */
struct CloudDescription
{
  bool normals = false;
  /** Origin of the map frame in the coordinates of the file [m]. */
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /** UNIX time of the recording's first scan [s], for the date in the header of a `.las`; nothing,
   * or a time before 1990: no date. */
  std::optional<double> recorded;
  /** EPSG number of the coordinate reference system, for `.las`; 0: none. */
  int epsg = 0;
};

/** A cloud that is written part by part: `.pcd`, `.ply` (both binary; x y z intensity and normals)
 * or `.las` (1.2, format 0, millimetres; normals as extra bytes).
 *
 * With an origin other than 0, `.las` and `.ply` (then in float64) hold the coordinates in full;
 * `.pcd`, whose readers expect float32, stays relative to the origin and names it as its viewpoint.
 */
class MapCloudFile
{
 public:
  /** \throws UserError for another ending, and for a file that cannot be written. */
  MapCloudFile(const std::string& path, const CloudDescription& description);
  /** File for a map frame with the origin of the file's coordinates. */
  MapCloudFile(const std::string& path, bool normals);
  ~MapCloudFile();
  MapCloudFile(const MapCloudFile&) = delete;
  MapCloudFile& operator=(const MapCloudFile&) = delete;

  /** \param points map frame [m] \throws std::invalid_argument if the file has normals and the
   * points have none; UserError if the file cannot be written, or the format does not hold so many
   * points or such coordinates. */
  void add(const MapPoints& points);
  /** Number of points added. */
  [[nodiscard]] std::size_t count() const;
  /** Completes the file; without this call there is no file. \throws UserError. */
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam

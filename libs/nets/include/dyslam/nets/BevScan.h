// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** \throws UserError naming `field` if a side of so many cells is no multiple of 16, as the
 * network's resolutions need it. */
void requireWholeCells(const std::string& field, int cells);

/** The grid seen from above in which DySeg reads scans. */
struct BevOptions : Options
{
  int cells = 512;                //!< along each side; a multiple of 16
  double cell_size = 0.2;         //!< [m]
  double ground_clearance = 0.2;  //!< m above the estimated ground below which points are ground
  double max_height = 4.5;        //!< m above ground; higher points are left out

  [[nodiscard]] float halfExtent() const { return static_cast<float>(0.5 * cells * cell_size); }
  void describe(OptionsVisitor& visitor) override;
};

/** Height of the ground around the sensor, from the points themselves.
 *
 * The lowest well-supported height in 3.2 m cells, then made consistent with the cells around:
 * roofs and walls (too high for a slope) and ghosts of mirrored beams (too low) are replaced.
 */
class BevGround
{
 public:
  /** \param points invalid ones allowed. \param reach half side of the covered square [m]. */
  explicit BevGround(const std::vector<Eigen::Vector3f>& points, float reach = 102.4F);

  /** Height of the ground under a place, in the frame of the points; 0 without any points. */
  [[nodiscard]] float heightAt(float x, float y) const;

 private:
  void makeConsistent(const std::vector<std::uint8_t>& known);

  float reach_;
  int width_;
  std::vector<float> height_;
};

/** What a scan's rays saw by direction: the nearest return in bins of azimuth and slope. */
class BevRays
{
 public:
  static constexpr int columns = 900;
  static constexpr int rows = 96;
  static constexpr int channels = 3;

  BevRays() = default;
  explicit BevRays(const std::vector<Eigen::Vector3f>& points);

  /** What this scan says about a point given in its frame: `channels` numbers.
   *
   * [0] how much farther than the point the nearest ray around it went, over 2 m, in [-1, 1];
   * [1] how far the best fitting return is from the point along the ray, over 1 m, in [0, 1];
   * [2] the share of the nine bins around that saw anything. All 0 where nothing was seen.
   */
  void compare(const Eigen::Vector3f& point, float* out) const;

 private:
  std::vector<float> range_;
};

/** A scan as DySeg's encoder reads it: points above ground, sorted by cell, with features.
 *
 * Cell (ix, iy) covers x from `corner.x() + ix * cell_size`; its number is iy * cells + ix.
 */
struct BevScan
{
  static constexpr int feature_count = 8;

  int cells = 0;
  float cell_size = 0;
  Eigen::Vector2f corner = Eigen::Vector2f::Zero();  //!< of cell 0, in the frame of the points [m]
  std::vector<Eigen::Vector3f> points;               //!< kept ones
  std::vector<float> height;                         //!< of each kept point above ground [m]
  std::vector<std::uint32_t> source;                 //!< position of each in the input
  std::vector<std::int32_t> cell;                    //!< number of each one's cell, ascending
  std::vector<float> features;                       //!< feature_count per kept point
  BevRays rays;                                      //!< of all input points

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

/** \param points sensor at the origin, z up; invalid ones are left out.
 * \param centre of the grid, in the frame of the points [m].
 * \throws UserError if an option is out of range. */
[[nodiscard]] BevScan makeBevScan(const std::vector<Eigen::Vector3f>& points,
                                  const BevOptions& options,
                                  const Eigen::Vector2f& centre = Eigen::Vector2f::Zero());
}  // namespace dyslam

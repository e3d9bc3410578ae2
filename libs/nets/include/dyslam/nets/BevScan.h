// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Checks that a grid's side can be halved four times, as the network's resolutions require.
 * \throws UserError naming `field` if `cells` is not a multiple of 16. */
void requireMultipleOf16(const std::string& field, int cells);

/** Bird's-eye-view grid of DySeg's input; ini section `[grid]` of its training. */
struct BevOptions : Options
{
  int cells = 512;                //!< number of cells along each side; a multiple of 16
  double cell_size = 0.2;         //!< side of a cell [m]
  double ground_clearance = 0.2;  //!< height above ground up to which points are ground [m]
  double max_height = 4.5;        //!< height above ground beyond which points are removed [m]

  [[nodiscard]] float halfExtent() const { return static_cast<float>(0.5 * cells * cell_size); }
  void describe(OptionsVisitor& visitor) override;
};

/** Local ground height estimated from a scan.
 *
 * The lowest sufficiently supported height in cells of 3.2 m, made consistent with the neighbouring
 * cells: roofs and walls (too steep) and multipath echoes (too low) are replaced.
 */
class BevGround
{
 public:
  /** \param points sensor frame [m]; invalid ones are ignored \param half_extent half side of the
   * covered square [m] */
  explicit BevGround(const std::vector<Eigen::Vector3f>& points, float half_extent = 102.4F);

  /** Ground height at (x, y), in the frame of the points [m]; 0 without points. */
  [[nodiscard]] float heightAt(float x, float y) const;

 private:
  void makeConsistent(const std::vector<std::uint8_t>& known);
  /** Median ground height near the sensor [m]: an error of a single first cell would propagate to
   * all others. */
  [[nodiscard]] float seedHeight(const std::vector<int>& order,
                                 const std::vector<float>& ring,
                                 const std::vector<std::uint8_t>& known) const;
  /** Collects in `around` the heights of the visited cells nearest to `cell`. */
  void collectAround(int cell,
                     const std::vector<std::uint8_t>& visited,
                     std::vector<float>& around) const;

  float half_extent_;
  int width_;
  std::vector<float> height_;
};

/** Range image for visibility tests: the nearest return per bin of azimuth and slope. */
class BevRays
{
 public:
  static constexpr int columns = 900;
  static constexpr int rows = 96;
  static constexpr int channels = 3;

  BevRays() = default;
  explicit BevRays(const std::vector<Eigen::Vector3f>& points);

  /** Visibility features of a point given in this scan's frame: `channels` numbers.
   *
   * [0] (range of the nearest neighbouring return - range of the point) / 2 m, in [-1, 1];
   * positive where the point's position was observed free;
   * [1] least range difference of a neighbouring return / 1 m, in [0, 1];
   * [2] fraction of the 3 x 3 bins with a return. All 0 without returns.
   */
  void compare(const Eigen::Vector3f& point, float* out) const;

 private:
  std::vector<float> range_;
};

/** DySeg's encoder input: points above ground, sorted by cell, with features.
 *
 * Cell (ix, iy) starts at x = `corner.x() + ix * cell_size`; its index is iy * cells + ix.
 */
struct BevScan
{
  static constexpr int feature_count = 8;

  int cells = 0;
  float cell_size = 0;
  Eigen::Vector2f corner =
      Eigen::Vector2f::Zero();          //!< corner of cell 0, in the frame of the points [m]
  std::vector<Eigen::Vector3f> points;  //!< points in the grid and above ground [m]
  std::vector<float> height;            //!< height of each point above ground [m]
  std::vector<std::uint32_t> source;    //!< index of each point in the input
  std::vector<std::int32_t> cell;       //!< cell index of each point, ascending
  std::vector<float> features;          //!< feature_count per point
  BevRays rays;                         //!< range image of all input points

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

/** \param points sensor frame, z up [m]; invalid ones are ignored \param centre centre of the grid,
 * sensor frame [m] \throws UserError if an option is out of range. */
[[nodiscard]] BevScan makeBevScan(const std::vector<Eigen::Vector3f>& points,
                                  const BevOptions& options,
                                  const Eigen::Vector2f& centre = Eigen::Vector2f::Zero());
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/dyseg/MovingSegmenter.h>

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace dyslam
{
/** Ini section `[residual]`. */
struct ResidualSegmenterOptions : Options
{
  int history = 30;  //!< age of the oldest scan that is compared [scans]
  int compared = 6;  //!< number of earlier scans that are compared
  double azimuth_bin = 0.3 * radians_per_degree;  //!< column width of the range images [rad]
  double slope_bin = 0.007;  //!< row height of the range images, height per horizontal distance
  double margin = 0.2;  //!< a moving point is nearer than the earlier range by this, at range 0 [m]
  double margin_per_range = 0.01;  //!< increase of margin with range [m/m]
  double max_range = 60;           //!< range beyond which points are static [m]
  /** Whether a ray without return above a point counts as free (sensors with few beams under open
   * sky); otherwise it does only if the returns above and below it are farther away. */
  bool open_sky = false;
  double ground_clearance = 0.15;  //!< height above the lowest point nearby of ground points [m]
  double cell_size = 0.4;  //!< side of the cells in which votes are clustered to objects [m]
  int min_points = 8;      //!< least number of points with a moving vote in a moving object
  double min_share = 0.3;  //!< least fraction of a moving object's points with a moving vote

  void describe(OptionsVisitor& visitor) override;
};

/** Moving points by visibility: a point is moving if an earlier ray passed through its position.
 *
 * Each point above ground is looked up in range images of a few earlier scans. A range shorter than
 * the earlier one by a margin votes for moving; an equal range votes, with half the weight, for
 * static (a moving object overlaps its earlier position); a longer range gives no vote, the point
 * was occluded. Votes are accumulated in connected grid cells, which rejects single noisy points.
 * Without learning, for lidars whose rings are far apart or that have none (vlp16.ini,
 * solid_state.ini). It needs poses accurate to the margin.
 */
class ResidualSegmenter : public MovingSegmenter
{
 public:
  ResidualSegmenter(const ResidualSegmenterOptions& options, ThreadPool& pool);

  [[nodiscard]] std::string name() const override { return "residual"; }
  [[nodiscard]] bool needsPose() const override { return true; }
  void segment(Frame& frame) override;
  void exchangeState(StateArchive& archive) override;

 private:
  /** Nearest range per direction of one lidar's earlier scan. */
  struct PastImage
  {
    Pose T_image_odom = Pose::Identity();  //!< image frame: the lidar's, with z upwards
    std::vector<float> range;              //!< rows x columns [m]; 0: no return
    int lowest_row = 0;  //!< first stored row: the one below the lowest row with returns
    int rows = 0;        //!< number of rows, up to the one above the highest row with returns
  };
  using PastScan = std::vector<PastImage>;  //!< one image per lidar

  [[nodiscard]] PastImage project(const Eigen::Vector3f* points,
                                  std::size_t count,
                                  const Pose& T_odom_vehicle,
                                  Pose T_vehicle_lidar) const;
  [[nodiscard]] PastScan project(const Frame& frame) const;
  /** Vote of a point in the image frame: 2 seen through, -1 occupied, 0 occluded or unknown. */
  [[nodiscard]] int vote(const PastImage& past, const Eigen::Vector3f& point) const;
  /** Vote of a scan: occupied by any of its lidars, else seen through by any of them. */
  void addVotes(const PastScan& past,
                const Frame& frame,
                const std::vector<std::uint32_t>& candidates,
                std::vector<std::int8_t>& votes);
  [[nodiscard]] std::vector<const PastScan*> comparedScans() const;

  ResidualSegmenterOptions options_;
  ThreadPool& pool_;
  float row_height_;  //!< slope of a row [m/m]
  int columns_;
  std::deque<PastScan> past_;  //!< newest first
};
}  // namespace dyslam

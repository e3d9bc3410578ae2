// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>

#include <deque>

namespace dyslam
{
struct ResidualSegmenterOptions : Options
{
  int history = 10;                  //!< how far back the oldest compared scan lies
  int compared = 4;                  //!< how many scans of the history are compared
  double azimuth_bin = 0.0069813;    //!< rad
  double elevation_bin = 0.0087266;  //!< rad
  double margin = 0.3;               //!< m, by which a point must lie before what was seen
  double margin_per_range = 0.015;   //!< m of further margin per m of range
  double max_range = 60;             //!< m, points beyond are called static
  double ground_clearance = 0.25;  //!< m above the lowest point nearby that still counts as ground
  double cell_size = 0.4;          //!< m, of the grid in which single votes become objects
  int min_points = 8;              //!< in a moving object
  double min_share = 0.5;          //!< of an object's points that must have voted moving

  void describe(OptionsVisitor& visitor) override;
};

/** Moving points by seeing through: a point where an earlier ray went on freely has come there
 * since.
 *
 * Each point is looked up in range images of a few earlier scans. Nearer than what was seen there,
 * by a margin, votes for moving; the same range votes for static; farther says nothing, it was
 * hidden. Votes are gathered in connected grid cells above ground, so that single noisy points do
 * not count. No learning: this is the baseline that a network has to beat. It needs poses good to
 * the margin.
 */
class ResidualSegmenter : public MovingSegmenter
{
 public:
  ResidualSegmenter(const ResidualSegmenterOptions& options, ThreadPool& pool);

  [[nodiscard]] std::string name() const override { return "residual"; }
  [[nodiscard]] bool needsPose() const override { return true; }
  void segment(Frame& frame) override;
  void reset() override { past_.clear(); }

 private:
  /** Nearest range per direction as one earlier scan saw it. */
  struct PastScan
  {
    Pose T_lidar_odom = Pose::Identity();
    std::vector<float> range;  //!< rows x columns [m]; 0 where nothing was seen
  };

  [[nodiscard]] PastScan project(const Frame& frame) const;
  /** +1 seen through, -1 seen there, 0 hidden or unknown. */
  [[nodiscard]] int vote(const PastScan& past, const Eigen::Vector3f& point) const;
  [[nodiscard]] std::vector<const PastScan*> comparedScans() const;

  ResidualSegmenterOptions options_;
  ThreadPool& pool_;
  int rows_;
  int columns_;
  std::deque<PastScan> past_;  //!< newest first
};
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/core/PoseGaussNewton.h>
#include <dyslam/core/VoxelGrid.h>

#include "LoamFeatures.h"
#include "ScanToScan.h"

namespace dyslam
{
/** LOAM: registers edge and plane points to the previous scan and, with mapping, to a local map. */
class LoamMatcher final : public ScanToScan
{
 public:
  LoamMatcher(bool mapping, const LoamOptions& options, ThreadPool& pool)
      : mapping_(mapping), options_(options), pool_(pool)
  {
  }
  [[nodiscard]] std::string name() const override { return mapping_ ? "loam" : "loam_no_mapping"; }

 protected:
  std::string extract(const Frame& frame) override;
  MotionEstimate align(const Pose& T_reference_current_guess) override;
  void accept(const Pose& T_reference_current) override;
  void exchangeReference(StateArchive& archive) override;

 private:
  /** Target points of one kind of feature. */
  struct Target
  {
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint16_t> rings;  //!< ring of each point; empty for a map
    KdTree tree;

    void set(const std::vector<LoamPoint>& features);
    void exchangeState(StateArchive& archive);
  };
  /** Map points of one kind, one per cube. */
  struct FeatureMap
  {
    Target target;
    void add(const std::vector<LoamPoint>& features, const Pose& T, double size, double radius);
  };

  /** Adds the residual of an edge point and the line through two edge points of the reference. */
  void addEdgeRow(const LoamPoint& f,
                  const Pose& T,
                  double gate,
                  NormalEquations& sums,
                  std::vector<Neighbour>& found) const;
  /** Adds the residual of a plane point and the plane through three points of the reference. */
  void addPlaneRow(const LoamPoint& f,
                   const Pose& T,
                   double gate,
                   NormalEquations& sums,
                   std::vector<Neighbour>& found) const;
  [[nodiscard]] MotionEstimate toScan(const Pose& T_guess);
  [[nodiscard]] MotionEstimate toMap(const Pose& T_guess);
  /** Registers all features. \param start_gate, end_gate largest distance of correspondences at the
   * start and at the end [m] */
  [[nodiscard]] MotionEstimate alignFeatures(const RowMatcher& match,
                                             const Pose& T_guess,
                                             double start_gate,
                                             double end_gate);

  bool mapping_;
  LoamOptions options_;
  ThreadPool& pool_;
  LoamFeatures features_;  //!< features of the frame
  Target edges_;           //!< edge points of the reference
  Target planes_;
  FeatureMap edge_map_;
  FeatureMap plane_map_;
  Pose T_map_reference_ = Pose::Identity();
};
}  // namespace dyslam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "SurfaceMap.h"

namespace dyslam
{
/** Points of one scan as measured, before deskewing. */
struct RawPoints
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame at the moment of measurement [m]
  std::vector<float> phase;             //!< as Cloud::phase; empty if there is nothing to deskew
  std::vector<float> weight;            //!< in [0, 1]; empty for 1

  [[nodiscard]] std::size_t size() const { return points.size(); }
  void clear();
  /** All points in the vehicle frame at the stamp, if the vehicle moves by `T_sweep`. */
  void deskewed(const Pose& T_sweep, ThreadPool& pool, std::vector<Eigen::Vector3f>& result) const;
};

struct ScanToMapSettings
{
  bool distributions = false;  //!< distribution to distribution instead of point to plane
  double start_kernel = 0.5;   //!< [m]
  double kernel = 0.05;        //!< [m]
  int max_iterations = 20;
  std::optional<Pose> T_prior;                  //!< expected pose; the start if there is none
  Matrix6 prior_information = Matrix6::Zero();  //!< of log(T_prior^-1 T) [1/m^2, 1/rad^2]
  double correlated_points = 1;
  double level_share = 1e9;  //!< see RefineOptions
};

struct ScanToMapResult
{
  Pose T = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  //!< of the points alone, of log(T_measured^-1 T)
  int iterations = 0;
  std::size_t inliers = 0;
  double inlier_share = 0;                 //!< of the weight of all points
  double rmse = 0;                         //!< of the inliers [m]
  Vector6 prior_weight = Vector6::Ones();  //!< what the prior still counted in the end
  bool settled = false;
};

/** Robust Gauss-Newton of one scan against a SurfaceMap; keeps its working memory. */
class ScanToMap
{
 public:
  explicit ScanToMap(ThreadPool& pool) : pool_(pool) {}

  /** \param T_before pose of the frame before: the motion since then deskews the points
   *  \param shapes covariances of the points in the vehicle frame, for distributions only */
  ScanToMapResult align(const RawPoints& scan,
                        const std::vector<Eigen::Matrix3f>& shapes,
                        const SurfaceMap& map,
                        const Pose& T_before,
                        const Pose& T_guess,
                        const ScanToMapSettings& settings);

 private:
  struct Match
  {
    Eigen::Vector3f at;  //!< where the surface was read
    Surface surface;
    float offset = 0;  //!< of the plane along its normal
    float weight = 0;
  };
  struct NormalEquations
  {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    double weight = 0;

    void add(const NormalEquations& other, double share = 1);
  };
  struct Sums
  {
    NormalEquations upright;  //!< all surfaces but level ones
    NormalEquations level;
    double error = 0;
    double weight = 0;
    double agreeing = 0;
    std::size_t inliers = 0;

    void add(const Sums& other);
    /** All together, level surfaces with at most `level_share` times the others' weight,
     * but with a fifth of their own at least. */
    [[nodiscard]] NormalEquations balanced(double level_share) const;
  };
  struct Iteration
  {
    Pose T_motion;  //!< since the frame before
    Eigen::Matrix3f R;
    Eigen::Vector3f t;
    VoxelCell base;
    float kernel = 0;
    bool distributions = false;
  };

  void refresh(Match& match,
               const Eigen::Vector3f& q,
               const SurfaceMap& map,
               const VoxelCell& base) const;
  void accumulate(const RawPoints& scan,
                  const std::vector<Eigen::Matrix3f>& shapes,
                  const SurfaceMap& map,
                  const Iteration& iteration,
                  Sums& total);

  ThreadPool& pool_;
  std::vector<Match> matches_;
  std::vector<Sums> parts_;
};
}  // namespace dyslam

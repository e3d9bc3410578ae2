// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/PoseGaussNewton.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "ScanSample.h"
#include "SurfacePyramid.h"

namespace dyslam
{
struct ScanToMapSettings
{
  bool distributions = false;     //!< distribution to distribution instead of point to plane
  double start_loss_width = 0.5;  //!< [m]
  double loss_width = 0.05;       //!< [m]
  int max_iterations = 20;
  std::optional<Pose> T_prior;                  //!< of the pose; the guess if there is none
  Matrix6 prior_information = Matrix6::Zero();  //!< of log(T_prior^-1 T) [1/m^2, 1/rad^2]
  double points_per_measurement = 1;
  /** Positions of the lidars, by RawPoints::lidar; vehicle frame [m]. */
  std::vector<Eigen::Vector3f> lidars = {Eigen::Vector3f::Zero()};
  /** Sine of the angle between ray and surface; below, the surface may be a single ring's. */
  double min_incidence = 0;
  double max_ground_weight_ratio = 1e9;  //!< see RefineOptions
};

struct ScanToMapResult
{
  Pose T = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  //!< of the points alone, of log(T_measured^-1 T)
  int iterations = 0;
  std::size_t inliers = 0;
  double inlier_share = 0;   //!< weight of the inliers over that of all points
  double surface_share = 0;  //!< weight of the points with a surface in the map over that of all
  double inlier_ratio = 0;   //!< weight of the inliers over that of those points
  double rmse = 0;           //!< of the inliers [m]
  Vector6 prior_weight = Vector6::Ones();  //!< final robust weight of the prior
  bool converged = false;
  bool finite = true;  //!< false after a step that was not: T is of the iteration before
};

/** Robust Gauss-Newton of one scan against a SurfacePyramid; keeps its working memory. */
class ScanToMap
{
 public:
  explicit ScanToMap(ThreadPool& pool) : pool_(pool) {}

  /** \param T_before pose of the frame before: the motion since then deskews the points
   *  \param shapes covariances of the points in the vehicle frame, for distributions only */
  ScanToMapResult align(const RawPoints& scan,
                        const std::vector<Eigen::Matrix3f>& shapes,
                        const SurfacePyramid& map,
                        const Pose& T_before,
                        const Pose& T_guess,
                        const ScanToMapSettings& settings);

 private:
  struct Match
  {
    Eigen::Vector3f looked_up_at;  //!< relative to the base [m]
    Surface surface;
    float offset = 0;  //!< of the plane along its normal, from the base [m]
    float weight = 0;  //!< 0 where there is no surface to compare with
  };
  struct Sums
  {
    NormalEquations ground;
    NormalEquations others;     //!< all surfaces but the ground's
    double error = 0;           //!< weighted squared residuals of the inliers [m^2]
    double weight = 0;          //!< of all points
    double matched_weight = 0;  //!< of the points with a surface in the map
    double inlier_weight = 0;   //!< robust weight of the inliers
    std::size_t inliers = 0;

    void add(const Sums& other);
    /** Sum of both, ground surfaces with at most `max_ground_weight_ratio` times the others'
     * weight, but with a fifth of their own at least. */
    [[nodiscard]] NormalEquations balanced(double max_ground_weight_ratio) const;
  };
  struct Iteration
  {
    Pose T_motion;  //!< since the frame before
    Eigen::Matrix3f R;
    Eigen::Vector3f t;
    SurfacePyramid::Base base;
    std::vector<Eigen::Vector3f> lidars;  //!< positions relative to the base [m]
    float min_incidence = 0;
    float loss_width = 0;
    bool distributions = false;
  };

  /** \param q point relative to the base [m] \param lidar position of its lidar, as `q` */
  void refresh(Match& match,
               const Eigen::Vector3f& q,
               const Eigen::Vector3f& lidar,
               const SurfacePyramid& map,
               const Iteration& iteration) const;
  static void addPlaneRow(const Match& match,
                          const Eigen::Vector3f& p,
                          float r,
                          const Eigen::Matrix3f& R,
                          double weight,
                          NormalEquations& equations);
  static void addDistributions(const Match& match,
                               const Eigen::Vector3f& p,
                               const Eigen::Vector3f& q,
                               const Eigen::Matrix3f& shape,
                               const Eigen::Matrix3f& R,
                               double weight,
                               NormalEquations& equations);
  void accumulate(const RawPoints& scan,
                  const std::vector<Eigen::Matrix3f>& shapes,
                  const SurfacePyramid& map,
                  const Iteration& iteration,
                  Sums& total);

  ThreadPool& pool_;
  std::vector<Match> matches_;
  std::vector<Sums> parts_;
};
}  // namespace dyslam

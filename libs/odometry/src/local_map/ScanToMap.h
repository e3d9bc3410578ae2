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
  double start_loss_width = 0.5;  //!< initial width of the robust loss [m]
  double loss_width = 0.05;       //!< final width of the robust loss [m]
  int max_iterations = 20;
  std::optional<Pose> T_prior;                  //!< prior of the pose; nothing: the guess
  Matrix6 prior_information = Matrix6::Zero();  //!< about log(T_prior^-1 T) [1/m^2, 1/rad^2]
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
  Matrix6 information = Matrix6::Zero();  //!< by the points only, about log(T_measured^-1 T)
  int iterations = 0;
  std::size_t inliers = 0;
  double inlier_share = 0;   //!< ratio of the weight of inliers to all points'
  double surface_share = 0;  //!< ratio of the weight of points with a surface to all points'
  double inlier_ratio = 0;   //!< ratio of the weight of inliers to points' with a surface
  double rmse = 0;           //!< RMS residual of the inliers [m]
  Vector6 prior_weight = Vector6::Ones();  //!< final robust weight of the prior
  bool converged = false;
  bool finite = true;  //!< false: a step was not finite, T is of the iteration before
};

/** Registers a scan to a SurfacePyramid by robust Gauss-Newton; keeps its buffers. */
class ScanToMap
{
 public:
  explicit ScanToMap(ThreadPool& pool) : pool_(pool) {}

  /** \param T_before pose of the previous frame: the motion since then deskews the points
   *  \param shapes covariances of the points in the vehicle frame, only for distributions */
  ScanToMapResult align(const RawPoints& scan,
                        const std::vector<Eigen::Matrix3f>& shapes,
                        const SurfacePyramid& map,
                        const Pose& T_before,
                        const Pose& T_guess,
                        const ScanToMapSettings& settings);

 private:
  /** The surface of a point, kept while the point moves little. */
  struct Match
  {
    Eigen::Vector3f looked_up_at;  //!< position of the look-up, relative to the base [m]
    Surface surface;
    float offset = 0;  //!< distance of the plane from the base, along its normal [m]
    float weight = 0;  //!< weight of the match; 0: no surface
  };
  /** Sums over points, by the weights of the robust loss. */
  struct Sums
  {
    NormalEquations ground;
    NormalEquations others;     //!< rows of all surfaces except the ground
    double error = 0;           //!< sum of weighted squared residuals of the inliers [m^2]
    double weight = 0;          //!< weight of all points
    double matched_weight = 0;  //!< weight of the points with a surface in the map
    double inlier_weight = 0;   //!< robust weight of the inliers
    std::size_t inliers = 0;

    void add(const Sums& other);
    /** Sum of ground and others; the weight of the ground is limited to `max_ground_weight_ratio`
     * times the others' weight, but not below a fifth of its own. */
    [[nodiscard]] NormalEquations balanced(double max_ground_weight_ratio) const;
  };
  /** What one Gauss-Newton iteration reads. */
  struct Iteration
  {
    Pose T_motion;      //!< motion since the previous frame
    Eigen::Matrix3f R;  //!< rotation of the estimate
    Eigen::Vector3f t;  //!< translation of the estimate from the base [m]
    SurfacePyramid::Base base;
    std::vector<Eigen::Vector3f> lidars;  //!< positions relative to the base [m]
    float min_incidence = 0;
    float loss_width = 0;
    bool distributions = false;

    /** \param T estimate \param T_before pose of the previous frame
     *  \param lidars_of_vehicle ScanToMapSettings::lidars */
    void setPose(const Pose& T,
                 const Pose& T_before,
                 const std::vector<Eigen::Vector3f>& lidars_of_vehicle);
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
  /** Gauss-Newton step from sums at result.T and prior. Writes what the sums say to the result. */
  [[nodiscard]] static Vector6 solve(const Sums& sums,
                                     const ScanToMapSettings& settings,
                                     const Pose& T_prior,
                                     ScanToMapResult& result);

  ThreadPool& pool_;
  std::vector<Match> matches_;
  std::vector<Sums> parts_;
};
}  // namespace dyslam

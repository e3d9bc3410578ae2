// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/LocalMapRefinement.h>

namespace dyslam
{
void RefineOptions::describe(OptionsVisitor& v)
{
  v.choice("method", method,
           {{"none", RefineMethod::none},
            {"point_to_plane", RefineMethod::point_to_plane},
            {"gicp", RefineMethod::gicp}},
           "registration to the local map");
  v.real("voxel_size", voxel_size, 0.05, 10, "side of the map's cells [m]");
  v.real("sample_voxel_size", sample_voxel_size, 0.05, 20, "spacing of the registered points [m]");
  v.integer("max_points", max_points, 100, 1000000, "cap on registered points per scan");
  v.real("map_radius", map_radius, 5, 1000, "farther map cells are dropped [m]");
  v.integer("max_iterations", max_iterations, 1, 200, "of the registration");
}

struct LocalMapRefinement::State
{
  RefineOptions options;
  ThreadPool& pool;
  Pose T_odom_vehicle = Pose::Identity();
};

LocalMapRefinement::LocalMapRefinement(const RefineOptions& options, ThreadPool& pool)
    : state_(new State{options, pool, Pose::Identity()})
{
  validate(options, "refine");
}
LocalMapRefinement::~LocalMapRefinement() = default;
LocalMapRefinement::LocalMapRefinement(LocalMapRefinement&&) noexcept = default;

RefineResult LocalMapRefinement::refine(const Frame& frame, const Pose& T_odom_vehicle_guess)
{
  RefineResult result;
  result.motion = frame.odometry;
  result.motion.T_previous_current = state_->T_odom_vehicle.inverse() * T_odom_vehicle_guess;
  result.T_odom_vehicle = T_odom_vehicle_guess;
  state_->T_odom_vehicle = T_odom_vehicle_guess;
  return result;
}

const Pose& LocalMapRefinement::pose() const
{
  return state_->T_odom_vehicle;
}
std::vector<Eigen::Vector3f> LocalMapRefinement::mapPoints() const
{
  return {};
}
void LocalMapRefinement::reset()
{
  state_->T_odom_vehicle = Pose::Identity();
}
}  // namespace dyslam

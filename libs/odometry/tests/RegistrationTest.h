// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the registration share.
#pragma once

#include <dyslam/odometry/LocalMapRegistration.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "TestScene.h"

namespace dyslam::test
{
/** A test of both methods of registration. */
class RegistrationTest : public testing::TestWithParam<RefineMethod>
{
 protected:
  [[nodiscard]] static RefineOptions options()
  {
    RefineOptions o;
    o.method = GetParam();
    o.sample_size = 0.5;
    return o;
  }

  StreetScene scene_;
  ThreadPool pool_{2};
};

inline std::string methodName(const testing::TestParamInfo<RefineMethod>& test_info)
{
  return test_info.param == RefineMethod::gicp ? "gicp" : "point_to_plane";
}

/** Registers a frame and adds it to the map, as the odometry does where nothing moves. */
inline RegistrationResult step(LocalMapRegistration& registration,
                               const Frame& frame,
                               const Pose& guess,
                               std::optional<double> initial_sigma = {})
{
  LocalMapRegistration::Alignment alignment =
      registration.align(frame, guess, nullptr, initial_sigma);
  const RegistrationResult result = alignment.result();
  registration.commit(std::move(alignment), frame);
  return result;
}

/** The frame with its points where the map has nothing. */
inline Frame inTheAir(Frame frame)
{
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    p.z() += 40;
  }
  return frame;
}

/** A drive along a bend, every frame skewed by its own motion. */
inline std::vector<Pose> drive(int frames)
{
  std::vector<Pose> poses{Pose::Identity()};
  for (int i = 1; i < frames; ++i)
  {
    poses.push_back(poses.back() * poseFromYpr(0.8, 0.02, 0, 0.8 * degree, 0, 0));
  }
  return poses;
}
}  // namespace dyslam::test

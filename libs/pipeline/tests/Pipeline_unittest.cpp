// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/pipeline/Pipeline.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <vector>

namespace dyslam
{
namespace
{
/** A frame `dt` seconds after the previous one, deskewed for a vehicle at 5 m/s. */
Frame deskewedFrame(double dt)
{
  Frame frame;
  frame.dt = dt;
  frame.cloud.points = {{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}};
  const auto half_sweep = static_cast<float>(0.05 / dt);
  frame.cloud.phase = {-half_sweep, 0, half_sweep};
  frame.cloud.phase_unit = dt;
  frame.cloud.T_sweep.translation().x() = 5 * dt;
  return frame;
}

/** A prediction covers two seconds of a longer gap: the velocity is not its motion over the gap. */
TEST(Pipeline, DeskewsByTheMotionUnlessThatIsAPredictionOverALongGap)
{
  const Config config;
  ConfigLoader loader(config);
  mrpt::system::CTimeLogger times(false, "test");
  Pipeline pipeline(loader, times);
  for (const bool registered : {true, false})
  {
    for (const double dt : {0.1, 10.0})
    {
      Frame frame = deskewedFrame(dt);
      const std::vector<Eigen::Vector3f> before = frame.cloud.points;
      frame.motion.T_previous_current.translation().x() = dt;
      frame.motion.status = registered ? MotionStatus::converged : MotionStatus::not_found;
      pipeline.deskew(frame);
      if (registered || dt < 1)
      {
        EXPECT_NEAR(frame.cloud.points[0].x(), 10.2F, 1e-4F) << registered << " " << dt;
        EXPECT_NEAR(frame.cloud.points[2].x(), -10.2F, 1e-4F) << registered << " " << dt;
      }
      else
      {
        EXPECT_EQ(frame.cloud.points, before);
      }
    }
  }
}

/** Of a live sensor, also before its rate is known. */
TEST(Pipeline, ScansAreProcessedThoughTheClockIsSetBack)
{
  constexpr std::size_t scans = 20;
  for (const std::size_t first_after : {1U, 3U, 12U})
  {
    const Config config;
    ConfigLoader loader(config);
    mrpt::system::CTimeLogger times(false, "test");
    Pipeline pipeline(loader, times);
    double time = 0;
    for (std::size_t i = 0; i < scans; ++i)
    {
      Frame frame;
      frame.index = i;
      frame.scan.points = {{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}};
      frame.scan.stamp = 100 + 0.1 * static_cast<double>(i) - (i < first_after ? 0 : 20);
      pipeline.process(frame);
      EXPECT_GT(frame.time(), time) << i;
      time = frame.time();
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.trajectory().size(), scans);
  }
}
}  // namespace
}  // namespace dyslam

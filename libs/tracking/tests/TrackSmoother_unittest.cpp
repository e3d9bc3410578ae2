// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/TrackSmoother.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** A body on a circle of 20 m at 8 m/s, ten states a second. */
TrackState onCircle(double time)
{
  const double rate = 8.0 / 20.0;
  TrackState state;
  state.time = time;
  state.centre = {20 * std::sin(rate * time), 20 - 20 * std::cos(rate * time), 1};
  state.velocity = {8 * std::cos(rate * time), 8 * std::sin(rate * time), 0};
  return state;
}

std::vector<TrackState> circle(int count)
{
  std::vector<TrackState> track;
  for (int i = 0; i < count; ++i)
  {
    track.push_back(onCircle(0.1 * i));
  }
  return track;
}

double rmsError(const std::vector<TrackState>& track)
{
  double sum = 0;
  for (const TrackState& state : track)
  {
    sum += (state.centre - onCircle(state.time).centre).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(track.size()));
}

TEST(TrackSmoother, NoiseIsReducedAndOutliersHaveNoInfluence)
{
  auto track = circle(80);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.2);
  for (TrackState& state : track)
  {
    state.centre += Eigen::Vector3d(noise(random), noise(random), 0);
    state.velocity.setZero();
  }
  const double before = rmsError(track);
  track[40].centre.x() += 3;
  track[41].centre.x() += 3;
  const auto smooth = smoothTrack(track, {});
  EXPECT_LT(rmsError(smooth), 0.5 * before);
  EXPECT_LT((smooth[40].centre - onCircle(4.0).centre).norm(), 0.3);
  for (std::size_t i = 5; i + 5 < smooth.size(); ++i)
  {
    EXPECT_LT((smooth[i].velocity - onCircle(smooth[i].time).velocity).norm(), 1.0) << i;
  }
}

TEST(TrackSmoother, MotionsOfTheDegreeStayAsTheyAre)
{
  std::vector<TrackState> track;
  for (int i = 0; i < 30; ++i)
  {
    const double t = 0.1 * i;
    TrackState state;
    state.time = t;
    state.centre = {3 * t - 0.5 * t * t, 2 + t, 0.5};
    track.push_back(state);
  }
  const auto smooth = smoothTrack(track, {});
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    EXPECT_LT((smooth[i].centre - track[i].centre).norm(), 1e-9);
    EXPECT_NEAR(smooth[i].velocity.x(), 3 - track[i].time, 1e-8);
    EXPECT_NEAR(smooth[i].velocity.y(), 1, 1e-8);
  }
}

TEST(TrackSmoother, PredictedStatesFollowTheObservationsAroundThem)
{
  auto track = circle(60);
  for (std::size_t i = 30; i < 33; ++i)
  {
    track[i].observed = false;
    track[i].centre.y() += 2;
  }
  const auto smooth = smoothTrack(track, {});
  EXPECT_LT(rmsError(smooth), 0.1);
}

TEST(TrackSmoother, FewObservationsLowerTheDegree)
{
  TrackSmoothingOptions options;
  EXPECT_TRUE(smoothTrack({}, options).empty());
  const auto one = smoothTrack(circle(1), options);
  EXPECT_LT((one[0].centre - onCircle(0).centre).norm(), 1e-12);
  // Farther from all observations than the window: as the tracker predicted it.
  auto track = circle(2);
  track[1].time = 5;
  track[1].observed = false;
  EXPECT_EQ(smoothTrack(track, options)[1].centre, track[1].centre);
}

/** A slow sensor, or the scan between two gaps: one observation does not tell the velocity. */
TEST(TrackSmoother, LoneObservationsKeepTheTrackersVelocity)
{
  std::vector<TrackState> track;
  for (int i = 0; i < 5; ++i)
  {
    track.push_back(onCircle(2.0 * i));
  }
  const auto smooth = smoothTrack(track, {});
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    EXPECT_EQ(smooth[i].centre, track[i].centre) << i;
    EXPECT_EQ(smooth[i].velocity, track[i].velocity) << i;
  }
  // A predicted state a second after the only observation around it is not drawn back to it.
  track.resize(2);
  track[1] = onCircle(1.0);
  track[1].observed = false;
  const auto after = smoothTrack(track, {});
  EXPECT_LT((after[1].centre - track[0].centre - track[1].velocity).norm(), 1e-9);
  EXPECT_EQ(after[1].velocity, track[1].velocity);
}

TEST(TrackSmoother, DegreeZeroKeepsTheVelocitiesAndDoesNotLag)
{
  auto track = circle(60);
  TrackSmoothingOptions options;
  options.window = 0.5;
  options.degree = 0;
  const auto smooth = smoothTrack(track, options);
  EXPECT_LT(rmsError(smooth), 0.2);  // 1.6 m at the ends if the observations were not moved
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    EXPECT_EQ(smooth[i].velocity, track[i].velocity) << i;
  }
}

TEST(TrackSmoother, NoWindowChangesNothingAndTimesMustIncrease)
{
  TrackSmoothingOptions options;
  options.window = 0;
  auto track = circle(5);
  track[2].centre.x() = 7;
  EXPECT_EQ(smoothTrack(track, options)[2].centre.x(), 7);
  track[2].time = track[1].time;
  EXPECT_THROW((void)smoothTrack(track, options), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam

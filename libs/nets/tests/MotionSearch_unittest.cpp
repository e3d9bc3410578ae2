// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/MotionSearch.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using dyslam::MotionSearchResult;
using dyslam::PlanarMotion;

constexpr int radius = 5;
constexpr int side = 2 * radius + 1;
constexpr float size = 0.8F;

/** Windows of randomly placed cells. */
struct Cells
{
  std::vector<Eigen::Vector2f> positions;
  std::vector<float> trust;
  std::vector<float> probability;
  std::mt19937 random{3};

  /** Adds a cell whose window peaks at the motion. \param open leaves x ambiguous, as a guard rail
   * does */
  void add(const PlanarMotion& motion, bool open, float trusted)
  {
    std::uniform_real_distribution<float> place(-45, 45);
    positions.emplace_back(place(random), place(random));
    trust.push_back(trusted);
    const Eigen::Vector2f flow = motion.flowAt(positions.back()) / size;
    std::vector<float> window;
    double sum = 0;
    for (int y = -radius; y <= radius; ++y)
    {
      for (int x = -radius; x <= radius; ++x)
      {
        const float dx = open ? 0 : static_cast<float>(x) - flow.x();
        const float dy = static_cast<float>(y) - flow.y();
        window.push_back(std::exp(-1.5F * (dx * dx + dy * dy)));
        sum += static_cast<double>(window.back());
      }
    }
    for (const float w : window)
    {
      probability.push_back(w / static_cast<float>(sum));
    }
  }
  [[nodiscard]] MotionSearchResult voted(const PlanarMotion& centre) const
  {
    return dyslam::searchMotion({probability.data(), radius, size, positions, trust}, centre, 0.02,
                                3);
  }
  [[nodiscard]] PlanarMotion vote(const PlanarMotion& centre) const { return voted(centre).motion; }
};

PlanarMotion motionOf(double x, double y, double yaw)
{
  PlanarMotion m;
  m.translation = {x, y};
  m.yaw = yaw;
  return m;
}

TEST(MotionSearchResult, FindsAMotionWithSubcellAccuracy)
{
  const auto truth = motionOf(-1.9, 0.3, 0.031);
  Cells cells;
  for (int i = 0; i < 300; ++i)
  {
    cells.add(truth, false, 1);
  }
  const auto found = cells.vote(PlanarMotion());
  EXPECT_LT((found.translation - truth.translation).norm(), 0.15);
  EXPECT_NEAR(found.yaw, truth.yaw, 0.006);
}

TEST(MotionSearchResult, IgnoresAmbiguousAndLowWeightCells)
{
  const auto truth = motionOf(-3.2, 0, 0);
  Cells cells;
  for (int i = 0; i < 60; ++i)
  {
    cells.add(truth, false, 1);
  }
  for (int i = 0; i < 300; ++i)
  {
    cells.add(truth, true, 1);
    cells.add(PlanarMotion(), false, 0.1F);
  }
  EXPECT_LT((cells.vote(PlanarMotion()).translation - truth.translation).norm(), 0.2);
  // With full weight, the moving cells are the majority.
  std::fill(cells.trust.begin(), cells.trust.end(), 1.0F);
  EXPECT_LT(cells.vote(PlanarMotion()).translation.norm(), 0.2);
}

TEST(MotionSearchResult, MarginMeasuresAmbiguity)
{
  Cells cells;
  for (int i = 0; i < 300; ++i)
  {
    cells.add(motionOf(-3.2, 0, 0), true, 1);
  }
  EXPECT_LT(cells.voted(PlanarMotion()).margin, 0.05) << "rails alone";
  for (int i = 0; i < 100; ++i)
  {
    cells.add(motionOf(-3.2, 0, 0), false, 1);
  }
  EXPECT_GT(cells.voted(PlanarMotion()).margin, 0.15);
}

TEST(MotionSearchResult, WithoutVotesTheMotionIsTheCentre)
{
  Cells cells;
  const auto centre = motionOf(1, 0, 0.1);
  for (int i = 0; i < 2; ++i)
  {
    const auto found = cells.vote(centre);
    EXPECT_EQ(found.translation, centre.translation) << i << " cells";
    EXPECT_EQ(found.yaw, centre.yaw) << i << " cells";
    cells.add(motionOf(-3.2, 0, 0), false, 0);
  }
}
}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "DysegValidation.h"

#include <dyslam/train/DysegScores.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace
{
using dyslam::DysegSample;

std::size_t pointsOf(const dyslam::DysegValidationSet& set)
{
  std::size_t points = 0;
  for (const DysegSample& sample : set.samples)
  {
    points += sample.current.size();
  }
  return points;
}

TEST(DysegValidation, SimulatedRowsAreOfFixedScenes)
{
  dyslam::DysegTrainerOptions options;  // without real data
  const auto sets = dyslam::makeDysegValidation(options);
  std::vector<std::string> names;
  for (const auto& set : sets)
  {
    names.push_back(set.name);
    ASSERT_EQ(set.samples.size(), 4U) << set.name;
    const bool far = set.name.find("8 scans back") != std::string::npos;
    EXPECT_EQ(set.with_guess, far) << set.name;
    std::ptrdiff_t moving = 0;
    for (const DysegSample& sample : set.samples)
    {
      EXPECT_NEAR(sample.elapsed, far ? 0.8 : 0.1, 1e-9);
      moving += std::count(sample.label.begin(), sample.label.end(), DysegSample::moving_point);
    }
    EXPECT_GT(moving, 100) << set.name;
  }
  ASSERT_EQ(names, (std::vector<std::string>{"simulated street", "simulated street 8 scans back",
                                             "simulated street 512 columns 8 scans back",
                                             "simulated highway 1024 columns 8 scans back",
                                             "simulated campus VLP-16 8 scans back"}));
  const double thinner =
      static_cast<double>(pointsOf(sets[2])) / static_cast<double>(pointsOf(sets[1]));
  EXPECT_NEAR(thinner, 512.0 / 2083, 0.02) << "the same streets";
}

TEST(DysegScores, WhatCannotBeEvaluatedIsNotZero)
{
  dyslam::DysegScores scores;
  scores.static_error = 3;
  scores.static_cells = 4;
  scores.translation_error = 0.5;
  scores.yaw_error = 0.02;
  scores.pairs = 2;
  EXPECT_EQ(std::nullopt, scores.iou()) << "nothing moves and nothing was found";
  EXPECT_EQ(",,,,0.7500,,0.2500,0.01000", dyslam::scoreFields(scores));
  scores.false_positives = 1;
  EXPECT_EQ(",0.0000,0.0000,,0.7500,,0.2500,0.01000", dyslam::scoreFields(scores));
  scores.true_positives = 3;
  scores.moving_error = 1;
  scores.moving_cells = 2;
  EXPECT_EQ(",0.7500,0.7500,1.0000,0.7500,0.5000,0.2500,0.01000", dyslam::scoreFields(scores));
}

/** Points too far away for a search of the ego-motion: only a guess is available. */
TEST(DysegScores, AGuessReplacesTheSearchOverAllMotions)
{
  dyslam::BevOptions grid;
  grid.cells = 640;
  const dyslam::DysegModel model(dyslam::DysegNetworkOptions(), grid, 1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i)
  {
    const float y = 0.02F * static_cast<float>(i) - 20;
    points.emplace_back(55.0F, y, -1.7F);
    points.emplace_back(56.0F, y, -0.5F);
  }
  dyslam::RandomDraws draws(1, 1);
  const auto sample = dyslam::doubleScan(points, dyslam::poseFromYpr(0, 9, 0, 0, 0, 0), draws);
  EXPECT_NEAR(dyslam::scorePair(model, sample).translation_error, 9, 1e-6);
  const dyslam::PlanarPrior guess{dyslam::PlanarMotion::fromPose(sample.T_past_current)};
  EXPECT_NEAR(dyslam::scorePair(model, sample, &guess).translation_error, 0, 1e-6);
}
}  // namespace

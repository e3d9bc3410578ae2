// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/TrackErrors.h>
#include <dyslam/eval/TrackMetrics.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace dyslam;

namespace
{
LabelledBox boxAt(int frame, int id, double x, double y, const std::string& type = "Car")
{
  LabelledBox box;
  box.frame = frame;
  box.id = id;
  box.type = type;
  box.object_class = objectClassFromString(type);
  box.box.centre = {x, y, 0};
  box.box.size = {4, 2, 1.5};
  return box;
}

TrackRules plainRules()
{
  TrackRules rules;
  rules.image_rules = false;
  rules.switches_across_gaps = true;
  return rules;
}

/** Two cars side by side for ten frames, estimated without error. */
TrackSequence perfect()
{
  TrackSequence sequence;
  sequence.frames = 10;
  for (int f = 0; f < 10; ++f)
  {
    for (const int id : {3, 8})
    {
      sequence.reference.push_back(boxAt(f, id, 10 + f, id));
      sequence.estimate.push_back(boxAt(f, id + 100, 10 + f, id));
    }
  }
  return sequence;
}
}  // namespace

TEST(TrackMetrics, perfectTracksScoreOne)
{
  const ClearMot mot = clearMot({perfect()}, plainRules());
  EXPECT_DOUBLE_EQ(mot.mota, 1);
  EXPECT_NEAR(mot.motp, 1, 1e-9);
  EXPECT_EQ(mot.references, 20u);
  EXPECT_EQ(mot.id_switches + mot.misses + mot.false_alarms, 0u);
  EXPECT_NEAR(hota({perfect()}, plainRules()).hota, 1, 1e-6);
}

/** Each kind of error counts once. */
TEST(TrackMetrics, eachErrorCountsOnce)
{
  TrackSequence missed = perfect();
  missed.estimate.pop_back();
  EXPECT_DOUBLE_EQ(clearMot({missed}, plainRules()).mota, 1 - 1.0 / 20);

  TrackSequence false_positive = perfect();
  false_positive.estimate.push_back(boxAt(4, 500, -30, 0));
  EXPECT_EQ(clearMot({false_positive}, plainRules()).false_alarms, 1u);
  EXPECT_DOUBLE_EQ(clearMot({false_positive}, plainRules()).mota, 1 - 1.0 / 20);

  TrackSequence swapped = perfect();
  for (LabelledBox& box : swapped.estimate)
  {
    if (box.frame >= 5)
    {
      box.id = box.id == 103 ? 108 : 103;
    }
  }
  const ClearMot mot = clearMot({swapped}, plainRules());
  EXPECT_EQ(mot.id_switches, 2u);
  EXPECT_DOUBLE_EQ(mot.mota, 1 - 2.0 / 20);
  EXPECT_NEAR(hota({swapped}, plainRules()).association, 1.0 / 3, 1e-6);  // 5 / (5 + 5 + 5)
}

TEST(TrackMetrics, ignoredBoxesAreNeitherHitsNorMisses)
{
  TrackSequence sequence = perfect();
  for (LabelledBox& box : sequence.reference)
  {
    box.occluded = box.id == 8 ? ignored_box : 0;
  }
  EXPECT_DOUBLE_EQ(clearMot({sequence}, plainRules()).mota,
                   1);  // their estimates are no false positives
  EXPECT_EQ(clearMot({sequence}, plainRules()).references, 10u);
  sequence.estimate.clear();
  EXPECT_EQ(clearMot({sequence}, plainRules()).misses, 10u);
}

TEST(TrackMetrics, areasWithoutLabelsAreNoEstimates)
{
  TrackSequence sequence = perfect();
  for (int f = 0; f < sequence.frames; ++f)
  {
    sequence.reference.push_back(boxAt(f, -1, -1000, -1000, "DontCare"));
    sequence.estimate.push_back(boxAt(f, -1, -1000, -1000, "DontCare"));
  }
  EXPECT_EQ(clearMot({sequence}, plainRules()).false_alarms, 0u);
  EXPECT_NEAR(hota({sequence}, plainRules()).hota, 1, 1e-6);
}

/** Six of ten counted boxes are found, and all ignored ones, with half a metre of error. */
TEST(TrackMetrics, matchesOfIgnoredBoxesCountUnderKittisRulesOnly)
{
  TrackSequence sequence = perfect();
  for (LabelledBox& box : sequence.reference)
  {
    box.occluded = box.id == 8 ? ignored_box : 0;
  }
  std::vector<LabelledBox> estimates;
  for (LabelledBox box : sequence.estimate)
  {
    box.box.centre.x() += box.id == 108 ? 0.5 : 0;
    if (box.id == 108 || box.frame < 6)
    {
      estimates.push_back(box);
    }
  }
  estimates.push_back(boxAt(7, 103, -30, 0));
  estimates.push_back(boxAt(8, 103, -30, 0));
  sequence.estimate = estimates;
  const ClearMot mot = clearMot({sequence}, plainRules());
  EXPECT_EQ(mot.matches, 6u);
  EXPECT_EQ(mot.misses, 4u);
  EXPECT_EQ(mot.false_alarms, 2u);
  EXPECT_DOUBLE_EQ(mot.recall, 0.6);
  EXPECT_DOUBLE_EQ(mot.precision, 0.75);
  EXPECT_NEAR(mot.motp, 1, 1e-9);
  // Of the recalls 0.1, 0.2, ... the thresholds reach 0.5.
  const RecallAverages averages = averagesOverRecall({sequence}, plainRules(), 10);
  EXPECT_EQ(averages.points.size(), 5u);
  EXPECT_NEAR(averages.amotp, 0.5, 1e-9);
  EXPECT_NEAR(averages.amota, 0.5 * 0.4, 1e-9);

  TrackRules kitti = plainRules();
  kitti.image_rules = true;
  const ClearMot as_kitti = clearMot({sequence}, kitti);
  EXPECT_EQ(as_kitti.matches, 16u);
  EXPECT_DOUBLE_EQ(as_kitti.recall, 0.8);
  EXPECT_LT(as_kitti.motp, 0.95);
}

TEST(TrackMetrics, distanceInsteadOfOverlap)
{
  TrackSequence sequence = perfect();
  for (LabelledBox& box : sequence.estimate)
  {
    box.box.centre.y() += 1.5;  // IoU with its own reference below 0.25
  }
  TrackRules rules = plainRules();
  EXPECT_LT(clearMot({sequence}, rules).mota, 0);
  rules.max_distance = 2;
  rules.min_iou = 1e-9;
  const ClearMot mot = clearMot({sequence}, rules);
  EXPECT_DOUBLE_EQ(mot.mota, 1);
  EXPECT_NEAR(mot.motp, 0.25, 1e-9);
}

TEST(TrackMetrics, emptyInputs)
{
  const ClearMot mot = clearMot({}, plainRules());
  EXPECT_TRUE(std::isnan(mot.mota));
  TrackSequence nothing;
  nothing.frames = 3;
  EXPECT_EQ(clearMot({nothing}, plainRules()).references, 0u);
  EXPECT_TRUE(std::isfinite(hota({nothing}, plainRules()).hota));
  EXPECT_TRUE(trackErrors(nothing, plainRules(), 2).empty());
  EXPECT_EQ(summaryOf({}).boxes, 0u);
}

TEST(TrackMetrics, whatCannotBeComputedIsNotZero)
{
  const RecallAverages twenty_boxes = averagesOverRecall({perfect()}, plainRules(), 21);
  EXPECT_TRUE(std::isnan(twenty_boxes.samota));
  EXPECT_TRUE(std::isnan(twenty_boxes.amota));
  EXPECT_TRUE(std::isnan(twenty_boxes.amotp));
  EXPECT_DOUBLE_EQ(twenty_boxes.best.mota, 1);
  EXPECT_NEAR(averagesOverRecall({perfect()}, plainRules(), 19).samota, 1, 1e-9);
  EXPECT_NEAR(averagesOverRecall({perfect()}, plainRules(), 20).samota, 0.95, 1e-9)
      << "AB3DMOT's thresholds: the first of the twenty matches counts as recall 0";

  TrackSequence without_estimates = perfect();
  without_estimates.estimate.clear();
  const ClearMot mot = clearMot({without_estimates}, plainRules());
  EXPECT_DOUBLE_EQ(mot.mota, 0);
  EXPECT_DOUBLE_EQ(mot.recall, 0);
  EXPECT_DOUBLE_EQ(mot.mostly_lost, 1);
  EXPECT_TRUE(std::isnan(mot.precision));
  EXPECT_TRUE(std::isnan(mot.motp));
  EXPECT_EQ(averagesOverRecall({without_estimates}, plainRules(), 20).samota, 0);

  const TrackErrorSummary errors = summaryOf(trackErrors(without_estimates, plainRules(), 2));
  EXPECT_EQ(errors.boxes, 20u);
  EXPECT_TRUE(std::isnan(errors.position_mean));
  EXPECT_TRUE(std::isnan(errors.yaw_median));
  EXPECT_TRUE(std::isnan(errors.speed_bias));
}

TEST(TrackErrors, speedsUseTheLidarPosesByFrameIndex)
{
  // The lidar is 2 m ahead of a vehicle that rotates in place; scan 2 has no true pose.
  const Pose T_vehicle_lidar = poseFromYpr(2, 0, 1.7, 0, 0, 0);
  std::map<int, StampedPose> T_world_lidar;
  std::vector<LabelledBox> boxes;
  for (const int f : {0, 1, 2, 3, 4, 5})
  {
    const Pose T = poseFromYpr(0, 0, 0, 0.1 * f, 0, 0) * T_vehicle_lidar;
    if (f != 2)
    {
      T_world_lidar[f] = {100 + 0.1 * f, T};
    }
    const Eigen::Vector3d at_rest = T.inverse() * Eigen::Vector3d(20, 5, 1);
    const Eigen::Vector3d in_motion = T.inverse() * Eigen::Vector3d(20 + 0.8 * f, -5, 1);
    boxes.push_back(boxAt(f, 1, at_rest.x(), at_rest.y()));
    boxes.back().box.centre.z() = at_rest.z();
    boxes.push_back(boxAt(f, 2, in_motion.x(), in_motion.y()));
    boxes.back().box.centre.z() = in_motion.z();
  }
  const TrackSpeeds speeds = speedsFrom(boxes, T_world_lidar);
  EXPECT_EQ(speeds.size(), 10u);
  for (const int f : {0, 1, 3, 4, 5})
  {
    EXPECT_NEAR(speeds.at({f, 1}), 0, 1e-9) << f;
    EXPECT_NEAR(speeds.at({f, 2}), 8, 1e-9) << f;
  }
  EXPECT_EQ(speeds.count({2, 2}), 0u);
}

TEST(TrackErrors, hiddenObjectsAreBetweenTheirBoxes)
{
  std::map<int, StampedPose> T_world_lidar;
  std::vector<LabelledBox> boxes;
  for (int f = 0; f < 8; ++f)
  {
    const Pose T = poseFromYpr(f, 0, 1.7, 0.1 * f, 0, 0);
    if (f != 4)
    {
      T_world_lidar[f] = {100 + 0.1 * f, T};
    }
    const Eigen::Vector3d centre = T.inverse() * Eigen::Vector3d(20 + 0.8 * f, 5, 1);
    if (f == 1 || f == 2 || f == 6)
    {
      boxes.push_back(boxAt(f, 7, centre.x(), centre.y()));
      boxes.back().box.centre = centre;
    }
  }
  boxes.push_back(boxAt(3, 8, 1, 1));  // seen once
  const CentresByFrame hidden = hiddenCentres(boxes, T_world_lidar);
  ASSERT_EQ(hidden.size(), 2u) << "frames 3 and 5; 4 has no pose";
  for (const int f : {3, 5})
  {
    ASSERT_EQ(hidden.at(f).size(), 1u);
    EXPECT_LT(
        (T_world_lidar.at(f).pose * hidden.at(f)[0] - Eigen::Vector3d(20 + 0.8 * f, 5, 1)).norm(),
        1e-9);
  }
  EXPECT_TRUE(hiddenCentres({}, T_world_lidar).empty());
  EXPECT_TRUE(hiddenCentres(boxes, {}).empty());
}

TEST(TrackErrors, positionYawAndSpeedErrors)
{
  TrackSequence sequence;
  sequence.frames = 2;
  sequence.reference = {boxAt(0, 1, 10, 0), boxAt(1, 1, 11, 0), boxAt(0, 2, 30, 0, "Cyclist"),
                        boxAt(1, 7, -30, 5)};
  sequence.estimate = {boxAt(0, 51, 10.3, 0.4), boxAt(1, 51, 11, 0), boxAt(0, 52, 31, 0)};
  sequence.estimate[0].box.yaw = M_PI - 0.1;  // opposite heading: the axis is right
  const auto errors = trackErrors(sequence, plainRules(), 2, {{{0, 1}, 5.0}, {{1, 1}, 5.0}},
                                  {{{0, 51}, 4.0}, {{1, 51}, 7.0}});
  ASSERT_EQ(errors.size(), 4u);
  const TrackErrorSummary cars = summaryOf(errors, "Car", 0, 20);
  EXPECT_EQ(cars.boxes, 2u);
  EXPECT_EQ(cars.found, 2u);
  EXPECT_NEAR(cars.position_mean, 0.25, 1e-9);
  EXPECT_NEAR(cars.position_rmse, 0.5 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(cars.yaw_median, 0.05, 1e-9);
  EXPECT_NEAR(cars.speed_mean_abs, 1.5, 1e-9);
  EXPECT_NEAR(cars.speed_bias, 0.5, 1e-9);
  const TrackErrorSummary far = summaryOf(errors, "", 20, 40);
  EXPECT_EQ(far.boxes, 2u);
  EXPECT_EQ(far.found, 1u);
  EXPECT_EQ(far.same_type, 0u);
  EXPECT_EQ(far.speeds, 0u);
}

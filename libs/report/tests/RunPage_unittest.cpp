// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/report/RunPage.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "PoseDrift.h"

namespace dyslam
{
namespace
{
const char* const page_template =
    "<title>@TITLE@</title><img src=\"@PICTURE@\"><p>@POINTS@</p>"
    "<script type=\"application/json\">@DATA@</script>";

/** Three scans along x; the odometry ends 0.5 m to the left, 0.2 m too high, turned by 0.1 rad. */
RunPage smallRun()
{
  RunPage page;
  page.title = "run";
  for (int i = 0; i < 3; ++i)
  {
    const bool last = i == 2;
    page.scans.push_back({static_cast<std::size_t>(10 + i), 1000, last ? 50U : 0U, i > 0, i == 0});
    page.trajectory.push_back(100 + 0.1 * i, poseFromYpr(5 + i, 0, 0, 0, 0, 0));
    page.odometry.push_back(100 + 0.1 * i,
                            poseFromYpr(i, last ? 0.5 : 0, last ? 0.2 : 0, last ? 0.1 : 0, 0, 0));
  }
  return page;
}

nlohmann::json dataOf(const std::string& html)
{
  const std::string begin = "<script type=\"application/json\">";
  const auto from = html.find(begin) + begin.size();
  return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST(PoseDrift, IsMeasuredFromTheFirstPose)
{
  const RunPage page = smallRun();
  const PoseDrift drift = poseDrift(associateByTime(page.trajectory, page.odometry, 1e-3));
  ASSERT_EQ(drift.distance.size(), 3U);
  EXPECT_NEAR(drift.distance[2], 2, 1e-12);
  EXPECT_NEAR(drift.position[1], 0, 1e-12);
  EXPECT_NEAR(drift.position[2], 0.5, 1e-12);
  EXPECT_NEAR(drift.height[2], 0.2, 1e-12);
  EXPECT_NEAR(drift.heading[2], 0.1, 1e-12);
}

TEST(RunPage, LongRunsAreThinnedButCountedInFull)
{
  RunPage page;
  constexpr int count = 1001;
  for (int i = 0; i < count; ++i)
  {
    page.scans.push_back({static_cast<std::size_t>(i), 1000, 0, i > 0, i % 2 == 0});
    page.trajectory.push_back(0.1 * i, poseFromYpr(i, 0, 0, 0, 0, 0));
    page.odometry.push_back(0.1 * i, poseFromYpr(i, 0, 0, 0, 0, 0));
    page.loops.push_back({});
  }
  page.loops_left_out = 20;
  page.reported_tracks = 5;
  page.objects.push_back({3, ObjectClass::car, {}});
  page.objects.push_back({4, ObjectClass::car, {}});
  for (std::size_t i = 100; i < 200; ++i)
  {
    page.objects[0].states.push_back({i, {}, {}});
  }
  page.objects[1].states.push_back({57, {}, {}});
  RunPageOptions options;
  options.max_scans = 100;
  const auto json = dataOf(renderRunPage(page, page_template, options));
  EXPECT_EQ(json["totals"]["scans"], count);
  EXPECT_EQ(json["totals"]["registered"], count - 1);
  EXPECT_EQ(json["totals"]["keyframes"], count / 2 + 1);
  EXPECT_EQ(json["totals"]["loops"], count);
  EXPECT_EQ(json["totals"]["loops_left_out"], 20);
  EXPECT_EQ(json["totals"]["reported_tracks"], 5);
  EXPECT_NEAR(json["totals"]["seconds"].get<double>(), 100, 1e-9);
  EXPECT_NEAR(json["length"].get<double>(), count - 1, 1e-9);
  ASSERT_EQ(json["scans"]["index"].size(), 91U);  // every 11th
  EXPECT_EQ(json["scans"]["index"][90], 990);
  EXPECT_EQ(json["final"]["x"].size(), 91U);
  EXPECT_EQ(json["odometry"]["x"].size(), 91U);
  EXPECT_EQ(json["drift"]["odometry"]["distance"].size(), 91U);
  EXPECT_EQ(json["loops"].size(), 91U);
  EXPECT_EQ(json["objects"][0]["scan"][0], 10);  // scan 110
  EXPECT_EQ(json["objects"][0]["scan"].size(), 9U);
  EXPECT_EQ(json["objects"][1]["scan"][0], 5);  // its only scan lies between two shown ones
}

/** Fifteen scans a second in a zigzag, at 12 m/s, of which every eighth is shown. */
TEST(RunPage, PathSpeedsAndKeyframesAreThoseOfAllScans)
{
  RunPage page;
  constexpr int count = 800;
  for (int i = 0; i < count; ++i)
  {
    page.scans.push_back({static_cast<std::size_t>(i), 1000, 0, true, i % 16 == 1});
    const double y = i % 4 < 2 ? 0.3 : 0;
    page.trajectory.push_back(i / 15.0, poseFromYpr(0.8 * i, y, 0, 0, 0, 0));
    page.odometry.push_back(i / 15.0, poseFromYpr(0.8 * i, i == 3 ? 7 : y, 0, 0, 0, 0));
  }
  RunPageOptions options;
  options.max_scans = 100;
  const auto json = dataOf(renderRunPage(page, page_template, options));
  EXPECT_EQ(json["scans"]["step"], 8);
  ASSERT_EQ(json["keyframes"]["position"].size(), count / 16U) << "none is a scan that is shown";
  EXPECT_EQ(json["keyframes"]["step"], 1);
  EXPECT_EQ(json["keyframes"]["position"][2], nlohmann::json({26.4, 0.3, 0.0}));
  EXPECT_EQ(json["scans"]["speed"].size(), 100U);
  EXPECT_NEAR(json["scans"]["speed"][0].get<double>(), 12, 0.4);
  EXPECT_NEAR(json["scans"]["speed"][50].get<double>(), 12, 0.4);
  const double per_scan = (0.8 + std::hypot(0.8, 0.3)) / 2;
  EXPECT_NEAR(json["final"]["distance"][99].get<double>(), 792 * per_scan, 0.2);
  EXPECT_NEAR(json["totals"]["correction"].get<double>(), 7, 1e-3);
  options.max_scans = 40;
  const auto fewer = dataOf(renderRunPage(page, page_template, options));
  EXPECT_EQ(fewer["keyframes"]["step"], 2);
  EXPECT_EQ(fewer["keyframes"]["position"].size(), 25U);
}

TEST(RunPage, SpeedIsThatOverHalfASecondNotOverAGroupOfScans)
{
  RunPage page;
  for (int i = 0; i < 1000; ++i)
  {
    const double x = i < 500 ? 0 : i - 500;  // stands, then drives 10 m/s
    page.scans.push_back({static_cast<std::size_t>(i), 1000, 0, true, false});
    page.trajectory.push_back(0.1 * i, poseFromYpr(x, 0, 0, 0, 0, 0));
  }
  page.odometry = page.trajectory;
  RunPageOptions options;
  options.max_scans = 10;
  const auto speed = dataOf(renderRunPage(page, page_template, options))["scans"]["speed"];
  ASSERT_EQ(speed.size(), 10U);
  EXPECT_EQ(speed[4], 0.0);
  EXPECT_NEAR(speed[6].get<double>(), 10, 1e-3);
}

TEST(RunPage, WithoutTruthHasTheDriftOfTheOdometryAgainstTheFinalTrajectory)
{
  const auto json = dataOf(renderRunPage(smallRun(), page_template));
  EXPECT_TRUE(json["errors"].empty());
  EXPECT_TRUE(json["reference"].is_null());
  EXPECT_EQ(json["drift_against"], "final");
  EXPECT_NEAR(json["drift"]["odometry"]["heading"][2].get<double>(), 0.1 * 180 / M_PI, 1e-4);
  EXPECT_EQ(json["scans"]["index"], nlohmann::json({10, 11, 12}));
  EXPECT_EQ(json["scans"]["time"], nlohmann::json({0.0, 0.1, 0.2}));
  EXPECT_EQ(json["odometry"]["x"][0], 5.0) << "drawn in the map frame";
  EXPECT_EQ(json["map"]["count"], 0);
}

TEST(RunPage, WithTruthHasErrorsOfBothTrajectories)
{
  RunPage page = smallRun();
  page.reference = page.trajectory;
  page.reference_origin = "simulated, exact";
  const auto json = dataOf(renderRunPage(page, page_template));
  EXPECT_EQ(json["reference_origin"], "simulated, exact");
  EXPECT_EQ(json["difference_to"], "");
  ASSERT_EQ(json["errors"].size(), 2U);
  EXPECT_EQ(json["errors"][0]["name"], "final");
  EXPECT_NEAR(json["errors"][0]["ate"]["translation_m"]["rmse"].get<double>(), 0, 1e-9);
  EXPECT_NEAR(json["errors"][1]["end_error"]["translation_m"].get<double>(), std::hypot(0.5, 0.2),
              1e-9);
  EXPECT_EQ(json["drift_against"], "truth");
}

TEST(RunPage, ShowsObjectsLoopsAndMap)
{
  RunPage page = smallRun();
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {10, 20, 5}};
  page.map_points = &points;
  page.loops.push_back({{1, 2, 3}, {4, 5, 6}});
  PageObject object{7, ObjectClass::pedestrian, {}};
  object.states.push_back({1, {{1, 2, 0.9}, {0.6, 0.5, 1.8}, 0.25}, {3, 4, 0}});
  page.objects.push_back(object);
  const auto json = dataOf(renderRunPage(page, page_template));
  EXPECT_EQ(json["map"]["count"], 2);
  EXPECT_EQ(json["map"]["ceilings"], 0);
  EXPECT_EQ(json["loops"][0]["to"], nlohmann::json({4.0, 5.0, 6.0}));
  EXPECT_EQ(json["objects"][0]["class"], "Pedestrian");
  EXPECT_EQ(json["objects"][0]["scan"], nlohmann::json({1}));
  EXPECT_EQ(json["objects"][0]["speed"], nlohmann::json({5.0}));
}

/** The caller gives a part of the points of a map of millions. */
TEST(RunPage, CountsThePointsOfTheWholeMap)
{
  RunPage page = smallRun();
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {10, 20, 5}};
  page.map_points = &points;
  EXPECT_EQ(dataOf(renderRunPage(page, page_template))["map"]["of"], 2);
  page.map_size = 5000000;
  const auto json = dataOf(renderRunPage(page, page_template));
  EXPECT_EQ(json["map"]["of"], 5000000);
  EXPECT_EQ(json["map"]["count"], 2);
}

TEST(RunPage, HasWhatSatellitePositionsAndAccelerationsShow)
{
  RunPage page = smallRun();
  const auto without = dataOf(renderRunPage(page, page_template));
  EXPECT_TRUE(without["georeference"].is_null());
  EXPECT_TRUE(without["gravity"].is_null());
  page.georeference.emplace();
  page.georeference->fixes = 42;
  page.georeference->fused = true;
  page.georeference->horizontal_rmse = 0.9312;
  page.gravity.emplace();
  page.gravity->tilt = 0.035;
  const auto json = dataOf(renderRunPage(page, page_template));
  EXPECT_EQ(json["georeference"]["fixes"], 42);
  EXPECT_EQ(json["georeference"]["fused"], true);
  EXPECT_EQ(json["georeference"]["horizontal_rmse"], 0.93);
  EXPECT_EQ(json["gravity"]["tilt_deg"], 2.0);
}

TEST(RunPage, HasHowTheRunFitsThePriorMap)
{
  RunPage page = smallRun();
  EXPECT_TRUE(dataOf(renderRunPage(page, page_template))["prior_map"].is_null());
  page.prior_map.emplace();
  EXPECT_EQ(dataOf(renderRunPage(page, page_template))["prior_map"]["localised"], false);
  page.prior_map->localised = true;
  page.prior_map->path_length = 12.34;
  page.prior_map->tried = 93;
  page.prior_map->registered = 90;
  page.prior_map->rmse = 0.0304;
  const auto json = dataOf(renderRunPage(page, page_template))["prior_map"];
  EXPECT_EQ(json["localised"], true);
  EXPECT_EQ(json["path_length"], 12.3);
  EXPECT_EQ(json["keyframes"], 93);
  EXPECT_EQ(json["registered"], 90);
  EXPECT_EQ(json["rmse"], 0.03);
}

TEST(RunPage, CountsTheScansOfFurtherLidars)
{
  RunPage page = smallRun();
  EXPECT_TRUE(dataOf(renderRunPage(page, page_template))["further_lidars"].empty());
  page.parts = {{10, "left", 100.01, 500},  {10, "rear", 100.05, 900}, {11, "left", 100.07, 700},
                {11, "left", 100.125, 600}, {12, "left", 100.21, 600}, {99, "left", 200, 1}};
  const auto lidars = dataOf(renderRunPage(page, page_template))["further_lidars"];
  ASSERT_EQ(lidars.size(), 2U);
  EXPECT_EQ(lidars[0]["label"], "left");
  EXPECT_EQ(lidars[0]["scans"], 4) << "without that of a scan that is not in the run";
  EXPECT_EQ(lidars[0]["merged_into"], 3);
  EXPECT_EQ(lidars[0]["offset_ms"], 10.0);
  EXPECT_EQ(lidars[0]["largest_offset_ms"], -30.0);
  EXPECT_EQ(lidars[0]["points"], 600);
  EXPECT_EQ(lidars[1]["label"], "rear");
  EXPECT_EQ(lidars[1]["merged_into"], 1);
}

/** A scan that is not shown passes its mark on to the shown one before it. */
TEST(RunPage, MarksTheScansThatWereNotRegistered)
{
  RunPage page;
  for (int i = 0; i < 6; ++i)
  {
    page.scans.push_back({static_cast<std::size_t>(i), 1000, 0, i != 3, false});
    page.trajectory.push_back(0.1 * i, poseFromYpr(i, 0, 0, 0, 0, 0));
    page.odometry.push_back(0.1 * i, poseFromYpr(i, 0, 0, 0, 0, 0));
  }
  RunPageOptions options;
  options.max_scans = 3;
  EXPECT_EQ(dataOf(renderRunPage(page, page_template, options))["scans"]["registered"],
            nlohmann::json({true, false, true}));
}

TEST(RunPage, TextsCannotBecomeMarkup)
{
  RunPage page = smallRun();
  const std::string evil = "</script><script>alert(1)</script><!-- & \"";
  page.title = page.input = page.settings = evil;
  page.warnings = {evil};
  page.files = {evil, "not UTF-8: \xff"};
  const std::string html = renderRunPage(page, page_template);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
  EXPECT_NE(html.find("<title>&lt;/script&gt;"), std::string::npos);
  EXPECT_EQ(dataOf(html)["warnings"][0], evil);
}

TEST(RunPage, HasTheVerdictOfTheRun)
{
  RunPage page = smallRun();
  EXPECT_EQ(dataOf(renderRunPage(page, page_template))["verdict"], "usable");
  page.verdict = "doubtful";
  EXPECT_EQ(dataOf(renderRunPage(page, page_template))["verdict"], "doubtful");
}

TEST(RunPage, AnEmptyRunHasAPage)
{
  const auto json = dataOf(renderRunPage({}, page_template));
  EXPECT_TRUE(json["scans"]["index"].empty());
  EXPECT_EQ(json["length"], 0.0);
}

TEST(RunPage, PosesThatAreNotFiniteAreLeftOpen)
{
  RunPage page = smallRun();
  page.trajectory[1].pose.translation().x() = std::nan("");
  EXPECT_TRUE(dataOf(renderRunPage(page, page_template))["final"]["x"][1].is_null());
}

TEST(RunPage, RefusesWhatDoesNotFit)
{
  RunPage page = smallRun();
  EXPECT_THROW((void)renderRunPage(page, "no placeholder"), UserError);
  RunPageOptions none;
  none.max_points = 0;
  EXPECT_THROW((void)renderRunPage(page, page_template, none), UserError);
  page.scans.pop_back();
  EXPECT_THROW((void)renderRunPage(page, page_template), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam

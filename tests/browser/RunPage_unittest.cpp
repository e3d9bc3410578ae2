// SPDX-License-Identifier: BSD-3-Clause
// report.html, opened in Chromium and used as a reader uses it.
#include <dyslam/base/Files.h>
#include <dyslam/report/RunPage.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "../cli/RunProgram.h"
#include "BrowserTest.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

const char* const all_drawn =
    "const c = document.getElementById('scene'); if (!c || !c.dataset.drawn) return false;"
    "const n = c.dataset.drawn; const same = window.before === n; window.before = n; return same;";

/** Writes the page of a run to a file. */
std::string written(const RunPage& page,
                    const std::string& name,
                    const RunPageOptions& options = {})
{
  const std::string file = (fs::temp_directory_path() / name).string();
  std::ofstream(file) << renderRunPage(
      page, readWhole(std::string(DYSLAM_SHARE_DIR) + "/report/page.html"), options);
  return file;
}

cv::Mat imageOf(const std::string& base64_png)
{
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> png;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : base64_png.substr(0, base64_png.find('=')))
  {
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8)
    {
      count -= 8;
      png.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(count)));
    }
  }
  return cv::imdecode(png, cv::IMREAD_COLOR);
}

/** Whether pictures differ by more than the rounding of colours in a software renderer. */
bool differ(const std::string& base64_png, const std::string& other)
{
  const cv::Mat a = imageOf(base64_png);
  const cv::Mat b = imageOf(other);
  if (a.size() != b.size())
  {
    return true;
  }
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  return cv::norm(difference, cv::NORM_INF) > 8;
}

/** Twenty scans ahead in a curve and one object beside them. */
RunPage smallRun()
{
  RunPage page;
  page.title = "small";
  PageObject object{3, ObjectClass::car, {}};
  for (int i = 0; i < 20; ++i)
  {
    page.scans.push_back({static_cast<std::size_t>(i), 1000, 10, true, i % 5 == 0});
    const double y = -0.02 * i * i;  // seen from behind, posts on a straight path hide behind it
    page.trajectory.push_back(100 + 0.1 * i, poseFromYpr(i, y, 0, 0, 0, 0));
    page.odometry.push_back(100 + 0.1 * i, poseFromYpr(i, y + 0.01 * i, 0, 0, 0, 0));
    object.states.push_back(
        {static_cast<std::size_t>(i), {Eigen::Vector3d(i, 4, 0.7), {4, 2, 1.5}, 0}, {10, 0, 0}});
  }
  page.objects.push_back(object);
  return page;
}

class RunPageInBrowser : public BrowserTest
{
 protected:
  static std::string textOf(const std::string& id)
  {
    return browser()
        .run("return document.getElementById('" + id + "').textContent")
        .get<std::string>();
  }
};

TEST_F(RunPageInBrowser, ShowsARunOfTheProgram)
{
  const fs::path folder = fs::temp_directory_path() / "page run";
  fs::create_directories(folder);
  const auto outcome = runProgram("dyslam",
                                  "-v ERROR -i '" + std::string(DYSLAM_SOURCE_DIR) +
                                      "/rawlog/street64.rawlog' -o '" + folder.string() +
                                      "' --only-first-n 40 --set dyseg.method=residual",
                                  fs::temp_directory_path().string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_TRUE(fs::exists(folder / "map.png"));

  browser().open((folder / "report.html").string());
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run("return performance.getEntriesByType('resource').filter(e => "
                          "!e.name.startsWith('data:')).length"),
            0)
      << "nothing is loaded";
  for (const char* section :
       {"summary", "view", "above", "errors", "trajectory", "drift", "tracks", "times", "details"})
  {
    EXPECT_GT(browser().run(std::string("return document.getElementById('") + section +
                            "').getBoundingClientRect().height"),
              60)
        << section;
  }
  EXPECT_GT(browser().run("return document.querySelectorAll('#error-table tbody tr').length"), 5);
  EXPECT_GT(browser().run("return document.getElementById('picture').naturalWidth"), 300);
  EXPECT_GT(browser().run("return document.querySelectorAll('polyline').length"), 10);
  EXPECT_GT(browser().run("return document.querySelectorAll('#times .bar').length"), 4);
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, SliderMovesThroughTheScans)
{
  browser().open(written(smallRun(), "slider.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(textOf("scene-info"), "Scan 0 (1 of 20), 0.00 s: 1 moving object");
  const std::string before = browser().screenshot("scene");
  browser().type("time-slider", "\xEE\x80\x90");  // End, as WebDriver writes it: U+E010
  EXPECT_EQ(textOf("scene-info"), "Scan 19 (20 of 20), 1.90 s: 1 moving object");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  EXPECT_TRUE(differ(browser().screenshot("scene"), before));

  browser().click("play");  // at the end, playing begins again from the start
  EXPECT_TRUE(browser().waitFor("return document.getElementById('time-slider').value > 3"));
  EXPECT_TRUE(browser().waitFor("return document.getElementById('play').textContent === 'Play'"))
      << "it stops at the end";
  EXPECT_EQ(browser().run("return document.getElementById('time-slider').value"), "19");
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, LayersCanBeHidden)
{
  RunPage page = smallRun();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i)
  {
    points.emplace_back(0.01F * static_cast<float>(i) - 10, 5, 0.001F * static_cast<float>(i));
  }
  page.map_points = &points;
  page.reference = page.trajectory;
  page.loops.push_back({{0, 0, 0}, {19, 0, 0}});
  browser().open(written(page, "layers.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  const std::string before = browser().screenshot("scene");
  for (const char* layer : {"map", "path", "loops", "objects", "tracks", "odometry", "truth",
                            "keyframes", "grid", "labels"})
  {
    const std::string id = std::string("layer-") + layer;
    browser().click(id);
    ASSERT_TRUE(browser().waitFor(all_drawn));
    EXPECT_TRUE(differ(browser().screenshot("scene"), before)) << layer;
    browser().click(id);
    ASSERT_TRUE(browser().waitFor(all_drawn));
    EXPECT_FALSE(differ(browser().screenshot("scene"), before)) << layer;
  }
  browser().click("view-above");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  EXPECT_TRUE(differ(browser().screenshot("scene"), before));
  EXPECT_EQ(browser().errors(), "");
}

/** A room of 30 m by 10 m and 3 m height with the vehicle's path in it. */
std::vector<Eigen::Vector3f> room()
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 15000; ++i)
  {
    const float x = 0.2F * static_cast<float>(i % 150) - 5;
    const float y = 0.2F * static_cast<float>(i / 150) - 10;
    points.emplace_back(x, y, -1.0F);
    points.emplace_back(x, y, 2.0F);
  }
  return points;
}

TEST_F(RunPageInBrowser, CeilingsAreHiddenAtFirstAndHeightsCanBeCutOff)
{
  RunPage page = smallRun();
  const std::vector<Eigen::Vector3f> points = room();
  page.map_points = &points;
  browser().open(written(page, "room.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("view").find("belong to ceilings, which are not shown at first"),
            std::string::npos);
  EXPECT_EQ(browser().run("return document.getElementById('layer-ceilings').checked"), false);
  const std::string without = browser().screenshot("scene");
  browser().click("layer-ceilings");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  const std::string with = browser().screenshot("scene");
  EXPECT_TRUE(differ(with, without));

  EXPECT_EQ(textOf("cut-height"), "nothing");
  browser().type("cut", "\xEE\x80\x92\xEE\x80\x92\xEE\x80\x92\xEE\x80\x92\xEE\x80\x92");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  EXPECT_EQ(textOf("cut-height"), "above 1.5 m over the path") << "five steps to the left";
  browser().click("layer-ceilings");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  const std::string open = browser().screenshot("scene");
  browser().click("layer-ceilings");
  ASSERT_TRUE(browser().waitFor(all_drawn));
  EXPECT_FALSE(differ(browser().screenshot("scene"), open)) << "the ceiling is cut off";
  browser().type("cut", "\xEE\x80\x90");  // End
  ASSERT_TRUE(browser().waitFor(all_drawn));
  EXPECT_EQ(textOf("cut-height"), "nothing");
  EXPECT_FALSE(differ(browser().screenshot("scene"), with));
  EXPECT_EQ(browser().errors(), "");
}

/** On a slope of 20 % the ground is at the height of the path everywhere. */
TEST_F(RunPageInBrowser, StatesWhatTheColoursMean)
{
  RunPage page = smallRun();
  std::vector<Eigen::Vector3f> points;
  Trajectory path;
  for (int i = 0; i < 20; ++i)
  {
    path.push_back(100 + 0.1 * i, poseFromYpr(i, 0, 0.2 * i, 0, 0, 0));
    for (int k = -5; k <= 5; ++k)
    {
      points.emplace_back(static_cast<float>(i), 0.2F * static_cast<float>(k),
                          0.2F * static_cast<float>(i));
    }
  }
  page.trajectory = page.odometry = path;
  page.map_points = &points;
  browser().open(written(page, "slope.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("colours").find(" mover the path"), std::string::npos);
  EXPECT_NEAR(std::stod(textOf("colours")), 0, 0.2) << "the lowest points";
  const std::string over_path = browser().screenshot("scene");
  const auto choose = [](const std::string& value)
  {
    (void)browser().run("const c = document.getElementById('colour'); c.value = '" + value +
                        "'; c.dispatchEvent(new Event('change')); return true");
    return browser().waitFor(all_drawn);
  };
  ASSERT_TRUE(choose("1"));
  EXPECT_EQ(textOf("colours"), "0.0 m3.8 mheight");
  EXPECT_TRUE(differ(browser().screenshot("scene"), over_path));
  ASSERT_TRUE(choose("2"));
  EXPECT_EQ(textOf("colours"), "01intensity");
  ASSERT_TRUE(choose("3"));
  EXPECT_EQ(browser().run("return document.getElementById('colours').hidden"), true);
  ASSERT_TRUE(choose("0"));
  EXPECT_FALSE(differ(browser().screenshot("scene"), over_path));
  EXPECT_EQ(textOf("kinds"), "vehicles");
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, OpensWithAMillionPoints)
{
  RunPage page = smallRun();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 1000000; ++i)
  {
    const auto t = static_cast<float>(i);
    points.emplace_back(1e-4F * t - 40, 20 * std::sin(0.01F * t), 3 * std::cos(0.003F * t));
  }
  page.map_points = &points;
  browser().open(written(page, "million.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("view").find("1,000,000 map points"), std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, FitsASmallScreenAndShowsTextsAsTheyAre)
{
  RunPage page = smallRun();
  const std::string evil = "</script><img src=x onerror='window.evil=1'>" + std::string(200, 'w');
  page.title = page.input = page.method = page.settings = page.failure = evil;
  page.warnings = {evil};
  page.files = {evil};
  browser().resize(500, 900);  // Chromium makes no smaller window
  browser().open(written(page, "evil.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run("return window.evil === undefined"), true);
  EXPECT_NE(textOf("verdict").find(evil), std::string::npos);
  EXPECT_LE(browser().run("return document.documentElement.scrollWidth - window.innerWidth"), 0);
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, StatesTheSensorAndWhereTheTruthIsFrom)
{
  RunPage page = smallRun();
  page.sensor = "64 rings; the points have no times";
  page.reference = page.trajectory;
  page.reference_origin = "GNSS/INS (oxts), not exact";
  page.difference_to = "GNSS/INS";
  page.files = {"tracks.csv"};
  page.reported_tracks = 3;
  page.stage_ms["deskew"] = 2;
  browser().open(written(page, "origin.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("summary").find("Sensor: 64 rings; the points have no times."),
            std::string::npos);
  EXPECT_NE(textOf("verdict").find("No warnings."), std::string::npos);
  EXPECT_NE(textOf("errors").find("(GNSS/INS (oxts), not exact)"), std::string::npos);
  EXPECT_NE(textOf("summary").find(
                "1 moving object tracked (3 tracks in tracks.csv: 2 of them never moved): "),
            std::string::npos);
  EXPECT_EQ(textOf("errors").find("Differences to GNSS/INS"), 0U);
  EXPECT_NE(textOf("limits").find("may be of either"), std::string::npos);
  EXPECT_NE(textOf("summary").find(" from GNSS/INS, which is not exact."), std::string::npos);
  EXPECT_EQ(textOf("drift").find("error"), std::string::npos) << "differences";
  EXPECT_NE(textOf("times").find("with the motion that was found"), std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

/** The page has no threshold of its own: the number of scans that were not registered gives no
 * verdict by itself. */
TEST_F(RunPageInBrowser, ShowsTheVerdictOfTheRun)
{
  RunPage page = smallRun();
  for (PageScan& scan : page.scans)
  {
    scan.registered = false;
  }
  browser().open(written(page, "usable.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("verdict").find("No warnings."), std::string::npos);
  page.verdict = "doubtful";
  page.warnings = {"7 of 20 scans could not be registered: check trajectory and map"};
  browser().open(written(page, "doubtful.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(textOf("verdict").find("Check trajectory and map."), 0U);
  EXPECT_NE(textOf("verdict").find(page.warnings[0]), std::string::npos);
  page.verdict = "unusable";
  page.failure = "15 of 20 scans could not be registered: do not trust trajectory and map";
  page.warnings = {"the local map was restarted 2 times"};
  browser().open(written(page, "unusable.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(textOf("verdict").find("This run is unusable."), 0U);
  EXPECT_NE(textOf("verdict").find(page.failure), std::string::npos);
  EXPECT_NE(textOf("verdict").find(page.warnings[0]), std::string::npos);
}

TEST_F(RunPageInBrowser, MarksScansThatWereNotRegistered)
{
  const char* const crosses = "return document.querySelectorAll('#trajectory .plot path').length";
  RunPage page = smallRun();
  browser().open(written(page, "registered.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run(crosses), 0);
  EXPECT_EQ(textOf("trajectory").find("not registered"), std::string::npos);
  page.scans[19].registered = false;
  browser().open(written(page, "lost.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run(crosses), 2) << "from above, and in the speed";
  EXPECT_NE(textOf("trajectory").find("not registered"), std::string::npos);
  browser().type("time-slider", "\xEE\x80\x90");  // End
  EXPECT_EQ(textOf("scene-info"), "Scan 19 (20 of 20), 1.90 s: 1 moving object, not registered");
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, ListsFurtherLidars)
{
  RunPage page = smallRun();
  browser().open(written(page, "one lidar.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run("return document.getElementById('lidars') === null"), true);
  page.parts = {{0, "left", 100.02, 500}, {1, "left", 100.13, 700}, {1, "rear", 100.05, 900}};
  browser().open(written(page, "three lidars.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run("return [...document.querySelectorAll('#lidars tbody tr')].map(r => "
                          "[...r.children].map(c => c.textContent).join('|')).join(' ')"),
            "left|2|2 of 20 scans|30.0|30.0|600 rear|1|1 of 20 scans|-50.0|-50.0|900");
  EXPECT_NE(textOf("summary").find("Merged with its scans are those of left, rear."),
            std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

/** Plots of zeros would look like an odometry without errors. */
TEST_F(RunPageInBrowser, DrawsNoDriftWhereNothingWasCorrected)
{
  RunPage page = smallRun();
  page.odometry = page.trajectory;
  browser().open(written(page, "uncorrected.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_EQ(browser().run("return document.querySelectorAll('#drift .plot').length"), 0);
  EXPECT_NE(textOf("drift").find("does not mean that nothing has drifted"), std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, SaysWhichScansOfALongRunAreShownAndWhichLoopsAreLeftOut)
{
  RunPage page = smallRun();
  page.loops.push_back({{0, 0, 0}, {19, 0, 0}});
  page.loops_left_out = 20;
  RunPageOptions options;
  options.max_scans = 7;
  browser().open(written(page, "thinned.html", options));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  browser().type("time-slider", "\xEE\x80\x90");  // End
  EXPECT_EQ(textOf("scene-info").find("Scan 18 (19 of 20), 1.80 s"), 0U);
  for (const char* section : {"view", "trajectory"})
  {
    EXPECT_NE(textOf(section).find("Shown is every 3rd scan"), std::string::npos) << section;
  }
  EXPECT_NE(textOf("summary").find("1 loop: places recognised a second time."), std::string::npos);
  EXPECT_NE(textOf("summary").find("20 left out, as they contradict the others."),
            std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

TEST_F(RunPageInBrowser, SaysThatSatellitePositionsCorrectTheDriftAndHowLargeTheMapIs)
{
  RunPage page = smallRun();
  page.loops.clear();
  page.georeference.emplace();
  page.georeference->fixes = 42;
  page.georeference->fused = true;
  page.georeference->horizontal_rmse = 0.93;
  page.georeference->epsg = 32632;
  page.reference = Trajectory();
  page.reference.push_back(page.trajectory[0].stamp, page.trajectory[0].pose);
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {10, 20, 5}};
  page.map_points = &points;
  page.map_size = 5000000;
  browser().open(written(page, "satellites.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  const std::string summary = textOf("summary");
  EXPECT_NE(summary.find("42 satellite positions moved the trajectory by up to"),
            std::string::npos);
  EXPECT_NE(
      summary.find("(georeference.ini; UTM: EPSG 32632); they are 0.93 m from the trajectory"),
      std::string::npos);
  EXPECT_EQ(summary.find("nothing corrects the drift"), std::string::npos);
  EXPECT_EQ(summary.find("has no ground truth"), std::string::npos);
  EXPECT_NE(summary.find("5,000,000"), std::string::npos);
  EXPECT_NE(textOf("view").find("2 of 5,000,000 map points, evenly thinned"), std::string::npos);
  EXPECT_EQ(browser().errors(), "");
}

/** As ms_per_scan of report.json. */
TEST_F(RunPageInBrowser, CheckpointsAreNoStagesAndAPriorMapCorrectsTheDrift)
{
  RunPage page = smallRun();
  page.loops.clear();
  page.loops_left_out = 0;
  page.prior_map.emplace();
  page.prior_map->localised = true;
  page.prior_map->path_length = 12.3;
  page.prior_map->tried = 93;
  page.prior_map->registered = 90;
  page.prior_map->rmse = 0.03;
  page.stage_ms = {{"refine", 20.3}, {"map", 10}, {"checkpoint.back_end", 7}};
  browser().open(written(page, "checkpoints.html"));
  ASSERT_TRUE(browser().waitFor(all_drawn)) << browser().errors();
  EXPECT_NE(textOf("summary").find("The stages took 30.3 ms per scan"), std::string::npos)
      << textOf("summary");
  EXPECT_NE(textOf("times").find("checkpoint.back_end"), std::string::npos);
  EXPECT_NE(textOf("summary").find("Localised in a prior map after 12.3 m; 90 of 93 keyframes "
                                   "within it were registered to it (RMSE 0.030 m)."),
            std::string::npos)
      << textOf("summary");
  EXPECT_EQ(textOf("summary").find("nothing corrects the drift"), std::string::npos);
}

TEST_F(RunPageInBrowser, HasAWordForARunWithoutScans)
{
  browser().open(written({}, "empty.html"));
  EXPECT_TRUE(browser().waitFor("return document.getElementById('summary') !== null"));
  EXPECT_EQ(browser().errors(), "");
}
}  // namespace
}  // namespace dyslam

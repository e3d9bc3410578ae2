// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/RunSettings.h>
#include <dyslam/run/SlamRunSettings.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::string campus_rawlog = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";

TEST(RunSettings, AreThoseOfTheSensorUnderThoseGiven)
{
  const TestFolder folder;
  const GivenSettings given = readGivenSettings(
      folder.write("my.ini", "[odometry]\nmethod = gicp\n"), {"dyseg.method=none"});
  RunSettings chosen = chooseRunSettings(campus_rawlog, given);
  EXPECT_EQ("vlp16.ini + my.ini", chosen.source);
  EXPECT_EQ(16U, chosen.sensor.pattern.rings.size());
  EXPECT_EQ(chosen.sensor.missingTimes(chosen.config), chosen.missing_times);
  EXPECT_EQ("gicp", chosen.config.text("odometry", "method"));
  EXPECT_EQ("none", chosen.config.text("dyseg", "method"));
  SlamRunSettings run;
  run.warnings = {"of the conversion"};
  chosen.warnings = {"of the settings"};
  setSettings(chosen, run);
  EXPECT_EQ(chosen.config.toIni(), run.config.toIni());
  EXPECT_EQ((std::vector<std::string>{"of the conversion", "of the settings"}), run.warnings);
  EXPECT_EQ(0U, run.sensor.rfind(chosen.sensor.summary(), 0)) << run.sensor;
}

TEST(RunSettings, ANameOfShippedWeightsThatIsAlsoAFileIsTold)
{
  const TestFolder folder;
  const WorkingFolder within(folder.path());
  folder.write("dyseg_simulated.safetensors", "");
  const auto warnings = [](const std::string& weights)
  {
    const GivenSettings given =
        readGivenSettings("", {"dyseg.method=none", "dyseg_network.weights=" + weights});
    return chooseRunSettings(campus_rawlog, given).warnings;
  };
  const std::vector<std::string> told = warnings("dyseg_simulated");
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(contains(told.front() + told.back(),
                       "dyseg_network.weights = dyseg_simulated: is the name of shipped ones"));
  const std::size_t others = told.size() - 1;
  EXPECT_EQ(others, warnings("dyseg_simulated.safetensors").size());
}

TEST(RunSettings, WheelsThatContradictTheScansAreNotUsedUnlessTheyAreAskedFor)
{
  const TestFolder folder;
  const std::string rawlog = folder.file("a.rawlog");
  {
    RawlogSource source(campus_rawlog);
    RawlogWriter writer(rawlog);
    for (int scans = 0; scans < 30; ++scans)
    {
      const auto frame = source.next();
      ASSERT_TRUE(frame);
      WheelSample wheels;
      wheels.stamp = frame->scan.stamp;
      wheels.forward_speed = 12;
      writer.write(wheels);
      writer.write(frame->scan);
    }
    writer.close();
  }
  const auto chosen = [&](const std::vector<std::string>& assignments)
  { return chooseRunSettings(rawlog, readGivenSettings("", assignments)); };
  const auto saying = [](const RunSettings& settings, const std::string& what)
  {
    return std::any_of(settings.warnings.begin(), settings.warnings.end(),
                       [&](const std::string& warning) { return contains(warning, what); });
  };
  const RunSettings without = chosen({});
  EXPECT_EQ("false", without.config.text("motion_sensors", "wheel_odometry").value_or(""));
  EXPECT_TRUE(saying(without, "the wheel odometry is not used: it states 12.0 m/s"));
  const RunSettings with = chosen({"motion_sensors.wheel_odometry=true"});
  EXPECT_EQ("true", with.config.text("motion_sensors", "wheel_odometry").value_or(""));
  EXPECT_TRUE(saying(with, "the wheel odometry is used, though it states 12.0 m/s"));
}

TEST(RunSettings, TheReportNamesSensorMissingTimesLevellingAndStartSpeed)
{
  RunSettings settings;
  const std::string sensor = settings.sensor.summary();
  EXPECT_EQ(sensor, settings.aboutSensor());
  settings.levelling_note = "tilted by 15 deg";
  EXPECT_EQ(sensor + "; tilted by 15 deg", settings.aboutSensor());
  settings.missing_times = "no times";
  EXPECT_EQ(sensor + "; no times; tilted by 15 deg", settings.aboutSensor());
  settings.start_speed = "26.7";
  EXPECT_EQ(sensor +
                "; no times; tilted by 15 deg; begins at about 26.7 m/s "
                "(odometry.start_speed)",
            settings.aboutSensor());
}

TEST(RunSettings, BadOnesAndAMissingRecordingAreRefused)
{
  EXPECT_THROW((void)chooseRunSettings("none.rawlog", readGivenSettings("")), UserError);
  const GivenSettings bad = readGivenSettings("", {"input.only_first=3"});
  EXPECT_THROW((void)chooseRunSettings(campus_rawlog, bad), UserError);
}
}  // namespace
}  // namespace dyslam

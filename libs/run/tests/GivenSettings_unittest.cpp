// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/run/GivenSettings.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
RecordedSensor sensorWith(std::size_t rings, double spacing_deg)
{
  RecordedSensor sensor;
  sensor.pattern.ring_spacing = spacing_deg * M_PI / 180;
  sensor.pattern.azimuth_extent = 2 * M_PI;
  sensor.pattern.rings.resize(rings);
  return sensor;
}

TEST(GivenSettings, AssignmentsAreOverTheIniAndThatOverTheSensors)
{
  const TestFolder folder;
  const std::string path =
      folder.write("my.ini", "[odometry]\nmethod = icp_po2pl\n[refine]\nmethod = gicp\n");
  const GivenSettings given =
      readGivenSettings(path, {"odometry.method=gicp", "labels.hindsight=false"});
  EXPECT_EQ(path, given.path);
  EXPECT_EQ("icp_po2pl", given.ini.text("odometry", "method"));
  EXPECT_EQ("gicp", given.merged().text("odometry", "method"));
  EXPECT_EQ(std::nullopt, given.merged().text("dyseg", "method"));

  const ChosenSettings chosen = settingsFor(sensorWith(16, 2), given);
  EXPECT_EQ("vlp16.ini + my.ini", chosen.source);
  EXPECT_TRUE(chosen.warnings.empty());
  EXPECT_EQ("gicp", chosen.config.text("odometry", "method"));
  EXPECT_EQ("gicp", chosen.config.text("refine", "method"));
  EXPECT_EQ("residual", chosen.config.text("dyseg", "method")) << "of vlp16.ini";
  EXPECT_EQ("false", chosen.config.text("labels", "hindsight"));
}

TEST(GivenSettings, WithoutAnIniTheSensorsAreTaken)
{
  const GivenSettings given = readGivenSettings("");
  EXPECT_EQ("", given.path);
  EXPECT_EQ("", given.merged().toIni());
  const ChosenSettings chosen = settingsFor(sensorWith(64, 0.4), given);
  EXPECT_EQ("kitti64.ini", chosen.source);
  EXPECT_EQ(Config::fromFile(findGivenOrShared("kitti64", "config_files", ".ini")).toIni(),
            chosen.config.toIni());
}

TEST(GivenSettings, AShippedIniIsFoundByItsName)
{
  const GivenSettings given = readGivenSettings("kitti64");
  EXPECT_EQ("kitti64.ini", std::filesystem::path(given.path).filename());
  const ChosenSettings chosen = settingsFor(sensorWith(16, 2), given);
  EXPECT_EQ("kitti64.ini", chosen.source);
  EXPECT_EQ(1U, chosen.warnings.size()) << "for other sensors";
}

TEST(GivenSettings, WhatIsWrongIsNamed)
{
  const TestFolder folder;
  EXPECT_THROW((void)readGivenSettings("nothere.ini"), UserError);
  EXPECT_THROW((void)readGivenSettings(folder.write("junk.ini", "no ini\n")), UserError);
  EXPECT_THROW(
      (void)readGivenSettings(folder.write("other.ini", "program = dyslam-train\n[a]\nb = 1\n")),
      UserError);
  const GivenSettings given = readGivenSettings("", {"odometry"});
  EXPECT_THROW((void)given.merged(), UserError);
  EXPECT_THROW((void)settingsFor(sensorWith(16, 2), given), UserError);
}
}  // namespace
}  // namespace dyslam

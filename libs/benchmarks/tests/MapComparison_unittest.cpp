// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/DistanceCloud.h>
#include <dyslam/benchmarks/MapComparison.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** Four points in a plane, the last at `x`. */
Scan square(float x)
{
  Scan scan;
  scan.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {x, 1, 0}};
  return scan;
}
}  // namespace

TEST(MapComparison, LabelsAreInTheIntensityOrThereAreNone)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  EXPECT_EQ(readReferenceLabels(reference).missing, "no intensity, no .label file");
  reference.cloud.intensity = {0, 0, 1, 1};
  EXPECT_EQ(readReferenceLabels(reference).labels,
            (std::vector<Label>{label_static, label_static, label_moving, label_moving}));
  reference.cloud.intensity = {40, 252, 1, 0};
  EXPECT_EQ(readReferenceLabels(reference).labels, (std::vector<Label>{40, 252, 1, 0}));
  reference.cloud.intensity = {0, 0.5F, 0, 0};
  EXPECT_TRUE(contains(readReferenceLabels(reference).missing, "intensity 0.5"));
}

TEST(MapComparison, IntensitiesThatWereMeasuredAreNoLabels)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  for (const float value : {0.0F, 1.0F, 40.0F})  // 0: the recording has no intensities
  {
    reference.cloud.intensity.assign(reference.cloud.size(), value);
    const ReferenceLabels same = readReferenceLabels(reference);
    EXPECT_EQ(same.missing, "all intensities are " + std::to_string(std::lround(value)));
    EXPECT_TRUE(same.labels.empty());
  }
  reference.cloud.intensity = {0, 10, 117, 255};  // reflectivities
  const ReferenceLabels reflectivities = readReferenceLabels(reference);
  EXPECT_TRUE(contains(reflectivities.missing, "intensity 117")) << reflectivities.missing;
  EXPECT_TRUE(reflectivities.labels.empty());
  EXPECT_EQ(readReferenceLabels({reference.path, Scan()}).missing, "no intensity, no .label file");
}

TEST(MapComparison, LabelsSayWhetherTheyAreOfTheIntensity)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  reference.cloud.intensity = {0, 0, 1, 1};
  EXPECT_EQ(readReferenceLabels(reference).from_intensity, "0: static, 1: moving");
  reference.cloud.intensity = {40, 252, 1, 0};
  EXPECT_EQ(readReferenceLabels(reference).from_intensity, "SemanticKITTI classes");
  writeLabels(folder.file("a.label"), {40, 40, 252, 0});
  const ReferenceLabels of_file = readReferenceLabels(reference);
  EXPECT_EQ(of_file.from_intensity, "");
  EXPECT_EQ(of_file.labels, (std::vector<Label>{40, 40, 252, 0}));
}

TEST(MapComparison, MapsAreComparedByLabelsOrByDistance)
{
  const TestFolder folder;
  writePly(folder.file("b.ply"), square(1.3F).points);
  const ReferenceMap reference{folder.file("a.ply"), square(1)};
  const std::vector<NamedMap> maps{{"b", folder.file("b.ply")}};
  const MapComparisonReport by_distance = compareByDistance(reference, maps, folder.file("d.ply"));
  const auto distance = nlohmann::json::parse(by_distance.json)["maps"][0];
  EXPECT_EQ(by_distance.table.rows(), 2U);
  EXPECT_NEAR(distance["estimate"]["max_m"].get<double>(), 0.3, 1e-6);
  EXPECT_NE(folder.read("d.ply").find("scalar_distance"), std::string::npos);

  const MapComparisonReport by_labels = compareByLabels(
      reference, {label_static, label_static, label_static, label_moving}, maps, {});
  const auto points = nlohmann::json::parse(by_labels.json)["maps"][0]["by_point"];
  EXPECT_EQ(points["static"], 3);
  EXPECT_EQ(points["dynamic"], 1);
  EXPECT_DOUBLE_EQ(
      std::sqrt(points["preservation"].get<double>() * points["rejection"].get<double>()),
      points["geometric_mean"].get<double>());
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] {
                             (void)compareByDistance({"empty.ply", Scan()}, maps);
                           }),
                       "empty.ply: has no points"));
}

TEST(DistanceCloud, HasColoursAndDistances)
{
  const std::vector<Eigen::Vector3f> points{{0, 1, 0}, {1, 1, 0}};
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_EQ((Colour{0, 64, 255}), colourOfDistance(0));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(0.5F));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(100));
  EXPECT_EQ((Colour{128, 128, 128}), colourOfDistance(std::numeric_limits<float>::quiet_NaN()));
  const std::string ply = distancePly(points, {0.F, 0.7F});
  EXPECT_NE(std::string::npos, ply.find("element vertex 2\n"));
  EXPECT_NE(std::string::npos, ply.find("property float scalar_distance\n"));
  const std::string end = "end_header\n";
  ASSERT_EQ(ply.find(end) + end.size() + 2 * 19, ply.size());
  float last = 0;
  std::memcpy(&last, ply.data() + ply.size() - sizeof last, sizeof last);
  EXPECT_EQ(0.7F, last);
  EXPECT_THROW((void)distancePly(points, {0.F}), std::invalid_argument);
}
}  // namespace dyslam

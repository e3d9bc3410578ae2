// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/LabelFolders.h>
#include <dyslam/formats/LabelFiles.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A folder with the labels of two scans: a ground truth, and a run with the same labels but one.
 */
class LabelFolders : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    write("x.gt/labels/000000.label", {makeLabel(252, 1), makeLabel(10, 2), 40, 0});
    write("x.gt/labels/000001.label", {makeLabel(10, 1), makeLabel(10, 2), 40, 0});
    write("run/labels/000000.label", {makeLabel(252, 7), 9, 9, 9});
    write("run/labels/000001.label", {9, 9, 251, 9});
  }
  void write(const std::string& name, const std::vector<Label>& labels) const
  {
    std::filesystem::create_directories(std::filesystem::path(folder.file(name)).parent_path());
    writeLabels(folder.file(name), labels);
  }
  [[nodiscard]] LabelComparison compare(const std::string& estimate,
                                        const ReferenceReading& reading = {}) const
  {
    return compareLabelFolders(folder.file("x.gt"), folder.file(estimate), reading);
  }
  [[nodiscard]] std::string errorOf(const std::string& estimate) const
  {
    return messageOfError<UserError>([&] { (void)compare(estimate); });
  }

  const TestFolder folder;
};

TEST_F(LabelFolders, NumbersOfALearningMapAreNoticed)
{
  const auto warning = [&](const std::string& reference, const std::string& estimate)
  {
    return labelWarning(reference, estimate,
                        compareLabelFolders(folder.file(reference), folder.file(estimate)));
  };
  EXPECT_EQ(warning("x.gt", "run"), "");
  write("static/000000.label", {9, 9, 40, 0});
  EXPECT_EQ(warning("x.gt", "static"), "") << "nothing moves";
  write("learned/000000.label", {2, 1, 1, 0});
  const std::string said = warning("x.gt", "learned");
  EXPECT_TRUE(contains(said, "learned: no label is of a moving class (251 to 259), and 2 is no "))
      << said;
  EXPECT_EQ(warning("learned", "run").find("learned: no label"), 0U);
  write("mixed/000000.label", {251, 2, 1, 0});
  EXPECT_EQ(warning("x.gt", "mixed"), "") << "further static classes of another data set";
}

TEST_F(LabelFolders, ScansArePairedByName)
{
  write("run/labels/000007.label", {9});
  for (const std::string estimate : {"run", "run/labels", "run/labels/"})
  {
    const LabelComparison result = compare(estimate);
    EXPECT_EQ(result.reference_scans, 2U);
    EXPECT_EQ(result.estimated_scans, 3U);
    EXPECT_EQ(result.evaluator.scans(), 2U);
    const SegmentationScores& scores = result.evaluator.scores();
    EXPECT_EQ(scores.true_positives, 1U);
    EXPECT_EQ(scores.false_positives, 1U);
    EXPECT_EQ(scores.false_negatives, 0U);
    EXPECT_EQ(scores.true_negatives, 4U);
    EXPECT_EQ(scores.ignored, 2U);
  }
}

TEST_F(LabelFolders, APartOfTheScansIsNoted)
{
  EXPECT_EQ(partNote("x.gt", "run", compare("run")), "");
  write("run/labels/000007.label", {9});
  EXPECT_EQ(partNote("x.gt", "run", compare("run")),
            "run has labels of 3 scans, x.gt of 2; the figures are of the 2 that both have");
}

TEST_F(LabelFolders, SeveralReferencesHaveATotalOfEachMethod)
{
  const LabelComparison run = compare("run");  // 1 hit, 1 false alarm, 4 static
  write("other/labels/000000.label", {9, 9, 9, 9});
  const LabelComparison other = compare("other");  // 1 miss, 2 static
  Table table = segmentationTable({{"a/00", run}, {"a/01", other}});
  EXPECT_EQ(addTotalRows(table, {{"a/00", run}, {"a/01", other}}, {"00", "01"}), "");
  EXPECT_TRUE(contains(table.toCsv(), "\nall points,3,4,0.333333333,0.5,0.5,")) << table.toCsv();
  const NamedComparisons both{{"a/00", run}, {"a/01", other}, {"b/00", other}, {"b/01", other}};
  Table methods = segmentationTable(both);
  EXPECT_EQ(addTotalRows(methods, both, {"00", "01", "00", "01"}), "");
  EXPECT_TRUE(contains(methods.toCsv(), "\nall points of a,3,4,")) << methods.toCsv();
  EXPECT_TRUE(contains(methods.toCsv(), "\nall points of b,2,4,0,")) << methods.toCsv();
  Table none = segmentationTable(both);
  EXPECT_TRUE(contains(addTotalRows(none, both, {"00", "00", "01", "01"}), "no row of all points"));
  EXPECT_EQ(none.rows(), 4U);
}

TEST_F(LabelFolders, InstancesMayMoveInAllScansOrStand)
{
  ReferenceReading reading;
  reading.ever_moving = true;
  EXPECT_EQ(compare("run", reading).evaluator.scores().false_negatives, 1U)
      << "instance 1 in the second scan";
  reading.standing = {1};
  const LabelComparison standing = compare("run", reading);
  EXPECT_EQ(standing.evaluator.scores().true_positives, 0U);
  EXPECT_EQ(standing.evaluator.scores().false_positives, 2U);
}

TEST_F(LabelFolders, ProbabilitiesAreThoseOfTheRun)
{
  const std::vector<float> values{1, 0, 0.25F, 0};
  const std::string bytes(reinterpret_cast<const char*>(values.data()), 4 * sizeof(float));
  folder.write("run/probabilities/000001.bin", bytes);
  for (const std::string estimate : {"run", "run/labels", "run/labels/"})
  {
    const CalibrationEvaluator calibration = compare(estimate).calibration;
    EXPECT_EQ(calibration.points(), 3U) << estimate;
    EXPECT_NEAR(calibration.brierScore(), (1 + 0.0625) / 3, 1e-9) << estimate;
  }
  write("plain/000001.label", {9, 9, 9, 9});
  EXPECT_EQ(compare("plain").calibration.points(), 0U);
  folder.write("plain/probabilities/000001.bin", bytes);
  EXPECT_EQ(compare("plain").calibration.points(), 3U);
  folder.write("run/probabilities/000001.bin", bytes.substr(4));
  EXPECT_TRUE(contains(errorOf("run"), "000001.bin: has 12 bytes for 4 points of 4 bytes"))
      << errorOf("run");
}

TEST_F(LabelFolders, OtherFoldersAreErrors)
{
  EXPECT_TRUE(contains(errorOf("none"), "none: is not a folder"));
  folder.write("empty/a.txt", "");
  EXPECT_TRUE(contains(errorOf("empty"), "empty: has no .label files"));
  EXPECT_TRUE(contains(errorOf("x.gt/labels"), "labels: has the labels of the reference"));
  write("other/000002.label", {9, 9, 9, 9});
  EXPECT_TRUE(contains(errorOf("other"), "other: no .label file has the name of one in"));
  write("short/000001.label", {9, 9, 9});
  EXPECT_TRUE(contains(errorOf("short"), "000001.label")) << errorOf("short");
}
}  // namespace
}  // namespace dyslam

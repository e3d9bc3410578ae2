// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentationCommand.h"

#include <dyslam/benchmarks/LabelFolders.h>

#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct SegmentationArguments
{
  std::string reference;
  std::vector<std::string> estimates;
  bool ever_moving = false;
  std::vector<std::uint16_t> standing;
  OutputFlags output;
};

/** Points by true class, and probabilities if the estimate has them. */
void printDetails(const LabelComparison& result)
{
  std::cout << classTable(result).toText();
  if (result.calibration.points() > 0)
  {
    std::cout << '\n'
              << calibrationTable(result.calibration).toText() << "expected calibration error "
              << result.calibration.expectedError() << ", Brier score "
              << result.calibration.brierScore() << '\n';
  }
}

void runSegmentation(const SegmentationArguments& a)
{
  const ReferenceReading reading{a.ever_moving, {a.standing.begin(), a.standing.end()}};
  NamedComparisons results;
  for (const std::string& estimate : a.estimates)
  {
    results.emplace_back(estimate, compareLabelFolders(a.reference, estimate, reading));
    const std::string warning = labelWarning(a.reference, estimate, results.back().second);
    if (!warning.empty())
    {
      std::cerr << "warning: " << warning << '\n';
    }
  }
  a.output.write(segmentationTable(results), segmentationJson(results));
  for (const auto& [name, result] : results)
  {
    std::cout << '\n' << (results.size() > 1 ? name + ":\n" : "");
    printDetails(result);
  }
}
}  // namespace

Subcommand segmentationCommand(CLI::App& app)
{
  const auto a = std::make_shared<SegmentationArguments>();
  CLI::App* sub = app.add_subcommand(
      "segmentation", "IoU, precision and recall of moving points (SemanticKITTI .label files)");
  sub->add_option("--reference", a->reference, "folder of true labels, or a .gt folder")
      ->required();
  sub->add_option("--estimate", a->estimates, "folders of estimated labels, or of runs; any number")
      ->required();
  sub->add_flag("--ever-moving", a->ever_moving,
                "instances that move in one scan of the reference count as moving in all");
  sub->add_option("--standing", a->standing,
                  "instances that stand, although the reference calls them moving")
      ->delimiter(',');
  a->output.declare(*sub);
  return {sub, [a] { runSegmentation(*a); }};
}
}  // namespace dyslam

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
  std::string estimate;
  bool ever_moving = false;
  std::vector<std::uint16_t> standing;
  OutputFlags output;
};
}  // namespace

Subcommand segmentationCommand(CLI::App& app)
{
  const auto a = std::make_shared<SegmentationArguments>();
  CLI::App* sub = app.add_subcommand(
      "segmentation", "IoU, precision and recall of moving points (SemanticKITTI .label files)");
  sub->add_option("--reference", a->reference, "folder of true labels, or a .gt folder")
      ->required();
  sub->add_option("--estimate", a->estimate, "folder of estimated labels, or a run's folder")
      ->required();
  sub->add_flag("--ever-moving", a->ever_moving,
                "instances that move in one scan of the reference count as moving in all");
  sub->add_option("--standing", a->standing,
                  "instances that stand, although the reference calls them moving")
      ->delimiter(',');
  a->output.declare(*sub);
  return {sub, [a]
          {
            const LabelComparison result =
                compareLabelFolders(a->reference, a->estimate,
                                    {a->ever_moving, {a->standing.begin(), a->standing.end()}});
            a->output.write(segmentationTable({{a->estimate, result}}),
                            segmentationJson({{a->estimate, result}}));
            std::cout << '\n' << classTable(result).toText();
            if (result.calibration.points() > 0)
            {
              std::cout << '\n'
                        << calibrationTable(result.calibration).toText()
                        << "expected calibration error " << result.calibration.expectedError()
                        << ", Brier score " << result.calibration.brierScore() << '\n';
            }
          }};
}
}  // namespace dyslam

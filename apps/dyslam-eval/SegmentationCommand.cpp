// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentationCommand.h"

#include <dyslam/benchmarks/LabelFolders.h>

#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct SegmentationArguments
{
  std::vector<std::string> references;
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

/** What is to be known about the figures, on stderr. */
void printProblems(const std::string& reference,
                   const std::string& estimate,
                   const LabelComparison& result)
{
  if (const std::string warning = labelWarning(reference, estimate, result); !warning.empty())
  {
    std::cerr << "warning: " << warning << '\n';
  }
  if (const std::string note = partNote(reference, estimate, result); !note.empty())
  {
    printNote(note);
  }
}

void runSegmentation(const SegmentationArguments& a)
{
  requireOneOrEach("--reference", a.references.size(), a.estimates.size(), "estimates");
  const ReferenceReading reading{a.ever_moving, {a.standing.begin(), a.standing.end()}};
  NamedComparisons results;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const std::string& reference = oneOrEach(a.references, i);
    const std::string& estimate = a.estimates[i];
    results.emplace_back(estimate, compareLabelFolders(reference, estimate, reading));
    printProblems(reference, estimate, results.back().second);
  }
  Table table = segmentationTable(results);
  const std::string no_total =
      a.references.size() > 1 ? addTotalRows(table, results, a.references) : "";
  a.output.write(table, segmentationJson(results));
  if (!no_total.empty())
  {
    printNote(no_total);
  }
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
  sub->add_option("--reference", a->references,
                  "folder of true labels, or a .gt folder; one, or one for each estimate")
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

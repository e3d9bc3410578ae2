// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/io/RawlogSource.h>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
constexpr const char* part_header = "frame,sensor_label,stamp,first_point,points\n";

/** Rows of the table for a scan. */
std::string rowsOf(const Frame& frame)
{
  const Scan& scan = frame.scan;
  std::string rows;
  for (std::size_t i = 0; i < scan.parts.size(); ++i)
  {
    const ScanPart& part = scan.parts[i];
    const std::size_t end = i + 1 < scan.parts.size() ? scan.parts[i + 1].begin : scan.size();
    const std::string numbers =
        formatted(",%.9f,%zu,%zu\n", scan.stamp + part.stamp, part.begin, end - part.begin);
    rows += std::to_string(frame.index) + "," + csvField(part.sensor_label) + numbers;
  }
  return rows;
}

/** `scan_parts.csv`: scans of further lidars that were merged into each scan. */
class ScanPartOutput : public RunOutput
{
 public:
  explicit ScanPartOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::scan_parts}),
        is_wanted_(!context.config.get<RawlogSourceOptions>("input").further_lidars.empty())
  {
  }
  void open() override
  {
    if (is_wanted_)
    {
      file_.open(path(run_files::scan_parts), part_header);
    }
  }
  void add(const Frame& frame) override
  {
    if (is_wanted_)
    {
      file_.write(rowsOf(frame));
    }
  }
  void exchangeState(StateArchive& archive) override
  {
    if (is_wanted_)
    {
      file_.exchangeState(path(run_files::scan_parts), archive);
    }
  }
  void finish(const RunResults& /*results*/) override
  {
    if (is_wanted_)
    {
      file_.close();
    }
  }

 private:
  bool is_wanted_;
  StreamedFile file_;
};
}  // namespace

std::unique_ptr<RunOutput> makeScanPartOutput(const RunOutputContext& context)
{
  return std::make_unique<ScanPartOutput>(context);
}
}  // namespace dyslam

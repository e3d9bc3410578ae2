// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/io/RawlogSource.h>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
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
      file_.open(path(run_files::scan_parts), scanPartsHeader());
    }
  }
  void add(const Frame& frame) override
  {
    if (is_wanted_)
    {
      file_.write(scanPartRows(frame));
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

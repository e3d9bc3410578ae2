// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanTable.h>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
/** `scans.csv`: the result of each scan. */
class ScanTableOutput : public RunOutput
{
 public:
  explicit ScanTableOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::scan_table})
  {
  }
  void open() override { file_.open(path(run_files::scan_table), scanTableHeader()); }
  void add(const Frame& frame) override { file_.write(scanTableRow(frame)); }
  void exchangeState(StateArchive& archive) override
  {
    file_.exchangeState(path(run_files::scan_table), archive);
  }
  void finish(const RunResults& /*results*/) override { file_.close(); }

 private:
  StreamedFile file_;
};
}  // namespace

std::unique_ptr<RunOutput> makeScanTableOutput(const RunOutputContext& context)
{
  return std::make_unique<ScanTableOutput>(context);
}
}  // namespace dyslam

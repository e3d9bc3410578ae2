// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Files.h>
#include <dyslam/core/StateArchive.h>

#include "../RunOutput.h"
#include "ScanLabels.h"

namespace dyslam
{
namespace
{
constexpr const char* folder = "labels";
constexpr const char* extension = ".label";

/** `labels/NNNNNN.label`: SemanticKITTI labels of every point of the input scan. */
class LabelOutput : public RunOutput
{
 public:
  explicit LabelOutput(const RunOutputContext& context) : RunOutput(context, {{folder, extension}})
  {
  }
  [[nodiscard]] bool isSlow() const override { return true; }
  [[nodiscard]] FrameKind wants() const override { return FrameKind::decided; }
  void open() override { makeFolder(path(folder)); }
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      open();
    }
  }
  void add(const Frame& frame) override
  {
    writeLabels(numberedPath(path(folder), frame, extension), scanLabels(frame));
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeLabelOutput(const RunOutputContext& context)
{
  return std::make_unique<LabelOutput>(context);
}
}  // namespace dyslam

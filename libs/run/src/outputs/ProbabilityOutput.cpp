// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/TextFile.h>

#include <limits>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* probability_folder = "probabilities";
constexpr const char* probability_extension = ".bin";

/** Moving probability of every point of the frame's scan; NaN for points not in the cloud. */
std::vector<float> scanProbabilities(const Frame& frame)
{
  std::vector<float> result(frame.scan.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    result[frame.cloud.source[i]] =
        i < frame.moving_probability.size() ? frame.moving_probability[i] : 0.0F;
  }
  return result;
}

/** `probabilities/NNNNNN.bin`: float32 moving probability of every point of the input scan. */
class ProbabilityOutput : public RunOutput
{
 public:
  explicit ProbabilityOutput(const RunOutputContext& context)
      : RunOutput(context, {{probability_folder, probability_extension}})
  {
  }
  [[nodiscard]] OutputThread thread() const override { return OutputThread::writer; }
  [[nodiscard]] WantedFrames wants() const override { return WantedFrames::final_scans; }
  void open() override { makeFolder(path(probability_folder)); }
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      open();
    }
  }
  void add(const Frame& frame) override
  {
    writeWhole(numberedPath(path(probability_folder), frame.index, probability_extension),
               bytesOf(scanProbabilities(frame)), Durable::no);
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeProbabilityOutput(const RunOutputContext& context)
{
  return std::make_unique<ProbabilityOutput>(context);
}
}  // namespace dyslam

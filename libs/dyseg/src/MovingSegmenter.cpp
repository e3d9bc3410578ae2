// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/ResidualSegmenter.h>

namespace dyslam
{
void MovingSegmenterOptions::describe(OptionsVisitor& visitor)
{
  visitor.word("method", method, segmenterMethods(), "what finds the moving points");
}

std::vector<std::string> segmenterMethods()
{
  return {"none", "residual"};
}

std::unique_ptr<MovingSegmenter> makeSegmenter(ConfigLoader& config, ThreadPool& pool)
{
  const auto options = config.get<MovingSegmenterOptions>("dyseg");
  const auto residual = config.get<ResidualSegmenterOptions>("residual");
  if (options.method == "residual")
  {
    return std::make_unique<ResidualSegmenter>(residual, pool);
  }
  return nullptr;
}
}  // namespace dyslam

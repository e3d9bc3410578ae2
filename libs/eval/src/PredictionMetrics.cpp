// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/PredictionMetrics.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyslam
{
PredictionError predictionError(OneStepPredictor& predictor,
                                const PlanarTrack& observations,
                                const PlanarTrack& truth,
                                std::size_t warm_up)
{
  std::vector<double> errors;
  double sum = 0;
  std::size_t observed = 0;
  for (const auto& [frame, position] : observations)
  {
    predictor.observe(frame, position);
    ++observed;
    const auto next = truth.find(frame + 1);
    if (observed < warm_up || next == truth.end())
    {
      continue;
    }
    if (const auto predicted = predictor.predict(frame + 1))
    {
      errors.push_back((*predicted - next->second).norm());
      sum += errors.back() * errors.back();
    }
  }
  PredictionError result;
  result.predictions = errors.size();
  if (!errors.empty())
  {
    result.rmse = std::sqrt(sum / static_cast<double>(errors.size()));
    std::sort(errors.begin(), errors.end());
    result.median = errors[errors.size() / 2];
    result.max = errors.back();
  }
  return result;
}
}  // namespace dyslam

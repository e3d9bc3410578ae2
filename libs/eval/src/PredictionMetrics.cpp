// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>
#include <dyslam/eval/PredictionMetrics.h>

#include <vector>

namespace dyslam
{
Statistics predictionError(OneStepPredictor& predictor,
                           const PlanarTrack& observations,
                           const PlanarTrack& truth,
                           std::size_t warm_up)
{
  std::vector<double> errors;
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
    }
  }
  return statisticsOf(errors);
}
}  // namespace dyslam

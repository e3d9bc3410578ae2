// SPDX-License-Identifier: BSD-3-Clause
#include "DyloPairs.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/RandomDraws.h>
#include <dyslam/train/RecordingPairSource.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "SimulatorPairSource.h"

namespace dyslam
{
namespace
{
constexpr std::size_t min_body_points = 120;

std::vector<Body> readBodies(const DataOptions& data,
                             const std::string& base,
                             const DataSplits& splits)
{
  std::vector<Body> bodies;
  for (const std::string& folder : listItems(data.bodies, '|'))
  {
    for (const std::string& file : listBinFiles(dataPath(base, folder)))
    {
      splits.requireScan(file, Split::training, "[data] bodies");
    }
    for (Body& body : loadBodies(dataPath(base, folder), min_body_points))
    {
      bodies.push_back(std::move(body));
    }
  }
  return bodies;
}

std::vector<std::vector<Eigen::Vector3f>> readSingleScans(const DataOptions& data,
                                                          const std::string& base,
                                                          const DataSplits& splits)
{
  std::vector<std::vector<Eigen::Vector3f>> scans;
  for (const std::string& folder : listItems(data.singles, '|'))
  {
    for (const std::string& file : listBinFiles(dataPath(base, folder)))
    {
      splits.requireScan(file, Split::training, "[data] singles");
      scans.push_back(readTrainingPoints(file, std::numeric_limits<float>::quiet_NaN()));
    }
  }
  return scans;
}

/** Labels of the nodes of levels 1 to 4. */
std::vector<torch::Tensor> nodeLabels(const PreparedScan& scan,
                                      const std::vector<PointLabel>& labels)
{
  std::vector<torch::Tensor> result(PreparedScan::level_count);
  for (std::size_t l = 1; l < PreparedScan::level_count; ++l)
  {
    const auto& cells = scan.levels[l].cell;
    result[l] = torch::zeros({static_cast<std::int64_t>(cells.size())}, torch::kLong);
    for (std::size_t n = 0; n < cells.size(); ++n)
    {
      const std::int32_t source =
          cells[n] >= 0 ? scan.source[static_cast<std::size_t>(cells[n])] : -1;
      if (source >= 0 && !labels.empty())
      {
        result[l].data_ptr<std::int64_t>()[n] =
            static_cast<std::int64_t>(labels[static_cast<std::size_t>(source)]);
      }
    }
  }
  return result;
}

/** Initial guess of the network: zero motion, or the truth with the errors of a prediction. */
Pose drawInitialGuess(const Pose& truth,
                      double perturbed_starts,
                      std::uint64_t seed,
                      std::uint64_t index)
{
  RandomDraws draws(seed ^ 0x57A27ULL, index);
  constexpr double reach = 1.5;  // range of a search from zero motion [m]
  const double share =
      truth.translation().norm() > reach ? std::max(perturbed_starts, 0.8) : perturbed_starts;
  if (perturbed_starts <= 0 || !draws.chance(share))
  {
    return Pose::Identity();
  }
  const double meters = 0.02 * std::pow(25.0, draws.uniform());
  const double radians = 0.001 * std::pow(15.0, draws.uniform());
  const auto [x, y, z, yaw, pitch, roll] = draws.normals<6>(
      {meters, 0.3 * meters, 0.15 * meters, radians, 0.3 * radians, 0.3 * radians});
  return truth * poseFromYpr(x, y, z, yaw, pitch, roll);
}
}  // namespace

std::unique_ptr<PairSource> makeDyloPairSource(const DataOptions& data,
                                               const AugmentationOptions& augmentation,
                                               const std::string& base,
                                               const DataSplits& splits,
                                               std::uint64_t seed)
{
  const std::vector<Body> bodies = readBodies(data, base, splits);
  auto mixed = std::make_unique<MixedPairSource>(seed);
  if (data.recordings_weight > 0 && !data.recordings.empty())
  {
    mixed->add(std::make_unique<RecordingPairSource>(
                   loadRecordings(data.recordings, base, splits, Split::training), bodies,
                   augmentation, data.max_gap, seed),
               data.recordings_weight);
  }
  if (data.singles_weight > 0 && !data.singles.empty())
  {
    mixed->add(std::make_unique<SingleScanSource>(readSingleScans(data, base, splits), bodies,
                                                  augmentation, seed),
               data.singles_weight);
  }
  if (data.simulator_weight > 0)
  {
    mixed->add(makeSimulatorPairSource(listItems(data.simulator_worlds, '|'), augmentation,
                                       data.max_gap, splits.trainingSeeds(), seed),
               data.simulator_weight);
  }
  if (mixed->empty())
  {
    throw UserError("[data]: no training data; set recordings, singles or simulator_weight");
  }
  return mixed;
}

PreparedDyloPair prepareDyloPair(const TrainingPair& pair,
                                 double perturbed_starts,
                                 std::uint64_t seed,
                                 std::uint64_t index,
                                 torch::Device device)
{
  const PreparedScan prepared1 = prepareScan(pair.points1);
  PreparedDyloPair result;
  result.scan1 = toTensors(prepared1, device);
  result.scan2 = toTensors(prepareScan(pair.points2), device);
  result.labels = nodeLabels(prepared1, pair.labels1);
  for (torch::Tensor& label : result.labels)
  {
    label = label.defined() ? label.to(device) : label;
  }
  result.T_2_1 = pair.T_2_1;
  result.start = drawInitialGuess(pair.T_2_1, perturbed_starts, seed, index);
  return result;
}
}  // namespace dyslam

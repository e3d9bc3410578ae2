// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/TensorFile.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace dyslam
{
namespace
{
constexpr const char* kind = "dyslam-dyseg";
constexpr const char* version = "5";

torch::Tensor shapeOf(const DysegNetworkOptions& o)
{
  return torch::tensor(
      std::vector<std::int64_t>{o.pillar_channels, o.half_channels, o.quarter_channels,
                                o.matching_channels, o.fine_channels, o.hidden, o.radius,
                                o.fine_radius},
      torch::kInt64);
}

torch::Tensor gridOf(const BevOptions& grid)
{
  return torch::tensor(
      {static_cast<double>(grid.cells), grid.cell_size, grid.ground_clearance, grid.max_height},
      torch::kFloat64);
}

/** Values of a list in the file. \throws UserError if there are not as many, or one is not
 * between 0 and 10,000. */
std::vector<double> valuesOf(const TensorFile& file,
                             const std::string& path,
                             const char* name,
                             std::int64_t count)
{
  const torch::Tensor list = file.tensor(name).to(torch::kFloat64);
  if (list.dim() != 1 || list.size(0) != count ||
      !list.ge(0).logical_and(list.le(1e4)).all().item<bool>())
  {
    throw UserError(path + ": " + name + " is not that of a DySeg network");
  }
  return {list.data_ptr<double>(), list.data_ptr<double>() + count};
}

DysegNetworkOptions optionsOf(const std::vector<double>& shape)
{
  DysegNetworkOptions o;
  std::size_t i = 0;
  for (int* value : {&o.pillar_channels, &o.half_channels, &o.quarter_channels,
                     &o.matching_channels, &o.fine_channels, &o.hidden, &o.radius, &o.fine_radius})
  {
    *value = static_cast<int>(shape[i++]);
  }
  return o;
}

BevOptions gridOptionsOf(const std::vector<double>& grid)
{
  BevOptions o;
  o.cells = static_cast<int>(grid[0]);
  o.cell_size = grid[1];
  o.ground_clearance = grid[2];
  o.max_height = grid[3];
  return o;
}
}  // namespace

void saveDyseg(const DysegNetwork& network, const std::string& path)
{
  TensorFile file;
  file.setText("kind", kind);
  file.setText("version", version);
  file.set("shape", shapeOf(network.net->options()));
  file.set("grid", gridOf(network.grid));
  file.setWeights("weights.", *network.net, torch::kFloat16);
  file.write(path);
}

DysegNetwork loadDyseg(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw UserError(path + ": no such file; give the weights of a DySeg network");
  }
  const TensorFile file(path);
  if (file.text("kind") != kind || file.text("version") != version)
  {
    throw UserError(path +
                    ": weights of another network or version; give a dyseg.safetensors trained "
                    "with this version");
  }
  const DysegNetworkOptions shape = optionsOf(valuesOf(file, path, "shape", 8));
  DysegNetwork network;
  network.grid = gridOptionsOf(valuesOf(file, path, "grid", 4));
  try
  {
    validate(shape, "network");
    validate(network.grid, "grid");
  }
  catch (const UserError& error)
  {
    throw UserError(path + ": " + error.what() + "; train the network again");
  }
  network.net = DysegNet(shape);
  file.loadWeights("weights.", *network.net);
  return network;
}
}  // namespace dyslam

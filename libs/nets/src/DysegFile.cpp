// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/SaveArchive.h>
#include <dyslam/nets/WeightsChecksum.h>

#include <filesystem>

namespace dyslam
{
namespace
{
constexpr const char* kind = "dyslam-dyseg";
constexpr std::int64_t version = 4;

std::vector<std::int64_t> shapeOf(const DysegNetworkOptions& o)
{
  return {
      version,         o.pillar_channels, o.half_channels, o.quarter_channels, o.matching_channels,
      o.fine_channels, o.hidden,          o.radius,        o.fine_radius};
}

DysegNetworkOptions optionsOf(const torch::Tensor& shape)
{
  const auto value = [&](std::int64_t i)
  { return static_cast<int>(shape[i].item<std::int64_t>()); };
  DysegNetworkOptions o;
  o.pillar_channels = value(1);
  o.half_channels = value(2);
  o.quarter_channels = value(3);
  o.matching_channels = value(4);
  o.fine_channels = value(5);
  o.hidden = value(6);
  o.radius = value(7);
  o.fine_radius = value(8);
  return o;
}
}  // namespace

void saveDyseg(const DysegNetwork& network, const std::string& file)
{
  torch::NoGradGuard no_gradient;
  torch::serialize::OutputArchive archive;
  archive.write("kind", c10::IValue(std::string(kind)));
  archive.write("shape", torch::tensor(shapeOf(network.net->options())));
  archive.write("grid",
                torch::tensor({static_cast<double>(network.grid.cells), network.grid.cell_size,
                               network.grid.ground_clearance, network.grid.max_height},
                              torch::kFloat64));
  for (const auto& p : network.net->named_parameters())
  {
    archive.write("weights." + p.key(), p.value().cpu().contiguous().to(torch::kFloat16));
  }
  writeChecksum(checksumOf(*network.net, torch::kFloat16), archive);
  saveArchive(archive, file);
}

DysegNetwork loadDyseg(const std::string& file)
{
  if (!std::filesystem::is_regular_file(file))
  {
    throw UserError(file + ": no such file; give the weights of a DySeg network");
  }
  torch::NoGradGuard no_gradient;
  DysegNetwork network;
  try
  {
    torch::serialize::InputArchive archive;
    archive.load_from(file);
    c10::IValue found;
    archive.read("kind", found);
    torch::Tensor shape;
    torch::Tensor grid;
    archive.read("shape", shape);
    archive.read("grid", grid);
    if (found.toStringRef() != kind || shape[0].item<std::int64_t>() != version)
    {
      throw UserError(
          file +
          ": weights of another network or version; give a dyseg.pt trained with this version");
    }
    network.net = DysegNet(optionsOf(shape));
    network.grid.cells = static_cast<int>(grid[0].item<double>());
    network.grid.cell_size = grid[1].item<double>();
    network.grid.ground_clearance = grid[2].item<double>();
    network.grid.max_height = grid[3].item<double>();
    for (auto& p : network.net->named_parameters())
    {
      torch::Tensor value;
      archive.read("weights." + p.key(), value);
      TORCH_CHECK(value.sizes() == p.value().sizes(), "shape of ", p.key());
      p.value().copy_(value);
    }
    verifyChecksum(*network.net, archive, file);
  }
  catch (const UserError&)
  {
    throw;
  }
  catch (const std::exception&)  // torch's exceptions for foreign files have no common type
  {
    throw UserError(file + ": not a DySeg network; retrain it or use the one that is shipped");
  }
  return network;
}
}  // namespace dyslam

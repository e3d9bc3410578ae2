// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/nets/TensorFile.h>

#include <filesystem>

namespace dyslam
{
namespace
{
constexpr const char* section = "dylo_network";
constexpr const char* kind = "dyslam-dylo";
constexpr const char* version = "1";
}  // namespace

void saveDylo(DyloNetwork& network, const std::string& path)
{
  TensorFile file;
  Config config;
  save(network->options(), config, section);
  file.setText("kind", kind);
  file.setText("version", version);
  file.setText("options", config.toIni());
  file.setWeights("weights.", *network);
  file.write(path);
}

bool isDyloModel(const std::string& path)
{
  try
  {
    return TensorFile(path).text("kind") == kind;
  }
  catch (const UserError&)
  {
    return false;
  }
}

DyloNetwork loadDylo(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw UserError(path + ": no such DyLO model; give a dylo.safetensors made by dyslam-train");
  }
  const TensorFile file(path);
  if (file.text("kind") != kind)
  {
    throw UserError(path +
                    ": is not a DyLO model; give a dylo.safetensors made by dyslam-train dylo");
  }
  if (file.text("version") != version)
  {
    throw UserError(path + ": is a DyLO model of version " + file.text("version") +
                    ", this program reads version " + version);
  }
  DyloNetworkOptions options;
  load(options, Config::fromText(file.text("options"), path), section);
  DyloNetwork network(options);
  file.loadWeights("weights.", *network);
  return network;
}
}  // namespace dyslam

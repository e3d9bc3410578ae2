// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/nets/SaveArchive.h>
#include <dyslam/nets/WeightsChecksum.h>

#include <filesystem>

namespace dyslam
{
namespace
{
constexpr const char* section = "dylo_network";
}

void saveDylo(DyloNetwork& network, const std::string& path)
{
  torch::serialize::OutputArchive archive;
  Config config;
  save(network->options(), config, section);
  archive.write("dyslam_dylo_version", torch::IValue(static_cast<std::int64_t>(1)));
  archive.write("options", torch::IValue(config.toIni()));
  network->save(archive);
  writeChecksum(checksumOf(*network), archive);
  saveArchive(archive, path);
}

bool isDyloModel(const std::string& path)
{
  try
  {
    torch::serialize::InputArchive archive;
    archive.load_from(path);
    torch::IValue version;
    return archive.try_read("dyslam_dylo_version", version);
  }
  catch (const std::exception&)  // torch's exceptions for foreign files have no common type
  {
    return false;
  }
}

DyloNetwork loadDylo(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw UserError(path +
                    ": no such DyLO model; give the path of a .pt file made by dyslam-train");
  }
  torch::serialize::InputArchive archive;
  torch::IValue version;
  torch::IValue text;
  try
  {
    archive.load_from(path);
    if (!archive.try_read("dyslam_dylo_version", version) || !archive.try_read("options", text))
    {
      throw UserError(path + ": is not a DyLO model; give a dylo.pt made by dyslam-train dylo");
    }
  }
  catch (const UserError&)
  {
    throw;
  }
  catch (const std::exception&)
  {
    throw UserError(
        path + ": is not a DyLO model or is damaged; give a dylo.pt made by dyslam-train dylo");
  }
  if (version.toInt() != 1)
  {
    throw UserError(path + ": is a DyLO model of version " + std::to_string(version.toInt()) +
                    ", this program reads version 1");
  }
  DyloNetworkOptions options;
  load(options, Config::fromText(text.toStringRef(), path), section);
  DyloNetwork network(options);
  try
  {
    network->load(archive);
  }
  catch (const std::exception&)
  {
    throw UserError(path + ": its weights do not fit the network of this program; train it again");
  }
  verifyChecksum(*network, archive, path);
  return network;
}
}  // namespace dyslam

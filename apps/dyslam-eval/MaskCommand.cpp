// SPDX-License-Identifier: BSD-3-Clause
#include "MaskCommand.h"

#include <dyslam/base/Files.h>
#include <dyslam/eval/Table.h>
#include <dyslam/plot/MaskPicture.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "OutputFiles.h"

namespace dyslam
{
Subcommand maskCommand(CLI::App& app)
{
  struct Arguments
  {
    std::vector<std::string> files;
  };
  const auto a = std::make_shared<Arguments>();
  Subcommand command;
  command.parser = app.add_subcommand(
      "mask", "plots the static confidence of DyLO's network and its ROC curve, one PNG per file");
  command.parser->add_option("files", a->files, "CSV files of dyslam-train dylo --mask-csv")
      ->required();
  command.run = [a]
  {
    Table table({"scan", "static", "moving", "area under ROC", "picture"});
    for (const auto& file : a->files)
    {
      const std::filesystem::path path(file);
      MaskScan scan =
          parseMaskScan(readWhole(file, "give a file of dyslam-train dylo --mask-csv"), file);
      scan.name = path.stem().string();
      const auto picture = renderMaskScan(scan);
      const auto to = std::filesystem::path(file).replace_extension(".png").string();
      writePng(to, picture);
      table.addRow(
          {scan.name,
           TableCell(static_cast<double>(sampledPoints(scan, MaskScan::Truth::stationary)), 0),
           TableCell(static_cast<double>(sampledPoints(scan, MaskScan::Truth::moving)), 0),
           TableCell(areaUnderCurve(scan), 3), to});
    }
    std::fputs(table.toText().c_str(), stdout);
  };
  return command;
}
}  // namespace dyslam

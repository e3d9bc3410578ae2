// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/batch/Manifest.h>
#include <dyslam/formats/ExternalFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <openssl/evp.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
using Json = nlohmann::ordered_json;
constexpr const char* file_name = "manifest.json";

class Sha256
{
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free)
  {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(const char* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string digits()
  {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes = {};
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), bytes.data(), &size);
    std::string text;
    for (unsigned i = 0; i < size; ++i)
    {
      text += "0123456789abcdef"[bytes.at(i) >> 4U];
      text += "0123456789abcdef"[bytes.at(i) & 15U];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

struct FileState
{
  std::uintmax_t bytes = 0;
  std::int64_t time = 0;  //!< time of the last change [ns]
};

std::optional<FileState> stateOf(const std::string& path)
{
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0)
  {
    return std::nullopt;
  }
  return FileState{
      static_cast<std::uintmax_t>(status.st_size),
      std::int64_t{status.st_mtim.tv_sec} * 1000000000 + std::int64_t{status.st_mtim.tv_nsec}};
}

/** Total size and latest change of the files and folders in a folder; a folder changes when a file
 * is removed. */
FileState stateOfFolder(const std::string& folder)
{
  FileState all;
  all.time = stateOf(folder).value_or(FileState()).time;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
  {
    const FileState one = stateOf(entry.path().string()).value_or(FileState());
    all.bytes += entry.is_regular_file() ? one.bytes : 0;
    all.time = std::max(all.time, one.time);
  }
  return all;
}

/** The folder with the files of a recording: the recording itself, or the folder of a rawlog's
 * external files. */
std::optional<std::string> folderOfFiles(const std::string& path)
{
  return fs::is_directory(path) ? path : externalFolderOf(path);
}

/** Whether a recording can be taken for unchanged without reading it: same path, sizes and times.
 */
bool looksUnchanged(const Work& known, const Work& now)
{
  return known.input == now.input && known.input_bytes == now.input_bytes &&
         known.input_time == now.input_time && known.external_bytes == now.external_bytes &&
         known.external_time == now.external_time;
}

/** Checksum of a rawlog and its external files in a folder beside it, or of all files of a
 * recording that is a folder. */
std::string checksumOfRecording(const std::string& path)
{
  const auto folder = folderOfFiles(path);
  if (!folder)
  {
    return checksumOfFile(path);
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(*folder))
  {
    if (entry.is_regular_file())
    {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  std::string all = fs::is_directory(path) ? "" : checksumOfFile(path);
  for (const std::string& file : files)
  {
    all += fs::path(file).filename().string() + checksumOfFile(file);
  }
  return checksumOfText(all);
}

State stateFromText(const std::string& text)
{
  for (const State state : {State::running, State::done, State::unregistered, State::failed})
  {
    if (text == toString(state))
    {
      return state;
    }
  }
  return State::unknown;
}
}  // namespace

std::string checksumOfText(const std::string& text)
{
  Sha256 sum;
  sum.add(text.data(), text.size());
  return sum.digits();
}

std::string checksumOfFile(const std::string& path)
{
  auto file = openBinary(path);
  Sha256 sum;
  std::vector<char> part(1U << 20U);
  while (file)
  {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    sum.add(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  requireReadable(file, path);
  return sum.digits();
}

const char* toString(State state)
{
  switch (state)
  {
    case State::running:
      return "running";
    case State::done:
      return "done";
    case State::unregistered:
      return "unregistered";
    case State::failed:
      return "failed";
    default:
      return "not run";
  }
}

std::optional<Manifest> readManifest(const std::string& folder)
{
  const fs::path path = fs::path(folder) / file_name;
  if (!fs::is_regular_file(path))
  {
    return std::nullopt;
  }
  try
  {
    const Json json = Json::parse(readWhole(path.string()));
    Manifest m;
    m.state = stateFromText(json.at("state"));
    m.reason = json.at("reason");
    const bool has_signal = m.reason.rfind("ended by the signal ", 0) == 0;
    m.interrupted = json.value(
        "interrupted", has_signal);  // manifests of earlier versions: derived from the reason
    m.attempts = json.at("attempts");
    m.seconds = json.at("seconds");
    m.peak_memory = json.at("peak_memory_bytes");
    m.settings_checksum = json.at("effective_ini_sha256");
    m.work.input = json.at("input").at("path");
    m.work.input_bytes = json.at("input").at("bytes");
    m.work.input_time = json.at("input").at("changed_ns");
    m.work.external_bytes = json.at("input").value("external_bytes", std::uintmax_t{0});
    m.work.external_time = json.at("input").value("external_changed_ns", std::int64_t{0});
    m.work.input_checksum = json.at("input").at("sha256");
    m.work.settings = json.at("settings");
    m.work.version = json.at("program").at("version");
    m.work.program_checksum = json.at("program").at("sha256");
    return m;
  }
  catch (const Json::exception&)
  {
    return std::nullopt;
  }
}

void writeManifest(const std::string& folder, const Manifest& m)
{
  Json json;
  json["state"] = toString(m.state);
  json["reason"] = m.reason;
  json["interrupted"] = m.interrupted;
  json["attempts"] = m.attempts;
  json["seconds"] = m.seconds;
  json["peak_memory_bytes"] = m.peak_memory;
  json["input"] = {{"path", m.work.input},
                   {"bytes", m.work.input_bytes},
                   {"changed_ns", m.work.input_time},
                   {"external_bytes", m.work.external_bytes},
                   {"external_changed_ns", m.work.external_time},
                   {"sha256", m.work.input_checksum}};
  json["settings"] = m.work.settings;
  json["effective_ini_sha256"] = m.settings_checksum;
  json["program"] = {{"version", m.work.version}, {"sha256", m.work.program_checksum}};
  writeWhole((fs::path(folder) / file_name).string(),
             json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Work workOn(const std::string& input, const Work& common, const std::optional<Manifest>& known)
{
  const auto file = stateOf(input);
  if (!file)
  {
    throw UserError(input + ": no such file");
  }
  const auto folder = folderOfFiles(input);
  const FileState external = folder ? stateOfFolder(*folder) : FileState();
  Work work = common;
  work.input = input;
  work.input_bytes = fs::is_directory(input) ? 0 : file->bytes;
  work.input_time = file->time;
  work.external_bytes = external.bytes;
  work.external_time = external.time;
  const bool unchanged = known && looksUnchanged(known->work, work);
  work.input_checksum = unchanged ? known->work.input_checksum : checksumOfRecording(input);
  return work;
}

bool isSame(const Work& a, const Work& b)
{
  return a.input_checksum == b.input_checksum && a.settings == b.settings &&
         a.version == b.version && a.program_checksum == b.program_checksum;
}

bool isDone(const std::string& folder, const Work& work, const std::optional<Manifest>& known)
{
  const fs::path settings = fs::path(folder) / run_files::settings;
  return known && known->hasResults() && isSame(known->work, work) &&
         fs::is_regular_file(fs::path(folder) / run_files::report) &&
         fs::is_regular_file(settings) &&
         checksumOfFile(settings.string()) == known->settings_checksum;
}
}  // namespace dyslam::batch

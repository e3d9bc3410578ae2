// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/batch/Recordings.h>
#include <dyslam/formats/ExternalFiles.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RecordingOrigin.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <glob.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <system_error>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
using Note = std::function<void(const std::string&)>;

constexpr int deepest_list = 8;  // depth of list files within list files

/** Whether a folder is that of a run, whose rawlogs are results, not recordings. */
bool isRun(const fs::path& folder)
{
  return fs::exists(folder / run_files::report) || fs::exists(folder / "manifest.json");
}

/** Whether a folder is a ROS 2 bag, which has metadata. Any other folder with bags is a folder of
 * recordings. */
bool isBagFolder(const std::string& folder)
{
  return fs::is_regular_file(fs::path(folder) / "metadata.yaml") && isBag(folder);
}

/** Whether a folder is certainly one recording. Folders of point clouds may be something else. */
bool isRecordingFolder(const std::string& folder)
{
  return isBagFolder(folder) || officialKittiKind(folder).has_value();
}

/** What a folder of recordings holds. */
struct Findings
{
  std::vector<std::string> recordings;     //!< without folders of point clouds
  std::vector<std::string> cloud_folders;  //!< folders of point clouds that count as recordings
  std::vector<std::string> other_clouds;   //!< other folders of point clouds
  std::size_t runs = 0;                    //!< output folders of runs
};

/** Whether a folder that the user names is one recording. Its clouds may be maps: those of a run,
 * or beside recordings. */
bool isRecordingNamed(const std::string& folder, const Findings& inside)
{
  const RecordingKind kind = recordingKind(folder);
  return kind == RecordingKind::bag     ? isBagFolder(folder)
         : kind == RecordingKind::scans ? inside.recordings.empty() && !isRun(folder)
                                        : kind != RecordingKind::unknown;
}

bool isRecordingFile(const fs::path& path)
{
  const bool is_hidden = path.filename().string()[0] == '.';  // as ._a.bag of macOS
  return !is_hidden &&
         (path.extension() == ".rawlog" || recordingKind(path.string()) != RecordingKind::unknown);
}

/** Whether a folder is the ground truth or the external storage of a rawlog beside it. */
bool isOfRawlog(const fs::path& folder)
{
  const std::string name = folder.filename().string();
  const std::size_t ending = name.find_last_of("._");
  if (ending == std::string::npos)
  {
    return false;
  }
  const std::string rawlog = (folder.parent_path() / (name.substr(0, ending) + ".rawlog")).string();
  std::error_code none;
  return fs::is_regular_file(rawlog, none) &&
         (folder.extension() == ".gt" || externalFolderOf(rawlog) == folder.string());
}

/** Adds an entry of a folder if it is a recording, or all recordings in it, at any depth. Links to
 * folders are not followed. \param depth of the entry below the folder that the user names; 0:
 * directly in it \throws UserError for a folder that cannot be read. */
void addRecordings(const fs::directory_entry& entry, int depth, Findings& found)
{
  std::error_code none;
  const std::string path = entry.path().string();
  if (!entry.is_directory(none))
  {
    if (entry.is_regular_file(none) && isRecordingFile(entry.path()))
    {
      found.recordings.push_back(path);
    }
    return;
  }
  const bool is_of_disk = entry.path().filename() == "lost+found";  // only root can read it
  if (is_of_disk || isOfRawlog(entry.path()))
  {
    return;
  }
  const auto inside = entriesOf(entry.path());
  if (isRun(entry.path()))
  {
    ++found.runs;
    return;
  }
  if (isRecordingFolder(path))
  {
    found.recordings.push_back(path);
    return;
  }
  const std::size_t before = found.recordings.size();
  for (const auto& one : inside)
  {
    if (!entry.is_symlink(none))
    {
      addRecordings(one, depth + 1, found);
    }
  }
  const auto clouds =
      std::count_if(inside.begin(), inside.end(),
                    [](const auto& one) { return isCloudFile(one.path().string()); });
  if (clouds > 0)
  {
    const bool is_recording = clouds > 1 && depth == 0 && found.recordings.size() == before;
    (is_recording ? found.cloud_folders : found.other_clouds).push_back(path);
  }
}

/** What a folder holds; nothing if it is that of a run. */
Findings within(const std::string& folder)
{
  Findings found;
  if (isRun(folder))
  {
    return found;
  }
  for (const auto& entry : entriesOf(folder))
  {
    addRecordings(entry, 0, found);
  }
  return found;
}

/** Adds the recordings in a folder, by path. \param note gets a line about what is left out */
void addFound(const std::string& folder,
              const Findings& found,
              const Note& note,
              std::vector<std::string>& files)
{
  std::vector<std::string> all = found.recordings;
  all.insert(all.end(), found.cloud_folders.begin(), found.cloud_folders.end());
  std::sort(all.begin(), all.end());
  files.insert(files.end(), all.begin(), all.end());
  std::string left_out;
  if (!found.other_clouds.empty())
  {
    left_out = counted(found.other_clouds.size(), "folder") + " of point clouds (" +
               found.other_clouds.front() + (found.other_clouds.size() > 1 ? ", ..." : "") +
               "; name those that are recordings)";
  }
  if (found.runs > 0)
  {
    appendWord(left_out, counted(found.runs, "output folder") + " of runs");
  }
  if (note && !left_out.empty() && !all.empty())
  {
    note(folder + ": left out: " + left_out);
  }
}

std::vector<std::string> matching(const std::string& pattern)
{
  glob_t found = {};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
  {
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  ::globfree(&found);
  return files;
}

/** \param list in which the entry is; empty if the user names it */
void expand(const std::string& entry,
            int depth,
            const Note& note,
            std::vector<std::string>& files,
            const std::string& list = "");

void expandList(const std::string& list,
                int depth,
                const Note& note,
                std::vector<std::string>& files)
{
  if (depth >= deepest_list)
  {
    throw UserError(list + ": lists within lists, without end; name recordings in it");
  }
  std::string text = readWhole(list);
  removeByteOrderMark(text);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
  {
    line.erase(std::min(line.find('#'), line.size()));
    line = trimmed(line);
    if (!line.empty())
    {
      expand((fs::path(list).parent_path() / line).string(), depth + 1, note, files, list);
    }
  }
}

void expand(const std::string& entry,
            int depth,
            const Note& note,
            std::vector<std::string>& files,
            const std::string& list)
{
  const std::size_t before = files.size();
  std::error_code no_path;  // a line of another text file may be too long for one
  std::string why =
      ": has no recordings (.rawlog, .bag, .mcap, .db3, .pcap, KITTI drives, and directly in it "
      "folders of several point clouds; those in folders of runs are results; any other folder of "
      "point clouds must be named itself)";
  if (fs::is_directory(entry, no_path))
  {
    const Findings found = within(entry);
    if (isRecordingNamed(entry, found))
    {
      files.push_back(entry);
    }
    else
    {
      addFound(entry, found, note, files);
    }
  }
  else if (fs::is_regular_file(entry, no_path))
  {
    if (fs::path(entry).extension() == ".txt")
    {
      expandList(entry, depth, note, files);
    }
    else
    {
      files.push_back(entry);
    }
  }
  else if (entry.find_first_of("*?[") != std::string::npos)
  {
    for (const std::string& one : matching(entry))
    {
      expand(one, depth, note, files, list);
    }
    why = ": no file matches";
  }
  else
  {
    why = ": no such file";
  }
  if (files.size() == before)
  {
    throw UserError((list.empty() ? "" : list + ": ") + entry + why +
                    "; give recordings, folders, patterns or lists (.txt) of them");
  }
}

/** The name of a recording with that of some folders that it is in. The recording of a run that was
 * converted from another has the name of the run. */
std::string nameWith(const fs::path& recording, int folders)
{
  const bool is_converted = recording.filename() == run_files::recording &&
                            fs::exists(recordingOriginFile(recording.parent_path().string()));
  const fs::path path = is_converted ? recording.parent_path() : recording;
  std::string name = fs::is_directory(path) ? path.filename().string() : path.stem().string();
  fs::path folder = path.parent_path();
  for (int i = 0; i < folders && folder.has_filename(); ++i, folder = folder.parent_path())
  {
    name = folder.filename().string() + "_" + name;
  }
  return name;
}

/** Files and a folder that a batch writes beside the folders of results. */
const std::set<std::string> names_of_batch{"batch.json", "index.html", "slurm",    "table.csv",
                                           "table.json", "table.log",  "table.txt"};

/** Gives unique names: names that occur once are final, the others, and those of files of the
 * batch, are preceded by one more folder, repeatedly. */
void giveNames(std::vector<Recording>& recordings)
{
  std::set<std::string> taken = names_of_batch;
  for (int folders = 0; folders < 64; ++folders)
  {
    std::map<std::string, int> uses;
    for (const Recording& r : recordings)
    {
      uses[nameWith(r.path, folders)] += r.name.empty() ? 1 : 0;
    }
    for (Recording& r : recordings)
    {
      const std::string name = nameWith(r.path, folders);
      if (r.name.empty() && uses[name] == 1 && taken.insert(name).second)
      {
        r.name = name;
      }
    }
  }
  for (Recording& r : recordings)
  {
    for (int i = 2; r.name.empty(); ++i)
    {
      const std::string name = nameWith(r.path, 64) + "_" + std::to_string(i);
      r.name = taken.insert(name).second ? name : "";
    }
  }
}
}  // namespace

namespace
{
std::uintmax_t sizeOf(const std::string& path)
{
  if (!fs::is_directory(path))
  {
    return fs::file_size(path);
  }
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path))
  {
    bytes += entry.is_regular_file() ? entry.file_size() : 0;
  }
  return bytes;
}

/** The absolute path without a slash at the end. */
std::string normalPath(const std::string& path)
{
  const fs::path normal = fs::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).string();
}
}  // namespace

std::vector<Recording> listRecordings(const std::vector<std::string>& entries, const Note& note)
{
  std::vector<std::string> files;
  for (const std::string& entry : entries)
  {
    expand(entry, 0, note, files);
  }
  std::vector<Recording> recordings;
  std::set<std::string> seen;
  for (const std::string& file : files)
  {
    const std::string path = normalPath(file);
    if (seen.insert(path).second)
    {
      recordings.push_back({"", path, sizeOf(path)});
    }
  }
  giveNames(recordings);
  for (const Recording& recording : recordings)
  {
    if (const std::string name = nameWith(recording.path, 0);
        note && names_of_batch.count(name) != 0)
    {
      note(recording.path + ": its results are in " + recording.name + ", as " + name +
           " is a name that the batch uses itself");
    }
  }
  return recordings;
}
}  // namespace dyslam::batch

// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <gtest/gtest.h>

#include <string>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
enum class Kernel
{
  none,
  cauchy
};

struct SampleOptions : Options
{
  double voxel_size = 0.123456789012345;
  int threads = 2;
  bool deskew = true;
  std::string label;
  double cone = 0.5235987755982988;
  Kernel kernel = Kernel::cauchy;

  void describe(OptionsVisitor& v) override
  {
    v.real("voxel_size", voxel_size, 0.01, 10, "m");
    v.renamed("cell", "voxel_size");
    v.integer("threads", threads, 1, 64, "threads");
    v.flag("deskew", deskew, "undo the motion within a scan");
    v.text("label", label, "sensor label");
    v.degrees("cone_deg", cone, 0, 90, "half angle");
    v.choice("kernel", kernel, {{"none", Kernel::none}, {"cauchy", Kernel::cauchy}},
             "robust kernel");
  }
};

std::string errorOf(const std::string& text)
{
  try
  {
    SampleOptions options;
    load(options, Config::fromText(text, "a.ini"), "sample");
  }
  catch (const UserError& error)
  {
    return error.what();
  }
  return "no error";
}

TEST(Options, SaveThenLoadGivesEqualValues)
{
  SampleOptions written;
  written.voxel_size = 1.0 / 3;
  written.deskew = false;
  written.label = "lidar top";
  written.cone = 0.7;
  written.kernel = Kernel::none;
  Config config;
  save(written, config, "sample");
  SampleOptions read;
  load(read, Config::fromText(config.toIni(), "saved.ini"), "sample");
  EXPECT_EQ(read.voxel_size, written.voxel_size);
  EXPECT_EQ(read.deskew, written.deskew);
  EXPECT_EQ(read.label, written.label);
  EXPECT_NEAR(read.cone, written.cone, 1e-10);
  EXPECT_EQ(read.kernel, written.kernel);
  Config again;
  save(read, again, "sample");
  EXPECT_EQ(config.toIni(), again.toIni());
}

TEST(Options, KeysNotGivenKeepTheirDefaults)
{
  SampleOptions options;
  load(options, Config::fromText("[sample]\nthreads = 4 // four\n", "a.ini"), "sample");
  EXPECT_EQ(options.threads, 4);
  EXPECT_EQ(options.voxel_size, SampleOptions().voxel_size);
}

TEST(Options, ErrorsNamePlaceAndFix)
{
  EXPECT_EQ(errorOf("[sample]\nvoxel_sise = 1\n"),
            "a.ini:2: [sample]: unknown key 'voxel_sise'; did you mean 'voxel_size'? (one of: "
            "voxel_size, threads, deskew, label, cone_deg, kernel)");
  EXPECT_EQ(errorOf("[sample]\ncell = 1\n"), "a.ini:2: [sample] cell was renamed to voxel_size");
  EXPECT_EQ(errorOf("[sample]\nvoxel_size = abc\n"),
            "a.ini:2: [sample] voxel_size = abc is not a number");
  EXPECT_EQ(errorOf("[sample]\nvoxel_size = 99\n"),
            "a.ini:2: [sample] voxel_size = 99 is out of range; use 0.01 to 10");
  EXPECT_EQ(errorOf("[sample]\nvoxel_size = nan\n"),
            "a.ini:2: [sample] voxel_size = nan is out of range; use 0.01 to 10");
  EXPECT_EQ(errorOf("[sample]\nthreads = 1.5\n"),
            "a.ini:2: [sample] threads = 1.5 is not a whole number");
  EXPECT_EQ(errorOf("[sample]\ndeskew = yes\n"),
            "a.ini:2: [sample] deskew = yes is not a switch; use true or false");
  EXPECT_EQ(errorOf("[sample]\nkernel = cauchi\n"),
            "a.ini:2: [sample] kernel: unknown value 'cauchi'; did you mean 'cauchy'? (one of: "
            "none, cauchy)");
  EXPECT_EQ(errorOf("[sample]\nthreads = 1\nthreads = 2\n"),
            "a.ini:3: [sample] threads is given twice; the first is at a.ini:2");
  EXPECT_EQ(errorOf("threads = 1\n"),
            "a.ini:1: key 'threads' stands before the first [section], where only include and "
            "program may");
  EXPECT_EQ(errorOf("[sample]\njunk\n"), "a.ini:2: 'junk' is not a setting; write key = value");
}

/** Options of a kind for two sensors. */
struct SampleOfTwo : Options
{
  SampleOptions front;
  SampleOptions rear;

  void describe(OptionsVisitor& v) override
  {
    PrefixedVisitor of_front(v, "", "front");
    front.describe(of_front);
    PrefixedVisitor of_rear(v, "rear_", "rear");
    rear.describe(of_rear);
  }
};

TEST(Options, APrefixMakesTwoOfAKind)
{
  SampleOfTwo options;
  const Config given = Config::fromText("[two]\nthreads = 4\nrear_threads = 5\n", "a.ini");
  load(options, given, "two");
  EXPECT_EQ(options.front.threads, 4);
  EXPECT_EQ(options.rear.threads, 5);
  Config config;
  save(options, config, "two");
  EXPECT_EQ(config.section("two").at("rear_cone_deg").comment, "rear: half angle");
  EXPECT_EQ(config.section("two").at("kernel").comment, "front: robust kernel (none, cauchy)");
  try
  {
    load(options, Config::fromText("[two]\nrear_cell = 1\n", "a.ini"), "two");
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_STREQ(error.what(), "a.ini:2: [two] rear_cell was renamed to rear_voxel_size");
  }
}

TEST(Options, ValidateChecksValuesSetInCode)
{
  SampleOptions options;
  EXPECT_NO_THROW(validate(options, "sample"));
  options.threads = 0;
  EXPECT_THROW(validate(options, "sample"), UserError);
}

/** A choice that counts assignments to it. */
struct CountedChoice
{
  explicit CountedChoice(int number_in) : number(number_in) {}
  CountedChoice(const CountedChoice&) = default;
  ~CountedChoice() = default;
  CountedChoice& operator=(const CountedChoice& other)
  {
    number = other.number;
    ++assignments;
    return *this;
  }
  bool operator==(const CountedChoice& other) const { return number == other.number; }

  int number;
  int assignments = 0;
};

struct CountedOptions : Options
{
  CountedChoice value{1};

  void describe(OptionsVisitor& v) override
  {
    v.choice("value", value, {{"one", CountedChoice(1)}, {"two", CountedChoice(2)}}, "a number");
  }
};

TEST(Options, SavingAndCheckingAssignNothing)
{
  CountedOptions options;
  Config config;
  save(options, config, "counted");
  validate(options, "counted");
  EXPECT_EQ(config.text("counted", "value"), "one");
  EXPECT_EQ(options.value.assignments, 0);

  load(options, Config::fromText("[counted]\nvalue = two\n", "a.ini"), "counted");
  EXPECT_EQ(options.value.number, 2);
  EXPECT_EQ(options.value.assignments, 1);
  save(options, config, "counted");
  EXPECT_EQ(config.text("counted", "value"), "two");
  EXPECT_EQ(options.value.assignments, 1);
}

TEST(Config, SetReplacesTheFilesValue)
{
  Config config = Config::fromText("[sample]\nthreads = 4\n", "a.ini");
  config.set("sample.threads=8");
  EXPECT_EQ(config.text("sample", "threads"), "8");
  EXPECT_THROW(config.set("threads=8"), UserError);
  EXPECT_THROW(config.set("sample.threads"), UserError);
}

TEST(Options, ATextThatAnIniWouldCutIsAnError)
{
  SampleOptions options;
  for (const char* text : {"//server/scans", "scans // of today"})
  {
    Config config;
    config.set(std::string("sample.label=") + text);
    EXPECT_THROW(load(options, config, "sample"), UserError) << text;
    options.label = text;
    EXPECT_THROW(validate(options, "sample"), UserError) << text;
  }
  Config config;
  config.set("sample.label=/data//scans");
  EXPECT_NO_THROW(load(options, config, "sample"));
}

TEST(Config, ErrorsAreAboutTheSettingsIfTheyNameTheirOrigin)
{
  const std::string of_ini = errorOf("[sample]\nvoxel_sise = 1\n");
  EXPECT_TRUE(isAboutSettings(of_ini, "inis/a.ini")) << of_ini;
  EXPECT_FALSE(isAboutSettings(of_ini, "b.ini"));
  EXPECT_FALSE(isAboutSettings(of_ini, ""));
  for (const char* assignment : {"sample", "sample.voxel_sise=1"})
  {
    try
    {
      Config config;
      config.set(assignment);
      SampleOptions options;
      load(options, config, "sample");
      ADD_FAILURE() << assignment;
    }
    catch (const UserError& error)
    {
      EXPECT_TRUE(isAboutSettings(error.what(), "")) << error.what();
    }
  }
}

TEST(Config, AByteOrderMarkIsPassedOver)
{
  SampleOptions options;
  load(options, Config::fromText("\xEF\xBB\xBF[sample]\nthreads = 5\n", "t.ini"), "sample");
  EXPECT_EQ(options.threads, 5);
}

TEST(Config, UnknownSectionNamesTheNearest)
{
  const Config config = Config::fromText("[smaple]\n", "a.ini");
  ConfigLoader loader(config);
  (void)loader.get<SampleOptions>("sample");
  try
  {
    loader.requireAllUsed();
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_STREQ(error.what(),
                 "a.ini:1: unknown section 'smaple'; did you mean 'sample'? (one of: sample)");
  }
}

/** Options of another section than SampleOptions. */
struct OtherOptions : Options
{
  double resolution = 0.1;
  void describe(OptionsVisitor& v) override
  {
    v.real("resolution", resolution, 0, 1, "resolution of the grid [m]");
  }
};

/** The error of a config that is loaded as a program with [sample] and [other] does. */
std::string errorOfProgram(const Config& config)
{
  try
  {
    (void)loadAll(config,
                  [](ConfigLoader& loader)
                  {
                    (void)loader.get<SampleOptions>("sample");
                    (void)loader.get<OtherOptions>("other");
                  });
    return "";
  }
  catch (const UserError& error)
  {
    return error.what();
  }
}

TEST(Config, AKeyOfAnotherSectionIsNamedWithThatSection)
{
  EXPECT_EQ("", errorOfProgram(Config::fromText("[other]\nresolution = 0.5\n", "a.ini")));
  EXPECT_EQ("a.ini:2: [sample]: unknown key 'resolution'; 'resolution' is a key of [other]",
            errorOfProgram(Config::fromText("[sample]\nresolution = 0.5\n", "a.ini")));
  Config assigned;
  assigned.set("sample.resolution=0.5");
  EXPECT_EQ(
      "--set sample.resolution: [sample]: unknown key 'resolution'; 'resolution' is a key of "
      "[other]: --set other.resolution=0.5",
      errorOfProgram(assigned));
}

TEST(Config, AKeyOfAnUnknownSectionIsNamedWithItsSections)
{
  Config assigned;
  assigned.set("tiles.resolution=0.5");
  EXPECT_EQ(
      "--set tiles.resolution: unknown section 'tiles'; 'resolution' is a key of [other]: --set "
      "other.resolution=0.5",
      errorOfProgram(assigned));
  EXPECT_EQ("a.ini:1: unknown section 'othr'; did you mean 'other'? (one of: sample, other)",
            errorOfProgram(Config::fromText("[othr]\nnothing = 1\n", "a.ini")));
  EXPECT_EQ("a.ini:1: unknown section 'othr'; did you mean 'other'? (one of: sample, other)",
            errorOfProgram(Config::fromText("[othr]\nresolution = 1\n", "a.ini")))
      << "a mistyped section";
  const UnknownSetting error("here: unknown key 'x'", "; did you mean 'y'?",
                             {"", "x", {"1", "here", {}}});
  Config known;
  known.set("b.x=1");
  known.set("a.x=2");
  EXPECT_STREQ("here: unknown key 'x'; 'x' is a key of [a], [b]",
               error.withSectionsOf(known).what());
  EXPECT_STREQ("here: unknown key 'x'; did you mean 'y'?", error.withSectionsOf(Config()).what());
}

TEST(Config, ASectionOfAnotherProgramIsNamedWithIt)
{
  EXPECT_EQ("a.ini:1: the section [train] belongs to dyslam-train",
            errorOfProgram(Config::fromText("[train]\nsteps = 1\n", "a.ini")));
  Config assigned;
  assigned.set("grid.resolution=0.5");
  EXPECT_EQ(
      "--set grid.resolution: the section [grid] belongs to dyslam-train dyseg; 'resolution' is a "
      "key of [other]: --set other.resolution=0.5",
      errorOfProgram(assigned));
  EXPECT_EQ("", programOfSection("trains"));
  const std::string of_dyslam =
      errorOfProgram(Config::fromText("[odometry]\nmethod = gicp\n", "a.ini"));
  EXPECT_EQ(0U, of_dyslam.find("a.ini:1: unknown section 'odometry'; ")) << of_dyslam;
  EXPECT_TRUE(contains(of_dyslam, "(one of: sample, other)")) << of_dyslam;
}

TEST(Config, SectionsForAnotherProgramAreRefused)
{
  const auto message = [](const std::string& section, const std::string& program)
  {
    const Config config = Config::fromText("[train]\n\n[" + section + "]\nx = 1\n", "a.ini");
    return messageOfError<UserError>([&] { config.requireSectionsFor(program); });
  };
  EXPECT_EQ("a.ini:3: the section [map] belongs to dyslam, not to dyslam-train dylo",
            message("map", "dyslam-train dylo"));
  EXPECT_EQ("a.ini:3: the section [merge] belongs to dyslam-map, not to dyslam-train dyseg",
            message("merge", "dyslam-train dyseg"));
  EXPECT_EQ("a.ini:3: the section [data] belongs to dyslam-train dylo, not to dyslam-train dyseg",
            message("data", "dyslam-train dyseg"));
  Config fitting = Config::fromText("[train]\nsteps = 1\n[mapp]\nx = 1\n", "a.ini");
  fitting.set("data.base=1");
  EXPECT_NO_THROW(fitting.requireSectionsFor("dyslam-train dylo"))
      << "a section that no program has is an error elsewhere";
  fitting.set("odometry.method=gicp");
  EXPECT_EQ(
      "--set odometry.method: the section [odometry] belongs to dyslam, not to "
      "dyslam-train dylo",
      messageOfError<UserError>([&] { fitting.requireSectionsFor("dyslam-train dylo"); }));
}

/** Inis in a folder of their own. */
class ConfigFiles : public ::testing::Test
{
 protected:
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const
  {
    return folder_.write(name, text);
  }
  static std::string errorOf(const std::string& path)
  {
    return messageOfError<UserError>([&path] { (void)Config::fromFile(path); });
  }

  const TestFolder folder_;
};

TEST_F(ConfigFiles, AnIniChangesWhatItIncludes)
{
  (void)write("sub/base.ini", "[sample]\nthreads = 4\nscale = 2\n[other]\nkey = a\n");
  (void)write("sub/more.ini", "include = base.ini  // of its own folder\n[other]\nkey = b\n");
  const Config config =
      Config::fromFile(write("my.ini", "include = sub/more.ini\n[sample]\nthreads = 8\n"));
  EXPECT_EQ("8", config.text("sample", "threads"));
  EXPECT_EQ("my.ini:3", config.section("sample").at("threads").origin);
  EXPECT_EQ("2", config.text("sample", "scale"));
  EXPECT_EQ("base.ini:3", config.section("sample").at("scale").origin);
  EXPECT_EQ("b", config.text("other", "key"));
  EXPECT_EQ(std::nullopt, config.text("other", "threads"));
  EXPECT_EQ(std::nullopt, config.text("none", "key"));
  const Config shipped = Config::fromFile(write("s.ini", "include = kitti64.ini\n"));
  EXPECT_EQ("network", shipped.text("dyseg", "method"));
}

TEST_F(ConfigFiles, IncludesThatFailAreNamed)
{
  const std::string missing = errorOf(write("a.ini", "\ninclude = none.ini\n"));
  EXPECT_EQ(0U, missing.find("a.ini:2: include = none.ini: no such file")) << missing;
  EXPECT_NE(missing.find("kitti64.ini"), std::string::npos) << missing;
  (void)write("one.ini", "include = two.ini\n");
  (void)write("two.ini", "include = one.ini\n");
  EXPECT_EQ(
      "two.ini:1: include = one.ini: that file includes this one; remove one of the two lines",
      errorOf(folder_.file("one.ini")));
  EXPECT_NE(errorOf(write("self.ini", "include = self.ini\n")).find("self.ini:1"),
            std::string::npos);
}

TEST_F(ConfigFiles, AnIniForAnotherProgramIsRefused)
{
  const Config config = Config::fromFile(write("t.ini", "program = dyslam-train\n[a]\nb = 1\n"));
  EXPECT_NO_THROW(config.requireFor("dyslam-train"));
  EXPECT_NO_THROW(Config().requireFor("dyslam"));
  EXPECT_EQ("t.ini:1: these settings are for dyslam-train, not for dyslam",
            messageOfError<UserError>([&config] { config.requireFor("dyslam"); }));
}

TEST_F(ConfigFiles, AnIniForAnotherCommandOfTheProgramIsRefused)
{
  const Config of_command = Config::fromFile(write("c.ini", "program = dyslam-train dylo\n"));
  EXPECT_NO_THROW(of_command.requireFor("dyslam-train dylo"));
  for (const char* other : {"dyslam-train dyseg", "dyslam-train", "dyslam-train dylo2", "dyslam"})
  {
    EXPECT_THROW(of_command.requireFor(other), UserError) << other;
  }
  const Config of_program = Config::fromFile(write("p.ini", "program = dyslam-train\n"));
  EXPECT_NO_THROW(of_program.requireFor("dyslam-train dylo"));
  EXPECT_THROW(of_program.requireFor("dyslam-train2"), UserError);
}

TEST(Config, MissingFileIsAnError)
{
  EXPECT_THROW((void)Config::fromFile("/nowhere/x.ini"), UserError);
}

TEST_F(ConfigFiles, AnEmptyOneIsAnError)
{
  for (const std::string& text : {std::string(), std::string("\n \n"), std::string(100, '\0')})
  {
    const std::string file = write("empty.ini", text);
    EXPECT_EQ(file + ": is empty; restore it, or give another .ini", errorOf(file));
  }
  EXPECT_NO_THROW((void)Config::fromFile(write("comment.ini", "# all defaults\n")));
}
}  // namespace
}  // namespace dyslam

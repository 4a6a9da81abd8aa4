// gate, calibrate, converge with real processes, as a script calls them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "client/run_json.h"
#include "film/exr.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kScene = PENUMBRA_SOURCE_DIR "/scenes/gallery/monolith.pbrt";
const std::string kSmall = kScene + " --resolution 32x32 --quiet ";

struct Said {
  int code = -1;
  std::string out;
};

class Commands : public testing::Test {
 protected:
  Commands()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("penumbra-") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                 "-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Commands() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Standard output, and standard error with it.
  Said run(const std::string& words) const {
    const std::string command = "cd '" + folder_.string() + "' && '" PENUMBRA_CLIENT "' " + words + " 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    Said said;
    char buffer[4096];
    while (const size_t n = fread(buffer, 1, sizeof buffer, pipe)) said.out.append(buffer, n);
    const int status = pclose(pipe);
    said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return said;
  }
  /// A reference, and a run against it.
  void render_reference() const {
    ASSERT_EQ(run("render " + kSmall + "--spp 512 --mix line-sa@v:2 --seed 99 --out ref").code, 0);
    fs::rename(folder_ / "ref/line-sa-v-2_balance.exr", folder_ / "ref.exr");
  }
  Said render(const std::string& words) const {
    return run("render " + kSmall + "--reference ref.exr --mix sa:1 " + words);
  }
  Json read(const std::string& name) const { return *read_json(path(name)); }
  void write(const std::string& name, const Json& json) const { std::ofstream(path(name)) << json.dump(); }

  fs::path folder_;
};

/// The scene's text names it: "pixel B = X,Y".
std::string pixel_b() {
  std::ifstream in(kScene);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const size_t at = text.find("pixel B = ") + 10;
  return text.substr(at, text.find_first_not_of("0123456789,", at) - at);
}

TEST_F(Commands, GateTellsPassFromWorse) {
  render_reference();
  ASSERT_EQ(render("--spp 64 --out base").code, 0);
  ASSERT_EQ(render("--spp 64 --out now").code, 0);
  const std::string cpu = " --cpu-tolerance 400%";
  const Said same = run("gate now/run.json --baseline base/run.json" + cpu);
  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("1.000")) << "the same seed gives the same error";
  EXPECT_THAT(same.out, HasSubstr("gate: pass"));

  // A quarter of the light samples' worth: twice the error with as many passes.
  Json worse = read("now/run.json");
  worse["mixes"][0]["relmse"] = 2 * worse["mixes"][0]["relmse"].get<double>();
  write("worse.json", worse);
  const Said found = run("gate worse.json --baseline base/run.json" + cpu);
  EXPECT_EQ(found.code, 3) << found.out;
  const Said json = run("gate worse.json --baseline base/run.json --json" + cpu);
  EXPECT_EQ(json.code, 3);
  EXPECT_EQ(Json::parse(json.out)["verdict"], "worse");

  // A true change of the estimator: fewer samples under the old mix's name.
  ASSERT_EQ(render("--spp 256 --out sure").code, 0);
  ASSERT_EQ(run("render " + kSmall + "--reference ref.exr --mix area:1 --spp 256 --out area").code, 0);
  Json area = read("area/run.json");
  area["mixes"][0]["mix"] = "sa:1/balance";
  write("area.json", area);
  const Said other = run("gate area.json --baseline sure/run.json" + cpu);
  EXPECT_EQ(other.code, 3) << other.out;

  ASSERT_EQ(run("gate base/run.json --write-baseline kept.json").code, 0);
  EXPECT_EQ(run("gate now/run.json --baseline kept.json" + cpu).code, 0);
}

TEST_F(Commands, AnUnknownCommandIsNamed) {
  const Said said = run("rendr " + kScene);
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.out, HasSubstr("'rendr'"));
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("--help").code, 0);
}

TEST_F(Commands, BinsOfPathLengthAreReplayedAndTheFolderHoldsOneExrPerMix) {
  const std::string job = "render " + kSmall + "--spp 16 --tile 16 --mix sa:1 --mix line-sa@u:1 ";
  ASSERT_EQ(run(job + "--out plain").code, 0);
  const Said said = run(job + "--transient 8,28,10 --out binned --json");
  ASSERT_EQ(said.code, 0) << said.out;
  const Json json = read("binned/run.json");
  EXPECT_EQ(json["transient"], Json({{"t0", 8.0}, {"t1", 28.0}, {"bins", 10}}));
  EXPECT_EQ(json["needs"].back(), Json({{"effect", "transient"}, {"why", "--transient 8,28,10"}}));
  EXPECT_EQ(read("plain/run.json")["transient"], Json(nullptr));
  size_t images = 0;
  for (const auto& entry : fs::directory_iterator(path("binned")))
    images += entry.path().extension() == ".exr";
  EXPECT_EQ(images, 2u);
  for (const char* name : {"/sa-1_balance.exr", "/line-sa-u-1_balance.exr"}) {
    const auto plain = read_exr(path("plain") + name), picture = read_exr(path("binned") + name);
    ASSERT_TRUE(plain.ok() && picture.ok());
    EXPECT_EQ(plain->rgb, picture->rgb) << "the picture changed";
    const auto bins = read_exr_bins(path("binned") + name);
    ASSERT_TRUE(bins.ok()) << bins.status();
    EXPECT_EQ(bins->images.size(), 10u);
    EXPECT_FALSE(read_exr_bins(path("plain") + name).ok());
  }
  const Said again = run("replay binned/run.json --verify --workers 1 --quiet --out again");
  EXPECT_EQ(again.code, 0) << again.out;
  // One bit of one bin.
  auto bins = *read_exr_bins(path("binned/sa-1_balance.exr"));
  const auto picture = *read_exr(path("binned/sa-1_balance.exr"));
  float& value = bins.images[4].rgb[1500];
  value = std::nextafter(value, 100.f);
  ExrHeader header;
  header.transient = bins.transient;
  ASSERT_TRUE(write_exr(path("binned/sa-1_balance.exr"), picture, header, bins.images).ok());
  const Said changed = run("replay binned/run.json --verify --quiet --out once_more");
  EXPECT_EQ(changed.code, 1);
  EXPECT_THAT(changed.out, HasSubstr("1 of 11264 pixels differ"));
  const Said refused = run("render " + kSmall + "--transient 0,1,5000");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.out, HasSubstr("--transient: 5000 bins"));
  EXPECT_EQ(run("converge " + kScene + " --quiet --pixel 9,9 --transient 0,1,4").code, 2);
}

TEST_F(Commands, AFolderWithoutANameIsNoneToWriteTo) {
  for (const std::string& words : {"render " + kSmall + "--spp 1 --mix sa:1 --out ''",
                                   std::string("fetch somejob --server 127.0.0.1:1 --out ''")}) {
    const Said said = run(words);
    EXPECT_EQ(said.code, 2) << words << "\n" << said.out;
    EXPECT_THAT(said.out, HasSubstr("--out")) << words;
  }
}

TEST_F(Commands, GateRefusesBadUsage) {
  render_reference();
  ASSERT_EQ(render("--spp 4 --out now").code, 0);
  ASSERT_EQ(run("render " + kSmall + "--spp 1 --mix sa:1 --out blind").code, 0);
  const auto refused = [&](const std::string& words, const std::string& why) {
    const Said said = run("gate " + words);
    EXPECT_EQ(said.code, 2) << words << "\n" << said.out;
    EXPECT_THAT(said.out, HasSubstr(why)) << words;
  };
  refused("now/run.json", "--baseline");
  refused("now/run.json --baseline none.json", "none.json: no such file");
  refused("now/run.json --baseline blind/run.json", "render it with --reference");
  refused("blind/run.json --baseline now/run.json", "render it with --reference");
  refused("now/run.json --baseline now/run.json --tolerance 5", "--tolerance");
  refused("now/run.json --baseline now/run.json --spp 4", "--against");
  refused("now/run.json --baseline ref.exr", "ref.exr: not JSON");
  refused(kSmall + "--against /nowhere --spp 1 --mix sa:1", "--reference");
  refused(kSmall + "--against /nowhere --spp 1 --mix sa:1 --reference ref.exr", "--against: /nowhere");
}

TEST_F(Commands, OptionsThatWouldBeIgnoredAreRefused) {
  const auto refused = [&](const std::string& words, const std::string& flag) {
    const Said said = run(words);
    EXPECT_EQ(said.code, 2) << words << "\n" << said.out;
    EXPECT_THAT(said.out, HasSubstr(flag)) << words;
  };
  // Finished runs (which are not there: told before they are looked for) take nothing that renders.
  for (const char* words : {"--camera-grid 4", "--transient 0,1,4", "--rounds 3", "--workers 1",
                            "--threads 1", "--crop 0,0,1,1", "--strict"}) {
    const std::string flag = std::string(words).substr(0, std::string(words).find(' '));
    refused(std::string("gate run.json --baseline base.json ") + words, "penumbra: " + flag + ":");
    refused(std::string("gate run.json --write-baseline base.json ") + words, "penumbra: " + flag + ":");
  }
  for (const char* words : {"--tolerance 5%", "--cpu-tolerance 5%", "--noise n.json", "--json"})
    refused(std::string("gate run.json --write-baseline base.json ") + words,
            std::string(words).substr(0, std::string(words).find(' ')));
  refused("gate run.json --write-baseline base.json --baseline old.json", "--baseline");
  refused("gate run.json --baseline base.json --noise ''", "--noise");
  refused("gate " + kSmall + "--against /nowhere --reference ref.exr --region a=0,0,8,8", "--region");
  refused("calibrate " + kSmall + "--mix sa:1 --region a=0,0,8,8", "--region");
  // A local cluster has no certificates, and what is only looked at no workers.
  for (const char* command : {"render ", "calibrate ", "converge --pixel 1,1 "})
    refused(command + kSmall + "--token-file none", "--token-file");
  refused("replay run.json --tls-ca none", "--tls-ca");
  for (const char* flag : {"--workers", "--threads"}) refused("inspect " + kScene + " " + flag + " 1", flag);
  EXPECT_EQ(run("inspect " + kScene + " --quiet").code, 0);
  const std::string converge = "converge " + kScene + " --pixel 1,1 ";
  refused(converge + "--light 0", "--light");
  refused(converge + "--grid 8", "--grid");
  refused(converge + "--integrand --estimates 1000", "--estimates");
  refused(converge + "--integrand --most 16", "--most");
}

TEST_F(Commands, GateAgainstTheSameBuildPasses) {
  render_reference();
  const Said said = run("gate " + kSmall + "--against '" PENUMBRA_BUILD "' --rounds 2 --spp 16 --mix sa:1 " +
                        "--reference ref.exr --cpu-tolerance 5000%");
  EXPECT_EQ(said.code, 0) << said.out;
  EXPECT_THAT(said.out, HasSubstr("1.000"));
}

TEST_F(Commands, CalibrateMeasuresWhatGateReads) {
  render_reference();
  const Said said = run("calibrate " + kSmall + "--spp 8 --runs 3 --mix sa:1 --json");
  ASSERT_EQ(said.code, 0) << said.out;
  std::ofstream(path("noise.json")) << said.out;
  const Json noise = Json::parse(said.out);
  EXPECT_EQ(noise["runs"], 3);
  EXPECT_GT(noise["cpu_per_pass"]["log_sd"].get<double>(), 0);
  EXPECT_GT(noise["calibration"]["seconds_per_unit"].get<double>(), 0);
  ASSERT_EQ(render("--spp 8 --out now").code, 0);
  const Said gate = run("gate now/run.json --baseline now/run.json --noise noise.json --cpu-tolerance 5000%");
  EXPECT_EQ(gate.code, 0) << gate.out;
  EXPECT_EQ(run("calibrate " + kSmall + "--mix sa:1 --mix area:1").code, 2);
  EXPECT_EQ(run("calibrate " + kSmall + "--mix sa:1 --runs 1").code, 2);
}

TEST_F(Commands, ConvergeFindsThePapersOrder) {
  const Said said = run("converge " + kScene + " --quiet --json --pixel " + pixel_b() +
                        " --estimates 200 --most 121 --out c "
                        "--mix bsdf:1 --mix line-sa@u:1 --mix line-sa@v:1 --mix bsdf:1+line-sa@u:1");
  ASSERT_EQ(said.code, 0) << said.out;
  EXPECT_EQ(Json::parse(said.out), read("c/converge.json"));
  EXPECT_TRUE(fs::exists(path("c/converge.svg")));
  const Json mixes = read("c/converge.json")["mixes"];
  ASSERT_EQ(mixes.size(), 4u);
  // Salesin & Jarosz 2019, Figure 6, pixel B; our scene is of the same make, not the same.
  const double paper[4] = {-1.48, -2.57, -1.61, -1.53};
  for (size_t m = 0; m < 4; ++m) {
    EXPECT_NEAR(mixes[m]["slope"].get<double>(), paper[m], 0.5) << mixes[m]["mix"];
    EXPECT_EQ(mixes[m]["points"].size(), 7u);
  }
  EXPECT_LT(mixes[1]["slope_ci"][1], mixes[0]["slope_ci"][0]) << "lines along the edge converge faster";
  // All estimate the same number: within 5 of its standard error.
  for (const Json& mix : mixes) {
    const Json& point = mix["points"][3];
    const double error = std::sqrt(point["variance"].get<double>() / point["estimates"].get<double>());
    const double best = mixes[1]["points"][6]["mean"].get<double>();
    EXPECT_NEAR(point["mean"].get<double>(), best, 5 * error) << mix["mix"];
  }
}

TEST_F(Commands, ConvergeRefusesBadUsage) {
  const auto refused = [&](const std::string& words, const std::string& why) {
    const Said said = run("converge " + kScene + " --quiet " + words);
    EXPECT_EQ(said.code, 2) << words << "\n" << said.out;
    EXPECT_THAT(said.out, HasSubstr(why)) << words;
  };
  refused("", "--pixel");
  refused("--pixel 256,0", "--pixel: 256,0 is not in the image, which is 256x256");
  refused("--pixel x", "--pixel");
  refused("--pixel 1,1 --spp 4", "--estimates");
  refused("--pixel 1,1 --mix auto", "--mix");
  refused("--pixel 1,1 --estimates 0", "--estimates");
  EXPECT_EQ(run("converge none.pbrt --pixel 1,1").code, 2);
}

}  // namespace
}  // namespace penumbra

#include "client/integrand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Integrands, ThePagesImagesAreTheFilesThatWereWritten) {
  JobSpec picture;
  picture.width = picture.height = 8;
  // A repeated mix is "#2", and "#" begins a fragment in a URL.
  picture.mixes = {*parse_mix("bsdf:1+line-sa@v:1"), *parse_mix("bsdf:1+line-sa@v:1")};
  const auto job = integrand_job(picture, 1, 1, 0, 2);
  ASSERT_TRUE(job.ok()) << message_of(job.status());
  FilmImage image;
  image.width = image.height = 2;
  image.window = {0, 0, 2, 2};
  image.rgb.assign(12, 1);
  const fs::path folder = fs::path(testing::TempDir()) / ("penumbra_integrand_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const auto json = write_integrands(*job, std::vector<FilmImage>(job->parts.size(), image), folder);
  ASSERT_TRUE(json.ok()) << message_of(json.status());
  std::ifstream in(folder / "integrand.html");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_TRUE(fs::exists(folder / "bsdf-1+line-sa-v-1_balance#2.bsdf.png"));
  EXPECT_THAT(page, HasSubstr("<img src=\"bsdf-1%2Bline-sa-v-1_balance%232.bsdf.png\""));
  EXPECT_THAT(page, HasSubstr("in bsdf:1+line-sa@v:1/balance#2<br>")) << "text is no URL";
  EXPECT_EQ((*json)[2]["image"], "bsdf-1+line-sa-v-1_balance#2.bsdf.exr");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace penumbra

#include "client/output_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFolder : public testing::Test {
 protected:
  OutputFolder() { fs::create_directories(root_); }
  ~OutputFolder() override { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file_atomically(root_ / name, text).ok());
  }
  fs::path root_ = fs::path(testing::TempDir()) / "penumbra-output-folder";
};

TEST_F(OutputFolder, AFileIsNoFolder) {
  write("file", "");
  EXPECT_THAT(message_of(prepare_folder(root_ / "file")), HasSubstr("--out: "));
  EXPECT_TRUE(prepare_folder(root_ / "new" / "deep").ok());
  EXPECT_TRUE(fs::is_empty(root_ / "new" / "deep")) << "nothing is left of the trial";
}

TEST_F(OutputFolder, TheReferenceIsNeitherOverwrittenNorRemoved) {
  JobSpec spec;
  spec.mixes = {*parse_mix("sa:1")};
  const std::string name = image_name("sa:1/balance");
  write(name, "a reference");
  write("other.exr", "an image");
  write("run.json", R"({"mixes": [{"image": ")" + name + R"("}, {"image": "other.exr"}]})");
  spec.reference = (root_ / "." / name).string();
  EXPECT_THAT(message_of(check_reference_stays(spec, root_)), HasSubstr("--reference: "));
  EXPECT_TRUE(check_reference_stays(spec, root_ / "elsewhere").ok());
  remove_old_images(root_, spec.reference);
  EXPECT_TRUE(fs::exists(root_ / name));
  EXPECT_FALSE(fs::exists(root_ / "other.exr"));
}

}  // namespace
}  // namespace penumbra

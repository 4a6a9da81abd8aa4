// Our strategies against an independent renderer's images of the real scenes: block means, z-tested with
// Šidák's correction. The reference's block errors are estimated from 16 runs, so they are pooled over
// blocks of like brightness before use (15 degrees of freedom are too few for normal quantiles).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "film/statistics.h"
#include "tests/support/render.h"

namespace penumbra {
namespace {

struct ReferenceBlock {
  double mean[3], error[3];
};

/// Rows of NAME-blocks.csv, row by row of the 16×16 grid.
std::vector<ReferenceBlock> read_blocks(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<ReferenceBlock> out;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    double skip = 0;
    ReferenceBlock b{};
    in >> skip >> skip >> skip >> skip;
    for (double& m : b.mean) in >> m;
    for (double& e : b.error) in >> e;
    out.push_back(b);
  }
  return out;
}

/// Replaces each block's standard error by the root mean square over blocks of similar brightness.
void pool_errors(std::vector<ReferenceBlock>& blocks) {
  constexpr size_t kPool = 24;
  for (int c = 0; c < 3; ++c) {
    std::vector<size_t> order(blocks.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return blocks[a].mean[c] < blocks[b].mean[c]; });
    std::vector<double> pooled(blocks.size());
    for (size_t i = 0; i < order.size(); ++i) {
      const size_t first = i > kPool / 2 ? i - kPool / 2 : 0, last = std::min(order.size(), first + kPool);
      double sum = 0;
      for (size_t j = first; j < last; ++j) sum += blocks[order[j]].error[c] * blocks[order[j]].error[c];
      pooled[order[i]] = std::max(std::sqrt(sum / double(last - first)), blocks[order[i]].error[c]);
    }
    for (size_t i = 0; i < blocks.size(); ++i) blocks[i].error[c] = pooled[i];
  }
}

struct Case {
  std::string scene, reference;
  int width, height;
  std::vector<std::string> mixes;
  int64_t passes;
};

class Reference : public testing::TestWithParam<Case> {};

TEST_P(Reference, BlocksAgree) {
  const char* folder = std::getenv("PENUMBRA_SCENES_DIR");
  if (!folder) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const Case& c = GetParam();
  const std::string root = folder;
  std::vector<ReferenceBlock> reference = read_blocks(root + "/../references/" + c.reference + "-blocks.csv");
  ASSERT_FALSE(reference.empty());
  pool_errors(reference);
  const ScenePtr scene = test::load(root + "/" + c.scene);
  ASSERT_TRUE(scene);
  const test::Rendered rendered = test::render(*scene, test::job(c.width, c.height, c.mixes, c.passes));
  for (size_t m = 0; m < c.mixes.size(); ++m) {
    const std::vector<Block> ours = blocks(rendered.images[m], {0, 0, c.width, c.height});
    ASSERT_EQ(ours.size(), reference.size());
    std::vector<double> a, b, variance;
    double sum = 0, reference_sum = 0;
    for (size_t i = 0; i < ours.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        a.push_back(ours[i].mean[k]);
        b.push_back(reference[i].mean[k]);
        variance.push_back(ours[i].variance[k] + reference[i].error[k] * reference[i].error[k]);
        sum += ours[i].mean[k];
        reference_sum += reference[i].mean[k];
      }
    const ZTest z = z_test(a, b, variance, 0.001);
    std::printf("%-44s mean %+.3f %%  largest |z| %.2f (limit %.2f)  cpu %.2f s  rays %.1fM lines %.1fM\n",
                c.mixes[m].c_str(), 100 * (sum / reference_sum - 1), z.largest, z.threshold,
                rendered.costs[m].cpu_seconds, double(rendered.costs[m].rays) * 1e-6,
                double(rendered.costs[m].line_queries) * 1e-6);
    EXPECT_TRUE(z.passes()) << c.mixes[m] << ": " << z.rejected << " of " << z.compared << " rejected, worst "
                            << z.worst / 3 << " z " << z.largest << " ours " << a[size_t(z.worst)] << " reference "
                            << b[size_t(z.worst)];
    EXPECT_EQ(rendered.costs[m].non_finite, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Reference,
    testing::Values(Case{"cornell-box/cornell-box.pbrt", "cornell-box", 256, 256,
                         {"bsdf:4", "area:1", "sa:1", "line-area@0:1", "line-area@90:1", "line-area@37:1", "line-sa@u:1",
                          "line-sa@v:1", "bsdf:1+sa:1", "bsdf:1+line-sa@u:1", "line-area@0:1+line-area@90:1",
                          "line-area@0:1+line-area@90:1/average", "bsdf:1+line-sa@v:1/free", "sa:1+line-sa@u:1/power"},
                         32},
                    Case{"op-veach/op-veach-color.pbrt", "op-veach", 384, 256,
                         {"bsdf:4", "area:4", "sa:4", "bsdf:1+sa:1", "bsdf:1+line-sa@u:1", "bsdf:1+line-sa@v:1",
                          "bsdf:1+line-area@30:1", "bsdf:2+line-sa@v:2/free"},
                         32},
                    Case{"kitchen/kitchen-play.pbrt", "kitchen", 640, 360,
                         {"bsdf:4", "bsdf:2+sa:2", "bsdf:2+line-sa@v:2", "line-sa@v:4"},
                         4}),
    [](const auto& info) {
      std::string name = info.param.reference;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace penumbra

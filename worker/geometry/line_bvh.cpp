#include "worker/geometry/line_bvh.h"

#include <atomic>
#include <cmath>

#include "proto/status.h"
#include "worker/geometry/line_tree.h"

namespace penumbra {
namespace {

bool seen_by_lines(const MeshInput& input) {
  return input.visible && !input.alpha;
}

/// Which meshes belong to some object, and are therefore not in the world themselves.
std::vector<bool> meshes_of_objects(size_t meshes, std::span<const ObjectInput> objects) {
  std::vector<bool> in_object(meshes, false);
  for (const ObjectInput& o : objects) {
    PENUMBRA_CHECK(o.first_mesh <= o.last_mesh && o.last_mesh <= meshes);
    for (uint32_t m = o.first_mesh; m < o.last_mesh; ++m) in_object[m] = true;
  }
  return in_object;
}

/// Bounds of an object in its own space.
MovedBox own_bounds(const LineTree& tree) {
  const LineNode& root = tree.nodes[0];
  Vec3d lo(kInfinity, kInfinity, kInfinity), hi(-lo);
  for (int lane = 0; lane < kWidth; ++lane) {
    for (int k = 0; k < 3; ++k) {
      if (root.lo[k][lane] > root.hi[k][lane]) continue;
      lo[k] = std::min(lo[k], tree.centre[k] + root.lo[k][lane]);
      hi[k] = std::max(hi[k], tree.centre[k] + root.hi[k][lane]);
    }
  }
  return {lo, hi};
}

void extend_outwards(Box& box, const Vec3d& w) {
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = std::min(box.lo[k], std::nextafter(static_cast<float>(w[k]), -kInfinity));
    box.hi[k] = std::max(box.hi[k], std::nextafter(static_cast<float>(w[k]), kInfinity));
  }
}

/// World bounds of a placed object, from the corners of its own; of one that moves, at all times.
Box placed_bounds(const LineTree& tree, const InstanceInput& instance) {
  Box box = empty_box();
  const MovedBox own = own_bounds(tree);
  if (instance.motion) {
    for (const MovedBox& moved : instance.motion->boxes(own)) {
      extend_outwards(box, moved.lo);
      extend_outwards(box, moved.hi);
    }
    return box;
  }
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d w;
    instance.to_world.multVecMatrix(Vec3d(corner & 1 ? own.hi.x : own.lo.x, corner & 2 ? own.hi.y : own.lo.y,
                                          corner & 4 ? own.hi.z : own.lo.z),
                                    w);
    extend_outwards(box, w);
  }
  return box;
}

absl::Status place_instances(LineBvh& bvh, std::span<const InstanceInput> instances, TreeBuilder& builder) {
  std::vector<Box> boxes;
  std::vector<uint32_t> numbers;
  bvh.instances.resize(instances.size());
  for (size_t i = 0; i < instances.size(); ++i) {
    PENUMBRA_CHECK(instances[i].object < bvh.objects.size());
    const Matrix& m = instances[i].to_world;
    bvh.instances[i] = {instances[i].object, m.inverse(), instances[i].motion};
    const LineTree& tree = bvh.objects[instances[i].object];
    if (tree.nodes.empty()) continue;
    boxes.push_back(placed_bounds(tree, instances[i]));
    numbers.push_back(static_cast<uint32_t>(i));
  }
  RETURN_IF_ERROR(build_tree(boxes, nullptr, builder, bvh.instance_tree, 1));
  for (LineNode& node : bvh.instance_tree.nodes) {
    for (int lane = 0; lane < kWidth; ++lane) {
      if (node.leaves >> lane & 1) node.child[lane] = numbers[node.child[lane]];
    }
  }
  return absl::OkStatus();
}

absl::Status build_tubes(std::span<const MeshInput> meshes, TreeBuilder& builder, LineTubes& tubes) {
  std::vector<Box> boxes;
  for (const MeshInput& input : meshes) {
    if (input.tubes == nullptr || !input.visible) continue;
    tubes.meshes.push_back(static_cast<uint32_t>(&input - meshes.data()));
    tubes.first_segment.push_back(static_cast<uint32_t>(tubes.segments.size()));
    for (const uint32_t first : input.tubes->segments) {
      const Imath::V4f* p = &input.tubes->points[first];
      Box box = empty_box();
      for (int end = 0; end < 2; ++end) {
        const Vec3f centre(p[end].x, p[end].y, p[end].z), radius(p[end].w);
        extend(box, centre - radius);
        extend(box, centre + radius);
      }
      // The sums above are rounded; set_bounds() widens once more, for its own rounding.
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = std::nextafter(box.lo[k], -kInfinity);
        box.hi[k] = std::nextafter(box.hi[k], kInfinity);
      }
      boxes.push_back(box);
      tubes.segments.push_back(p);
    }
  }
  return build_tree(boxes, nullptr, builder, tubes.tree, kWidth);
}

size_t bytes_of(const LineTree& tree) {
  return tree.nodes.size() * sizeof(LineNode) + tree.blocks.size() * sizeof(PairBlock);
}

}  // namespace

absl::Status check_line_input(std::span<const MeshInput> meshes, std::span<const InstanceInput> instances) {
  uint64_t triangles = 0, segments = 0;
  for (const MeshInput& m : meshes) {
    triangles += m.mesh->triangles();
    segments += m.tubes == nullptr ? 0 : m.tubes->segments.size();
  }
  if (triangles >= kNone)
    return make_status(absl::StatusCode::kResourceExhausted, "more than {} triangles in one scene", kNone);
  if (segments >= kNone)
    return make_status(absl::StatusCode::kResourceExhausted, "curves of more than {} segments in one scene",
                       kNone);
  for (size_t i = 0; i < instances.size(); ++i) {
    const double det = instances[i].to_world.determinant();
    if (!std::isfinite(det) || det == 0) return invalid_input("instance {}: its transform is singular", i);
  }
  return absl::OkStatus();
}

absl::StatusOr<LineBvh> build_line_bvh(std::span<const MeshInput> meshes,
                                       std::span<const ObjectInput> objects,
                                       std::span<const InstanceInput> instances, int threads) {
  RETURN_IF_ERROR(check_line_input(meshes, instances));
  TreeBuilder builder(threads);
  static std::atomic<uint64_t> built{0};
  LineBvh bvh;
  bvh.id = ++built;
  uint64_t first = 0;
  for (const MeshInput& m : meshes) {
    bvh.first_triangle.push_back(static_cast<uint32_t>(first));
    first += m.mesh->triangles();
  }
  const auto build_over = [&](LineTree& tree, auto belongs) {
    PairList list;
    size_t triangles = 0;
    for (size_t m = 0; m < meshes.size(); ++m) {
      if (belongs(m) && seen_by_lines(meshes[m])) triangles += meshes[m].mesh->triangles();
    }
    list.reserve(triangles / 2);
    for (size_t m = 0; m < meshes.size(); ++m) {
      if (belongs(m) && seen_by_lines(meshes[m])) list.add(*meshes[m].mesh, bvh.first_triangle[m]);
    }
    return build_tree(list.boxes, &list, builder, tree, kWidth);
  };
  const std::vector<bool> in_object = meshes_of_objects(meshes.size(), objects);
  RETURN_IF_ERROR(build_over(bvh.world, [&](size_t m) { return !in_object[m]; }));
  bvh.objects.resize(objects.size());
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectInput& o = objects[i];
    RETURN_IF_ERROR(
        build_over(bvh.objects[i], [&](size_t m) { return m >= o.first_mesh && m < o.last_mesh; }));
  }
  RETURN_IF_ERROR(place_instances(bvh, instances, builder));
  RETURN_IF_ERROR(build_tubes(meshes, builder, bvh.tubes));
  return bvh;
}

uint32_t LineBvh::depth() const {
  uint32_t below = 0;
  for (const LineTree& tree : objects) below = std::max(below, tree.depth);
  return std::max({world.depth, instance_tree.depth + below, tubes.tree.depth});
}

size_t LineBvh::bytes() const {
  size_t sum = bytes_of(world) + bytes_of(instance_tree) + instances.size() * sizeof(LineInstance);
  sum += bytes_of(tubes.tree) + tubes.segments.size() * sizeof(tubes.segments[0]);
  for (const LineTree& tree : objects) sum += bytes_of(tree);
  return sum;
}

size_t LineBvh::triangles() const {
  size_t sum = world.triangles;
  for (const LineTree& tree : objects) sum += tree.triangles;
  return sum;
}

}  // namespace penumbra

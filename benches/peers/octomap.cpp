// OctoMap on the exported rays: whole clouds into an octree that keeps to the grid, and the voxels
// along each ray alone.

#include <octomap/octomap.h>

#include "common.hpp"

namespace {

octomap::point3d grid_corner(double share) {
    const auto at = [&](int axis) {
        return static_cast<float>(kMinM[axis] + share * kShape[axis] * kVoxelM);
    };
    return {at(0), at(1), at(2)};
}

octomap::point3d point_of(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

struct Sweep {
    octomap::point3d origin;
    octomap::Pointcloud ends;
};

std::vector<Sweep> read_sweeps(const std::string& folder) {
    const auto rays = read_array<std::array<Point, 2>>(folder, "rays.f64");
    const auto starts = read_array<std::uint64_t>(folder, "ray_starts.u64");
    std::vector<Sweep> sweeps;
    for (std::size_t sweep = 0; sweep + 1 < starts.size(); ++sweep) {
        if (starts[sweep] == starts[sweep + 1]) continue;
        sweeps.push_back({point_of(rays[starts[sweep]][0]), {}});
        for (auto ray = starts[sweep]; ray < starts[sweep + 1]; ++ray) {
            sweeps.back().ends.push_back(point_of(rays[ray][1]));
        }
    }
    return sweeps;
}

void insert(octomap::OcTree& tree, const std::vector<Sweep>& sweeps, bool discretize) {
    auto min = grid_corner(0.0), max = grid_corner(1.0);
    const float inside = 0.01f;
    for (int axis = 0; axis < 3; ++axis) {
        min(axis) += inside;
        max(axis) -= inside;
    }
    tree.setBBXMin(min);
    tree.setBBXMax(max);
    tree.useBBXLimit(true);
    for (const auto& sweep : sweeps) {
        tree.insertPointCloud(sweep.ends, sweep.origin, -1.0, true, discretize);
    }
}

void insert_into_new(const std::string& name, const std::vector<Sweep>& sweeps, std::size_t rays,
                     bool discretize) {
    octomap::OcTree tree(kVoxelM);
    measure(name.c_str(), "ray", rays, [&] { insert(tree, sweeps, discretize); });
    std::size_t free = 0, hit = 0;
    tree.expand();
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
        ++(tree.isNodeOccupied(*leaf) ? hit : free);
    }
    tell(name + ": free", "voxels", free);
    tell(name + ": hit", "voxels", hit);
}

std::size_t all_keys(octomap::OcTree& tree, const std::vector<Sweep>& sweeps) {
    octomap::KeyRay keys;
    std::size_t count = 0;
    for (const auto& sweep : sweeps) {
        for (const auto& end : sweep.ends) {
            tree.computeRayKeys(sweep.origin, end, keys);
            count += keys.size();
        }
    }
    return count;
}

}  // namespace

int main(int, char** arguments) {
    const auto sweeps = read_sweeps(arguments[1]);
    std::size_t rays = 0;
    for (const auto& sweep : sweeps) rays += sweep.ends.size();

    insert_into_new("rays, OctoMap discretize", sweeps, rays, true);
    insert_into_new("rays, OctoMap", sweeps, rays, false);

    octomap::OcTree tree(kVoxelM);
    std::size_t keys = 0;
    measure("rays, OctoMap computeRayKeys", "ray", rays, [&] { keys = all_keys(tree, sweeps); });
    tell("rays, OctoMap computeRayKeys: visits, grid or not", "visits a ray", double(keys) / rays);
}

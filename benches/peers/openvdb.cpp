// OpenVDB's DDA on the exported rays: each clipped to the grid, all that it passes into a MaskGrid.

#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>

#include "common.hpp"

using openvdb::Coord;
using openvdb::Vec3d;
using Ray = openvdb::math::Ray<double>;

namespace {

Vec3d in_voxels(const Point& p) {
    return {(p[0] - kMinM[0]) / kVoxelM, (p[1] - kMinM[1]) / kVoxelM, (p[2] - kMinM[2]) / kVoxelM};
}

// Marks the voxels from the origin's side up to that of the end, which is left out.
void cast(const Vec3d& origin, const Vec3d& end, openvdb::MaskGrid::Accessor& passed) {
    Vec3d way = end - origin;
    const double length = way.length();
    Ray ray(origin, way / length, 0.0, length);
    const openvdb::BBoxd grid(Vec3d(0.0), Vec3d(kShape[0], kShape[1], kShape[2]));
    if (!ray.clip(grid)) return;
    const Coord last = Coord::floor(end);
    openvdb::math::DDA<Ray> walk(ray);
    do {
        if (walk.voxel() == last) return;
        passed.setValueOn(walk.voxel());
    } while (walk.step());
}

bool is_inside(const Coord& voxel) {
    for (int axis = 0; axis < 3; ++axis) {
        if (voxel[axis] < 0 || voxel[axis] >= kShape[axis]) return false;
    }
    return true;
}

}  // namespace

int main(int, char** arguments) {
    const auto rays = read_array<std::array<Point, 2>>(arguments[1], "rays.f64");
    openvdb::initialize();
    auto passed = openvdb::MaskGrid::create(), hit = openvdb::MaskGrid::create();
    measure("rays, OpenVDB DDA", "ray", rays.size(), [&] {
        auto into_passed = passed->getAccessor(), into_hit = hit->getAccessor();
        for (const auto& [origin, end] : rays) {
            const Vec3d last = in_voxels(end);
            cast(in_voxels(origin), last, into_passed);
            into_hit.setValueOn(Coord::floor(last));
        }
    });
    std::size_t free = 0;
    auto hits = hit->getConstAccessor();
    for (auto voxel = passed->cbeginValueOn(); voxel; ++voxel) {
        free += is_inside(voxel.getCoord()) && !hits.isValueOn(voxel.getCoord());
    }
    tell("rays, OpenVDB DDA: free", "voxels", free);
    tell("rays, OpenVDB DDA: hit", "voxels", hit->activeVoxelCount());
}

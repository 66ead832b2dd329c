// nanoflann on the exported points: five neighbours of each query, and the class that most have.

#include <nanoflann.hpp>

#include "common.hpp"

namespace {

struct Points {
    std::vector<std::array<float, 3>> at;

    std::size_t kdtree_get_point_count() const { return at.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return at[i][axis]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const { return false; }
};

using Distance = nanoflann::L2_Simple_Adaptor<float, Points>;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Distance, Points, 3, std::uint32_t>;

Points read_points(const std::string& folder, const std::string& name) {
    const auto exact = read_array<Point>(folder, name);
    Points points;
    for (const auto& p : exact) {
        points.at.push_back({float(p[0]), float(p[1]), float(p[2])});
    }
    return points;
}

// The class that most of the five have; of equals, that of the nearest.
std::uint8_t vote(const std::uint32_t* found, const std::vector<std::uint8_t>& classes) {
    std::uint8_t best = classes[found[0]];
    int most = 0;
    for (int i = 0; i < 5; ++i) {
        int votes = 0;
        for (int j = 0; j < 5; ++j) votes += classes[found[j]] == classes[found[i]];
        if (votes > most) {
            most = votes;
            best = classes[found[i]];
        }
    }
    return best;
}

}  // namespace

int main(int, char** arguments) {
    const std::string folder = arguments[1];
    const Points points = read_points(folder, "labelled.f64");
    const Points queries = read_points(folder, "queries.f64");
    const auto classes = read_array<std::uint8_t>(folder, "labelled.u8");
    const auto ours = read_array<std::uint8_t>(folder, "queries.u8");

    Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    measure("neighbours, nanoflann: index", "point", points.at.size(), [&] { tree.buildIndex(); });
    std::vector<std::uint8_t> voted(queries.at.size());
    measure("neighbours, nanoflann", "query", voted.size(), [&] {
        std::array<std::uint32_t, 5> found;
        std::array<float, 5> squared;
        for (std::size_t query = 0; query < voted.size(); ++query) {
            tree.knnSearch(queries.at[query].data(), 5, found.data(), squared.data());
            voted[query] = vote(found.data(), classes);
        }
    });
    std::size_t equal = 0;
    for (std::size_t query = 0; query < voted.size(); ++query) equal += voted[query] == ours[query];
    tell("neighbours, nanoflann: same class as ours", "share", double(equal) / voted.size());
}

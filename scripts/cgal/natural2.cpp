// Natural neighbours by CGAL, for comparison. On stdin each set is the number of its points and of its targets as
// u32, and pairs of f64: the points, all different, then the targets. On stdout go, for each target, the number of
// its neighbours as u32, and for each of them its index as u32 and its weight as f64; none outside of the hull.
//
// Weights are computed in rational numbers, and rounded once.
#include <cstdint>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_2;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;
using Weights = std::vector<std::pair<Point, Kernel::FT>>;

template <typename Value>
static bool get(Value& value) {
    return std::fread(&value, sizeof value, 1, stdin) == 1;
}

template <typename Value>
static void put(Value value) {
    std::fwrite(&value, sizeof value, 1, stdout);
}

static std::vector<Point> read_points(std::uint32_t count) {
    std::vector<Point> points;
    for (double x, y; points.size() < count && get(x) && get(y);) points.emplace_back(x, y);
    return points;
}

int main() {
    for (std::uint32_t point_count, target_count; get(point_count) && get(target_count);) {
        const auto points = read_points(point_count);
        std::map<Point, std::uint32_t> indices;
        for (std::uint32_t i = 0; i < points.size(); ++i) indices.emplace(points[i], i);
        const Triangulation triangulation(points.begin(), points.end());
        for (const Point& target : read_points(target_count)) {
            Weights weights;
            const auto result = CGAL::natural_neighbor_coordinates_2(triangulation, target, std::back_inserter(weights));
            if (!result.third) weights.clear();
            put(static_cast<std::uint32_t>(weights.size()));
            for (const auto& [point, area] : weights) {
                const auto weight = CGAL::exact(area) / CGAL::exact(result.second);
                put(indices.at(point));
                put(CGAL::to_double(weight));
            }
        }
        std::fflush(stdout);
    }
}

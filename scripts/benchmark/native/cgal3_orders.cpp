// CGAL's Delaunay hierarchy (thesis figure 3.8), with points inserted one by one and no hint where: at random, in
// rounds that double and each follow a curve (BRIO), or along one Hilbert curve. The time includes sorting.
#include "points3.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <random>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Fast_location>;

constexpr unsigned SEED = 1;

int main(int count, char** words) {
    if (count != 3) fail(std::string("usage: ") + words[0] + " POINTS random|brio|hilbert");
    const std::string order = words[2];
    std::vector<Kernel::Point_3> points;
    points.reserve(count_points3(words[1]));
    each_point3(words[1], [&](const Point3& point) { points.emplace_back(point.x, point.y, point.z); });
    const Clock clock;
    if (order == "random") {
        std::shuffle(points.begin(), points.end(), std::mt19937(SEED));
    } else if (order == "brio") {
        CGAL::spatial_sort(points.begin(), points.end());
    } else if (order == "hilbert") {
        CGAL::hilbert_sort(points.begin(), points.end());
    } else {
        fail(order + ": not random, brio or hilbert");
    }
    Triangulation triangulation;
    for (const auto& point : points) triangulation.insert(point);
    const auto seconds = clock.seconds();
    report3(points.size(), triangulation.number_of_finite_cells(), seconds);
}

// CGAL's Delaunay_triangulation of dimension 4, with its own insertion of a range, which sorts along a curve.
// It makes no diagram: cospherical points are divided into simplices.
#include "points4.hpp"

#include <CGAL/Delaunay_triangulation.h>
#include <CGAL/Epick_d.h>

using Kernel = CGAL::Epick_d<CGAL::Dimension_tag<4>>;
using Triangulation = CGAL::Delaunay_triangulation<Kernel>;

int main(int count, char** words) {
    if (count != 2) fail(std::string("usage: ") + words[0] + " POINTS");
    std::vector<Kernel::Point_d> points;
    {
        const auto read = read_points4(words[1]);
        points.reserve(read.size());
        for (const auto& point : read) points.emplace_back(point.begin(), point.end());
    }
    const Clock clock;
    Triangulation triangulation(4);
    triangulation.insert(points.begin(), points.end());
    const auto seconds = clock.seconds();
    report4(points.size(), "simplices", triangulation.number_of_finite_full_cells(), seconds);
}

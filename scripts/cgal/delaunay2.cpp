// Delaunay triangulation by CGAL, for comparison: points "x y" on stdin, a triangle "x y x y x y" per line.
#include <cstdio>
#include <vector>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;

int main() {
    std::vector<Kernel::Point_2> points;
    for (double x, y; std::scanf("%lf %lf", &x, &y) == 2;) points.emplace_back(x, y);
    const Triangulation triangulation(points.begin(), points.end());
    if (triangulation.dimension() < 2) return 0;
    for (auto face : triangulation.finite_face_handles()) {
        for (int i = 0; i < 3; ++i) {
            const auto& point = face->vertex(i)->point();
            std::printf(i < 2 ? "%.17g %.17g " : "%.17g %.17g\n", point.x(), point.y());
        }
    }
}

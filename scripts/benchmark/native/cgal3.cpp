// CGAL's Delaunay_triangulation_3, with its own insertion of a range, which sorts along a curve. With TBB it
// inserts in parallel; a grid of locks separates the threads.
#include "points3.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#ifdef CGAL_LINKED_WITH_TBB
#include <CGAL/bounding_box.h>
#include <tbb/global_control.h>
using Concurrency = CGAL::Parallel_tag;
#else
using Concurrency = CGAL::Sequential_tag;
#endif

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_3<Kernel>;
using CellBase = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Concurrency>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;

constexpr int LOCKS_PER_AXIS = 50;

int main(int count, char** words) {
    [[maybe_unused]] const int threads = threads_of_arguments(count, words);
    std::vector<Kernel::Point_3> points;
    points.reserve(count_points3(words[1]));
    each_point3(words[1], [&](const Point3& point) { points.emplace_back(point.x, point.y, point.z); });
    const Clock clock;
#ifdef CGAL_LINKED_WITH_TBB
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Triangulation::Lock_data_structure locks(CGAL::bounding_box(points.begin(), points.end()).bbox(), LOCKS_PER_AXIS);
    const Triangulation triangulation(points.begin(), points.end(), &locks);
#else
    const Triangulation triangulation(points.begin(), points.end());
#endif
    const auto seconds = clock.seconds();
    report3(points.size(), triangulation.number_of_finite_cells(), seconds);
}

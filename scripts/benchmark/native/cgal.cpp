// CGAL's Delaunay_triangulation_2, with its own insertion of a range, which sorts the points along a curve
// first. Indices in the file number the vertices in CGAL's order, which spares it from storing ours; equal
// points have no vertex.
#include "points.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase>;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel, Structure>;

static std::vector<Kernel::Point_2> converted(std::vector<Point> points) {
    std::vector<Kernel::Point_2> result;
    result.reserve(points.size());
    for (const auto& point : points) result.emplace_back(point.x, point.y);
    return result;
}

int main(int count, char** words) {
    expect_arguments(count, words);
    auto points = read_points(words[1]);
    const auto size = points.size();
    const Clock clock;
    Triangulation triangulation;
    {
        const auto input = converted(std::move(points));
        triangulation.insert(input.begin(), input.end());
    }
    const auto seconds = clock.seconds();
    std::uint32_t vertices = 0;
    for (auto vertex : triangulation.finite_vertex_handles()) vertex->info() = vertices++;
    Triangles triangles(words[2]);
    for (auto face : triangulation.finite_face_handles()) {
        triangles.put(face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info());
    }
    report(size, triangles.count, seconds);
}

// Regular triangulations by CGAL, for comparison. On stdin each set of points is its size as u32 and four f64
// per point: x, y, z and the weight, a squared radius. On stdout go the numbers of tetrahedra and of hull
// facets as u32, and per tetrahedron four u32: indices of points with the coordinates and weights of its
// vertices, positively oriented. Then goes the number of points that are no vertices as u32, and their
// indices, ascending: hidden points, and all but one of several equal points.
//
// The kernel has exact predicates. Where five points are orthogonal to one sphere, CGAL raises each point on
// the lifting paraboloid by an infinitesimal amount, by far the most the last in the order of x, y, z. So a
// point on a lower facet of the lifted hull is a vertex, not hidden.
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointBase = CGAL::Regular_triangulation_vertex_base_3<Kernel>;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel, PointBase>;
using CellBase = CGAL::Regular_triangulation_cell_base_3<Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Triangulation = CGAL::Regular_triangulation_3<Kernel, Structure>;
using Input = std::vector<std::pair<Kernel::Weighted_point_3, std::uint32_t>>;

static bool read_set(Input& points) {
    std::uint32_t count;
    if (std::fread(&count, sizeof count, 1, stdin) != 1) return false;
    points.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        double xyzw[4];
        if (std::fread(xyzw, sizeof xyzw, 1, stdin) != 1) return false;
        points.emplace_back(Kernel::Weighted_point_3({xyzw[0], xyzw[1], xyzw[2]}, xyzw[3]), i);
    }
    return true;
}

static void put(std::uint32_t number) { std::fwrite(&number, sizeof number, 1, stdout); }

static void put_tetrahedra(const Triangulation& triangulation) {
    const bool is_solid = triangulation.dimension() == 3;
    const auto tetrahedra = is_solid ? triangulation.number_of_finite_cells() : 0;
    put(static_cast<std::uint32_t>(tetrahedra));
    put(static_cast<std::uint32_t>(is_solid ? triangulation.number_of_cells() - tetrahedra : 0));
    if (!is_solid) return;
    for (auto cell : triangulation.finite_cell_handles()) {
        for (int i = 0; i < 4; ++i) put(cell->vertex(i)->info());
    }
}

static void put_others(const Triangulation& triangulation, std::size_t count) {
    std::vector<bool> is_vertex(count);
    for (auto vertex : triangulation.finite_vertex_handles()) is_vertex[vertex->info()] = true;
    put(static_cast<std::uint32_t>(count - triangulation.number_of_vertices()));
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!is_vertex[i]) put(i);
    }
}

int main() {
    for (Input points; read_set(points);) {
        Triangulation triangulation;
        triangulation.insert(points.begin(), points.end());
        put_tetrahedra(triangulation);
        put_others(triangulation, points.size());
        std::fflush(stdout);
    }
}

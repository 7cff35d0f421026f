// Delaunay tetrahedralizations by CGAL, for comparison. On stdin each set of points is its size as u32 and
// triples of f64. On stdout go the numbers of tetrahedra and of hull facets as u32, and per tetrahedron four
// u32: indices of points with the coordinates of its vertices, positively oriented.
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>;
using CellBase = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
using Input = std::vector<std::pair<Kernel::Point_3, std::uint32_t>>;

static bool read_set(Input& points) {
    std::uint32_t count;
    if (std::fread(&count, sizeof count, 1, stdin) != 1) return false;
    points.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        double xyz[3];
        if (std::fread(xyz, sizeof xyz, 1, stdin) != 1) return false;
        points.emplace_back(Kernel::Point_3(xyz[0], xyz[1], xyz[2]), i);
    }
    return true;
}

static void put(std::uint32_t number) { std::fwrite(&number, sizeof number, 1, stdout); }

int main() {
    for (Input points; read_set(points);) {
        const Triangulation triangulation(points.begin(), points.end());
        const bool is_solid = triangulation.dimension() == 3;
        const auto tetrahedra = is_solid ? triangulation.number_of_finite_cells() : 0;
        put(static_cast<std::uint32_t>(tetrahedra));
        put(static_cast<std::uint32_t>(is_solid ? triangulation.number_of_cells() - tetrahedra : 0));
        if (is_solid) {
            for (auto cell : triangulation.finite_cell_handles()) {
                for (int i = 0; i < 4; ++i) put(cell->vertex(i)->info());
            }
        }
        std::fflush(stdout);
    }
}

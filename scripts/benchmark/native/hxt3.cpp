// HXT's Delaunay triangulation by Marot, Pellerin and Remacle, from the sources of gmsh. It stores four
// numbers per vertex, the fourth for internal use, and ghost tetrahedra outside the hull.
#include "points3.hpp"

extern "C" {
#include "hxt_omp.h"
#include "hxt_tools.h"
}
#include "hxt_tetDelaunay.h"

static void check(HXTStatus status) {
    if (status != HXT_STATUS_OK) fail("HXT failed");
}

int main(int count, char** words) {
    const int threads = threads_of_arguments(count, words);
    omp_set_num_threads(threads);
    HXTMesh* mesh;
    check(hxtMeshCreate(&mesh));
    const auto size = count_points3(words[1]);
    check(hxtAlignedMalloc(&mesh->vertices.coord, size * 4 * sizeof(double)));
    mesh->vertices.num = mesh->vertices.size = static_cast<std::uint32_t>(size);
    double* next = mesh->vertices.coord;
    each_point3(words[1], [&](const Point3& point) {
        next[0] = point.x, next[1] = point.y, next[2] = point.z;
        next += 4;
    });
    const Clock clock;
    HXTDelaunayOptions options{};
    options.perfectDelaunay = 1;
    options.delaunayThreads = threads;
    check(hxtDelaunay(mesh, &options));
    const auto seconds = clock.seconds();
    std::size_t tetrahedra = 0;
    for (std::uint64_t i = 0; i < mesh->tetrahedra.num; ++i) {
        tetrahedra += mesh->tetrahedra.node[4 * i + 3] != HXT_GHOST_VERTEX;
    }
    report3(size, tetrahedra, seconds);
}

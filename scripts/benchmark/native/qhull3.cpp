// Qhull's Delaunay triangulation, by a convex hull in 4D. Switches: Qt splits the facets that were merged,
// Qbb scales the lift, and Qz adds a point at infinity, so that points on one sphere do not fail. Its
// tetrahedra need not be Delaunay or even have a volume.
#include "points3.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

int main(int count, char** words) {
    threads_of_arguments(count, words);
    auto points = read_points3(words[1]);
    const Clock clock;
    qhT state;
    qhT* qh = &state;
    qh_zero(qh, stderr);
    char command[] = "qhull d Qt Qbb Qz";
    if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), &points[0].x, False, command, nullptr, stderr)) {
        fail("Qhull failed");
    }
    const auto seconds = clock.seconds();
    std::size_t tetrahedra = 0;
    facetT* facet;
    FORALLfacets tetrahedra += !facet->upperdelaunay;
    report3(points.size(), tetrahedra, seconds);
}

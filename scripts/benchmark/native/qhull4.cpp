// Qhull's Delaunay diagram, by a convex hull in 5D. By default, Qhull merges facets that are coplanar up to
// rounding, so that cells of cospherical points stay whole. With "split" it divides them into simplices (Qt),
// which need not be Delaunay or even have a volume.
#include "points4.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

int main(int count, char** words) {
    const bool is_split = count == 3 && !std::strcmp(words[2], "split");
    if (count != 2 && !is_split) fail(std::string("usage: ") + words[0] + " POINTS [split]");
    auto points = read_points4(words[1]);
    const Clock clock;
    qhT state;
    qhT* qh = &state;
    qh_zero(qh, stderr);
    // As in qdelaunay: Qbb scales the lift, Qx selects how facets are merged in 5D.
    char merged[] = "qhull d Qbb Qx";
    char split[] = "qhull d Qbb Qx Qt";
    char* command = is_split ? split : merged;
    const auto points_count = static_cast<int>(points.size());
    if (qh_new_qhull(qh, 4, points_count, points[0].data(), False, command, nullptr, stderr)) fail("Qhull failed");
    const auto seconds = clock.seconds();
    std::size_t lower = 0;
    facetT* facet;
    FORALLfacets lower += !facet->upperdelaunay;
    report4(points.size(), is_split ? "simplices" : "cells", lower, seconds);
}

// Geogram's sequential Delaunay2d (BDEL2d), from the library in its Python package.
#include "points.hpp"

#include <geogram/basic/common.h>
#include <geogram/basic/command_line.h>
#include <geogram/basic/command_line_args.h>
#include <geogram/basic/logger.h>
#include <geogram/basic/process.h>
#include <geogram/delaunay/delaunay.h>

int main(int count, char** words) {
    expect_arguments(count, words);
    GEO::initialize(GEO::GEOGRAM_INSTALL_NONE);
    GEO::Logger::instance()->set_quiet(true);
    GEO::CmdLine::import_arg_group("standard");
    GEO::CmdLine::import_arg_group("algo");
    GEO::Process::enable_multithreading(false);
    const auto points = read_points(words[1]);
    const Clock clock;
    GEO::Delaunay_var delaunay = GEO::Delaunay::create(2, "BDEL2d");
    delaunay->set_vertices(static_cast<GEO::index_t>(points.size()), &points[0].x);
    const auto seconds = clock.seconds();
    Triangles triangles(words[2]);
    for (GEO::index_t cell = 0; cell < delaunay->nb_cells(); ++cell) {
        triangles.put(delaunay->cell_vertex(cell, 0), delaunay->cell_vertex(cell, 1), delaunay->cell_vertex(cell, 2));
    }
    report(points.size(), triangles.count, seconds);
}

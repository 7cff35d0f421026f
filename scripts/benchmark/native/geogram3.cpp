// Geogram's Delaunay3d from the library in its Python package: sequential (BDEL) with one thread, parallel
// (PDEL) with more.
#include "points3.hpp"

#include <geogram/basic/command_line.h>
#include <geogram/basic/command_line_args.h>
#include <geogram/basic/common.h>
#include <geogram/basic/logger.h>
#include <geogram/basic/process.h>
#include <geogram/delaunay/delaunay.h>

int main(int count, char** words) {
    const int threads = threads_of_arguments(count, words);
    GEO::initialize(GEO::GEOGRAM_INSTALL_NONE);
    GEO::Logger::instance()->set_quiet(true);
    GEO::CmdLine::import_arg_group("standard");
    GEO::CmdLine::import_arg_group("algo");
    GEO::Process::enable_multithreading(threads > 1);
    GEO::Process::set_max_threads(static_cast<GEO::index_t>(threads));
    const auto points = read_points3(words[1]);
    const Clock clock;
    GEO::Delaunay_var delaunay = GEO::Delaunay::create(3, threads > 1 ? "PDEL" : "BDEL");
    delaunay->set_vertices(static_cast<GEO::index_t>(points.size()), &points[0].x);
    const auto seconds = clock.seconds();
    report3(points.size(), delaunay->nb_cells(), seconds);
}

// Code shared by all peers in 3D. A peer is run as PEER POINTS THREADS. POINTS has triples of little-endian
// f64. A line of JSON on stdout reports the number of tetrahedra and the time of the triangulation alone.
#pragma once

#include "points.hpp"

#include <sys/stat.h>

struct Point3 {
    double x, y, z;
};

// Calls `put` with each point, so that a peer stores the points only once, in its own types.
template <class Put>
void each_point3(const char* path, Put put) {
    File file(path, "rb");
    for (Point3 point; std::fread(&point, sizeof point, 1, file.handle) == 1;) put(point);
}

inline std::size_t count_points3(const char* path) {
    struct stat facts;
    if (stat(path, &facts)) fail(std::string(path) + ": not found");
    return static_cast<std::size_t>(facts.st_size) / sizeof(Point3);
}

inline std::vector<Point3> read_points3(const char* path) {
    std::vector<Point3> points;
    points.reserve(count_points3(path));
    each_point3(path, [&](const Point3& point) { points.push_back(point); });
    return points;
}

inline void report3(std::size_t points, std::size_t tetrahedra, double seconds) {
    std::printf("{\"points\": %zu, \"tetrahedra\": %zu, \"seconds\": %.6f}\n", points, tetrahedra, seconds);
}

// The number of threads, after a check of the arguments.
inline int threads_of_arguments(int count, char** words) {
    const int threads = count == 3 ? std::atoi(words[2]) : 0;
    if (threads < 1) fail(std::string("usage: ") + words[0] + " POINTS THREADS");
    return threads;
}

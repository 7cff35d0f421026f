// Code shared by all peers in 4D. A peer is run as PEER POINTS [FLAG]. POINTS has quadruples of little-endian
// f64. A line of JSON on stdout reports the number of cells or simplices, and the time that making them took.
#pragma once

#include "points.hpp"

#include <array>
#include <sys/stat.h>

using Point4 = std::array<double, 4>;

inline std::vector<Point4> read_points4(const char* path) {
    struct stat facts;
    if (stat(path, &facts)) fail(std::string(path) + ": not found");
    std::vector<Point4> points(static_cast<std::size_t>(facts.st_size) / sizeof(Point4));
    File file(path, "rb");
    file.read(points.data(), points.size() * sizeof(Point4));
    return points;
}

// `element` names the counted elements, finite cells or simplices.
inline void report4(std::size_t points, const char* element, std::size_t elements, double seconds) {
    std::printf("{\"points\": %zu, \"%s\": %zu, \"seconds\": %.6f}\n", points, element, elements, seconds);
}

// delaunay32, with THREADS threads. It takes 32-bit integers: other coordinates are multiplied by a power of
// two, so that they span up to 2^26, and rounded. Its points are not part of the time.
#include "points.hpp"

#include <algorithm>
#include <cmath>
#include <delaunay32/delaunay.hpp>

static constexpr double SPAN_MAX = 1 << 26;

// Integers are only moved, which changes no triangle.
static std::vector<delaunay32::Point> quantized(const std::vector<Point>& points) {
    if (points.empty()) return {};
    Point low = points[0], high = low;
    bool is_integral = true;
    for (const auto& point : points) {
        low = {std::min(low.x, point.x), std::min(low.y, point.y)};
        high = {std::max(high.x, point.x), std::max(high.y, point.y)};
        is_integral = is_integral && point.x == std::rint(point.x) && point.y == std::rint(point.y);
    }
    const auto span = std::max(high.x - low.x, high.y - low.y);
    const auto scale = is_integral ? 1.0 : std::exp2(std::floor(std::log2(SPAN_MAX / span)));
    const auto number = [scale](double from, double to) {
        return static_cast<std::int32_t>(std::rint((to - from) * scale));
    };
    std::vector<delaunay32::Point> result;
    result.reserve(points.size());
    for (const auto& point : points) result.push_back({number(low.x, point.x), number(low.y, point.y)});
    return result;
}

int main(int count, char** words) {
    expect_arguments(count, words);
    const auto points = quantized(read_points(words[1]));
    delaunay32::TriangulationOptions options;
    options.thread_count = THREADS;
    const Clock clock;
    delaunay32::Triangulator triangulator;
    triangulator.set_options(options);
    triangulator.set_points(points);
    const auto result = triangulator.triangulate();
    const auto seconds = clock.seconds();
    Triangles triangles(words[2]);
    for (const auto& triangle : result.triangles) triangles.put(triangle.i0, triangle.i1, triangle.i2);
    report(points.size(), triangles.count, seconds);
}

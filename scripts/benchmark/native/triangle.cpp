// Shewchuk's Triangle through its C function. Switches: z counts from zero, Q is quiet; N and B leave out the
// vertices and the boundary markers, which are not needed here.
#include "points.hpp"

#define REAL double
#define VOID void
extern "C" {
#include "triangle.h"
}

int main(int count, char** words) {
    expect_arguments(count, words);
    auto points = read_points(words[1]);
    const Clock clock;
    triangulateio in{}, out{};
    in.pointlist = &points[0].x;
    in.numberofpoints = static_cast<int>(points.size());
    char switches[] = "zQNB";
    triangulate(switches, &in, &out, nullptr);
    const auto seconds = clock.seconds();
    Triangles triangles(words[2]);
    for (int i = 0; i < out.numberoftriangles; ++i) {
        const int* corners = out.trianglelist + 3 * i;
        triangles.put(corners[0], corners[1], corners[2]);
    }
    report(points.size(), triangles.count, seconds);
}

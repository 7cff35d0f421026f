// Si's TetGen through its C++ function. Switches: Q is quiet; N, F and B leave out the points, the faces and
// the boundary markers, which are not needed here.
#include "points3.hpp"

#include <tetgen.h>

int main(int count, char** words) {
    threads_of_arguments(count, words);
    auto points = read_points3(words[1]);
    const Clock clock;
    tetgenio in, out;
    in.pointlist = &points[0].x;
    in.numberofpoints = static_cast<int>(points.size());
    char switches[] = "QNFB";
    tetrahedralize(switches, &in, &out);
    const auto seconds = clock.seconds();
    // Not its own.
    in.pointlist = nullptr;
    report3(points.size(), static_cast<std::size_t>(out.numberoftetrahedra), seconds);
}

// CDT by Artem Amirkhanov. It accepts no equal points, so their removal counts as work. Indices in the file
// are the indices after that.
#include "points.hpp"

#include <CDT.h>

int main(int count, char** words) {
    expect_arguments(count, words);
    const auto points = read_points(words[1]);
    const Clock clock;
    std::vector<CDT::V2d<double>> vertices;
    vertices.reserve(points.size());
    for (const auto& point : points) vertices.push_back(CDT::V2d<double>(point.x, point.y));
    CDT::RemoveDuplicates(vertices);
    CDT::Triangulation<double> triangulation;
    triangulation.insertVertices(vertices);
    triangulation.eraseSuperTriangle();
    const auto seconds = clock.seconds();
    Triangles triangles(words[2]);
    for (const auto& triangle : triangulation.triangles) {
        triangles.put(triangle.vertices[0], triangle.vertices[1], triangle.vertices[2]);
    }
    report(points.size(), triangles.count, seconds);
}

// The boundary of a union of balls: its spheres, the circles of two of them, and the corners of three.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>

#include "geometry.hpp"

// Items by cubes of space, each in the cube of its point.
class Grid {
  public:
    explicit Grid(double side) : side_(side) {}

    static std::uint64_t key(long i, long j, long k) {
        auto bits = [](long c) { return std::uint64_t(c & 0x1fffff); };
        return bits(i) << 42 | bits(j) << 21 | bits(k);
    }

    void add(Vector p, int item) { cubes_[key(at(p.x), at(p.y), at(p.z))].push_back(item); }

    // Calls `visit` with all items of cubes that the ball around `p` may meet.
    template <class Visit> void near(Vector p, double reach, Visit visit) const {
        for (long i = at(p.x - reach); i <= at(p.x + reach); ++i)
            for (long j = at(p.y - reach); j <= at(p.y + reach); ++j)
                for (long k = at(p.z - reach); k <= at(p.z + reach); ++k) {
                    auto found = cubes_.find(key(i, j, k));
                    if (found == cubes_.end()) continue;
                    for (int item : found->second) visit(item);
                }
    }

  private:
    long at(double c) const { return long(std::floor(c / side_)); }

    double side_;
    std::unordered_map<std::uint64_t, std::vector<int>> cubes_;
};

struct Boundary {
    std::vector<Ball> balls;
    // Those with uncovered points, and the uncovered corners.
    std::vector<Circle> circles;
    std::vector<Vector> corners;
};

// The balls that overlap one ball, from near to far.
class Overlapping {
  public:
    Overlapping(const std::vector<Ball>& balls, const Grid& grid, int i, double greatest) : balls_(balls) {
        std::vector<std::pair<double, int>> found;
        grid.near(balls[i].centre, balls[i].radius + greatest, [&](int j) {
            double d = length(balls[j].centre - balls[i].centre);
            if (j != i && d < balls[i].radius + balls[j].radius) found.emplace_back(d, j);
        });
        std::sort(found.begin(), found.end());
        for (auto [d, j] : found) numbers.push_back(j);
    }

    // Whether one of them, and neither j nor k, covers a point.
    bool cover(Vector p, int j, int k) {
        auto does = [&](int m) { return m != j && m != k && covers(balls_[m], p); };
        if (!numbers.empty() && does(numbers[last_])) return true;
        for (std::size_t n = 0; n < numbers.size(); ++n)
            if (does(numbers[n])) return last_ = n, true;
        return false;
    }

    std::vector<int> numbers;

  private:
    const std::vector<Ball>& balls_;
    // What covered the last point often covers the next.
    std::size_t last_ = 0;
};

inline Boundary boundary_of(const std::vector<Ball>& balls) {
    Boundary boundary{balls, {}, {}};
    double greatest = greatest_radius(balls);
    Grid grid(greatest);
    for (int i = 0; i < int(balls.size()); ++i) grid.add(balls[i].centre, i);
    for (int i = 0; i < int(balls.size()); ++i) {
        Overlapping others(balls, grid, i, greatest);
        for (int j : others.numbers) {
            Circle circle;
            if (j < i || !circle_of(balls[i], balls[j], circle)) continue;
            bool is_open = false;
            for (int k : others.numbers) {
                std::array<Vector, 2> corners;
                if (k == j || !corners_of(circle, balls[k], corners)) continue;
                for (Vector corner : corners) {
                    if (others.cover(corner, j, k)) continue;
                    is_open = true;
                    if (k > j) boundary.corners.push_back(corner);
                }
            }
            // Without corners, one point stands for all.
            Vector any = circle.centre + circle.radius * unit_across(circle.axis);
            if (is_open || !others.cover(any, j, -1)) boundary.circles.push_back(circle);
        }
    }
    return boundary;
}

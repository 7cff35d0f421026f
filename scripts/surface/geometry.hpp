// Points, spheres, circles and their distances.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

struct Vector {
    double x, y, z;
};
inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(Vector a) { return std::sqrt(dot(a, a)); }
inline Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// A point this deep in a ball is on its sphere: spheres that meet in one point do not cover it.
const double TOLERANCE = 1e-9;

struct Ball {
    Vector centre;
    double radius;
};

// Of two spheres, about an axis of length 1.
struct Circle {
    Vector centre, axis;
    double radius;
};

inline bool covers(const Ball& ball, Vector p) {
    Vector d = p - ball.centre;
    double r = ball.radius - TOLERANCE;
    return r > 0 && dot(d, d) < r * r;
}

inline double greatest_radius(const std::vector<Ball>& balls) {
    double greatest = 0;
    for (const Ball& ball : balls) greatest = std::max(greatest, ball.radius);
    return greatest;
}

inline Vector unit_across(Vector axis) {
    Vector other = std::abs(axis.x) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    Vector across = cross(axis, other);
    return (1 / length(across)) * across;
}

inline double distance(Vector p, const Ball& ball) { return std::abs(ball.radius - length(p - ball.centre)); }
inline double distance(Vector p, const Circle& circle) {
    Vector to = p - circle.centre;
    double height = dot(to, circle.axis), square = dot(to, to) - height * height;
    double out = std::sqrt(std::max(0.0, square)) - circle.radius;
    return std::sqrt(height * height + out * out);
}
inline double distance(Vector p, Vector corner) { return length(p - corner); }

// The nearest points. From a centre or an axis all are equally near; one is taken.
inline Vector nearest(Vector p, const Ball& ball) {
    Vector to = p - ball.centre;
    double r = length(to);
    return ball.centre + ball.radius * (r > 0 ? (1 / r) * to : Vector{1, 0, 0});
}
inline Vector nearest(Vector p, const Circle& circle) {
    Vector to = p - circle.centre;
    Vector flat = to - dot(to, circle.axis) * circle.axis;
    double r = length(flat);
    return circle.centre + circle.radius * (r > 0 ? (1 / r) * flat : unit_across(circle.axis));
}

// The circle of two spheres; false if they do not cross.
inline bool circle_of(const Ball& a, const Ball& b, Circle& circle) {
    Vector between = b.centre - a.centre;
    double d = length(between);
    if (d == 0 || d >= a.radius + b.radius || d <= std::abs(a.radius - b.radius)) return false;
    double height = (d * d + (a.radius - b.radius) * (a.radius + b.radius)) / (2 * d);
    circle.axis = (1 / d) * between;
    circle.centre = a.centre + height * circle.axis;
    circle.radius = std::sqrt(std::max(0.0, a.radius * a.radius - height * height));
    return circle.radius > 0;
}

// The two points of a circle on a sphere; false if there are none.
inline bool corners_of(const Circle& circle, const Ball& ball, std::array<Vector, 2>& corners) {
    Vector to = ball.centre - circle.centre;
    double height = dot(to, circle.axis);
    Vector flat = to - height * circle.axis;
    double d = length(flat), r2 = ball.radius * ball.radius - height * height;
    if (d == 0 || r2 <= 0) return false;
    double x = (d * d + circle.radius * circle.radius - r2) / (2 * d);
    double y2 = circle.radius * circle.radius - x * x;
    if (y2 <= 0) return false;
    Vector along = (1 / d) * flat, across = std::sqrt(y2) * cross(circle.axis, along);
    corners = {circle.centre + x * along + across, circle.centre + x * along - across};
    return true;
}

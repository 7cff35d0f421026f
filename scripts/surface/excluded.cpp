// Volume and area of what a probe cannot reach, by sampling; for scripts/check-surface.
//
// Arguments: radius of the probe, about how many samples, seed. On stdin: lines x y z radius of balls
// without the probe. On stdout: volume, area, and area from a band of twice the width, each with its
// standard error; number of samples, number of corners.
//
// A place of the probe's centre is accessible if no ball, enlarged by the probe, covers it. A point is
// excluded if it is at least the probe's radius away from all accessible places. The nearest one is the
// point itself, or its projection onto one sphere or onto the circle of two, or a corner of three: the
// nearest of these that no ball covers. Pairs and triples are searched without any triangulation.
//
// The distance changes by at most as much as the point moves. So cubes whose centre is far from the surface
// are decided as a whole; the others are halved until they are small, then two random points of each are
// samples. The area is the volume of a band around the surface, divided by its width.
#include <cstdio>
#include <cstdlib>
#include <random>
#include <unordered_set>

#include "boundary.hpp"

// Half the width of the band, as a part of the least radius of a patch.
static const double HALF_WIDTH = 1.0 / 32;
// Patches smaller than this part of the probe are too few to matter.
static const double PATCH_MIN = 0.25;
// Side of the largest cubes, as a part of the greatest radius.
static const double SIDE = 0.4;

// The parts of a boundary that can matter for the points of a cube.
struct Part {
    // Balls that may cover places, and those whose spheres may hold the nearest one.
    std::vector<Ball> balls, spheres;
    std::vector<Circle> circles;
    std::vector<Vector> corners;
    // What covered the last point often covers the next.
    mutable std::size_t last = 0;

    bool is_covered(Vector p) const {
        if (last < balls.size() && covers(balls[last], p)) return true;
        for (std::size_t n = 0; n < balls.size(); ++n)
            if (covers(balls[n], p)) return last = n, true;
        return false;
    }

    // The distance of a point from what is accessible, or `most` if it is greater.
    double depth(Vector p, double most) const {
        if (!is_covered(p)) return 0;
        double least = most;
        for (Vector corner : corners) least = std::min(least, distance(p, corner));
        auto compare = [&](const auto& item) {
            double d = distance(p, item);
            if (d < least && !is_covered(nearest(p, item))) least = d;
        };
        for (const Circle& circle : circles) compare(circle);
        for (const Ball& ball : spheres) compare(ball);
        return least;
    }

    // What is at most `reach` away from `p`.
    Part within(Vector p, double reach) const {
        Part part;
        for (const Ball& ball : balls)
            if (length(p - ball.centre) < ball.radius + reach) part.balls.push_back(ball);
        auto choose = [&](const auto& from, auto& to) {
            for (const auto& item : from)
                if (distance(p, item) < reach) to.push_back(item);
        };
        choose(spheres, part.spheres);
        choose(circles, part.circles);
        choose(corners, part.corners);
        return part;
    }
};

// A sum over cubes, each the mean of two samples; their difference gives the variance.
struct Sum {
    double sum = 0, variance = 0;
    void add(double cube, bool a, bool b) {
        sum += cube * (a + b) / 2;
        if (a != b) variance += cube * cube / 4;
    }
};

struct Measure {
    Sum volume, band, wide_band;
    long undecided = 0;
};

static double half_diagonal(double side) { return side * std::sqrt(0.75); }

// Finds parts of a boundary.
class Index {
  public:
    Index(const Boundary& boundary, double side)
        : boundary_(boundary), balls_(side), circles_(side), corners_(side), widest_(0) {
        for (std::size_t i = 0; i < boundary.balls.size(); ++i) balls_.add(boundary.balls[i].centre, int(i));
        for (std::size_t i = 0; i < boundary.corners.size(); ++i) corners_.add(boundary.corners[i], int(i));
        for (std::size_t i = 0; i < boundary.circles.size(); ++i) {
            circles_.add(boundary.circles[i].centre, int(i));
            widest_ = std::max(widest_, boundary.circles[i].radius);
        }
        greatest_ = greatest_radius(boundary.balls);
    }

    Part within(Vector p, double reach) const {
        Part part;
        auto add_to = [](auto& items, const auto& all) { return [&](int n) { items.push_back(all[n]); }; };
        balls_.near(p, greatest_ + reach, add_to(part.balls, boundary_.balls));
        circles_.near(p, widest_ + reach, add_to(part.circles, boundary_.circles));
        corners_.near(p, reach, add_to(part.corners, boundary_.corners));
        part.spheres = part.balls;
        return part.within(p, reach);
    }

  private:
    const Boundary& boundary_;
    Grid balls_, circles_, corners_;
    double greatest_, widest_;
};

class Sampling {
  public:
    // The largest cubes have this side.
    Sampling(const Boundary& boundary, double probe, double side, std::uint64_t seed)
        : balls_(boundary.balls), index_(boundary, 2 * side), probe_(probe), side_(side), random_(seed) {
        double least = probe;
        for (const Ball& ball : balls_) least = std::min(least, ball.radius - probe);
        half_width_ = HALF_WIDTH * std::max(least, PATCH_MIN * probe);
    }

    double half_width() const { return half_width_; }

    // Cubes are halved `levels` times. Without `is_sampling` the undecided cubes are only counted.
    Measure run(int levels, bool is_sampling) {
        Measure measure;
        // No greater distance is asked for, from any point of a large cube.
        double reach = probe_ + margin(side_) + half_width_ + half_diagonal(side_);
        visit_largest([&](Vector middle) {
            descend(middle, side_, index_.within(middle, reach), levels, is_sampling, measure);
        });
        return measure;
    }

  private:
    double margin(double side) const { return half_diagonal(side) + 2 * half_width_; }

    // Calls `visit` with the centre of each of the largest cubes that a ball meets.
    template <class Visit> void visit_largest(Visit visit) const {
        std::unordered_set<std::uint64_t> seen;
        auto at = [&](double c) { return long(std::floor(c / side_)); };
        for (const Ball& ball : balls_) {
            Vector c = ball.centre;
            double r = ball.radius;
            for (long i = at(c.x - r); i <= at(c.x + r); ++i)
                for (long j = at(c.y - r); j <= at(c.y + r); ++j)
                    for (long k = at(c.z - r); k <= at(c.z + r); ++k) {
                        Vector middle = {(i + 0.5) * side_, (j + 0.5) * side_, (k + 0.5) * side_};
                        if (length(middle - c) > r + half_diagonal(side_)) continue;
                        if (seen.insert(Grid::key(i, j, k)).second) visit(middle);
                    }
        }
    }

    void descend(Vector centre, double side, const Part& part, int levels, bool is_sampling, Measure& to) {
        // The limit is beyond the margin, also when it is rounded.
        double apart = part.depth(centre, probe_ + margin(side) + half_width_) - probe_;
        if (apart >= margin(side)) to.volume.sum += side * side * side;
        if (std::abs(apart) >= margin(side)) return;
        if (levels == 0) {
            ++to.undecided;
            if (is_sampling) sample(centre, side, part, to);
            return;
        }
        // What is nearest to the centre is at most half a diagonal farther from a point of the cube. So what
        // is nearest to that point is at most a whole diagonal farther from the centre.
        Part near = part.within(centre, apart + probe_ + side * std::sqrt(3.0) + TOLERANCE);
        double h = side / 4;
        for (int octant = 0; octant < 8; ++octant) {
            Vector step = {octant & 1 ? h : -h, octant & 2 ? h : -h, octant & 4 ? h : -h};
            descend(centre + step, side / 2, near, levels - 1, is_sampling, to);
        }
    }

    void sample(Vector centre, double side, const Part& part, Measure& measure) {
        std::uniform_real_distribution<double> place(-side / 2, side / 2);
        double apart[2];
        for (double& each : apart) {
            Vector p = centre + Vector{place(random_), place(random_), place(random_)};
            each = part.depth(p, probe_ + 3 * half_width_) - probe_;
        }
        double cube = side * side * side, narrow = half_width_, wide = 2 * half_width_;
        auto is_in = [](double d, double width) { return -width <= d && d < width; };
        measure.volume.add(cube, apart[0] >= 0, apart[1] >= 0);
        measure.band.add(cube, is_in(apart[0], narrow), is_in(apart[1], narrow));
        measure.wide_band.add(cube, is_in(apart[0], wide), is_in(apart[1], wide));
    }

    const std::vector<Ball>& balls_;
    Index index_;
    double probe_, side_, half_width_;
    std::mt19937_64 random_;
};

int main(int count, char** words) {
    if (count != 4) return std::fputs("usage: excluded PROBE SAMPLES SEED <BALLS\n", stderr), 2;
    double probe = std::atof(words[1]);
    long samples = std::atol(words[2]);
    std::vector<Ball> balls;
    for (Ball b; std::scanf("%lf %lf %lf %lf", &b.centre.x, &b.centre.y, &b.centre.z, &b.radius) == 4;)
        balls.push_back({b.centre, b.radius + probe});
    Boundary boundary = boundary_of(balls);
    std::uint64_t seed = std::strtoull(words[3], nullptr, 10);
    // The number of small cubes at the surface is as the square of their side.
    double side = SIDE * greatest_radius(boundary.balls);
    long coarse = Sampling(boundary, probe, side, seed).run(2, false).undecided;
    double smallest = side / 4 * std::sqrt(2.0 * std::max(coarse, 1L) / samples);
    int levels = int(std::ceil(std::max(0.0, std::log2(side / smallest))));
    Sampling sampling(boundary, probe, smallest * std::exp2(levels), seed);
    Measure found = sampling.run(levels, true);
    double width = 2 * sampling.half_width();
    auto error = [](const Sum& sum) { return std::sqrt(sum.variance); };
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g %ld %zu\n", found.volume.sum, error(found.volume),
                found.band.sum / width, error(found.band) / width, found.wide_band.sum / (2 * width),
                error(found.wide_band) / (2 * width), 2 * found.undecided, boundary.corners.size());
}

// Code shared by all peers in C++: points in, triangles out, and the clock.
//
// A peer is run as PEER POINTS TRIANGLES. POINTS is an uncompressed LAS file, whose stored integers are the
// coordinates, or any other file: pairs of little-endian f64. TRIANGLES gets three little-endian u32 per
// triangle, the indices of its points. A line of JSON on stdout reports the counts and the time of the
// triangulation alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

struct Point {
    double x, y;
};

[[noreturn]] inline void fail(const std::string& what) {
    std::fprintf(stderr, "%s\n", what.c_str());
    std::exit(1);
}

struct File {
    std::FILE* handle;
    std::string name;

    File(const char* path, const char* mode) : handle(std::fopen(path, mode)), name(path) {
        if (!handle) fail(name + ": cannot be opened");
        std::setvbuf(handle, nullptr, _IOFBF, 1 << 20);
    }
    void read(void* to, std::size_t size) {
        if (std::fread(to, 1, size, handle) != size) fail(name + ": ends too early");
    }
    void seek(long offset, int origin) {
        if (std::fseek(handle, offset, origin)) fail(name + ": cannot be positioned");
    }
    ~File() {
        if (std::fclose(handle)) fail(name + ": not written");
    }
};

template <class Number>
Number number_at(const char* bytes) {
    Number number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

inline std::vector<Point> read_las(File& file) {
    char header[227];
    file.read(header, sizeof header);
    if (std::memcmp(header, "LASF", 4) || header[104] & 0x80) fail(file.name + ": no uncompressed LAS file");
    const auto record_len = number_at<std::uint16_t>(header + 105);
    std::vector<Point> points(number_at<std::uint32_t>(header + 107));
    file.seek(number_at<std::uint32_t>(header + 96), SEEK_SET);
    std::vector<char> record(record_len);
    for (auto& point : points) {
        file.read(record.data(), record_len);
        point.x = number_at<std::int32_t>(record.data());
        point.y = number_at<std::int32_t>(record.data() + 4);
    }
    return points;
}

inline std::vector<Point> read_points(const char* path) {
    File file(path, "rb");
    if (file.name.ends_with(".las")) return read_las(file);
    file.seek(0, SEEK_END);
    std::vector<Point> points(std::ftell(file.handle) / sizeof(Point));
    file.seek(0, SEEK_SET);
    file.read(points.data(), points.size() * sizeof(Point));
    return points;
}

class Triangles {
    File file;

  public:
    std::size_t count = 0;

    explicit Triangles(const char* path) : file(path, "wb") {}
    void put(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const std::uint32_t corners[3] = {a, b, c};
        if (std::fwrite(corners, sizeof corners, 1, file.handle) != 1) fail(file.name + ": not written");
        ++count;
    }
};

class Clock {
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
};

inline void report(std::size_t points, std::size_t triangles, double seconds) {
    std::printf("{\"points\": %zu, \"triangles\": %zu, \"seconds\": %.6f}\n", points, triangles, seconds);
}

// Shortens main: checks the arguments.
inline void expect_arguments(int count, char** words) {
    if (count != 3) fail(std::string("usage: ") + words[0] + " POINTS TRIANGLES");
}

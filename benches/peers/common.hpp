// Arrays as `occlabel-suite export` writes them, a CPU clock, and rows as it prints them.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

using Point = std::array<double, 3>;

// The grid of the preset `precise`: lower corner, voxel size in metres, voxels along each axis.
constexpr Point kMinM = {-40.0, -40.0, -1.0};
constexpr double kVoxelM = 0.4;
constexpr std::array<int, 3> kShape = {200, 200, 16};

template <typename T>
std::vector<T> read_array(const std::string& folder, const std::string& name) {
    std::ifstream file(folder + "/" + name, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("no " + folder + "/" + name);
    std::vector<T> values(static_cast<std::size_t>(file.tellg()) / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(values.data()), values.size() * sizeof(T));
    return values;
}

inline double seconds(clockid_t clock) {
    timespec time;
    clock_gettime(clock, &time);
    return time.tv_sec + time.tv_nsec / 1e9;
}

// What `work` costs a unit, as a row.
template <typename Work>
void measure(const char* name, const char* unit, std::size_t count, Work work) {
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
    work();
    const double unit_ns = 1e9 / count;
    const double cpu_ns = (seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * unit_ns;
    const double wall_ns = (seconds(CLOCK_MONOTONIC) - wall) * unit_ns;
    std::printf("{\"bench\": \"peers\", \"name\": \"%s\", \"unit\": \"%s\", \"count\": %zu, "
                "\"cpu_ns\": [%.4f], \"wall_ns\": [%.4f]}\n", name, unit, count, cpu_ns, wall_ns);
}

inline void tell(const std::string& name, const char* unit, double value) {
    std::printf("{\"bench\": \"peers\", \"name\": \"%s\", \"unit\": \"%s\", \"value\": %.6g}\n",
                name.c_str(), unit, value);
}

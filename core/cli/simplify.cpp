// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace kestrel::cli {
namespace {

using glm::dvec3;

/// Corners whose attributes differ by less are on the same smooth patch.
constexpr float kSameNormal = 0.5f;  // cosine of the angle between normals
constexpr float kSameUv = 1e-4f;
/// A triangle may turn by at most this in a collapse: cosine.
constexpr double kSmallestTurn = 0.3;

/// Symmetric 4x4 matrix of squared distances to planes.
struct Quadric {
  std::array<double, 10> m{};  // xx xy xz xw yy yz yw zz zw ww

  void add_plane(const dvec3& n, double d, double weight) {
    const double v[4] = {n.x, n.y, n.z, d};
    for (int i = 0, k = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) m[k++] += weight * v[i] * v[j];
    }
  }
  void add(const Quadric& other) {
    for (int k = 0; k < 10; ++k) m[k] += other.m[k];
  }
  double at(const dvec3& p) const {
    const double v[4] = {p.x, p.y, p.z, 1.0};
    double sum = 0.0;
    for (int i = 0, k = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) sum += (i == j ? 1.0 : 2.0) * m[k++] * v[i] * v[j];
    }
    return sum;
  }
};

using Ring = std::vector<std::pair<uint32_t, int>>;

/// `gone` moves onto `kept`. Ordered by error, then by index, so that ties have one outcome.
struct Collapse {
  double error;
  uint32_t gone, kept;
  uint32_t version;  // of `gone` when the error was computed

  bool operator<(const Collapse& o) const {
    if (error != o.error) return error > o.error;
    if (gone != o.gone) return gone > o.gone;
    return kept > o.kept;
  }
};

class Simplifier {
 public:
  explicit Simplifier(MeshDescription& mesh) : mesh_(mesh) {
    weld();
    const size_t vertices = mesh_.positions.size();
    triangles_of_.resize(vertices);
    quadrics_.resize(vertices);
    versions_.resize(vertices, 0);
    alive_.resize(mesh_.triangles.size(), true);
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) add_triangle(t);
    for (uint32_t v = 0; v < vertices; ++v) push_collapse_of(v);
  }

  void run(size_t target) {
    while (live_ > target && !queue_.empty()) {
      const Collapse c = queue_.top();
      queue_.pop();
      if (c.version != versions_[c.gone] || triangles_of_[c.gone].empty()) continue;
      if (allowed(c)) {
        apply(c);
      } else {
        push_collapse_of(c.gone, &c);
      }
    }
    compact();
  }

 private:
  void weld() {
    struct Hash {
      size_t operator()(const vec3& p) const {
        size_t h = 0;
        for (int i = 0; i < 3; ++i) h = h * 0x9E3779B97F4A7C15ull + std::hash<float>()(p[i]);
        return h;
      }
    };
    std::unordered_map<vec3, uint32_t, Hash> index;
    std::vector<uint32_t> remap;
    std::vector<vec3> positions;
    for (const vec3& p : mesh_.positions) {
      const auto [it, is_new] = index.try_emplace(p, static_cast<uint32_t>(positions.size()));
      if (is_new) positions.push_back(p);
      remap.push_back(it->second);
    }
    mesh_.positions = std::move(positions);
    for (uvec3& t : mesh_.triangles) t = {remap[t.x], remap[t.y], remap[t.z]};
  }

  dvec3 cross_of(const uvec3& t) const {
    const dvec3 a(mesh_.positions[t.x]), b(mesh_.positions[t.y]), c(mesh_.positions[t.z]);
    return glm::cross(b - a, c - a);
  }

  void add_triangle(uint32_t t) {
    const uvec3& corners = mesh_.triangles[t];
    ++live_;
    const dvec3 cross = cross_of(corners);
    const double length = glm::length(cross);
    for (int i = 0; i < 3; ++i) {
      triangles_of_[corners[i]].push_back(t);
      if (!(length > 0.0)) continue;
      const dvec3 n = cross / length;
      quadrics_[corners[i]].add_plane(n, -glm::dot(n, dvec3(mesh_.positions[corners[i]])), length);
    }
  }

  size_t corner_of(uint32_t t, uint32_t vertex) const {
    const uvec3& c = mesh_.triangles[t];
    return 3 * size_t{t} + (c.x == vertex ? 0 : c.y == vertex ? 1 : 2);
  }

  bool same_attributes(size_t a, size_t b) const {
    if (!mesh_.corner_normals.empty() &&
        glm::dot(mesh_.corner_normals[a], mesh_.corner_normals[b]) < kSameNormal) {
      return false;
    }
    if (!mesh_.corner_uvs.empty() &&
        glm::distance(mesh_.corner_uvs[a], mesh_.corner_uvs[b]) > kSameUv) {
      return false;
    }
    return mesh_.triangle_slots.empty() ||
           mesh_.triangle_slots[a / 3] == mesh_.triangle_slots[b / 3];
  }

  /// The vertices around `v`, each with how many triangles it shares with `v`: 2 inside a closed
  /// fan, 1 on a border. Rings are short: a list is faster than any index.
  void find_ring(uint32_t v, Ring& ring) const {
    ring.clear();
    for (const uint32_t t : triangles_of_[v]) {
      for (int i = 0; i < 3; ++i) {
        const uint32_t other = mesh_.triangles[t][i];
        if (other == v) continue;
        const auto it = std::find_if(ring.begin(), ring.end(),
                                     [&](const auto& entry) { return entry.first == other; });
        if (it == ring.end()) {
          ring.emplace_back(other, 1);
        } else {
          ++it->second;
        }
      }
    }
  }

  static bool holds(const Ring& ring, uint32_t v) {
    return std::any_of(ring.begin(), ring.end(),
                       [&](const auto& entry) { return entry.first == v; });
  }

  /// Whether `v` lies inside one smooth patch: no border, hard edge or seam goes through it.
  bool is_free(uint32_t v, const Ring& around) const {
    for (const auto& [neighbour, count] : around) {
      if (count != 2) return false;
    }
    const size_t first = corner_of(triangles_of_[v][0], v);
    for (const uint32_t t : triangles_of_[v]) {
      if (!same_attributes(first, corner_of(t, v))) return false;
    }
    return true;
  }

  /// Queues the cheapest collapse of `v` that comes after `tried`, one that was not allowed.
  void push_collapse_of(uint32_t v, const Collapse* tried = nullptr) {
    if (triangles_of_[v].empty()) return;
    find_ring(v, ring_);
    if (!is_free(v, ring_)) return;
    std::optional<Collapse> best;
    for (const auto& [neighbour, count] : ring_) {
      Quadric sum = quadrics_[v];
      sum.add(quadrics_[neighbour]);
      const Collapse c{sum.at(dvec3(mesh_.positions[neighbour])), v, neighbour, versions_[v]};
      if (!std::isfinite(c.error) || (tried && !(c < *tried))) continue;
      if (!best || *best < c) best = c;
    }
    if (best) queue_.push(*best);
  }

  bool allowed(const Collapse& c) {
    find_ring(c.gone, ring_);
    if (!holds(ring_, c.kept) || !is_free(c.gone, ring_)) return false;
    find_ring(c.kept, other_ring_);
    int common = 0;
    for (const auto& [neighbour, count] : ring_) common += holds(other_ring_, neighbour);
    if (common != 2) return false;  // else the surface would pinch
    size_t kept_corner = SIZE_MAX;
    for (const uint32_t t : triangles_of_[c.gone]) {
      uvec3 moved = mesh_.triangles[t];
      if (moved.x == c.kept || moved.y == c.kept || moved.z == c.kept) {
        const size_t corner = corner_of(t, c.kept);
        if (kept_corner != SIZE_MAX && !same_attributes(kept_corner, corner)) return false;
        kept_corner = corner;
        continue;
      }
      const dvec3 before = cross_of(moved);
      for (int i = 0; i < 3; ++i) moved[i] = moved[i] == c.gone ? c.kept : moved[i];
      const dvec3 after = cross_of(moved);
      if (glm::dot(before, after) <= kSmallestTurn * glm::length(before) * glm::length(after)) {
        return false;
      }
    }
    return true;
  }

  void apply(const Collapse& c) {
    const std::vector<uint32_t> fan = std::move(triangles_of_[c.gone]);
    triangles_of_[c.gone].clear();
    size_t kept_corner = 0;
    for (const uint32_t t : fan) {
      const uvec3& v = mesh_.triangles[t];
      if (v.x != c.kept && v.y != c.kept && v.z != c.kept) continue;
      kept_corner = corner_of(t, c.kept);
      alive_[t] = false;
      --live_;
      for (int i = 0; i < 3; ++i) std::erase(triangles_of_[v[i]], t);
    }
    for (const uint32_t t : fan) {
      if (!alive_[t]) continue;
      const size_t corner = corner_of(t, c.gone);
      if (!mesh_.corner_normals.empty()) {
        mesh_.corner_normals[corner] = mesh_.corner_normals[kept_corner];
      }
      if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs[corner] = mesh_.corner_uvs[kept_corner];
      mesh_.triangles[t][static_cast<int>(corner % 3)] = c.kept;
      triangles_of_[c.kept].push_back(t);
    }
    quadrics_[c.kept].add(quadrics_[c.gone]);
    ++versions_[c.kept];
    push_collapse_of(c.kept);
    find_ring(c.kept, other_ring_);
    for (const auto& [neighbour, count] : other_ring_) {
      ++versions_[neighbour];
      push_collapse_of(neighbour);
    }
  }

  void compact() {
    size_t n = 0;
    for (size_t t = 0; t < alive_.size(); ++t) {
      if (!alive_[t]) continue;
      mesh_.triangles[n] = mesh_.triangles[t];
      for (int i = 0; i < 3; ++i) {
        if (!mesh_.corner_normals.empty()) {
          mesh_.corner_normals[3 * n + i] = mesh_.corner_normals[3 * t + i];
        }
        if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs[3 * n + i] = mesh_.corner_uvs[3 * t + i];
      }
      if (!mesh_.triangle_slots.empty()) mesh_.triangle_slots[n] = mesh_.triangle_slots[t];
      ++n;
    }
    mesh_.triangles.resize(n);
    if (!mesh_.corner_normals.empty()) mesh_.corner_normals.resize(3 * n);
    if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs.resize(3 * n);
    if (!mesh_.triangle_slots.empty()) mesh_.triangle_slots.resize(n);
    drop_unused_vertices();
  }

  void drop_unused_vertices() {
    std::vector<uint32_t> remap(mesh_.positions.size(), UINT32_MAX);
    std::vector<vec3> positions;
    for (uvec3& t : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) {
        uint32_t& index = remap[t[i]];
        if (index == UINT32_MAX) {
          index = static_cast<uint32_t>(positions.size());
          positions.push_back(mesh_.positions[t[i]]);
        }
        t[i] = index;
      }
    }
    mesh_.positions = std::move(positions);
  }

  MeshDescription& mesh_;
  std::vector<std::vector<uint32_t>> triangles_of_;  // by vertex
  std::vector<Quadric> quadrics_;
  std::vector<uint32_t> versions_;
  std::vector<bool> alive_;  // by triangle
  std::priority_queue<Collapse> queue_;
  size_t live_ = 0;
  Ring ring_, other_ring_;  // scratch
};

}  // namespace

void simplify(MeshDescription& mesh, size_t target) {
  if (mesh.triangles.size() <= target) return;
  Simplifier(mesh).run(target);
}

}  // namespace kestrel::cli

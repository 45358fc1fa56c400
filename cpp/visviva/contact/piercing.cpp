#include "visviva/contact/piercing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace visviva {

namespace {

constexpr double grazing = 0.025;   // of the least width: what is less deep beside a face lies on that
constexpr double most_parts = 400;  // of a step, at which bodies are looked at on their way

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;
using Bounds = Eigen::AlignedBox<double, 3>;

std::vector<int> of(const std::vector<std::pair<int, int>>& edges) {
    std::set<int> vertices;
    for (const auto& [a, b] : edges) vertices.insert({a, b});
    return {vertices.begin(), vertices.end()};
}

// Where vertices of both sides are in a step, and by how much they move.
void sweep(const std::vector<double>& X0, const std::vector<double>& X1,
           const std::array<std::vector<int>, 2>& of, Bounds (&swept)[2], Bounds (&ways)[2]) {
    for (int side : {0, 1})
        for (const int v : of[side]) {
            const Vector3 x0 = At(&X0[3 * v]), x1 = At(&X1[3 * v]);
            swept[side].extend(x0), swept[side].extend(x1), ways[side].extend(Vector3(x1 - x0));
        }
}

}  // namespace

Piercing::Piercing(Sides sides, double limit, double least, std::string cure)
    : of_(std::move(sides)),
      limit_(limit),
      least_(least),
      cure_(std::move(cure)),
      sides_{{of_.skin, 0, of_.skin.second_begin}, {of_.skin, of_.skin.second_begin, of_.skin.n_facets()}} {
    for (int side : {0, 1}) {
        if (!of_.encloses[side]) sides_[side].triangles.clear();
        vertices_[side] = of(sides_[side].edges);
        keep_touching(side);
    }
    if (!of_.thin && limit_ > grazing * least_) entrances_ = {sides_[0], sides_[1], grazing * least_};
}

// Edges of faces that may touch. At the border of these they are in what lies beside them, too, unless it is
// told by faces of that, too, whether they came in by them.
void Piercing::keep_touching(int side) {
    std::map<std::pair<int, int>, std::array<int, 2>>
        beside;  // facets of an edge, those that may touch or not
    std::array<int, 2> facets[2] = {};
    for (int f = 0; f < of_.skin.n_facets(); ++f) {
        const int of = f >= of_.skin.second_begin, touches = of_.faces[f] != 0, n = of_.skin.n_corners(f);
        const int* corner = of_.skin.corners(f);
        ++facets[of][touches];
        named_ = named_ || !touches;
        for (int i = 0; of == side && i < n; ++i)
            ++beside[std::minmax({corner[i], corner[(i + 1) % n]})][touches];
    }
    const bool by_part = facets[1 - side][0] > 0;
    auto& edges = sides_[side].edges;
    std::erase_if(edges, [&](const auto& edge) { return beside.at(edge)[1] == 0; });
    touching_[side] = of(edges);
    std::erase_if(edges, [&](const auto& edge) { return beside.at(edge)[0] > 0 && !by_part; });
}

std::vector<double> Piercing::positions(const double* q) const {
    std::vector<double> X;
    of_.skin.positions(q, X);
    if (of_.skin.dim == 2) Triangulated::stand_walls(X);
    return X;
}

Bodies Piercing::bodies(const std::vector<double>& X) const {
    return {Enclosure(X, sides_[0].triangles), Enclosure(X, sides_[1].triangles)};
}

// Of a place in the body of a side; 0 where the way out leads through faces that do not touch.
double Piercing::depth(const Enclosure& body, int side, const Vector3& x) const {
    const int k = body.nearest(x);
    return k >= 0 && touches(side, k) ? body.triangles()[k].distance(x) : 0;
}

// Whether the other body rests on a vertex of the first one about a place, whose edge or facet is a chord of
// what is round there: others may be about to leave it or to come to it.
bool Piercing::spans(int side, const Enclosure& body, const Enclosure& own, const Vector3& x,
                     const std::array<Vector3, 2>& edge, double depth) const {
    constexpr double chord = 0.1;  // of its length at most, which is a seventh of a circle
    std::vector<Vector3> ends(edge.begin(), edge.end());
    if (side == 1) {
        const Triangle& t = body.triangles()[body.nearest(x)];
        ends = {t.a, t.b, t.c};
    }
    const Enclosure& other = side == 1 ? own : body;
    if (other.triangles().empty()) return false;
    double length = 0;
    for (const Vector3& a : ends)
        for (const Vector3& b : ends) length = std::max(length, (a - b).norm());
    const double beyond = of_.thin ? least_ : 0;  // what touches with its other side
    auto touches = [&](const Vector3& a) { return other.touches(a, 0.25 * limit_ + beyond); };
    const double near = of_.thin ? chord * length : limit_;
    auto is_near = [&](const Vector3& a) { return other.touches(a, near); };
    if (std::none_of(ends.begin(), ends.end(), touches) || !std::all_of(ends.begin(), ends.end(), is_near))
        return false;
    return depth <= chord * length;
}

// Depth by which bodies may be in each other beside gaps that are as deep as `seen`, of which part they may
// be without. No body is deeper than half of its width: whatever passes through it comes deeper than this,
// unless gaps are nearly as deep.
double Piercing::beside(double seen, double without) const {
    constexpr double middle = 0.45;  // of the least width
    return std::max(2 * seen, std::min(without + 2 * seen, middle * least_));
}

Piercing::Finding Piercing::look(const double* q0, const double* q1, double seen) {
    constexpr double deep = 0.25;  // of the least width, by which what has met may come in within a step
    const std::vector<double> X0 = positions(q0), X1 = positions(q1);
    const double come = beside(seen, std::max(limit_, deep * least_));
    const TurnedWays ways(X0, X1, of_.skin.n_vertices(), vertices_, grazing * least_);
    Pass by;
    pass(ways, Middle::straight, by);
    if (ways.forks()) pass(ways, Middle::round, by);
    const double parts = parts_of(by, come);
    if (parts > most_parts) return {true, false, {}};
    const Bodies start = bodies(X0);
    entrances_.carry(seen);
    entrances_.settle(X0, start);
    if (!begun_) {
        each_part(X0, start, [this](const Part& part, double, const Vector3&) { given_.push_back(part); });
        begun_ = true;
    }
    Finding found;
    const int n = static_cast<int>(parts);
    const Allowed allowed{beside(seen, limit_), come};
    found.sinks = sinks(ways, Middle::straight, n, allowed, found.worst);
    if (ways.forks()) found.outruns = sinks(ways, Middle::round, n, allowed, found.worst) != found.sinks;
    return found;
}

// The end is looked at first, which ways to it may not be deeper than.
bool Piercing::sinks(const TurnedWays& ways, Middle middle, int parts, Allowed allowed,
                     DeepPlace& worst) const {
    std::optional<double> before;
    double after = 0;
    for (int part = parts; part > 0; --part) {
        worst = deepest(ways.at(static_cast<double>(part) / parts, middle));
        const double depth = worst.depth;
        if (part == parts) after = depth;
        if (depth <= allowed.in) continue;
        if (!before) before = deepest(ways.at(0, middle)).depth;
        const double most = *before > limit_ ? *before : allowed.come;
        if (depth > std::min(most, std::max(*before, after) + limit_)) return true;
    }
    return false;
}

void Piercing::pass(const TurnedWays& ways, Middle middle, Pass& pass) const {
    std::vector<double> X = ways.at(0, middle);
    for (int stage = 1; stage <= ways.stages(); ++stage) {
        const std::vector<double> from = std::exchange(X, ways.at(1.0 * stage / ways.stages(), middle));
        Bounds met[2], swept[2], gone[2];
        sweep(from, X, touching_, met, gone), sweep(from, X, vertices_, swept, gone);
        if (!swept[0].intersects(swept[1])) continue;
        pass.near = true, pass.touches = pass.touches || met[0].intersects(met[1]);
        pass.widths = std::max(pass.widths, ways.stages() * widths(from, X, swept, gone));
    }
}

double Piercing::widths(const std::vector<double>& X0, const std::vector<double>& X1,
                        const Bounds (&swept)[2], const Bounds (&ways)[2]) const {
    if (of_.thin) return std::max(across(X0, X1, 0, swept[1], ways[1]), across(X0, X1, 1, swept[0], ways[0]));
    const Vector3 way = (ways[0].max() - ways[1].min()).cwiseMax(ways[1].max() - ways[0].min());
    return way.norm() / least_;
}

// Looks on the way, so many that whatever passes through the least width of a body is deeper than `allowed`
// at one of them at least, below faces that may touch: these may be those of one side of its middle. None
// where they stay apart, or their faces that may touch do: flat ones have met in one step, and are behind
// each other then, until bodies are apart.
double Piercing::parts_of(const Pass& pass, double allowed) {
    constexpr double within = 0.8, least_apart = 0.1;  // of where it is deeper; of the least width
    met_ = pass.near && (met_ || pass.touches);
    if (!met_) return 0;
    const double sides = named_ ? 1 : 2;
    const double apart = within * sides * std::max(0.5 - allowed / least_, 0.5 * least_apart);
    return std::max(1.0, std::ceil(pass.widths / apart));
}

// The way of sheets, which may be slid along, across their triangles, by what is behind these.
double Piercing::across(const std::vector<double>& X0, const std::vector<double>& X1, int side,
                        const Bounds& swept, const Bounds& ways) const {
    double widths = 0;
    const auto& [edges, triangles, facets] = sides_[side];
    for (std::size_t k = 0; k < facets.size(); ++k) {
        Bounds own;
        Vector3 x[3], way = Vector3::Zero();
        for (int i : {0, 1, 2}) {
            const int v = 3 * triangles[3 * k + i];
            x[i] = At(&X0[v]), own.extend(x[i]), own.extend(At(&X1[v])), way += (At(&X1[v]) - x[i]) / 3;
        }
        if (!own.intersects(swept)) continue;
        const Vector3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
        const double most = std::abs(n.dot(ways.center() - way)) + 0.5 * n.cwiseAbs().dot(ways.sizes());
        widths = std::max(widths, most / std::max(of_.skin.behind[facets[k]], least_));
    }
    return widths;
}

DeepPlace Piercing::deepest(const std::vector<double>& X) const {
    const Bodies both = bodies(X);
    auto counts = [&](const Entrances::Place& p) {
        const Enclosure &body = both[1 - p.side], &own = both[p.side];
        return touches(1 - p.side, p.triangle) &&
               !(p.depth > limit_ && spans(p.side, body, own, p.x, p.ends, p.depth));
    };
    DeepPlace found = entrances_.deepest(X, both, counts);
    each_part(X, both, [&](const Part& part, double length, const Vector3& place) {
        const double more = part.depth - given(part, length);
        if (more > found.depth) found = {more, place};
    });
    return found;
}

// The ends and the middle of each part of an edge that the surface cuts off are looked at.
template <class F>
void Piercing::each_part(const std::vector<double>& X, const Bodies& bodies, F take) const {
    std::vector<double> cuts;
    for (int side : {0, 1}) {
        const Enclosure &body = bodies[1 - side], &own = bodies[side];
        if (body.triangles().empty()) continue;
        const auto& edges = sides_[side].edges;
        for (int k = 0; k < static_cast<int>(edges.size()); ++k) {
            const Vector3 p = At(&X[3 * edges[k].first]), way = At(&X[3 * edges[k].second]) - p;
            body.cut(p, way, cuts);
            for (std::size_t i = 1; i < cuts.size(); ++i) {
                Part part{side, k, cuts[i - 1], cuts[i], 0};
                Vector3 deepest = p;
                auto look = [&](double s) {
                    const Vector3 x = p + s * way;
                    const double d = depth(body, 1 - side, x);
                    if (d <= part.depth || (d > limit_ && spans(side, body, own, x, {p, p + way}, d))) return;
                    part.depth = d, deepest = x;
                };
                look(0.5 * (part.from + part.to));
                if (i == 1) look(0);
                if (i + 1 == cuts.size()) look(1);
                if (part.depth > 0) take(part, way.norm(), deepest);
            }
        }
    }
}

// What bodies were given where a part lies, such as at a hinge, is no sinking; elsewhere along the edge it
// is.
double Piercing::given(const Part& part, double length) const {
    double depth = 0;
    const double beside = length > 0 ? least_ / length : 0;
    for (const Part& g : given_)
        if (g.side == part.side && g.edge == part.edge && g.from - beside <= part.to &&
            part.from <= g.to + beside)
            depth = std::max(depth, g.depth);
    return depth;
}

void Piercing::write(std::vector<double>& memory) const {
    memory.push_back(begun_ ? static_cast<double>(given_.size()) : -1);
    memory.push_back(met_);
    entrances_.write(memory);
    for (const Part& g : given_)
        for (double value : {static_cast<double>(g.side), static_cast<double>(g.edge), g.from, g.to, g.depth})
            memory.push_back(value);
}

void Piercing::read(const double*& memory) {
    const double n = *memory++;
    begun_ = n >= 0, given_.clear();
    met_ = *memory++ != 0;
    entrances_.read(memory);
    for (double k = 0; k < n; ++k, memory += 5)
        given_.push_back(
            {static_cast<int>(memory[0]), static_cast<int>(memory[1]), memory[2], memory[3], memory[4]});
}

}  // namespace visviva

// Slips at mortar gaps, on which friction acts, and the masses of their vertices.
#include "visviva/contact/mortar.hpp"

namespace visviva::mortar {

void Mortar::find_weights(const double* X, const std::vector<char>& wanted, bool gradients) {
    find_near(X, &wanted);
    weights_.resize(near_.size());
    if (gradients) weight_gradients_.resize(near_.size());
    each_near(X, [&](const FacetPair& x, int, Segment& s) {
        const auto k = &s - segments_.data();
        if (gradients)
            segment_kernels().weight_gradients(x, weights_[k], weight_gradients_[k]);
        else
            segment_kernels().weights(x, weights_[k]);
        s.any = weights_[k].any;
    });
}

// Share of a vertex in the integrals of the gap, which fades out where stencils end.
void Mortar::masses(const double* X, const std::vector<char>& wanted, bool gradients,
                    std::vector<Grip>& out) {
    find_weights(X, wanted, gradients);
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        set_weights(A, gradients, out[A]);
        for (Eigen::Index v = 0; gradients && v < out[A].weight.size(); ++v)
            if (out[A].weight[v] < 0) out[A].weight_gradient.row(v) *= -1;
        out[A].weight = out[A].weight.cwiseAbs().eval();
    });
}

void Mortar::grips(const double* X, const std::vector<char>& wanted, bool gradients, std::vector<Grip>& out) {
    find_weights(X, wanted, gradients);
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        set_weights(A, gradients, out[A]);
        set_tangents(X, A, gradients, out[A]);
        out[A].turning.setZero(out[A].weight.size());
        out[A].turning.head(static_cast<Eigen::Index>(ring_size(A))).setOnes();
    });
}

// Integrals of N_A times the shapes of the second surface, minus those of the first.
void Mortar::set_weights(int A, bool gradients, Grip& out) const {
    const Eigen::Index k = stencils_[A].size();
    out.weight.setZero(k);
    if (gradients) out.weight_gradient.setZero(k, 3 * k);
    for (const Share& s : shares_[A]) {
        if (!segment(s.pair)) continue;
        const SegmentWeights& w = weights_[slot_[s.pair]];
        for (int c = 0; c < segment_corners; ++c) {
            if (s.local[c] < 0) continue;
            const int b = c % facet_corners;
            const double sign = c < facet_corners ? -1 : 1;
            out.weight[s.local[c]] += sign * (c < facet_corners ? w.first : w.second)[s.corner][b];
            if (!gradients) continue;
            const SegmentWeightGradients& g = weight_gradients_[slot_[s.pair]];
            const double* d = (c < facet_corners ? g.first : g.second)[s.corner][b];
            for (int e = 0; e < segment_corners; ++e)
                for (int i = 0; s.local[e] >= 0 && i < 3; ++i)
                    out.weight_gradient(s.local[c], 3 * s.local[e] + i) += sign * d[3 * e + i];
        }
    }
}

// The first direction is that of the first edge at the vertex, seen in the tangent plane.
void Mortar::set_tangents(const double* X, int A, bool gradients, Grip& out) const {
    const Eigen::Index k = stencils_[A].size();
    const Normal normal = this->normal(X, A);
    const Vector3& n = normal.n;
    Eigen::MatrixXd N;  // dn/dx
    if (gradients) {
        N.resize(3, 3 * k);
        const auto M = normal_gradient(X, A);
        for (Eigen::Index v = 0; v < k; ++v) N.middleCols<3>(3 * v) = normal.derivative() * M[v];
    }
    const int b = skin_.dim == 2 ? 0 : ring_[A][0];
    const Vector3 edge = At(X + 3 * stencils_[A][b]) - At(X + 3 * stencils_[A][0]);
    visviva::set_tangents(skin_.dim, n, gradients ? &N : nullptr, edge, 0, b, out);
}

}  // namespace visviva::mortar

// Arcs of a curve, held against the theorem of Newton and Kantorovich all along. What is bounded here and why
// stands in `bifurc.curves.kantorovich`, the theorem in `bifurc.curves.certificate`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bifurc/core/adjugates.hpp"
#include "bifurc/core/arrays.hpp"
#include "bifurc/core/chebyshev.hpp"

namespace bifurc {

namespace kantorovich {
constexpr double rounding = 2e-15;           // what F, over the magnitude, may be wrong by in doubles
constexpr double adjugate_rounding = 1e-14;  // of |H| |Q|: what rounding leaves of H Q - p I at the nodes
constexpr double tiny = 1e-150;              // in a denominator: its square is still a double
constexpr double infinity = std::numeric_limits<double>::infinity();
}  // namespace kantorovich

// What is known of F'', over the magnitude, as long as |F| is at most ``residual``: ``bound`` is K,
// ``growth`` is what F'' changes by along a unit of length, at most, up to half of ``reach`` from such a
// place; ``error`` is that of F'' itself, over K.
struct SecondDerivative {
    double bound, residual, growth, reach, error;
};

// An arc at its N nodes: `ArcNodes`, F in ``residuals`` (N, m), and F' times the steps at its ends in
// ``images`` (2, m); on ellipses about the arc (e) how far u is from its middle, and bounds on |F''|.
struct Arc {
    ArcNodes nodes;
    View<const double> residuals, images;
    Vector<const double> travel, curvature;
};

// The larger of two numbers; none where one of them is none.
inline double larger(double one, double other) { return one > other || one != one ? one : other; }

// A bound on the strong components of G and on the weakest, or the half-widths of a box of them.
struct Box {
    double strong, weak;
};

// Sizes of the columns of H^-1 that belong to the strong components of G and to the weakest one, and how
// far F''(H^-1 y, H^-1 z) may be, over |H^-1 y| |H^-1 z|, from what is known of it.
struct ColumnSizes {
    double strong, weak, error;

    // How far from the curve a box reaches.
    double reach(const Box& box) const { return strong * box.strong + weak * box.weak; }
};

// Norms of the blocks of a symmetric bilinear form: for its strong components and for the weakest one,
// with two strong arguments, with one, and with none.
struct Blocks {
    std::array<double, 3> strong, weak;

    // Norms larger by ``doubt`` times the sizes of both arguments.
    Blocks widened(double doubt, const ColumnSizes& sizes) const {
        const std::array<double, 3> products{sizes.strong * sizes.strong, sizes.strong * sizes.weak,
                                             sizes.weak * sizes.weak};
        Blocks out = *this;
        for (std::size_t i = 0; i < 3; ++i) {
            out.strong[i] += doubt * products[i];
            out.weak[i] += doubt * products[i];
        }
        return out;
    }

    // A box that is large enough for a contraction.
    Box box(const Box& gaps) const {
        const double half_width = 2.0 * gaps.weak;
        return {2.0 * gaps.strong + 8.0 * strong[2] * half_width * half_width, half_width};
    }

    // Half the Lipschitz constant of Newton's method in a box, which is the unit of length along each
    // component: comparable with omega |G|.
    double contraction(const Box& box) const {
        const double of_strong =
            strong[0] * box.strong + 2.0 * strong[1] * box.weak + strong[2] * box.weak * (box.weak / box.strong);
        const double of_weak =
            weak[0] * box.strong * (box.strong / box.weak) + 2.0 * weak[1] * box.strong + weak[2] * box.weak;
        return 0.5 * larger(of_strong, of_weak);
    }
};

// Bounds (e) on each ellipse on a polynomial of a ``degree`` with values (N, q) at the nodes, without its
// coefficients before number ``first``; returns the sum of their sizes.
inline double bound_polynomial(const Chebyshev& chebyshev, View<const double> values, Index degree, Index first,
                               Vector<double> bounds) {
    Matrix<double> series(degree + 1, values.columns);
    chebyshev.coefficients(values, series);
    std::vector<double> sizes(degree + 1);
    double sum = 0.0;
    for (Index k = first; k <= degree; ++k) {
        sizes[k] = length(series.row(k));
        sum += sizes[k];
    }
    chebyshev.on_ellipses(sizes, bounds);
    return sum;
}

// How far (e) u is, on ellipses about an arc, from where it is in the middle, from its ``points`` (N, n)
// at the nodes.
inline void bound_travel(const Chebyshev& chebyshev, View<const double> points, Index degree, Vector<double> travel) {
    const double from_mean_to_middle = bound_polynomial(chebyshev, points, degree, 1, travel);
    for (double& bound : travel) bound += from_mean_to_middle;
}

// Bounds on one arc after the other.
class ArcBounds {
public:
    ArcBounds(const Chebyshev& chebyshev, const SecondDerivative& second, Index unknowns, Index equations,
              Index degree)
        : chebyshev_(chebyshev),
          second_(second),
          n_(unknowns),
          m_(equations),
          degree_(degree),
          finder_(unknowns, chebyshev),
          determinants_(chebyshev.nodes()),
          series_(chebyshev.nodes()),
          frame_norms_(chebyshev.nodes()),
          at_edges_(chebyshev.edges()),
          adjugates_(chebyshev.nodes() * unknowns, unknowns),
          at_nodes_(3, chebyshev.nodes()),
          in_coefficients_(3, chebyshev.nodes()),
          on_ellipses_(3, chebyshev.ellipses()),
          frames_on_ellipses_(chebyshev.ellipses()),
          components_(chebyshev.nodes(), unknowns - 1),
          component_series_(chebyshev.nodes(), unknowns - 1) {}

    // Looks at an arc, which is to stay where it is as long as it is asked for.
    void look_at(const Arc& arc) {
        arc_ = &arc;
        finder_.of(arc.nodes, {determinants_, adjugates_, frame_norms_, norms_in(at_nodes_), norms_in(in_coefficients_)});
        bound_frames();
        bound_inverse();
        multiply(arc.residuals, components_);
        chebyshev_.coefficients(components_, component_series_);
    }

    // Whether H is much nearer to singular at one place than at another.
    bool is_uneven() const {
        const auto [least, largest] = std::minmax_element(at_edges_.begin(), at_edges_.end(), [](double p, double q) {
            return std::abs(p) < std::abs(q);
        });
        return std::abs(*least) - slack_ < 0.5 * (std::abs(*largest) - slack_);
    }

    // A bound on |G| all along, and on the steps at the ends.
    double gap() const { return gap_of(0, n_ - 1).between; }

    // Fills bounds on |H^-1| (c) in the cells, infinite where H may be singular.
    void bound_sizes(Vector<double> in_cells) const {
        fill_cells([&](Index edge) { return inverse_size(edge); }, in_cells);
    }

    // Fills bounds (c) on omega |G| in the cells by omega = K |H^-1|^2, where F stays small enough for K;
    // returns the least value at a node.
    double bound_doubts(Vector<double> in_cells) const {
        const Gap gap = gap_of(0, n_ - 1);
        fill_cells([&](Index edge) { return doubt_by_bound(inverse_size(edge), gap.between); }, in_cells);
        double least = kantorovich::infinity;
        for (Index k = 0; k < chebyshev_.nodes(); ++k) {
            const double size = at_nodes_(all, k) / std::abs(determinants_[k]);
            least = std::min(least, second_.bound * size * size * gap.at_nodes);
        }
        return least;
    }

    // The same by F'' itself, ``hessians`` (N * m * n, n) at the nodes: how far Newton's method is from a
    // contraction of a box, narrow along the strong components of G and wide along the weakest one. Near a
    // surface F'' is small where H^-1 is large.
    double bound_doubts(View<const double> hessians, Vector<double> in_cells) const {
        const Index last = std::max<Index>(n_ - 2, 0);
        const Gap strong_gap = gap_of(0, last), weak_gap = gap_of(last, n_ - 1);
        const BlockNorms norms = block_norms(hessians);
        const Blocks between = largest_blocks(norms);
        const double interpolation = error_of_forms();
        fill_cells(
            [&](Index edge) {
                const double low = lowest(edge);
                return contraction(scaled(between, low * low), {strong_gap.between, weak_gap.between},
                                   sizes_beside(low, interpolation));
            },
            in_cells);
        double least = kantorovich::infinity;
        for (Index k = 0; k < chebyshev_.nodes(); ++k) {
            const double square = std::max(determinants_[k] * determinants_[k], kantorovich::tiny);
            const double doubt = contraction(scaled(norms.at_node(k), square), {strong_gap.at_nodes, weak_gap.at_nodes},
                                             sizes_at(k));
            least = std::min(least, doubt);
        }
        return least;
    }

private:
    enum Columns { all, strong, weak };  // of Q: those that belong to some components of G

    // Bounds on some components of G, all along and at the nodes.
    struct Gap {
        double between, at_nodes;
    };

    // Norms (6, N) of the blocks of forms, those of the strong components first: at the nodes, and in the
    // coefficients of the polynomials through them.
    struct BlockNorms {
        Matrix<double> at_nodes, in_coefficients;

        Blocks at_node(Index k) const {
            const auto entry = [&](Index block) { return at_nodes(block, k); };
            return {{entry(0), entry(1), entry(2)}, {entry(3), entry(4), entry(5)}};
        }
    };

    static ColumnNorms norms_in(Matrix<double>& rows) { return {rows.row(all), rows.row(strong), rows.row(weak)}; }

    static double largest_row(View<const double> rows) {
        double square = 0.0;
        for (Index k = 0; k < rows.rows; ++k) square = larger(square, squared_length(rows.row(k)));
        return std::sqrt(square);
    }

    // Rows (k, m) times the combinations of the equations: (k, n - 1).
    void multiply(View<const double> rows, View<double> out) const {
        for (Index k = 0; k < rows.rows; ++k) {
            std::fill(out.row(k).begin(), out.row(k).end(), 0.0);
            for (Index row = 0; row < m_; ++row) {
                for (Index i = 0; i + 1 < n_; ++i) out(k, i) += rows(k, row) * arc_->nodes.left(row, i);
            }
        }
    }

    // --- H and its inverse ---

    // Sizes on the ellipses: of F and of H; the largest ones at the nodes.
    void bound_frames() {
        const Index middle = chebyshev_.nodes() / 2;
        const View<const double> jacobians = arc_->nodes.jacobians;
        const auto size = static_cast<std::size_t>(m_ * n_);
        const double in_the_middle = length({jacobians.row(middle * m_).data(), size});
        std::vector<double> slopes(chebyshev_.ellipses()), residuals(chebyshev_.ellipses());
        bound_polynomial(chebyshev_, arc_->nodes.slopes, degree_, 0, slopes);
        largest_residual_ = largest_row(arc_->residuals);
        largest_jacobian_ = 0.0;
        for (Index k = 0; k < chebyshev_.nodes(); ++k) {
            largest_jacobian_ = larger(largest_jacobian_, length({jacobians.row(k * m_).data(), size}));
        }
        for (std::size_t e = 0; e < slopes.size(); ++e) {
            const double jacobian = in_the_middle + arc_->curvature[e] * arc_->travel[e];
            residuals[e] = largest_residual_ + jacobian * arc_->travel[e];
            frames_on_ellipses_[e] = std::hypot(jacobian, slopes[e]);
        }
        residual_error_ = chebyshev_.error(residuals);
        // Rivlin 1990: what interpolation at n Chebyshev nodes makes of a number, at most
        const double lebesgue = 1.0 + 2.0 / std::numbers::pi * std::log(static_cast<double>(chebyshev_.nodes()));
        residual_between_ = lebesgue * largest_residual_ + residual_error_;
    }

    // Whether F is so small up to ``radius`` from the curve that what is known of F'' holds there.
    bool is_nearly_solved(double radius) const {
        const double slope = largest_jacobian_ + second_.bound * radius;
        return residual_between_ + slope * radius <= second_.residual;
    }

    void bound_inverse() {
        chebyshev_.coefficients({determinants_.data(), chebyshev_.nodes(), 1}, {series_.data(), chebyshev_.nodes(), 1});
        chebyshev_.on_edges(series_, at_edges_);
        double largest_determinant = 0.0, largest_frame = 0.0, largest_product = 0.0;
        for (Index k = 0; k < chebyshev_.nodes(); ++k) {
            largest_determinant = larger(largest_determinant, std::abs(determinants_[k]));
            largest_frame = larger(largest_frame, frame_norms_[k]);
            largest_product = larger(largest_product, frame_norms_[k] * at_nodes_(all, k));
        }
        for (Index group : {all, strong, weak}) {
            chebyshev_.on_ellipses(in_coefficients_.row(group), on_ellipses_.row(group));
            largest_[group] = chebyshev_.largest(at_nodes_.row(group), in_coefficients_.row(group));
        }
        // where there are no strong components
        const double least = largest_determinant / largest_frame;
        largest_[strong] = larger(largest_[strong], least);
        largest_[weak] = larger(largest_[weak], least);
        rounding_ = kantorovich::adjugate_rounding * largest_product;
        interpolation_ = error_of_product(all);
        interpolation_of_strong_ = error_of_product(strong);
        slack_ = chebyshev_.slack(series_) + interpolation_ + rounding_;
    }

    // A bound on H Q - p I between the nodes, for some columns of Q.
    double error_of_product(Columns group) const {
        std::vector<double> sizes(series_.size()), bounds(chebyshev_.ellipses());
        for (std::size_t k = 0; k < sizes.size(); ++k) sizes[k] = std::abs(series_[k]);
        chebyshev_.on_ellipses(sizes, bounds);
        const double of_identity = std::sqrt(static_cast<double>(n_));
        for (std::size_t e = 0; e < bounds.size(); ++e) {
            const double of_columns = on_ellipses_(group, static_cast<Index>(e));
            bounds[e] = frames_on_ellipses_[e] * of_columns + of_identity * bounds[e];
        }
        return chebyshev_.error(bounds);
    }

    // What |p| is at least in the cells beside an edge.
    double lowest(Index edge) const { return std::max(std::abs(at_edges_[edge]) - slack_, kantorovich::tiny); }

    // A bound on |H^-1| there.
    double inverse_size(Index edge) const { return largest_[all] / lowest(edge); }

    // Whether H is regular in a cell.
    bool is_regular(Index cell) const {
        const double before = at_edges_[cell], after = at_edges_[cell + 1];
        const bool keeps_sign = (before > 0.0) == (after > 0.0);
        return keeps_sign && std::abs(before) > slack_ && std::abs(after) > slack_;
    }

    // The larger one of what holds beside the two edges of each cell, infinite where H may be singular or
    // there is no number.
    template <class BesideEdge>
    void fill_cells(BesideEdge beside, Vector<double> in_cells) const {
        double before = beside(0);
        for (std::size_t cell = 0; cell < in_cells.size(); ++cell) {
            const double after = beside(static_cast<Index>(cell) + 1);
            const double largest = larger(before, after);
            const bool is_bound = is_regular(static_cast<Index>(cell)) && largest < kantorovich::infinity;
            in_cells[cell] = is_bound ? largest : kantorovich::infinity;
            before = after;
        }
    }

    // --- G ---

    // Of components ``first`` to ``last`` - 1.
    Gap gap_of(Index first, Index last) const {
        const auto length_of = [&](View<const double> rows, Index k) {
            return length(rows.row(k).subspan(first, last - first));
        };
        std::vector<double> at_nodes(chebyshev_.nodes()), in_coefficients(chebyshev_.nodes());
        for (Index k = 0; k < chebyshev_.nodes(); ++k) {
            at_nodes[k] = length_of(components_, k);
            in_coefficients[k] = length_of(component_series_, k);
        }
        Matrix<double> steps(2, n_ - 1);
        multiply(arc_->images, steps);
        const double along = chebyshev_.largest(at_nodes, in_coefficients);
        const double step = larger(length_of(steps, 0), length_of(steps, 1));
        const double largest = *std::max_element(at_nodes.begin(), at_nodes.end());
        return {along + residual_error_ + step + kantorovich::rounding, largest + kantorovich::rounding};
    }

    double doubt_by_bound(double size, double gap) const {
        const double radius = 2.0 * size * gap;
        return is_nearly_solved(radius) ? second_.bound * size * size * gap : kantorovich::infinity;
    }

    // --- F'' ---

    // Half the Lipschitz constant of Newton's method in a box about the curve, in which F'' is what the
    // ``blocks`` say to within the error of ``sizes``, and what it changes by off the curve.
    double contraction(const Blocks& blocks, const Box& gaps, const ColumnSizes& sizes) const {
        const double radius = 2.0 * sizes.reach(blocks.box(gaps));
        if (!(radius < 0.5 * second_.reach) || !is_nearly_solved(0.0)) return kantorovich::infinity;
        const Blocks widened = blocks.widened(second_.growth * radius + sizes.error, sizes);
        const Box box = widened.box(gaps);
        return sizes.reach(box) <= radius ? widened.contraction(box) : kantorovich::infinity;
    }

    static Blocks scaled(Blocks blocks, double divisor) {
        for (double& norm : blocks.strong) norm /= divisor;
        for (double& norm : blocks.weak) norm /= divisor;
        return blocks;
    }

    // Where |p| is at least ``low``.
    ColumnSizes sizes_beside(double low, double interpolation) const {
        const double strong_size = largest_[strong] / low, weak_size = largest_[weak] / low;
        const double share = std::max(interpolation_ / weak_size, interpolation_of_strong_ / strong_size);
        // how far a column of Q / p may be from that of H^-1, over its size
        const double of_inverse = (largest_[all] / low * share + rounding_) / low;
        return {strong_size, weak_size, interpolation + second_.bound * (2.0 * of_inverse + second_.error)};
    }

    ColumnSizes sizes_at(Index node) const {
        const double determinant = std::abs(determinants_[node]);
        const double error = second_.bound * (2.0 * rounding_ / determinant + second_.error);
        return {at_nodes_(strong, node) / determinant, at_nodes_(weak, node) / determinant, error};
    }

    // What F''(H^-1 y, H^-1 z) may be off between the nodes, over |H^-1 y| |H^-1 z|.
    double error_of_forms() const {
        std::vector<double> bounds(chebyshev_.ellipses());
        for (std::size_t e = 0; e < bounds.size(); ++e) {
            const Index ellipse = static_cast<Index>(e);
            const double growth = larger(on_ellipses_(strong, ellipse) / largest_[strong],
                                         on_ellipses_(weak, ellipse) / largest_[weak]);
            bounds[e] = arc_->curvature[e] * growth * growth;
        }
        return chebyshev_.error(bounds);
    }

    // Of L^T F''(Q y, Q z) at the nodes.
    BlockNorms block_norms(View<const double> hessians) const {
        const Index nodes = chebyshev_.nodes(), q = n_ - 1;
        Matrix<double> forms(nodes, q * q * q), series(nodes, q * q * q);
        for (Index k = 0; k < nodes; ++k) {
            fill_form({hessians.data + k * m_ * n_ * n_, m_ * n_, n_}, k, forms.row(k));
        }
        chebyshev_.coefficients(forms, series);
        BlockNorms norms{Matrix<double>(6, nodes), Matrix<double>(6, nodes)};
        for (Index k = 0; k < nodes; ++k) {
            take_block_norms(forms.row(k), norms.at_nodes, k);
            take_block_norms(series.row(k), norms.in_coefficients, k);
        }
        return norms;
    }

    // L^T F''(Q y, Q z) (q * q * q), q = n - 1, at node ``k``.
    void fill_form(View<const double> hessian, Index k, Vector<double> form) const {
        const Index q = n_ - 1;
        const auto across = [&](Index row, Index j) { return adjugates_(k * n_ + row, j); };
        Matrix<double> combined(n_, n_), halfway(n_, q);
        for (Index i = 0; i < q; ++i) {
            std::fill_n(combined.view().data, n_ * n_, 0.0);
            for (Index row = 0; row < m_; ++row) {
                const double share = arc_->nodes.left(row, i);
                const double* const entries = hessian.row(row * n_).data();
                for (Index entry = 0; entry < n_ * n_; ++entry) combined.view().data[entry] += share * entries[entry];
            }
            for (Index row = 0; row < n_; ++row) {
                for (Index j = 0; j < q; ++j) {
                    double total = 0.0;
                    for (Index column = 0; column < n_; ++column) total += combined(row, column) * across(column, j);
                    halfway(row, j) = total;
                }
            }
            for (Index j = 0; j < q; ++j) {
                for (Index l = 0; l < q; ++l) {
                    double total = 0.0;
                    for (Index row = 0; row < n_; ++row) total += across(row, j) * halfway(row, l);
                    form[(i * q + j) * q + l] = total;
                }
            }
        }
    }

    // Of a form with entries (q * q * q), into column ``k``.
    void take_block_norms(Vector<const double> form, Matrix<double>& norms, Index k) const {
        const Index q = n_ - 1, last = q - 1;
        std::array<double, 6> squares{};
        for (Index i = 0; i < q; ++i) {
            for (Index j = 0; j < q; ++j) {
                for (Index l = 0; l < q; ++l) {
                    if (j == last && l < last) continue;  // the form is symmetric
                    const double entry = form[(i * q + j) * q + l];
                    squares[(i == last ? 3 : 0) + (j == last) + (l == last)] += entry * entry;
                }
            }
        }
        for (Index block = 0; block < 6; ++block) norms(block, k) = std::sqrt(squares[block]);
    }

    Blocks largest_blocks(const BlockNorms& norms) const {
        const auto largest = [&](Index block) {
            return chebyshev_.largest(norms.at_nodes.row(block), norms.in_coefficients.row(block));
        };
        return {{largest(0), largest(1), largest(2)}, {largest(3), largest(4), largest(5)}};
    }

    const Chebyshev& chebyshev_;
    const SecondDerivative second_;
    const Index n_, m_, degree_;
    Adjugates finder_;
    const Arc* arc_ = nullptr;
    std::vector<double> determinants_, series_, frame_norms_, at_edges_;
    Matrix<double> adjugates_, at_nodes_, in_coefficients_, on_ellipses_;
    std::vector<double> frames_on_ellipses_;
    Matrix<double> components_, component_series_;
    std::array<double, 3> largest_{};  // bounds on columns of Q all along the arc
    double largest_residual_ = 0.0, largest_jacobian_ = 0.0;
    double residual_error_ = 0.0, residual_between_ = 0.0;  // of interpolation; |F| between the nodes
    double rounding_ = 0.0, interpolation_ = 0.0, interpolation_of_strong_ = 0.0;  // of H Q - p I
    double slack_ = 0.0;  // by which |p| may be less than at the edges of a cell
};

}  // namespace bifurc

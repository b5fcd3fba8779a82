// All configurations of a closed chain of three to five revolute joints, real or complex, as
// candidates: the elimination that `linkages.slices.elimination` describes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/eigenvalues.hpp"
#include "linkages/core/dual_quaternions.hpp"

namespace linkages {

using bifurc::SmallMatrix;
using bifurc::squared_size;

namespace elimination {

// exp(i theta) below this, or above its inverse: a complex solution at infinity
constexpr double infinite = 1e-4;
constexpr double regular = 1e-10;            // below this an elimination is singular
constexpr double one_line = 1e-12;           // norm of a part of a link: the two axes are one line
constexpr double nearly_null = 1e-3;         // what is left of a matrix whose null space may be larger
constexpr double null = 1e-6;                // what is left of one whose null space is larger
constexpr double in_quadric = 1e-6;          // defect of the moduli: the point satisfies them
constexpr double nearly_real = 1e-3;         // of the modulus of exp(i theta)
constexpr double no_pivot = 1e-14;           // of a matrix that has no inverse
constexpr double zero_square = 1e-300;       // of an entry that counts as 0
constexpr int samples = 8;                   // of a continuum
constexpr std::size_t most_candidates = 64;  // twelve, more only where a continuum is sampled
constexpr std::array origins = {0.3, 0.3 + std::numbers::pi / 3, 0.3 + 2 * std::numbers::pi / 3};

}  // namespace elimination

template <std::size_t n>
using Coordinates = std::array<Complex, n>;

// s p + t q
template <std::size_t n>
std::array<Complex, n> combine(const Complex& s, const std::array<Complex, n>& p, const Complex& t,
                               const std::array<Complex, n>& q) {
    std::array<Complex, n> out;
    for (std::size_t i = 0; i < n; ++i) out[i] = s * p[i] + t * q[i];
    return out;
}

// --- the space of a 2R chain ----------------------------------------------------------

// What Z_a G Z_b reaches, for the fixed link G between two joints: orthonormal rows of
// span(G', k G', G'', k G''), of its complement, and the norms of G' and G''. A norm of zero
// (then with zero rows) means that the two axes are one line.
struct PairSpace {
    std::array<DualQuaternion<double>, 4> rows{};
    std::array<DualQuaternion<double>, 4> complement{};
    std::array<double, 2> norms{};

    explicit PairSpace(const DualQuaternion<double>& link) {
        fill(link, 0, 0, 3);  // w + z k commutes with k
        fill(link, 1, 1, 2);  // (x + y k) i anticommutes
    }

    // Bilinear form of |x|^2 - |y|^2 for coordinates p = q in the rows.
    Complex modulus_defect(const Coordinates<4>& p, const Coordinates<4>& q) const {
        const double total = norms[0] * norms[0] + norms[1] * norms[1];
        const double first = norms[1] * norms[1] / total, second = norms[0] * norms[0] / total;
        return first * (p[0] * q[0] + p[1] * q[1]) - second * (p[2] * q[2] + p[3] * q[3]);
    }

    // exp(i theta_a), exp(i theta_b) of Z_a G Z_b with coordinates p; zeros where
    // tan(theta / 2) = +-i.
    std::array<Complex, 2> turns(const Coordinates<4>& p) const {
        const Complex x_plus = norms[1] * Complex(p[0].real() - p[1].imag(), p[0].imag() + p[1].real());
        const Complex x_minus = norms[1] * Complex(p[0].real() + p[1].imag(), p[0].imag() - p[1].real());
        const Complex y_plus = norms[0] * Complex(p[2].real() - p[3].imag(), p[2].imag() + p[3].real());
        const Complex y_minus = norms[0] * Complex(p[2].real() + p[3].imag(), p[2].imag() - p[3].real());
        const std::array squares = {std::norm(x_plus), std::norm(x_minus), std::norm(y_plus),
                                    std::norm(y_minus)};
        const double total = squares[0] + squares[1] + squares[2] + squares[3];
        const double least = *std::min_element(squares.begin(), squares.end());
        if (least <= elimination::infinite * elimination::infinite * total) return {};
        return {y_plus / x_minus, y_minus / x_minus};
    }

private:
    void fill(const DualQuaternion<double>& link, int part, int i, int j) {
        double g0 = link[i], g1 = link[j], h0 = link[i + 4], h1 = link[j + 4];
        const double norm = std::sqrt(g0 * g0 + g1 * g1 + h0 * h0 + h1 * h1);
        norms[part] = norm;
        if (norm < elimination::one_line) return;
        g0 /= norm, g1 /= norm, h0 /= norm, h1 /= norm;
        const auto set = [i, j](DualQuaternion<double>& row, double gi, double gj, double hi, double hj) {
            row[i] = gi, row[j] = gj, row[i + 4] = hi, row[j + 4] = hj;
        };
        set(rows[2 * part], g0, g1, h0, h1);
        set(rows[2 * part + 1], -g1, g0, -h1, h0);
        set(complement[2 * part], -h0, h1, g0, -g1);
        set(complement[2 * part + 1], -h1, -h0, g1, g0);
    }
};

// What the joints on the right reach: the span of q rows.
template <class T, std::size_t q>
using Rows = std::array<DualQuaternion<T>, q>;

// s P + t Q of two real matrices or sets of rows.
template <std::size_t q>
Rows<Complex, q> mix(const Complex& s, const Rows<double, q>& p, const Complex& t,
                     const Rows<double, q>& other) {
    Rows<Complex, q> out;
    for (Index j = 0; j < q; ++j) {
        for (int k = 0; k < 8; ++k) out[j][k] = s * p[j][k] + t * other[j][k];
    }
    return out;
}

template <std::size_t q>
Rows<Complex, q> as_complex(const Rows<double, q>& rows) {
    Rows<Complex, q> out;
    for (Index j = 0; j < q; ++j) std::copy(rows[j].begin(), rows[j].end(), out[j].begin());
    return out;
}

// The components (4, q) of the rows along those of ``onto``.
template <class T, std::size_t q>
SmallMatrix<T, 4, q> projections(const Rows<double, 4>& onto, const Rows<T, q>& rows) {
    SmallMatrix<T, 4, q> out;
    for (Index i = 0; i < 4; ++i) {
        for (Index j = 0; j < q; ++j) {
            T total{};
            for (int k = 0; k < 8; ++k) total += onto[i][k] * rows[j][k];
            out(i, j) = total;
        }
    }
    return out;
}

// --- null spaces ----------------------------------------------------------------------

// Gauss-Jordan elimination of a matrix (4, q) with complete pivoting, one step after the other.
template <Index q>
class Reduction {
public:
    explicit Reduction(const SmallMatrix<Complex, 4, q>& matrix) : reduced_(matrix) {
        for (Index j = 0; j < q; ++j) order_[j] = j;
        find_pivot();
    }

    // The largest entry that is left.
    double rest() const { return std::sqrt(largest_); }

    Reduction step() const {
        Reduction next = *this;
        next.eliminate();
        return next;
    }

    // An orthonormal basis of the null space that the matrix has but for the rest.
    template <Index dimension>
    std::array<Coordinates<q>, dimension> null_vectors() const {
        constexpr Index rank = q - dimension;
        std::array<Coordinates<q>, dimension> out{};
        for (Index d = 0; d < dimension; ++d) {
            out[d][order_[rank + d]] = 1.0;
            for (Index k = 0; k < rank; ++k) {
                if (reduced_(k, k) != 0.0) out[d][order_[k]] = -reduced_(k, rank + d) / reduced_(k, k);
            }
            for (Index e = 0; e < d; ++e) {
                Complex inner = 0.0;
                for (Index j = 0; j < q; ++j) inner += std::conj(out[e][j]) * out[d][j];
                for (Index j = 0; j < q; ++j) out[d][j] -= inner * out[e][j];
            }
            const double size = std::sqrt(squared_size(out[d]));
            for (Complex& entry : out[d]) entry /= size;
        }
        return out;
    }

private:
    void find_pivot() {
        largest_ = 0.0;
        for (Index i = steps_; i < 4; ++i) {
            for (Index j = steps_; j < q; ++j) {
                const double square = std::norm(reduced_(i, j));
                if (square > largest_) {
                    largest_ = square;
                    row_ = i;
                    column_ = j;
                }
            }
        }
    }

    void eliminate() {
        const Index k = steps_;
        if (largest_ < elimination::zero_square) return;
        std::swap(order_[k], order_[column_]);
        for (Index i = 0; i < 4; ++i) std::swap(reduced_(i, k), reduced_(i, column_));
        for (Index j = 0; j < q; ++j) std::swap(reduced_(k, j), reduced_(row_, j));
        const Complex inverse = 1.0 / reduced_(k, k);
        for (Index i = 0; i < 4; ++i) {
            if (i == k) continue;
            const Complex factor = reduced_(i, k) * inverse;
            for (Index j = k; j < q; ++j) reduced_(i, j) -= factor * reduced_(k, j);
        }
        ++steps_;
        find_pivot();
    }

    SmallMatrix<Complex, 4, q> reduced_;
    std::array<Index, q> order_;
    Index steps_ = 0;
    double largest_ = 0.0;  // square of the largest entry left, which is there
    Index row_ = 0;
    Index column_ = 0;
};

// --- candidates: null vectors that satisfy the moduli ---------------------------------

// exp(i theta) of every joint, 0 at infinity, and by how much the moduli differ.
struct Candidate {
    std::array<Complex, 5> turns;
    double defect;
};

struct Candidates {
    std::vector<Candidate> list;
    Index sampled = 0;        // how many of them sample a continuum
    bool is_crowded = false;  // a null space has dimensions that are not resolved
};

// Candidates of a chain whose right side, two joints or one, reaches q = 4 or 2 rows.
template <Index q>
class CandidateSearch {
public:
    // ``right`` is not used for a single joint on the right.
    CandidateSearch(const PairSpace& left, const PairSpace& right, const Rows<Complex, q>& rows,
                    std::vector<Candidate>& list)
        : left_(left), right_(right), to_left_(projections(left.rows, rows)), list_(list) {}

    // How many candidates of a null space sample a continuum, and whether it has dimensions that
    // are not resolved.
    struct Outcome {
        Index sampled = 0;
        bool is_crowded = false;
    };

    // Appends the candidates in the null space of a matrix (4, q). One of dimension two is a line
    // that meets the two quadrics |x| = |y| in at most two points, unless it lies in both: a
    // continuum. In one of dimension three (a Bennett loop within the linkage) the quadrics may
    // share a conic, a continuum too.
    Outcome search(const SmallMatrix<Complex, 4, q>& matrix) {
        const Reduction<q> start(matrix);
        const Reduction<q> of_plane = q == 4 ? start.step() : start;
        const Reduction<q> of_line = q == 4 ? of_plane.step() : start;
        const Reduction<q> of_point = of_line.step();
        record(of_point.template null_vectors<1>()[0]);
        if (of_line.rest() > elimination::nearly_null) return {};
        const auto line = of_line.template null_vectors<2>();
        const double form = record_line(line[0], line[1]);
        if (of_line.rest() > elimination::null) return {};
        if constexpr (q == 4) {
            if (of_plane.rest() < elimination::null) return search_plane(of_plane);
        }
        if (form > elimination::in_quadric) return {};
        for (int i = 0; i < elimination::samples; ++i) record(between(line[0], line[1], i));
        return {elimination::samples, false};
    }

private:
    Outcome search_plane(const Reduction<q>& part) {
        const auto plane = part.template null_vectors<3>();
        const std::size_t before = list_.size();
        for (int i = 0; i < elimination::samples; ++i) record_line(between(plane[0], plane[1], i), plane[2]);
        bool is_shared = list_.size() > before;
        for (std::size_t i = before; i < list_.size(); ++i) {
            is_shared = is_shared && list_[i].defect < elimination::in_quadric;
        }
        return is_shared ? Outcome{static_cast<Index>(list_.size() - before), false} : Outcome{0, true};
    }

    static Coordinates<q> between(const Coordinates<q>& p, const Coordinates<q>& other, int number) {
        const double angle = 0.2 + number * std::numbers::pi / elimination::samples;
        return combine(Complex(std::cos(angle)), p, Complex(std::sin(angle)), other);
    }

    Coordinates<4> to_left(const Coordinates<q>& y) const {
        Coordinates<4> x{};
        for (Index i = 0; i < 4; ++i) {
            for (Index j = 0; j < q; ++j) x[i] += to_left_(i, j) * y[j];
        }
        return x;
    }

    static double relative_defect(const PairSpace& pair, const Coordinates<4>& p) {
        return std::abs(pair.modulus_defect(p, p)) / (squared_size(p) + elimination::zero_square);
    }

    // Appends the joints (a, b, c, d) of the null vector y.
    void record(const Coordinates<q>& y) {
        if (list_.size() >= elimination::most_candidates) return;
        const Coordinates<4> x = to_left(y);
        Candidate candidate{{}, relative_defect(left_, x)};
        auto& turns = candidate.turns;
        const auto of_left = left_.turns(x);
        turns[0] = of_left[0], turns[1] = of_left[1];
        if constexpr (q == 2) {  // y is (cos, sin) of half the angle of the joint on the right
            constexpr double least = elimination::infinite * elimination::infinite;
            const Complex plus = y[0] + Complex(0.0, 1.0) * y[1], minus = y[0] - Complex(0.0, 1.0) * y[1];
            if (std::min(std::norm(plus), std::norm(minus)) > least) turns[2] = plus / minus;
        } else {
            candidate.defect = std::max(candidate.defect, relative_defect(right_, y));
            const auto [minus_d, minus_c] = right_.turns(y);
            if (minus_c != 0.0) turns[2] = 1.0 / minus_c;
            if (minus_d != 0.0) turns[3] = 1.0 / minus_d;
        }
        list_.push_back(candidate);
    }

    // Coefficients of the modulus defect of s p + t q in s s, s t, t t.
    static std::array<Complex, 3> line_form(const PairSpace& pair, const Coordinates<4>& p,
                                            const Coordinates<4>& q_) {
        return {pair.modulus_defect(p, p), 2.0 * pair.modulus_defect(p, q_), pair.modulus_defect(q_, q_)};
    }

    // Appends the points of the line through p and q on the quadrics |x| = |y|; the largest
    // coefficient of the quadrics: both contain the line when it vanishes.
    double record_line(const Coordinates<q>& p, const Coordinates<q>& other) {
        std::array<Complex, 3> form = line_form(left_, to_left(p), to_left(other));
        if constexpr (q == 4) {
            const auto of_right = line_form(right_, p, other);
            if (squared_size(of_right) > squared_size(form)) form = of_right;
        }
        const auto& [a, b, c] = form;
        const Complex root = std::sqrt(b * b - 4.0 * a * c);
        const Complex lead = std::norm(b + root) > std::norm(b - root) ? b + root : b - root;
        record_point(-lead, p, 2.0 * a, other);
        record_point(2.0 * c, p, -lead, other);
        return std::sqrt(squared_size(form));
    }

    void record_point(const Complex& s, const Coordinates<q>& p, const Complex& t,
                      const Coordinates<q>& other) {
        const double size = std::sqrt(std::norm(s) + std::norm(t));
        if (size > elimination::one_line) record(combine(s / size, p, t / size, other));
    }

    const PairSpace& left_;
    const PairSpace& right_;
    SmallMatrix<Complex, 4, q> to_left_;  // coordinates on the left side from those on the right
    std::vector<Candidate>& list_;
};

// --- the three lengths of chain -------------------------------------------------------

// Fixed links of a closed chain, each after its joint.
template <std::size_t m>
using Links = std::array<DualQuaternion<double>, m>;

// Entries 0, 1, ... from ``begin`` on belong to joints first, first + 1, ... of a chain of m.
template <Index m>
void reorder(std::vector<Candidate>& list, Index first) {
    for (Candidate& candidate : list) {
        const auto turns = candidate.turns;
        for (Index j = 0; j < m; ++j) candidate.turns[(first + j) % m] = turns[j];
    }
}

// Rows that span conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b), of the pair in the middle.
inline Rows<double, 4> right_rows(const DualQuaternion<double>& after_b, const PairSpace& pair,
                                  const DualQuaternion<double>& after_d) {
    const DualQuaternion<double> left = conjugate(after_d), right = conjugate(after_b);
    Rows<double, 4> out;
    for (Index i = 0; i < 4; ++i) out[i] = (left * pair.rows[i]) * right;
    return out;
}

inline Candidates find_candidates(const Links<3>& links) {
    Index best = 0;
    double largest = -1.0;
    for (Index a = 0; a < 3; ++a) {
        const auto norms = PairSpace(links[a]).norms;
        const double smallest = std::min(norms[0], norms[1]);
        if (smallest > largest) {
            best = a;
            largest = smallest;
        }
    }
    const DualQuaternion<double> after_b = conjugate(links[(best + 1) % 3]);
    const DualQuaternion<double>& after_c = links[(best + 2) % 3];
    const PairSpace left(links[best]);
    const Rows<double, 2> rows{conjugate(after_c) * after_b, conjugate(half_turned(after_c)) * after_b};
    const Rows<Complex, 2> complex_rows = as_complex<2>(rows);
    Candidates out;
    CandidateSearch<2> search(left, left, complex_rows, out.list);
    out.sampled = search.search(projections(left.complement, complex_rows)).sampled;
    out.is_crowded = largest < elimination::regular;
    reorder<3>(out.list, best);
    return out;
}

inline Candidates find_candidates(const Links<4>& links) {
    Candidates out;
    for (Index a = 0; a < 2; ++a) {
        out.list.clear();
        const PairSpace left(links[a]), right(conjugate(links[a + 2]));
        const Rows<Complex, 4> rows = as_complex<4>(right_rows(links[a + 1], right, links[(a + 3) % 4]));
        CandidateSearch<4> search(left, right, rows, out.list);
        const auto outcome = search.search(projections(left.complement, rows));
        out.sampled = outcome.sampled;
        out.is_crowded = outcome.is_crowded;
        reorder<4>(out.list, a);
        if (!out.is_crowded) break;
    }
    return out;
}

// (cos(v / 2) M_0 + sin(v / 2) M_1) y = 0 for the kept joint v of a chain of five.
struct Pencil {
    PairSpace left;
    PairSpace right;
    Rows<double, 4> cosine_rows;
    Rows<double, 4> sine_rows;
    SmallMatrix<double, 4, 4> cosine_part;  // M_0
    SmallMatrix<double, 4, 4> sine_part;    // M_1

    Pencil(const Links<5>& links, Index kept)
        : left(links[(kept + 1) % 5]), right(conjugate(links[(kept + 3) % 5])) {
        const Rows<double, 4> rows = right_rows(links[(kept + 2) % 5], right, links[(kept + 4) % 5]);
        const DualQuaternion<double> back = conjugate(links[kept]);
        const DualQuaternion<double> turned_back = conjugate(half_turned(links[kept]));
        for (Index i = 0; i < 4; ++i) {
            cosine_rows[i] = back * rows[i];
            sine_rows[i] = turned_back * rows[i];
        }
        cosine_part = projections(left.complement, cosine_rows);
        sine_part = projections(left.complement, sine_rows);
    }
};

// An inverse (4, 4), and 1 over its Frobenius norm, which is at most the smallest singular value
// of the matrix; 0 for a singular one.
struct Inverse {
    SmallMatrix<double, 4, 4> matrix{};
    double regularity = 0.0;
};

// The inverse of c M_0 + s M_1, with complete pivoting.
inline Inverse invert(const Pencil& pencil, const Turn<double>& half) {
    SmallMatrix<double, 4, 8> a{};
    std::array<Index, 4> order;
    for (Index i = 0; i < 4; ++i) {
        a(i, 4 + i) = 1.0;
        order[i] = i;
        for (Index j = 0; j < 4; ++j) {
            a(i, j) = half.cosine * pencil.cosine_part(i, j) + half.sine * pencil.sine_part(i, j);
        }
    }
    for (Index k = 0; k < 4; ++k) {
        double best = 0.0;
        Index row = k, column = k;
        for (Index i = k; i < 4; ++i) {
            for (Index j = k; j < 4; ++j) {
                if (std::abs(a(i, j)) > best) {
                    best = std::abs(a(i, j));
                    row = i;
                    column = j;
                }
            }
        }
        if (best < elimination::no_pivot) return {};
        std::swap(order[k], order[column]);
        for (Index i = 0; i < 4; ++i) std::swap(a(i, k), a(i, column));
        for (Index j = 0; j < 8; ++j) std::swap(a(k, j), a(row, j));
        for (Index i = 0; i < 4; ++i) {
            if (i == k) continue;
            const double factor = a(i, k) / a(k, k);
            for (Index j = k; j < 8; ++j) a(i, j) -= factor * a(k, j);
        }
    }
    Inverse out;
    double total = 0.0;
    for (Index k = 0; k < 4; ++k) {
        for (Index j = 0; j < 4; ++j) {
            const double entry = a(k, 4 + j) / a(k, k);
            out.matrix(order[k], j) = entry;
            total += entry * entry;
        }
    }
    out.regularity = 1.0 / std::sqrt(total);
    return out;
}

// The elimination of a chain of five that keeps one joint, about the half angle ``origin``.
class KeptJoint {
public:
    KeptJoint(const Links<5>& links, Index joint) : joint_(joint), pencil_(links, joint) {
        for (double half : elimination::origins) {
            const Turn<double> turn = turn_by(half);
            const Inverse inverse = invert(pencil_, turn);
            if (inverse.regularity <= inverse_.regularity) continue;
            inverse_ = inverse;
            origin_ = turn;
        }
    }

    // How well the best of its matrices is conditioned.
    double regularity() const { return inverse_.regularity; }

    // Candidates from the eigenvalues; crowded where the iteration for these does not end, too.
    Candidates find_candidates() const {
        const auto [c0, s0] = origin_;
        SmallMatrix<Complex, 4, 4> standard;
        for (Index i = 0; i < 4; ++i) {
            for (Index j = 0; j < 4; ++j) {
                double total = 0.0;
                for (Index k = 0; k < 4; ++k) {
                    total += inverse_.matrix(i, k) *
                             (c0 * pencil_.sine_part(k, j) - s0 * pencil_.cosine_part(k, j));
                }
                standard(i, j) = total;
            }
        }
        Candidates out;
        std::array<Complex, 4> values;
        if (!bifurc::find_eigenvalues(standard, values)) {
            out.is_crowded = true;
            return out;
        }
        for (const Complex& value : values) add(value, out);
        reorder<5>(out.list, (joint_ + 1) % 5);
        return out;
    }

private:
    // cos(half) M_0 + sin(half) M_1 is singular for half = origin + arccot(-value).
    void add(const Complex& value, Candidates& out) const {
        constexpr Complex i(0.0, 1.0);
        const double size = std::sqrt(1.0 + std::norm(value));
        const Complex c = (-value * origin_.cosine - origin_.sine) / size;
        const Complex s = (-value * origin_.sine + origin_.cosine) / size;
        constexpr double least = elimination::infinite * elimination::infinite;
        if (std::min(std::norm(c + i * s), std::norm(c - i * s)) < least) return;
        const Rows<Complex, 4> rows = mix<4>(c, pencil_.cosine_rows, s, pencil_.sine_rows);
        SmallMatrix<Complex, 4, 4> matrix;
        for (std::size_t k = 0; k < matrix.values.size(); ++k) {
            matrix.values[k] = c * pencil_.cosine_part.values[k] + s * pencil_.sine_part.values[k];
        }
        const std::size_t before = out.list.size();
        const auto outcome = CandidateSearch<4>(pencil_.left, pencil_.right, rows, out.list).search(matrix);
        const Complex kept = (c + i * s) / (c - i * s);
        for (std::size_t k = before; k < out.list.size(); ++k) out.list[k].turns[4] = kept;
        out.sampled += outcome.sampled;
        const bool is_nearly_real = std::abs(std::abs(kept) - 1.0) < elimination::nearly_real;
        out.is_crowded = out.is_crowded || (outcome.is_crowded && is_nearly_real);
    }

    Index joint_;
    Pencil pencil_;
    Inverse inverse_;
    Turn<double> origin_{};
};

// The most regular elimination first: a symmetric geometry makes some of them singular.
inline Candidates find_candidates(const Links<5>& links) {
    std::vector<KeptJoint> eliminations;
    for (Index joint = 0; joint < 5; ++joint) eliminations.emplace_back(links, joint);
    const auto is_more_regular = [](const KeptJoint& a, const KeptJoint& b) {
        return a.regularity() > b.regularity();
    };
    std::stable_sort(eliminations.begin(), eliminations.end(), is_more_regular);
    for (const KeptJoint& each : eliminations) {
        if (each.regularity() < elimination::regular) break;
        Candidates out = each.find_candidates();
        if (!out.is_crowded) return out;
    }
    Candidates none;
    none.is_crowded = true;
    return none;
}

}  // namespace linkages

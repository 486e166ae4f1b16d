// Eigenpairs by Spectra (shift-invert) on Eigen's CholmodSupernodalLLT, for `cargo xtask bench spectrum`.
//
//     spectra FOLDER EIGENPAIRS TOLERANCE OUT
//
// The last line on stdout is JSON: CPU and wall seconds of factorization and iteration (reading apart),
// and the process's peak memory. OUT gets the eigenvalues, then the M-orthonormal eigenvectors row by row.

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>
#include <Spectra/SymEigsShiftSolver.h>

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// (A - sigma I)^-1 as Spectra wants it.
class Inverse {
public:
    using Scalar = double;

    Inverse(const Matrix& matrix, int ordering) : matrix_(matrix) {
        auto& common = solver_.cholmod();
        common.nmethods = 1;
        common.method[0].ordering = ordering;
        common.postorder = 1;
    }
    Eigen::Index rows() const { return matrix_.rows(); }
    Eigen::Index cols() const { return matrix_.cols(); }
    void set_shift(const double& sigma) {
        solver_.setShift(-sigma);
        solver_.compute(matrix_);
        if (solver_.info() != Eigen::Success) {
            std::fprintf(stderr, "the factorization failed\n");
            std::exit(1);
        }
    }
    void perform_op(const double* x, double* y) const {
        Eigen::Map<const Eigen::VectorXd> in(x, rows());
        Eigen::Map<Eigen::VectorXd> out(y, rows());
        out = solver_.solve(in);
    }

private:
    const Matrix& matrix_;
    Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower> solver_;
};

template <class T>
std::vector<T> read(std::ifstream& file, size_t count) {
    std::vector<T> values(count);
    file.read(reinterpret_cast<char*>(values.data()), count * sizeof(T));
    return values;
}

// Bytes. Not ru_maxrss: that of a process started by a larger one is the larger one's.
static long peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return 1024L * std::atol(line.c_str() + 6);
    return 0;
}

static double cpu_seconds() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

int main(int argc, char** argv) {
    if (argc != 5) return 2;
    const std::string folder = argv[1];
    const int k = std::atoi(argv[2]);
    const double tolerance = std::atof(argv[3]);

    std::ifstream file(folder + "/operator.bin", std::ios::binary);
    const auto size = read<uint64_t>(file, 2);
    const auto starts = read<int32_t>(file, size[0] + 1);
    const auto rows = read<int32_t>(file, size[1]);
    auto values = read<double>(file, size[1]);
    const auto mass = read<double>(file, size[0]);
    if (!file) return 2;
    const int n = static_cast<int>(size[0]);
    double measure = 0.0;
    for (int column = 0; column < n; ++column) {
        measure += mass[column];
        for (int at = starts[column]; at < starts[column + 1]; ++at)
            values[at] /= std::sqrt(mass[column] * mass[rows[at]]);
    }
    const Matrix matrix = Eigen::Map<const Matrix>(n, n, size[1], starts.data(), rows.data(), values.data());
    const bool surface = std::ifstream(folder + "/mesh.bin").good();
    // A small negative shift keeps the matrix definite: a tenth of 1/A of a surface, V^(-2/3) of a volume.
    const double sigma = -0.1 * std::pow(measure, surface ? -1.0 : -2.0 / 3.0);

    const auto start = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    Inverse inverse(matrix, surface ? CHOLMOD_AMD : CHOLMOD_METIS);
    Spectra::SymEigsShiftSolver<Inverse> solver(inverse, k, std::min(2 * k, n), sigma);
    solver.init();
    const auto found = solver.compute(Spectra::SortRule::LargestMagn, 1000, 0.1 * tolerance, Spectra::SortRule::SmallestAlge);
    const Eigen::VectorXd eigenvalues = solver.eigenvalues();
    const Eigen::MatrixXd vectors = solver.eigenvectors();
    const double used = cpu_seconds() - cpu;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    if (solver.info() != Spectra::CompInfo::Successful || found != k) {
        std::fprintf(stderr, "%d of %d converged\n", static_cast<int>(found), k);
        return 1;
    }
    const long peak = peak_memory();

    const bool ascending = k < 2 || eigenvalues[0] <= eigenvalues[k - 1];
    std::ofstream out(argv[4], std::ios::binary);
    auto write = [&](double x) { out.write(reinterpret_cast<const char*>(&x), sizeof x); };
    for (int i = 0; i < k; ++i) write(eigenvalues[ascending ? i : k - 1 - i]);
    for (int row = 0; row < n; ++row)
        for (int i = 0; i < k; ++i) write(vectors(row, ascending ? i : k - 1 - i) / std::sqrt(mass[row]));
    std::printf("{\"cpu\": %.6f, \"wall\": %.6f, \"peak\": %ld}\n", used, wall.count(), peak);
}

// Segmentation by the shape diameter function (Shapira et al. 2008) with CGAL, for `cargo xtask peers`.
//
//     shape_diameter                        the version
//     shape_diameter MESH OUT CLUSTERS      segmentations with 2, 3, ... CLUSTERS clusters
//
// MESH holds, little-endian: uint64 vertices and triangles; three doubles for each vertex; three uint32 for each
// triangle. OUT gets, for each number of clusters, an int32 for each triangle: its segment, segments being connected.
// All parameters are CGAL's defaults: a cone of 2/3 pi, 25 rays, smoothing 0.26.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/mesh_segmentation.h>
#include <CGAL/version.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = boost::graph_traits<Mesh>::face_descriptor;

template <class T>
std::vector<T> read(std::ifstream& file, size_t count) {
    std::vector<T> values(count);
    file.read(reinterpret_cast<char*>(values.data()), count * sizeof(T));
    return values;
}

int run(const char* input, const char* output, int clusters) {
    std::ifstream file(input, std::ios::binary);
    const auto size = read<uint64_t>(file, 2);
    const auto places = read<double>(file, 3 * size[0]);
    const auto corners = read<uint32_t>(file, 3 * size[1]);
    if (!file) {
        std::fprintf(stderr, "%s: cannot be read\n", input);
        return 1;
    }
    std::vector<Point> points;
    for (size_t v = 0; v < size[0]; ++v) points.emplace_back(places[3 * v], places[3 * v + 1], places[3 * v + 2]);
    std::vector<std::vector<std::size_t>> triangles;
    for (size_t t = 0; t < size[1]; ++t)
        triangles.push_back({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
    // CGAL's meshes are manifolds: vertices and edges where more than two triangles meet become several. The order of
    // the triangles stays.
    CGAL::Polygon_mesh_processing::orient_polygon_soup(points, triangles);
    Mesh mesh;
    std::vector<Mesh::Vertex_index> vertices;
    for (const Point& point : points) vertices.push_back(mesh.add_vertex(point));
    std::vector<Face> faces;
    for (const auto& t : triangles) {
        faces.push_back(mesh.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]));
        if (faces.back() == Mesh::null_face()) {
            std::fprintf(stderr, "triangle %zu makes the surface no manifold\n", faces.size() - 1);
            return 1;
        }
    }
    auto sdf = mesh.add_property_map<Face, double>("f:sdf").first;
    auto segment = mesh.add_property_map<Face, std::size_t>("f:segment").first;
    CGAL::sdf_values(mesh, sdf);
    std::ofstream out(output, std::ios::binary);
    for (int k = 2; k <= clusters; ++k) {
        CGAL::segmentation_from_sdf_values(mesh, sdf, segment, k, 0.26);
        for (const Face face : faces) {
            const int32_t label = static_cast<int32_t>(segment[face]);
            out.write(reinterpret_cast<const char*>(&label), sizeof label);
        }
    }
    return 0;
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::printf("CGAL %s\n", CGAL_VERSION_STR);
        return argc == 1 ? 0 : 2;
    }
    try {
        return run(argv[1], argv[2], std::atoi(argv[3]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

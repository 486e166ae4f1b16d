mser3d_shape::choice! {
    /// The classes of transforms of the synthetic benchmark. D is the diagonal of the null shape's bounding box, s
    /// the strength from 1 to 5.
    #[derive(PartialOrd, Ord)]
    #[non_exhaustive]
    // The order is that of the names, and part of each transform's seed.
    pub enum Class("class of transforms") {
        /// A linear map of space near the identity
        ///
        /// It is I + 0.1 s R, with R random of Frobenius norm 1.
        Affine = "affine",
        /// Large holes in the surface
        ///
        /// There are 2 s of them, each of radius 0.04 D along the surface.
        Holes = "holes",
        /// Another pose of the same figure
        ///
        /// One pose per strength; see [`isometry`](super::isometry).
        Isometry = "isometry",
        /// Parts grown and shrunk
        ///
        /// Six regions of radius 0.15 D, in turn grown by up to 10 s % and shrunk by up to 8 s %.
        Localscale = "localscale",
        /// Many holes of the size of a triangle
        ///
        /// The triangles around 2 s % of the vertices are removed: with strength 5, nearly half of them.
        Microholes = "microholes",
        /// Every vertex displaced along its normal
        ///
        /// Normally distributed with standard deviation 0.002 s D.
        #[default]
        Noise = "noise",
        /// One side of a random plane cut away
        ///
        /// 1 - 0.08 s of the area stays.
        Partial = "partial",
        /// Voxelized and made a surface again
        ///
        /// The voxels have a pitch of 0.0025 (s + 1) D.
        Rasterize = "rasterize",
        /// Fewer vertices
        ///
        /// Decimated to 60, 35, 20, 10 and 4 % of the vertices.
        Sampling = "sampling",
        /// Scaled as a whole
        ///
        /// By 0.5, 0.875, 1.25, 1.625 and 2.
        Scaling = "scaling",
        /// A few vertices displaced far along their normals
        ///
        /// 0.4 s % of the vertices, in or out, by 0.01 D to 0.03 D.
        Shotnoise = "shotnoise",
        /// Parts glued together by tubes
        ///
        /// 2 s tubes of radius 0.012 D between parts that face each other; where no parts do, tunnels
        /// through the solid.
        Topology = "topology",
        /// What one far camera sees
        ///
        /// The strength numbers the camera.
        View = "view",
    }
}
